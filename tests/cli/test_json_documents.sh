#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A document for each schema of reports/schema, written by the program, is valid by python3-jsonschema; one that is not
# is refused. tests/bench/json_documents.sh holds the documents of all tests against the schemas.
. tests/support/cli.sh
skip_when_slow
kept=$(dirname "$program")/tests/foilgauge_kept
samples=$root/samples
runs=$samples/doe/springback_factorial.csv

# validate CODE WORDS: the documents in $work/documents.
validate() {
  expect "$1" "$2" /usr/bin/python3 -B "$root/tests/support/validate_documents.py" "$root/reports/schema" "$work/documents"
}
/usr/bin/python3 -c 'import jsonschema' 2>"$work/stderr" ||
  { echo "skipped: no python3-jsonschema" && exit 77; }

mkdir -p documents/own scans
export FOILGAUGE_KEEP_JSON=$work/documents/own
for seed in 1 2; do
  cat >spec.json <<S
{"schema": "foilgauge/render/1", "seed": $seed, "scanner": {"dpi": 1200},
 "foils": [{"rotate_deg": -90, "design": {"bump_count": 2}}]}
S
  expect 0 "" "$kept" render spec.json -o scans/$seed.png --truth truth.json
done
echo '{"schema": "foilgauge/design/1", "bump_count": 2}' >design.json
expect 0 "" "$kept" measure scans/1.png --design design.json -o -
python3 -c 'import json, sys; json.load(open(sys.argv[1]))' stdout || fail "a document that is kept does not reach its reader"
expect 0 "" "$kept" design design.json -o nominal.json
expect 0 "" "$kept" film --load 20 --speed 60000 --clearance 40 --mesh 2,2 --speeds 50000:60000:2 --shims=-5:5 --draws 2 -o film.json
expect 0 "" "$kept" lot scans --design design.json -o lot
expect 0 "" "$kept" lot scans/1.png --design design.json -o lot1
expect 0 "" "$kept" die --target design.json --lot lot1 -o next.json
expect 0 "" "$kept" lot scans/2.png --design design.json -o lot2 --expected next.json
expect 0 "" "$kept" lot --index lots.html -o lots.json lot
expect 0 "" "$kept" loop scans/1.png --design design.json -o loop.json --model-out scanner.json
python3 - >plate.json <<'P'
import json
discs = [{"centre_mm": [3 + 2.5 * i, 3 + 2.5 * j], "radius_mm": 0.5} for i in range(7) for j in range(5) if i + j]
print(json.dumps({"schema": "foilgauge/render/1", "seed": 3, "scanner": {"dpi": 600}, "discs": discs}))
P
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "pitch_mm": 2.5, "u_pitch_mm": 0.0005}' >grid.json
expect 0 "" "$kept" render plate.json -o plate.png
expect 0 "" "$kept" measure plate.png --design grid.json -o grid_measured.json
expect 0 "" "$kept" loop plate.png --design grid.json -o grid_loop.json --model-out grid_scanner.json
expect 0 "" "$kept" scanner grid_scanner.json grid_scanner.json -o scanner_change.json
expect 0 "" "$kept" loop --table "$runs" --response springback_error_pct \
  --model '1 + pressure_bar + temperature_C + duration_h' -o table.json --model-out model.json
expect 0 "" "$kept" doe "$runs" --response springback_error_pct --model 'temperature_C*duration_h' -o doe.json
expect 0 "" "$kept" doe plan --factor temperature_C=500:600 --factor duration_h=3:5 -o plan.csv
expect 0 "" "$kept" die "$samples/die/concave_1.txt" "$samples/die/convex_1.txt" -o die.json
expect 0 "" "$kept" forming --temperature 650 --time 5 -o form.json --material-out material.json
expect 0 "" "$kept" stiffness "$samples/stiffness/bearings.csv" -o stiffness.json
printf '%s\n' temperature_C,duration_h,springback_error_pct 500,3,20 600,3,15 500,5,18 600,5,11 550,4,16 650,4,9 >runs.csv
expect 0 "" "$kept" forming --fit runs.csv -o fit.json
mkdir parts hubbed
cp scans/1.png hubbed
echo '{"schema": "foilgauge/recipe/1", "station": {"pass_on": [{"to": "parts"}]}, "design": {"schema": "foilgauge/design/1", "bump_count": 2}}' >recipe.json
checks - "$kept" <<'P' || fail "the station passes nothing on"
import os, subprocess, sys, urllib.request
station = subprocess.Popen([sys.argv[1], "station", "scans", "--recipe", "recipe.json", "--port", "0"],
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
try:
    base = station.stdout.readline().strip()
    wait_until(lambda: len([name for name in os.listdir("parts") if name.endswith(".json") and name[0] != "."]) == 2)
    urllib.request.urlopen(base + "api/outbox").read()
    hub = subprocess.Popen([sys.argv[1], "hub", "--database", "hub.sqlite", "--port", "0"], stdout=subprocess.PIPE, text=True)
    address = hub.stdout.readline().strip()
    subprocess.run([sys.argv[1], "station", "hubbed", "--recipe", "recipe.json", "--once", "--hub", address], stderr=subprocess.DEVNULL)
    assert b'"serial"' in urllib.request.urlopen(address + "api/parts").read()
    hub.terminate()
    hub.wait()
finally:
    station.terminate()
    station.wait()
P
validate 0 ""
grep -q '^| measure.schema.json | 2 |' stdout || fail "the reports of scans are not counted: $(cat stdout)"

# refuse WORDS DOCUMENT
mkdir documents/made
refuse() {
  echo "$2" >documents/made/made.json
  validate 1 "$1"
}
refuse 'plan.schema.json: axial: .far. is not' '{"schema": "foilgauge/plan/1", "version": "1", "axial": "far", "factors": [], "settings": []}'
refuse "plan.schema.json: .document.: 'axial' is a required" '{"schema": "foilgauge/plan/1", "version": "1", "factors": [], "settings": []}'
refuse 'foilgauge/unknown/1 has no file' '{"inside": [{"schema": "foilgauge/unknown/1"}]}'
refuse 'stand in one object twice: .*name' '{"name": 1, "name": 2}'
refuse 'NaN is no JSON' '{"value": NaN}'
refuse 'not JSON' '{"value": 1'
rm -r documents/made
grep -l foilgauge/nominal/1 documents/own/*.json | xargs rm
validate 1 'nominal.schema.json: no test makes'

exit $failed
