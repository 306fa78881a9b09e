#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Grids: every kind of mark is rendered and measured; turned scans of a printed board tell scanner and board apart, one scan ties
# them; the model of a known plate takes the scanner's error off a plate of pins.
. tests/support/cli.sh
skip_when_slow

# spec FILE MARKS TURN SEED EFFECTS: a board of 3 mm, longer along its columns by 0.15 %, some marks missing.
spec() {
  cat >"$1" <<S
{"schema": "foilgauge/render/1", "seed": $4, "scanner": {"dpi": 600}, "effects": [$5],
 "grids": [{"marks": "$2", "centre_mm": [22, 22], "pitch_mm": 3, "columns": 12, "rows": 12, "rotate_deg": $3, "ratio": 0.0015,
            "missing": [[0, 0], [1, 0], [0, 1]]}]}
S
}
scale='{"id": "scan.scale_y", "value": 0.004}'

# near WORDS VALUE WANTED TOLERANCE
near() {
  awk -v v="$2" -v w="$3" -v t="$4" 'BEGIN { d = v - w; exit !(d <= t && -d <= t) }' || fail "$1 is $2, not $3 +- $4"
}
# member FILE NAME: the first number of that name
member() { sed -n "s/^ *\"$2\": \([-0-9.e]*\),*\$/\1/p" "$1" | head -n 1; }

for marks in dots chessboard crosses lines; do
  echo "{\"schema\": \"foilgauge/design/1\", \"form\": \"grid\", \"marks\": \"$marks\"}" >$marks.json
  spec spec.json $marks 2 1 ""
  expect 0 "" "$program" render spec.json -o $marks.png
  expect 0 "" "$program" measure $marks.png --design $marks.json -o measured.json --points points.csv --html page.html
  grep -q "magnified" page.html || fail "no map of the residuals of $marks on the page"
  if [ $marks = lines ]; then
    near "step of lines" "$(member measured.json step_x_mm)" 3.00225 0.0003
  else
    near "ratio of axes of $marks" "$(member measured.json axis_ratio)" 1.0015 0.0001
    near "marks of $marks" "$(member measured.json mark_count)" 143 6
  fi
done

# One pose: scanner or board. Turned: both, each with its own.
spec a.json dots 1 2 "$scale"
spec b.json dots 91 3 "$scale"
expect 0 "" "$program" render a.json -o a.png
expect 0 "" "$program" render b.json -o b.png
expect 0 "" "$program" loop a.png --design dots.json -o one.json
grep -q '"tied": true' one.json || fail "one scan of an unknown board is no tie"
expect 65 "no model is written" "$program" loop a.png --design dots.json -o one.json --model-out none.json
expect 0 "" "$program" loop --same-part a.png b.png --design dots.json -o pair.json --html pair.html
near "the scanner's axis ratio" "$(member pair.json axis_ratio)" 1.004 0.0001
near "the board's axis ratio" "$(member pair.json board_axis_ratio)" 1.0015 0.0001
python3 -c "
import json
r = json.load(open('pair.json'))
assert (r['domain'], r['verdict']) == ('scan', 'explained'), r['verdict']
assert r['after']['held_out_rms'] < r['before']['held_out_rms'] / 10 and r['error_ratio']['rms'] < 0.1, (r['before'], r['after'])
" || fail "the pair's loop has no verdict, or no smaller error"
grep -q '"turn_deg": 90' pair.json || fail "the quarter turn is not read from the pictures"
expect 0 "" "$program" loop --same-part a.png b.png --turned 0,90 --design dots.json -o said.json
cmp -s pair.json said.json || fail "a turn that is said differs from the same that is found"
expect 64 "not a multiple of 90" "$program" loop --same-part a.png b.png --turned 0,45 --design dots.json

