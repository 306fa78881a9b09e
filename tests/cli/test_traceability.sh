#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Every report says what its lengths rest on; no limit is judged where that is nothing.
#   test_traceability.sh PROGRAM
. tests/support/cli.sh

scanner='"scanner": {"dpi": 1200, "blur_px": 1.1, "noise": 1.0}, "effects": [{"id": "scan.scale_y", "value": 0.002}]'
cat >plate_spec.json <<J
{"schema": "foilgauge/render/1", "seed": 5, $scanner, "discs": [{"centre_mm": [5, 5], "radius_mm": 1.5},
 {"centre_mm": [20, 6], "radius_mm": 2}, {"centre_mm": [6, 20], "radius_mm": 2.5}, {"centre_mm": [21, 21], "radius_mm": 3}]}
J
cat >foil_spec.json <<J
{"schema": "foilgauge/render/1", "seed": 3, "foils": [{"design": {"bump_count": 3}}], $scanner}
J
mkdir scans
"$renderer" render plate_spec.json -o plate.png && "$renderer" render foil_spec.json -o scans/foil.png || fail "render"
design() {
  echo "{\"schema\": \"foilgauge/design/1\", \"bump_count\": 3, \"tolerances\": {\"radius_mm\": {\"min\": 3, \"max\": 3.5}}$1}" >"$2"
}
plate() {
  echo "{\"schema\": \"foilgauge/design/1\", \"form\": \"discs\", \"diameters_mm\": [3, 4, 5, 6]$1}" >"$2"
}
artefact='"artefact": {"name": "GP <17>", "certificate": "K 9", "date": "2026-03-14", "due": "2099-03-14"}'
design '' none.json
design ', "calibration": "flatbed"' flatbed.json
design ', "calibration": "not needed: the scan is rendered"' reason.json
plate '' known.json
plate ", $artefact" traced.json
scan=scans/foil.png

# Nothing is known: no limit is judged, however far a value lies from it, and every output says so.
expect 3 'no limit is judged. Scan a plate' "$program" measure $scan -d none.json -o none.out --html none.html --csv none.csv
grep -q '"cannot_tell": 3' none.out && grep -q '"state": "none"' none.out || fail "none: $(grep -A1 traceability none.out)"
sed 's/"max": 3.5/"max": 3.1/' none.json >far.json
expect 3 '' "$program" measure $scan -d far.json -o far.out
grep -q 'traced to: none' none.html || fail "the page does not say that it rests on nothing"
head -n 1 none.csv | grep -q ',traceability' && sed -n 2p none.csv | grep -q ',none,' || fail "CSV"
valid measure.schema.json none.out

# The default for a flatbed is never silent, and a reason is printed.
expect 0 '' "$program" measure $scan -d none.json --flatbed -o option.out
expect 0 '' "$program" measure $scan -d flatbed.json -o flatbed.out
expect 0 '' "$program" measure $scan -d reason.json -o reason.out --html reason.html
for name in option flatbed; do
  [ "$(value $name.out 'r["traceability"]["certificate"]')" = 'the default for an unknown flatbed' ] || fail "$name is silent"
  [ "$(value $name.out 'r["foils"][0]["bumps"][0]["u_radius_mm"] > 0.005')" = True ] || fail "$name: u does not hold 0.3 %"
done
grep -q 'no calibration is needed: the scan is rendered' reason.html || fail "the reason is not printed"
expect 64 'the design states a calibration' "$program" measure $scan -d flatbed.json --flatbed
expect 65 'with its reason' "$program" measure $scan -d <(sed 's/: the scan is rendered//' reason.json)
"$program" design reason.json | grep -q 'not needed: the scan is rendered' || fail "the design does not show the reason"

