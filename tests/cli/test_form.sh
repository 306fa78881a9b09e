#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge forming`: its outputs, a measured die, constants from runs, bad input. Its numbers: unit/test_forming.c.
. tests/support/cli.sh
listened="stdout stderr"

echo '{"schema": "foilgauge/design/1", "name": "<b>&"}' >design.json
expect 0 "" "$program" forming design.json --temperature 650 --time 5 --pressure 300 -o form.json --html form.html --table form.txt \
  --table-out bumps.csv --strip-out strip.csv --material-out material.json
grep -q '&lt;b&gt;&amp;' form.html && ! grep -q '<b>&' form.html || fail "a name is not made harmless"
for words in '<dt>Program</dt>' '<dt>Design</dt>' 'curvature, 1/mm' 'stress at the face, MPa' 'bump radius' 'Frost and Ashby' 'contact and friction'; do
  grep -q "$words" form.html || fail "the page lacks $words"
done
grep -q 'contact and friction' form.txt || fail "the table does not say what is out of reach"
value form.json "r['notes']" | grep -q 'contact and friction' || fail "the report does not say what is out of reach"
[ "$(wc -l <bumps.csv)" = 10 ] && [ "$(wc -l <strip.csv)" = 48 ] || fail "rows of the tables"
near "bump 5" "$(awk -F, '$1 == 5 {print $2}' bumps.csv)" "$(value form.json "r['bumps'][4]['radius_mm']")" 1e-6

# The constants that it wrote, and a hold as a schedule, give the same; --pressure changes nothing.
printf 'time_h,temperature_C\n0,650\n2,650\n5,650\n' >hold.csv
expect 0 "" "$program" forming design.json --material material.json --schedule hold.csv -o again.json
[ "$(value again.json "r['inputs']['material']['path'], r['inputs']['schedule']['path']")" = "('material.json', 'hold.csv')" ] ||
  fail "what was read is not named"
near "a hold in two parts" "$(value again.json "r['bumps'][4]['radius_mm']")" \
  "$(value form.json "r['bumps'][4]['radius_mm']")" 1e-9
expect 0 "" "$program" forming --shape sine -o sine.json
# A strip without strength takes the die's shape: its circles are the die's, which for a sine are not the design's arcs.
echo '{"schema":"foilgauge/material/1","yield_mpa":1,"hardening_mpa":0}' >soft.json
expect 0 "" "$program" forming --shape sine --material soft.json -o soft_sine.json
near "a soft strip in a sine" "$(value soft_sine.json "r['bumps'][4]['radius_mm'] / r['bumps'][4]['die_radius_mm']")" 1 0.001
near "angle of a soft strip" "$(value soft_sine.json "r['bumps'][4]['bump_angle_deg'] / r['bumps'][4]['die_bump_angle_deg']")" 1 0.001
near "a sine's circle" "$(value soft_sine.json "r['bumps'][4]['die_radius_mm']")" 2.64 0.02
expect 0 "" "$program" forming "$root/samples/render/../top_foil_design.json" -o arc.json
[ "$(value arc.json "r['overall']['radius_mm'] == r['plain_strip']['radius_mm'] and r['bumps']")" = "[]" ] || fail "a plain strip"