# A scan that only confirms: its marks err by the scanner and the board before, and by their noise after.
spec c.json dots 182 9 "$scale"
expect 0 "" "$program" render c.json -o c.png
expect 0 "" "$program" loop --same-part a.png --hold-out c.png b.png --design dots.json -o confirmed.json --html confirmed.html
python3 - <<'P' || fail "the scan held out has no error of its own, before and after"
import json
r, pair = json.load(open('confirmed.json')), json.load(open('pair.json'))
held, = r['held_out']
assert (held['path'], held['turn_deg'], held['marks']) == ('c.png', 180, 141), held
assert held['after_um'] < 1.5 * pair['noise_um']['mark'] and held['before_um'] > 20 * held['after_um'], held
assert (r['before']['held_out_rms'], r['after']['held_out_rms']) == (held['before_um'], held['after_um'])
assert r['claims'] == pair['claims']  # it took no part
P
grep -q "scan held out" confirmed.html && grep -q "marks of the scans held out" confirmed.html || fail "the page does not list the scan held out"
# A board that has changed is not confirmed.
sed 's/"ratio": 0.0015/"ratio": 0.004/' c.json >changed.json
expect 0 "" "$program" render changed.json -o changed.png
expect 0 "" "$program" loop --same-part a.png b.png --hold-out changed.png --design dots.json -o changed_loop.json
python3 -c "import json; assert json.load(open('changed_loop.json'))['held_out'][0]['after_um'] > 5" || fail "a board that has changed is confirmed"
expect 64 "give a scan" "$program" loop --hold-out a.png --design dots.json

# A plate that is known tells the scale, too; its model corrects gauges.
sed 's/"ratio": 0.0015/"ratio": 0/' a.json >plate.json
expect 0 "" "$program" render plate.json -o plate.png
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "pitch_mm": 3, "u_pitch_mm": 0.00005}' >known.json
expect 0 "" "$program" loop plate.png --design known.json -o known_loop.json --model-out scanner.json
cat >pins.json <<S
{"schema": "foilgauge/render/1", "seed": 8, "scanner": {"dpi": 600}, "effects": [$scale], "width_px": 1100, "height_px": 1100,
 "discs": [{"centre_mm": [22, 14], "radius_mm": 5}, {"centre_mm": [22, 31], "radius_mm": 4}]}
S
expect 0 "" "$program" render pins.json -o pins.png
expect 0 "" "$program" measure pins.png --form discs --tone linear --model scanner.json -o pins_corrected.json
near "the radius through the map" "$(member pins_corrected.json radius_mm)" 5 0.0005

# The model corrects a board, too: the scanner's ratio goes, the board's own stays, and U holds what the model leaves open.
expect 0 "" "$program" measure a.png --design dots.json --model scanner.json -o board_corrected.json --html board_corrected.html
expect 0 "" "$program" measure a.png --design dots.json -o board_raw.json
python3 - <<'P' || fail "a board through the model"
import json
grid = lambda name: json.load(open(name))['grid']
raw, own = grid('board_raw.json'), grid('board_corrected.json')
assert abs(raw['axis_ratio'] - 1.0055) < 1e-4, raw['axis_ratio']
assert abs(own['axis_ratio'] - 1.0015) < 3 * own['u_axis_ratio'] < 1e-4, (own['axis_ratio'], own['u_axis_ratio'])
assert abs(own['step_x_mm'] - 3 * 1.00075) < 3 * own['u_step_x_mm'], (own['step_x_mm'], own['u_step_x_mm'])
assert own['u_step_x_mm'] > raw['u_step_x_mm'] and own['u_model_um'] > 0 and own['uncorrected_rms_um'] == raw['rms_um']
assert 'u_model_um' not in raw
P
grep -q "without the scanner's model it were" board_corrected.html || fail "the page does not say what the model takes off a board"
sed 's/"dpi": 600/"dpi": 300/' a.json >coarse.json
expect 0 "" "$program" render coarse.json -o coarse.png
expect 65 "find a model at this resolution" "$program" measure coarse.png --design dots.json --model scanner.json -o never.json

# A certificate has the place of each mark: the plate's own errors, which a lattice takes for the scanner's, are none of it.
sed 's/"missing": .*]]/"place_um": 8/' a.json >odd.json
expect 0 "" "$program" render odd.json -o odd.png --truth odd.truth
python3 - <<'P'
import json
import random
random.seed(1)
truth, spec = json.load(open('odd.truth')), json.load(open('odd.json'))
mm = 25.4 / 600
import math
with open('plate.csv', 'w') as out:
    out.write('column,row,x_mm,y_mm,u_um\n')
    for m in truth['grids'][0]['marks'] if 'grids' in truth else truth['marks']:
        x, y = (v * mm for v in m['centre_px'])
        out.write('%d,%d,%.6f,%.6f,0.1\n' % (m['column'], m['row'], x, y))