# A plate's certificate goes by the scanner's model to every foil, until its due date.
expect 0 '' "$program" loop plate.png --design known.json --model-out known_model.json
expect 0 '' "$program" loop plate.png --design traced.json --model-out traced_model.json
valid scan_model.schema.json traced_model.json
expect 0 '' "$program" measure $scan -d none.json --model known_model.json -o known.out
expect 0 '' "$program" measure $scan -d none.json --model traced_model.json -o traced.out --html traced.html
[ "$(value known.out 'r["traceability"]["state"]')" = stated ] || fail "known diameters without a certificate"
[ "$(value traced.out '"{state} {artefact} {certificate} {date} {due}".format(**r["traceability"])')" = \
  'plate GP <17> K 9 2026-03-14 2099-03-14' ] || fail "the plate's certificate is lost"
grep -q 'plate: GP &lt;17&gt;, certificate K 9 of 2026-03-14, due 2099-03-14' traced.html || fail "the page"
# A grid of known pitch holds the scale as known diameters do; foils alone do not.
sed 's/"known_diameters": [0-9]*/"known_diameters": 0/' known_model.json >foils_model.json
sed 's/"known_grids": 0/"known_grids": 1/' foils_model.json >grid_model.json
expect 3 '' "$program" measure $scan -d none.json --model foils_model.json -o foils.out
expect 0 '' "$program" measure $scan -d none.json --model grid_model.json -o grid.out
[ "$(value grid.out 'r["traceability"]["state"] + " " + str(r["model"]["known_grids"])')" = 'stated 1' ] || fail "a grid of known pitch"
sed 's/"known_grids": 0/"known_grids": -1/' foils_model.json >bad_model.json
expect 65 'how many gauges' "$program" measure $scan -d none.json --model bad_model.json
sed 's/2099-03-14/2026-03-20/' traced_model.json >due_model.json
touch -d 2026-03-20T12:00Z $scan
expect 0 '' "$program" measure $scan -d none.json --model due_model.json
touch -d 2026-03-21T12:00Z $scan
expect 65 'was due for calibration on 2026-03-20' "$program" measure $scan -d none.json --model due_model.json
sed 's/"date": "2026-03-14"/"date": "soon"/' traced_model.json >bad_model.json
expect 65 'is no date' "$program" measure $scan -d none.json --model bad_model.json

# Lots, and what quality systems read.
expect 3 'nothing is known of the scanner' "$program" lot scans -d none.json -o lot_none
expect 0 '' "$program" lot scans -d none.json --flatbed -o lot_flatbed
expect 0 '' "$program" lot scans -d none.json --model traced_model.json -o lot_traced
grep -q 'nothing is known of the scanner' lot_none/index.html || fail "the lot's page does not say why"
for state in none flatbed:stated traced:plate; do
  folder=lot_${state%:*} word=${state#*:}
  [ "$(value "$folder/lot.json" 'r["traceability"]["state"]')" = "$word" ] || fail "$folder: lot.json"
  grep -qa "^K1900 traced to $word" "$folder/results.dfq" || fail "$folder: results.dfq"
  grep -q "name=\"traceability\" value=\"$word" "$folder/results.qif" || fail "$folder: results.qif"
  sed -n 2p "$folder/foils.csv" | grep -q ",$word," || fail "$folder: foils.csv"
  sed -n 2p "$folder/bumps.csv" | grep -q ",$word," || fail "$folder: bumps.csv"
  valid lot.schema.json "$folder/lot.json"
done
# A station withholds verdicts that would rest on nothing.
for kind in none flatbed; do
  mkdir "station_$kind"
  cp -p $scan "station_$kind"
  echo "{\"schema\": \"foilgauge/recipe/1\", \"design\": \"$kind.json\"}" >"$kind.recipe"
done
expect 3 '' "$program" station station_none --recipe none.recipe --once
expect 0 '' "$program" station station_flatbed --recipe flatbed.recipe --once
checks - <<'P' || fail "the station's verdicts"
import sqlite3
for kind in "none", "flatbed":
    withheld, = sqlite3.connect(f"station_{kind}/foilgauge.sqlite").execute("SELECT withheld FROM scans").fetchone()
    assert (withheld or "").startswith("Nothing is known of the scanner's scale") == (kind == "none"), (kind, withheld)
P
exit $failed