# A die that was measured: its bumps are the die's, +0.09 and +0.35 % by halves, and the foil's follow them.
expect 0 "" "$program" die "$root"/samples/die/*.txt -o die.json
expect 0 "" "$program" forming --die die.json -o of_die.json
expect 0 "" "$program" forming -o of_design.json
checks - of_die.json of_design.json die.json <<'END' || fail "the die's bumps"
import json, sys
die_form, design_form, die = (json.load(open(name)) for name in sys.argv[1:])
of = {b["number"]: b["radius_mm"] for b in die["die"]["bumps"]}
for a, b in zip(die_form["bumps"], design_form["bumps"]):
    assert abs(a["die_radius_mm"] - of.get(a["number"], die["die"]["mean"]["radius_mm"])) < 1e-7, a
    grown = a["radius_mm"] / b["radius_mm"] / (a["die_radius_mm"] / b["die_radius_mm"])
    assert 1 < grown < 1.002, grown  # a flatter bump springs back by a little more
END

if [ -z "${FOILGAUGE_TEST_BRIEF-}" ]; then
# Constants from the thesis's thirteen runs, as a page, a table and a material.
cat "$root/samples/doe/springback_factorial.csv" | cut -d, -f3- >runs.csv
tail -n +6 "$root/samples/doe/springback_composite.csv" | cut -d, -f2- >>runs.csv
[ "$(wc -l <runs.csv)" = 14 ] || fail "the sample's runs"
expect 0 "" "$program" forming --fit runs.csv -o fit.json --html fit.html --table fit.txt --material-out fitted.json
valid form_fit.schema.json fit.json
valid material.schema.json fitted.json material.json
valid form.schema.json form.json arc.json of_die.json
near "residual sd" "$(value fit.json "r['beam_model']['residual_sd']")" 1.81 0.01
grep -q 'leaves 1.81 points' fit.txt && grep -q 'quadratic surface 1.41' fit.txt || fail "what the fit leaves is not said"
grep -q 'not beyond' fit.html || fail "the page does not say how far a fit may be believed"
expect 0 "fitted to 13 runs" "$program" forming --material fitted.json --temperature 650 --time 5 -o -

fi

# Bad input: the error and its place.
bad() {
  echo "$2" >bad.json
  expect 65 "bad.json: .*$1" "$program" forming --material bad.json
}
head='"schema": "foilgauge/material/1"'
bad "line 2, column 1: this is not JSON" "{ $head"
bad "schema is missing" '{"yield_mpa": 300}'
bad "yield_stress is not a member" "{$head, \"yield_stress\": 300}"
bad "yield_mpa must be a number" "{$head, \"yield_mpa\": \"300\"}"
bad "yield_mpa is -3; it must be from 1" "{$head, \"yield_mpa\": -3}"
bad "yield_mpa is given twice" "{$head, \"yield_mpa\": 300, \"yield_mpa\": 301}"
bad "yield_mpa: the unit must be .MPa" "{$head, \"yield_mpa\": {\"value\": 0.3, \"unit\": \"GPa\"}}"
bad "creep_exponent is 0.5" "{$head, \"creep_exponent\": 0.5}"
bad "temperatures must rise" "{$head, \"yield_curve\": {\"temperature_C\": [20, 20], \"share\": [1, 1]}}"
bad "2 temperatures and 1 shares" "{$head, \"yield_curve\": {\"temperature_C\": [20, 30], \"share\": [1]}}"
bad "nothing is left of E" "{$head, \"modulus_slope_per_K\": 0.001, \"yield_curve\": {\"temperature_C\": [20, 990], \"share\": [1, 1]}}"
: >empty.json
expect 65 "empty.json: line 1" "$program" forming --material empty.json
expect 65 "2000 degrees C is beyond the material" "$program" forming --temperature 2000 --time 1
printf 'time_h,temperature_C\n0,650\n1,2000\n' >hot.csv
expect 65 "hot.csv: row 2: temperature_C: 2000 degrees C is beyond the material" "$program" forming --schedule hot.csv
printf 'temperature_C,duration_h,springback_error_pct\n500,3,-13\n500,3,-9\n600,3,-4\n2000,3,-4\n600,3,-4\n' >hot.csv
expect 65 "hot.csv: row 4: temperature_C: 2000 degrees C is beyond the material" "$program" forming --fit hot.csv

printf 'temperature_K,duration_h,springback_error_pct\n773,3,-13\n773,3,-9\n873,3,-4\n873,5,-4\n873,7,-3\n' >kelvin.csv
expect 65 "no column 'temperature_C'.*in degrees Celsius" "$program" forming --fit kelvin.csv

# A constant that runs to its bound is not identified: table, report, page and material say so.
printf 'temperature_C,duration_h,springback_error_pct\n500,3,-900\n500,5,-900\n600,3,-900\n600,5,-900\n' >flat.csv
expect 0 "" "$program" forming --fit flat.csv --free creep_rate_per_h -o bound.json --table bound.txt --html bound.html --material-out bound_material.json
[ "$(value bound.json "[(f['at_bound'], f['identified']) for f in r['found']]")" = "[(True, False)]" ] || fail "a constant at its bound is called found"
for report in bound.txt bound.html bound_material.json; do
  grep -q 'at its bound: not identified' $report || fail "$report does not say that a constant is at its bound"
done
value bound.json "r['notes']" | grep -q 'At its bound: not identified: creep_rate_per_h' || fail "the notes do not name it"
printf 'time_h,temperature_C\n0,650\n0,650\n' >bad.csv
expect 65 "bad.csv: row 2: time_h is 0 after 0" "$program" forming --schedule bad.csv
printf 'time_h,temperature_C\n0,650\n1,hot\n' >bad.csv
expect 65 "bad.csv: .*row 2" "$program" forming --schedule bad.csv
printf 'temperature_C,duration_h,springback_error_pct\n500,3,-13\n500,3,-9\n600,3,-4\n' >bad.csv
expect 65 "3 runs; to find 3 constants takes 5" "$program" forming --fit bad.csv
printf 'temperature_C,duration_h,springback_error_pct\n500,3,-13\n500,0,-9\n600,3,-4\n600,3,-4\n600,3,-4\n' >bad.csv
expect 65 "row 2: duration_h is 0" "$program" forming --fit bad.csv
expect 65 "bad.csv: .*spring" "$program" forming --fit bad.csv --response spring
echo '{"schema": "foilgauge/design/1", "form": "discs", "diameters_mm": [5]}' >discs.json
expect 65 "has no strip that is bent" "$program" forming discs.json
expect 65 "form.json: not a report of .foilgauge die" "$program" forming --die form.json
expect 64 "belong together" "$program" forming --temperature 650
expect 64 "says temperature and time already" "$program" forming --temperature 650 --time 5 --schedule hold.csv
expect 64 "is no constant of a material" "$program" forming --fit bad.csv --free stiffness
expect 64 "belong to --fit" "$program" forming --of foil
expect 64 "neither arcs nor sine" "$program" forming --shape round
expect 64 "" "$program" forming design.json -o design.json
if [ -w /dev/full ]; then expect 74 "full" "$program" forming -o /dev/full; fi
exit $failed