P
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "certificate": "plate.csv"}' >certified.json
expect 0 "" "$program" loop odd.png --design certified.json -o certified_loop.json --model-out certified_model.json
near "the scale by a certificate" "$(member certified_loop.json axis_ratio)" 1.004 0.00003
near "the marks by a certificate" "$(python3 -c "import json; print(json.load(open('certified_loop.json'))['after']['rms'])")" 0.3 0.3
awk -F, -v OFS=, 'NR > 1 { $1 = 11 - $1; $2 = 11 - $2; $3 = 50 - $3; $4 = 50 - $4 } { print }' plate.csv >turned.csv
sed 's/plate.csv/turned.csv/' certified.json >turned.json
expect 65 "turned by 180 degrees clockwise against its certificate" "$program" loop odd.png --design turned.json -o never.json
awk -F, -v OFS=, 'NR > 1 { c = $1; x = $3; $1 = $2; $2 = 11 - c; $3 = $4; $4 = 50 - x } { print }' plate.csv >turned.csv
expect 65 "turned by 90 degrees clockwise against its certificate" "$program" loop odd.png --design turned.json -o never.json
head -n 100 plate.csv >short.csv
sed 's/plate.csv/short.csv/' certified.json >short.json
expect 65 "lay the whole plate on the glass" "$program" loop odd.png --design short.json -o never.json
echo 'column,row,x_mm,y_mm,u_um' >short.csv; echo '0,0,0,0,0' >>short.csv
expect 65 "u_um is 0; it must be positive" "$program" loop odd.png --design short.json -o never.json

# A mark sees the mean over its edges: dots as large as half the pitch leave a ripple its size, and rows lost between a dot's edges are
# one step. A ripple of little more than a pitch looks like a longer one: that is told, and a board that is turned tells. A ripple
# that is nearly as long as the board is no row of steps.
dots() {
  cat >"$1.json" <<S
{"schema": "foilgauge/render/1", "seed": 6, "scanner": {"dpi": 600}, "effects": [$3],
 "grids": [{"marks": "dots", "centre_mm": [18, 18], "pitch_mm": 2.5, "mark_mm": 1.25, "columns": 12, "rows": 12, "rotate_deg": $2}]}
S
  expect 0 "" "$program" render "$1.json" -o "$1.png"
  expect 0 "" "$program" loop "$1.png" --design pitch.json -o "$1_loop.json" --model-out "$1_model.json"
}
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "pitch_mm": 2.5, "u_pitch_mm": 0.00005}' >pitch.json
dots large 0.4 '{"id": "scan.carriage_ripple", "amplitude_um": 8, "period_mm": 6.1}'
dots alike 0 '{"id": "scan.carriage_ripple", "amplitude_um": 8, "period_mm": 3.1}'
dots turned 6 '{"id": "scan.carriage_ripple", "amplitude_um": 8, "period_mm": 3.1}'
dots slow 1 '{"id": "scan.carriage_ripple", "amplitude_um": 15, "period_mm": 21}'
dots step 0.4 '{"id": "scan.row_step", "amplitude_um": 20, "y_mm": 16.6}'
python3 - <<'P' || fail "ripples and steps on large dots"
import json
found = lambda name: [c for c in json.load(open(name + '_loop.json'))['claims'] if c['verdict'] == 'found']
ripple, = found('large')
assert ripple['id'] == 'scan.carriage_ripple' and abs(ripple['shape_mm'] - 6.1) < 0.01, ripple
assert abs(ripple['amplitude_um'] - 8) < 4 * ripple['u_amplitude_um'] + 0.02, ripple
ripple, = found('slow')
assert abs(ripple['shape_mm'] - 21) < 0.1 and abs(ripple['amplitude_um'] - 15) < 0.2, ripple
summary = json.load(open('slow_loop.json'))['summary']
assert 'Found besides: a ripple of the carriage (15 ± 0.' in summary, summary
step, = found('step')
assert step['id'] == 'scan.row_step' and abs(step['amplitude_um'] - 20) < 0.2, step
advice = json.load(open('alike_loop.json'))['advice']
assert 'a ripple of 3.1 mm looks like' in advice and 'turned by 6°' in advice, advice
ripple, = found('turned')
assert abs(ripple['shape_mm'] - 3.1) < 0.01 and abs(ripple['amplitude_um'] - 8) < 4 * ripple['u_amplitude_um'] + 0.05, ripple
P
# The same marks through the model: none of the ripple is left.
expect 0 "" "$program" measure large.png --design pitch.json --model large_model.json -o large_corrected.json
near "marks through the model of a ripple" "$(member large_corrected.json rms_um)" 0 0.3

