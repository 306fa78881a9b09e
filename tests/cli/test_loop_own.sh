#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on what the program itself measured: `loop --lot` and `loop --doe --scans`.
. tests/support/loop.sh
skip_when_slow
listened="stdout stderr"

# foil NAME SEED SPRINGBACK: a foil of four bumps whose radii lie above the design's by that share, with a scatter.
foil() {
  printf '{"schema":"foilgauge/render/1","seed":%d,"foils":[{"design":{"bump_count":4},"overall_radius_mm":20.9,
"radius_springback":{"mean":%s,"sd":0.01},"rotate_deg":-90}],"scanner":{"dpi":1200,"blur_px":1.0,"noise":1}}' \
    "$2" "$3" >spec.json
  "$renderer" render spec.json -o "$1" || fail "render $1"
}
printf '{"schema":"foilgauge/design/1","bump_count":4}' >four.json

# Fourteen foils, bent on two dies that differ by 5 % of the radius; the manifest is a German one.
mkdir scans
echo 'scan;serial;die;coil_mm;operator;date' >lot.csv
for i in $(seq 14); do
  die=$((i * 7 % 3 % 2))
  foil "scans/$i.png" "$i" "0.0$((3 + 5 * die))"
  printf 'scans/%d.png;F%03d;%s;0,10%d;%s;%02d.05.2024\n' "$i" "$i" "$((die + 1))A" $((i * i % 10)) \
    "$([ $((i % 4)) -lt 2 ] && echo ann || echo bob)" $((1 + i / 2)) >>lot.csv
done
expect 0 '' "$program" lot lot.csv -o lot --design four.json
expect 0 '' "$program" loop --lot lot -o bumps.json --html bumps.html
checks - <<'P' || fail "the bumps of the lot: $(head -c 3000 bumps.json)"
import json
r = json.load(open("bumps.json"))
assert r["verdict"] == "explained", r["summary"]
names = {c["name"] for c in r["claims"]} | {a["name"] for c in r["claims"] for a in c["alias_class"]}
assert "table.factor(die)" in names, names
assert r["declared"] == {"response": "radius_mm", "model": "1", "offset": None, "group": "foil", "groups": 14}, r["declared"]
assert [i["path"] for i in r["inputs"]] == ["lot/results.jsonl", "lot/manifest.csv", "lot/recipe.json"]
assert r["inputs"][0]["rows"] == 56 and all(len(i["sha256"]) == 64 for i in r["inputs"])
tried = " ".join(c["name"] for c in r["claims"] + r["rejected"])
for column in ("die", "coil_mm", "operator", "date", "serial", "bump"):
    assert column in tried, (column, tried)
for column in ("height", "scan", "verdict", "stiffness", "rms"):
    assert column not in tried, (column, tried)
notes = " ".join(r["notes"])
assert "serial counts by the digits behind 'F'" in notes and "date counts days since 01.05.2024" in notes, notes
P
valid loop.schema.json bumps.json
grep -q 'date counts days since' bumps.html || fail "the page does not say how the dates are taken"
sum=$(sha256sum lot/results.jsonl | cut -d' ' -f1)
grep -q "$sum" bumps.json || fail "the sum of the results is not theirs"

# Foils; constant arc length; columns left out; what the loop cannot have.
expect 0 '"rows": 14,' "$program" loop --lot lot --response overall.radius_mm -o -
grep -q '"group": null' stdout || fail "foils that are there once are grouped"
expect 0 '"model": "arc_length"' "$program" loop --lot lot --response bump_angle_deg --model arc_length -o -
expect 0 '' "$program" loop --lot lot --without die -o without.json
grep -q 'die' without.json && fail "a column that is left out is a candidate"
expect 65 "'stiffness' is no quantity that a lot holds; there are: .*radius_mm" "$program" loop --lot lot --response stiffness
expect 74 "no/results.jsonl" "$program" loop --lot no
expect 64 "a file of the lot" "$program" loop --lot lot -o lot/foils.csv
expect 64 "one of --table, --lot and --doe" "$program" loop --lot lot --table lot.csv
expect 65 "no column 'dye'; the columns are" "$program" loop --lot lot --without dye
sed 's/operator/OPERATOR/' lot/manifest.csv >other.csv
cp -r lot changed && cp other.csv changed/manifest.csv
expect 65 "changed/manifest.csv: not the one" "$program" loop --lot changed
# A column of names and numbers is refused, with its line in the manifest; foils that were measured again are one.
awk -F';' -v OFS=';' 'NR == 5 { $4 = "thin" } NR > 1 { $2 = "F" int(NR / 2) } { print }' lot.csv | sed 's/serial/foil/' >again.csv
expect 0 '' "$program" lot again.csv -o again --design four.json
expect 65 "again/manifest.csv: row 1 .line 2., column 'coil_mm': '0,10[0-9]*' is a number.*; and 'thin' in the same column" "$program" loop --lot again
expect 0 '"groups": 7' "$program" loop --lot again --response overall.radius_mm --without coil_mm -o -

