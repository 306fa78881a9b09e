#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge scanner`: two models of an unchanged scanner are the same, a change of scale, of shear or of the bed is told with its size,
# a limit decides the exit code, and models that cannot be compared are refused.
. tests/support/cli.sh
skip_when_slow

# model NAME SEED TURN EFFECTS [PITCH]: a scan of a plate on a scanner with these effects, and the model of it
model() {
  cat >"$1_spec.json" <<S
{"schema": "foilgauge/render/1", "seed": $2, "scanner": {"dpi": ${5:-600}}, "effects": [$4],
 "grids": [{"marks": "dots", "centre_mm": [17, 17], "pitch_mm": 2.5, "columns": 12, "rows": 12, "rotate_deg": $3}]}
S
  expect 0 "" "$renderer" render "$1_spec.json" -o "$1.png"
  expect 0 "" "$program" loop "$1.png" --design plate.json --scanner "${6:-left}" -o "$1_loop.json" --model-out "$1.json"
}
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "pitch_mm": 2.5, "u_pitch_mm": 0.00005}' >plate.json
usual='{"id": "scan.scale_y", "value": 0.003}, {"id": "scan.optical_cubic", "amplitude_um": 8}'
model older 1 0.7 "$usual"
model again 2 -1.2 "$usual"
model scale 3 1.1 "${usual/0.003/0.0033}"
model bowed 4 0.3 "${usual/8/14}"
model coarse 5 0.3 "$usual" 300
model right 6 0.3 "$usual" 600 right

expect 0 "" "$program" scanner older.json again.json -o same.json --html same.html
expect 1 "" "$program" scanner older.json scale.json -o scale_change.json
expect 1 "" "$program" scanner older.json bowed.json -o bowed_change.json --html bowed.html
python3 - <<'P' || fail "changes are not as they were made"
import json
same, scale, bowed = (json.load(open(n)) for n in ('same.json', 'scale_change.json', 'bowed_change.json'))
number = lambda r, name: next(n for n in r['numbers'] if n['id'] == name)
assert same['verdict'] == 'same' and same['p_value'] > 0.1, (same['verdict'], same['p_value'])
assert same['rms_um'] < same['would_show_um'], (same['rms_um'], same['would_show_um'])
for n in same['numbers']:
    assert abs(n['difference']) < 3.5 * n['u_difference'], n
# y reads 300 ppm less: x over y 300 ppm more, the mean scale 150 ppm less
assert scale['verdict'] == 'changed' and scale['scale_known']
ratio, mean = number(scale, 'axis_ratio'), number(scale, 'scale')
assert abs(ratio['difference'] - 3.0e-4) < 3 * ratio['u_difference'] + 2e-6, ratio
assert abs(mean['difference'] + 1.5e-4) < 3 * mean['u_difference'] + 2e-6, mean
assert abs(number(scale, 'shear')['difference']) < 3.5 * number(scale, 'shear')['u_difference']
assert bowed['verdict'] == 'changed' and 1 < bowed['largest_um'] < 8, bowed['largest_um']
assert bowed['would_show_um'] < bowed['rms_um']
P
grep -q "No change of the scanner shows" same.html || fail "the page of an unchanged scanner does not say so"
grep -q "The scanner has changed" bowed.html && grep -q "Displacement by the newer model" bowed.html || fail "the page of a changed scanner"

# The limit decides, also against the verdict; both ways differ in the sign alone.
expect 0 "" "$program" scanner older.json bowed.json --limit 20 -o within.json
expect 1 "" "$program" scanner bowed.json older.json --limit 0.5 -o beyond.json
grep -q '"limit": "beyond"' beyond.json || fail "a difference beyond the limit is not told"
limit=$(python3 -c "import json; print(json.load(open('same.json'))['largest_um'])")
expect 3 "" "$program" scanner older.json again.json --limit "$limit" -o open.json
grep -q "cannot be told" open.json || fail "a limit within U is not told"

# Not of one resolution, not of one scanner, no model at all.
expect 65 "compare models of one resolution" "$program" scanner older.json coarse.json
expect 65 "is of the scanner 'left' and right.json of 'right'" "$program" scanner older.json right.json
expect 65 "not a model of a scanner" "$program" scanner older.json plate.json
expect 64 "give two models" "$program" scanner older.json
exit $failed