# A curve over y on a board that lies askew: chips of the marks' own pitch would show the marks the same ramp, and are not claimed.
cat >curve.json <<'S'
{"schema": "foilgauge/render/1", "seed": 1, "scanner": {"dpi": 600, "noise": 4},
 "effects": [{"id": "scan.scale_y", "value": 0.001},
  {"id": "free.scan.y", "knots": [[0, 3], [4, 2.52], [8, 1.25], [12, -0.43], [16, -1.96], [20, -2.88], [24, -2.87], [28, -1.96], [32, -0.44]]},
  {"id": "free.scan.x", "knots": [[0, 2.52], [5, 2.99], [10, 2.33], [15, 0.78], [20, -1.05], [25, -2.49], [30, -3], [36, -2.12]]}],
 "grids": [{"marks": "dots", "centre_mm": [17.3, 15.5], "pitch_mm": 2.5, "columns": 11, "rows": 9, "rotate_deg": 4, "place_um": 0.25}]}
S
expect 0 "" "$program" render curve.json -o curve.png
expect 0 "" "$program" loop curve.png --design pitch.json -o curve_loop.json --model-out curve_model.json
python3 - <<'P' || fail "chips that no marks can show"
import json
r = json.load(open('curve_loop.json'))
assert not any(c['id'].startswith('scan.chip') and c['verdict'] != 'absent' for c in r['claims']), r['claims']
x = 17.3
near = [p['dy_um'] for p in r['map'] if abs(p['x_mm'] - x) < 6 and abs(p['y_mm'] - 15.5) < 1.5]
assert max(near) - min(near) < 5, near
P

# A pitch of 2.5 mm that is stated as 2.54 would be a scale that no flatbed has.
sed 's/2\.5,/2.54,/' pitch.json >inch.json
expect 0 "" "$program" loop step.png --design inch.json -o inch_loop.json
python3 -c "import json; r = json.load(open('inch_loop.json')); assert 'is more than a flatbed' in r['advice'], r['advice']" ||
  fail "a wrong pitch is taken without a word"

# Beyond the map of a plate U holds the changes that the map has inside.
cat >part.json <<S
{"schema": "foilgauge/render/1", "seed": 4, "scanner": {"dpi": 600},
 "effects": [{"id": "free.scan.x", "knots": [[0, 0], [8, 12], [15, -9], [23, 8], [30, -12]]}],
 "grids": [{"marks": "dots", "centre_mm": [12, 18], "pitch_mm": 2.5, "mark_mm": 0.8, "columns": 8, "rows": 12, "rotate_deg": 1}]}
S
sed '/"grids"/d; s/"effects": \(.*\),$/"effects": \1, "width_px": 800, "height_px": 850,\n "discs": [{"centre_mm": [12, 18], "radius_mm": 5}, {"centre_mm": [24, 18], "radius_mm": 5}]}/' part.json >beyond.json
expect 0 "" "$program" render part.json -o part.png
expect 0 "" "$program" render beyond.json -o beyond.png
expect 0 "" "$program" loop part.png --design pitch.json -o part_loop.json --model-out part_model.json
expect 0 "" "$program" measure beyond.png --form discs --tone linear --model part_model.json -o beyond_discs.json
python3 - <<'P' || fail "U of a pin beyond the map"
import json
inside, beyond = sorted(json.load(open('beyond_discs.json'))['discs'], key=lambda d: d['centre_mm'][0])
for d in (inside, beyond):
    assert abs(d['radius_mm'] - 5) < 2.5 * d['u_radius_mm'], d