[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || exit $failed

# Its own tables through --table: results of the same measurement are never causes.
expect 0 '' "$program" loop --table lot/bumps.csv --response radius_mm --model 1 --group serial -o own.json
checks - <<'P' || fail "the lot's own table: $(head -c 2000 own.json)"
import json
r = json.load(open("own.json"))
tried = " ".join(c["name"] for c in r["claims"] + r["rejected"])
for column in ("stiffness", "verdict", "arc_", "points", "height", "u_"):
    assert column not in tried, (column, tried)
assert "results of the same measurement, not causes: flags, normalised_stiffness" in r["not_candidates"]
P

# Runs: the radius follows the temperature, which the model knows, and the shelf, which it does not.
echo 'run,T_C,shelf,by,scan' >runs.csv
for i in $(seq 12); do
  shelf=$((i % 4 / 2))
  foil "scans/r$i.png" $((100 + i)) "0.$((10 + 4 * (i % 2) + 3 * shelf))"
  echo "$i,$((500 + 100 * (i % 2))),S$shelf,$([ $i -lt 6 ] && echo ann || echo bob),r$i.png" >>runs.csv
done
runs=("$program" loop --doe runs.csv --response radius_mm --model T_C --design four.json)
expect 0 '' "${runs[@]}" --scans scans -o runs.json
checks - <<'P' || fail "the runs: $(head -c 3000 runs.json)"
import json
r = json.load(open("runs.json"))
assert r["verdict"] == "explained", r["summary"]
assert [c["name"] for c in r["claims"]] == ["table.factor(shelf)"], r["summary"]
assert [i["path"] for i in r["inputs"]] == ["runs.csv"] + ["scans/r%d.png" % i for i in range(1, 13)]
tried = " ".join(c["name"] for c in r["claims"] + r["rejected"])
assert "by" in tried and "run" in tried and "scan" not in tried and "u_" not in tried, tried
P
valid loop.schema.json runs.json
# The same numbers as `doe --scans` measures, copied by hand.
cp runs.csv scans
expect 0 '' "$program" doe scans/runs.csv --scans scan --response radius_mm --model T_C --design four.json -o doe.json
python3 - <<'P'
import csv, json
runs = list(csv.DictReader(open("runs.csv")))
measured = [run["response"] for run in json.load(open("doe.json"))["runs"]]
with open("copied.csv", "w") as out:
    print("run,T_C,shelf,by,radius_mm", file=out)
    for run, y in zip(runs, measured, strict=True):
        print(run["run"], run["T_C"], run["shelf"], run["by"], y, sep=",", file=out)
P
expect 0 '' "$program" loop --table copied.csv --response radius_mm --model T_C -o copied.json
near "the shelf's amplitude" "$(value runs.json 'r["claims"][0]["amplitude"]')" \
  "$(value copied.json 'r["claims"][0]["amplitude"]')" 1e-7

# A scan that is not there leaves its run out and is said; the sheet beside its scans needs no folder.
sed 's/,r3.png/,lost.png/' runs.csv >scans/lost.csv
expect 2 'row 3: scans/lost.png: cannot be opened' "$program" loop --doe scans/lost.csv --response radius_mm --model T_C \
  --design four.json -o lost.json
valid loop.schema.json lost.json
grep -q '"scans/lost.png", "sha256": null' lost.json || fail "a scan that cannot be read has a sum"
grep -q '"left out: 0 runs without a scan, 1 scan that could not be measured"' lost.json || fail "what is left out is not said"
expect 64 "which column was measured" "$program" loop --doe runs.csv --model T_C
expect 64 "belongs to --doe" "$program" loop --lot lot --scans scans
expect 64 "the scan" "${runs[@]}" --scans scans -o scans/r1.png

exit $failed
