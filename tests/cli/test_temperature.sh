#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Temperature of plate and part: both are referred to 20 °C by their own expansion, a calibration may state it without a scale where a
# model has that, and the difference between the model's temperature and the part's is in U.
. tests/support/cli.sh
skip_when_slow

warm() { # warm CELSIUS EXPANSION
  echo "\"calibration\": {\"temperature\": {\"value_C\": $1, \"u_K\": 0.1}, \"expansion\": {\"value_per_K\": $2, \"u_per_K\": 1e-7}}"
}
# A plate of 2.5 mm pitch at 20 °C, which expands by 5e-5 per K, scanned at 30 °C; the scanner's y is 0.2 % too short.
cat >plate_spec.json <<'S'
{"schema": "foilgauge/render/1", "scanner": {"dpi": 600}, "effects": [{"id": "scan.scale_y", "value": 0.002}],
 "grids": [{"marks": "dots", "centre_mm": [17, 17], "pitch_mm": 2.50125, "columns": 12, "rows": 12, "rotate_deg": 1}]}
S
expect 0 "" "$renderer" render plate_spec.json -o plate.png
plate='{"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "pitch_mm": 2.5, "u_pitch_mm": 0.00002'
echo "$plate, $(warm 30 5e-5)}" >plate.json
echo "$plate}" >cold.json
expect 0 "" "$program" loop plate.png --design plate.json -o warm_loop.json --model-out warm.json
expect 0 "" "$program" loop plate.png --design cold.json -o cold_loop.json --model-out cold.json.model
# The part: a pin of 5 mm radius at 20 °C, which expands by 2e-5 per K, scanned at 36 °C.
cat >pin_spec.json <<'S'
{"schema": "foilgauge/render/1", "seed": 2, "scanner": {"dpi": 600}, "effects": [{"id": "scan.scale_y", "value": 0.002}],
 "width_px": 803, "height_px": 803, "discs": [{"centre_mm": [17, 17], "radius_mm": 5.0016}]}
S
expect 0 "" "$renderer" render pin_spec.json -o pin.png
echo "{\"schema\": \"foilgauge/design/1\", \"form\": \"discs\", \"tone\": \"linear\", $(warm 36 2e-5)}" >pin.json
expect 0 "" "$program" measure pin.png --design pin.json --model warm.json -o pin_report.json --html pin.html
python3 - <<'P' || fail "plate, model or pin are not those of 20 °C"
import json
warm, cold = json.load(open('warm_loop.json')), json.load(open('cold_loop.json'))
scale = lambda r: next((c for c in r['claims'] if c['id'] == 'scan.scale'), {'ratio': 0, 'u_ratio': 0})
# The plate is longer by 5e-4: without its temperature that is an error of the scanner.
assert abs(scale(warm)['ratio'] - scale(cold)['ratio'] - 5e-4) < 2e-5, (scale(warm), scale(cold))
model = json.load(open('warm.json'))
assert (model['temperature_C'], model['u_temperature_K']) == (30, 0.1)
assert 'temperature_C' not in json.load(open('cold.json.model'))
r = json.load(open('pin_report.json'))
pin = r['discs'][0]
bed = 23e-6 / 3 ** .5 * (36 - 30)
assert abs(r['calibration']['u_rel']['bed'] / bed - 1) < 1e-3, r['calibration']['u_rel']
assert 5 * bed < pin['u_radius_mm'] < 6 * 5 * bed, pin['u_radius_mm']
assert abs(pin['radius_mm'] - 5) < 2.5e-4, pin['radius_mm']
assert 'scale' not in r['calibration'] and r['model']['temperature_C'] == 30
assert r['traceability']['state'] == 'stated' if isinstance(r['traceability'], dict) else r['traceability'] == 'stated', r['traceability']
P
grep -q "at 30 °C" pin.html || fail "the page does not say how warm the scanner was"
# Without a model nothing has the scale: temperature alone traces nothing.
expect 0 "" "$program" measure pin.png --design pin.json -o alone.json
python3 -c "import json; t = json.load(open('alone.json'))['traceability']; assert (t['state'] if isinstance(t, dict) else t) == 'none', t" ||
  fail "a temperature alone is taken for a scale"
# A warmer plate's own u: of its temperature and its expansion.
echo "$plate, $(warm 30 5e-5 | sed 's/"u_K": 0.1/"u_K": 10/')}" >vague.json
expect 0 "" "$program" loop plate.png --design vague.json -o vague_loop.json
python3 - <<'P' || fail "the plate's uncertain temperature is not in the map's u"
import json
u = lambda n: json.load(open(n))['noise_um']['u_map']
assert u('vague_loop.json') > 3 * u('warm_loop.json'), (u('vague_loop.json'), u('warm_loop.json'))
P
sed 's/30,/90,/' warm.json >hot.json
grep -q '"temperature_C": 90' hot.json || fail "the model has no temperature to spoil"
expect 65 'temperature_C. is 90; a number, 0 to 60, is allowed' "$program" measure pin.png --design pin.json --model hot.json -o never.json
exit $failed