assert beyond['u_radius_mm'] > 1.5 * inside['u_radius_mm'] > 0, (inside, beyond)
assert 'beyond_model_region' in beyond['flags'] and not inside['flags'], (inside['flags'], beyond['flags'])
P
# Askew as straight: the curve is a map's, and no cubic with steps.
sed 's/"rotate_deg": 1/"rotate_deg": 7/' part.json >askew.json
expect 0 "" "$program" render askew.json -o askew.png
expect 0 "" "$program" loop askew.png --design pitch.json -o askew_loop.json --model-out askew_model.json
expect 0 "" "$program" measure beyond.png --form discs --tone linear --model askew_model.json -o askew_discs.json
python3 - <<'P' || fail "U of a pin beyond the map of a board that lies askew"
import json
report = json.load(open('askew_loop.json'))
assert report['noise_um']['map'] > 4, report['noise_um']
assert not [c for c in report['claims'] if c['id'] == 'scan.optical_cubic' and c['verdict'] == 'found'], report['claims']
for d in json.load(open('askew_discs.json'))['discs']:
    assert abs(d['radius_mm'] - 5) < 2.5 * d['u_radius_mm'], d
P

# Names are for displacements that no map follows: tilted chips with gaps, and a ripple whose period is as uncertain as the marks make it.
spec chips.json dots 1.5 4 '{"id": "scan.chip_tilt", "amplitude_um": 12, "x_mm": 4, "pitch_mm": 10}, {"id": "scan.chip_gap",
 "amplitude_um": 9, "x_mm": 4, "pitch_mm": 10}, {"id": "scan.carriage_ripple", "amplitude_um": 8, "period_mm": 8.5}'
sed -i 's/"ratio": 0.0015/"ratio": 0, "mark_mm": 0.35/' chips.json
expect 0 "" "$program" render chips.json -o chips.png
expect 0 "" "$program" loop chips.png --design known.json -o chips_loop.json --model-out chips_model.json
python3 -c "
import json
claims = {c['id']: c for c in json.load(open('chips_loop.json'))['claims'] if c['verdict'] == 'found'}
for name, size in (('scan.chip_tilt', 12), ('scan.chip_gap', 9), ('scan.carriage_ripple', 8)):
    assert name in claims, (name, list(claims))
    assert abs(abs(claims[name]['amplitude_um']) - size) < 1.5, claims[name]  # marks that lie across a seam shrink it
assert abs(claims['scan.carriage_ripple']['shape_mm'] - 8.5) < 0.05, claims['scan.carriage_ripple']
" || fail "chips and a ripple are not named with their sizes"
# A seam lies anywhere between two marks of 3 mm, or within one that it cuts: so does it in the model, and what lies there has that in
# its u.
python3 -c "
import json
fields = {f['id']: f for f in json.load(open('chips_model.json'))['fields']}
for name in ('scan.chip_tilt', 'scan.chip_gap'):
    (place, pitch), (u, _) = fields[name]['shape'], fields[name]['u_shape']
    assert 0.08 < u < 1.1 and abs((place - 4 + pitch / 2) % pitch - pitch / 2) < 2.5 * u, fields[name]
assert fields['scan.carriage_ripple']['u_shape'][0] == 0, fields['scan.carriage_ripple']
" || fail "the model does not say how well the place of a seam is known"
# The strokes of these crosses end round: a window that holds an end's corners made u 20 times what the places scatter by.
echo '{"schema": "foilgauge/render/1", "seed": 2, "grids": [{"marks": "crosses", "centre_mm": [10, 10], "pitch_mm": 5, "columns": 3, "rows": 3, "mark_mm": 0.3,
  "length_mm": 3}], "scanner": {"dpi": 2400}}' >crosses.json
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "crosses", "pitch_mm": 5}' >crosses_design.json
"$renderer" render crosses.json -o crosses.png -t crosses_truth.json || fail "render crosses"
expect 0 "" "$program" measure crosses.png --design crosses_design.json -o crosses_found.json
python3 - <<'P' || fail "u of crosses with round ends"
import json, math
marks = json.load(open("crosses_found.json"))["grid"]["marks"]
true = [[value * 25.4 / 2400 for value in mark["centre_px"]] for mark in json.load(open("crosses_truth.json"))["marks"]]
errors = []
for mark in marks:
    place = (mark["x_mm"], mark["y_mm"])
    near = min(true, key=lambda at: math.dist(at, place))
    errors += [1000 * (a - b) for a, b in zip(place, near)]
means = [sum(errors[axis::2]) / len(marks) for axis in (0, 1)]
scatter = math.sqrt(sum((e - means[k % 2]) ** 2 for k, e in enumerate(errors)) / (len(errors) - 2))
u = sum(mark["u_um"] for mark in marks) / len(marks)
assert len(marks) == 9 and 0.5 < u / scatter < 2, (u, scatter)
P

exit $failed
