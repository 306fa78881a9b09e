#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on round gauges: a plate names what the scanner does and corrects foils that were scanned
# on it, known diameters give the absolute scale, a single ring is a tie, pins that are not round are
# not taken for the scanner.
. tests/support/loop.sh

# Centres and radii of twelve pins over 32 x 20 mm.
pins='[1.2,1.6,1],[5.0,2.2,1.5],[10.1,2.9,2],[16.2,3.2,2.5],[23.1,3.6,3],[29.8,2.9,2.25],[2.1,9.4,1.25],[7.2,10.1,2.75],[13.9,11.3,3],[20.8,12.0,2.5],[26.9,12.9,1.75],[6.2,16.9,1.5]'
scanner='"scanner":{"dpi":2400,"background":30,"contrast":175,"blur_px":1.3,"noise":1.2}'
effects='{"id":"scan.scale_y","value":0.001},{"id":"scan.shear","value":0.0006},
 {"id":"scan.carriage_ripple","amplitude_um":6,"period_mm":3.1,"phase_deg":30},
 {"id":"scan.row_step","amplitude_um":15,"y_mm":9.2}'

# plate NAME SEED EFFECTS [UM of two lobes at most, each pin its own]
plate() {
  python3 - "$1" "$2" "$3" "${4:-0}" "$pins" "$scanner" <<'PYTHON' || fail "spec $1"
import json, random, sys
name, seed, effects, lobe, pins, scanner = sys.argv[1:]
random.seed(int(seed))
discs = [{"centre_mm": p[:2], "radius_mm": p[2]} for p in json.loads("[" + pins + "]")]
for d in discs if float(lobe) else []:
    d.update(lobes=2, lobe_um=random.uniform(0, float(lobe)), lobe_phase_deg=random.uniform(0, 360))
spec = {"schema": "foilgauge/render/1", "seed": int(seed), "discs": discs, "effects": json.loads("[" + effects + "]")}
spec.update(json.loads("{" + scanner + "}"))
json.dump(spec, open(name + ".json", "w"))
PYTHON
  "$renderer" render "$1.json" -o "$1.png" || fail "render $1"
}

# Largest error of a radius in um, against the pins in order of size.
error_of() {
  checks - "$1" "$2" "$pins" <<'PYTHON'
import json, sys
report, side, pins = sys.argv[1:]
r = json.load(open(report))
got = sorted(d["radius_mm"] for d in (r[side] if side else r)["discs"])
true = sorted(p[2] for p in json.loads("[" + pins + "]"))
assert len(got) == len(true), (len(got), len(true))
print(max(abs(a - b) for a, b in zip(got, true)) * 1000)
PYTHON
}

plate clean 1 ''
if [ -n "${FOILGAUGE_TEST_LONG-}" ]; then
"$program" loop clean.png --form discs -o clean.out || fail "loop on a clean plate"
[ "$(value clean.out "r['verdict'], len(r['claims'])")" = "('clean', 0)" ] || fail "a clean plate is $(value clean.out "r['verdict']")"
fi

plate all 2 "$effects"
"$program" loop all.png --form discs -o all.out --model-out scanner.json || fail "loop on a plate"
[ "$(value all.out "sorted(c['id'] + ' ' + c['verdict'] for c in r['claims'])")" = \
  "['scan.carriage_ripple found', 'scan.row_step found', 'scan.scale_y found', 'scan.shear found']" ] ||
  fail "the plate's effects: $(value all.out "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")"
claim() { value all.out "next(c for c in r['claims'] if c['id'] == '$1')['parameters']['$2']"; }
near scale "$(claim scan.scale_y value)" 0.001 0.00001
near shear "$(claim scan.shear value)" 0.0006 0.00001
near ripple "$(claim scan.carriage_ripple amplitude_um)" 6 0.05
near period "$(claim scan.carriage_ripple period_mm)" 3.1 0.002
near step "$(claim scan.row_step amplitude_um)" 15 0.1
near "place of the step" "$(claim scan.row_step y_mm)" 9.2 0.06
before=$(error_of all.out before)
after=$(error_of all.out after)
near "radius after" "$after" 0 0.15
python3 -c "import sys; sys.exit(float(sys.argv[1]) * 10 > float(sys.argv[2]))" "$after" "$before" ||
  fail "the error of a radius goes from $before only to $after um"
[ "$(value all.out "r['before']['foils'] + r['after']['foils']")" = "[]" ] || fail "a plate has foils"

# The plate's model corrects the plate, and a foil that was scanned on the same scanner.
"$program" measure all.png --form discs --model scanner.json --html relative.html -o plate.out || fail "measure a plate with its model"
near "radius of the plate by its model" "$(error_of plate.out "")" 0 0.15
cat >foil.json <<SPEC
{"schema":"foilgauge/render/1","seed":7,
 "foils":[{"overall_radius_mm":20.95,"radius_mm":[3.34,3.41,3.36,3.44,3.38,3.35,3.42,3.37,3.40],"rotate_deg":-90}],
 $scanner,"effects":[$effects]}
SPEC
"$renderer" render foil.json -o foil.png && "$program" measure foil.png -o plain.out &&
  "$program" measure foil.png --model scanner.json -o corrected.out || fail "measure a foil with the plate's model"
python3 - <<'PYTHON' || fail "the plate's model does not correct the foil"
import json
true = [3.34, 3.41, 3.36, 3.44, 3.38, 3.35, 3.42, 3.37, 3.40]
def error(path):
    foil = json.load(open(path))["foils"][0]
    r = sum((b["radius_mm"] - t) ** 2 for b, t in zip(foil["bumps"], true)) / len(true)
    return 1000 * r ** 0.5, 1000 * abs(foil["overall"]["radius_mm"] - 20.95)
before, after = error("plain.out"), error("corrected.out")
print("R, R0 of the foil, um: before %.3f, %.3f, after %.3f, %.3f" % (before + after))
raise SystemExit(after[0] * 10 > before[0] or after[1] > 0.5 or after[1] * 5 > before[1])
PYTHON

if [ -n "${FOILGAUGE_TEST_BRIEF-}" ]; then
  valid loop_scan.schema.json all.out
  exit $failed
fi

# Known diameters, in any order: the picture is too small by 0.2 %.
python3 -c "
import json
pins = json.loads('[' + '''$pins''' + ']')
json.dump({'schema': 'foilgauge/design/1', 'name': 'plate', 'form': 'discs',
           'diameters_mm': [2.004 * p[2] for p in pins][::-1]}, open('known.json', 'w'))"
"$program" loop clean.png --design known.json --model-out absolute.json -o known.out || fail "loop with known diameters"
[ "$(value known.out "[c['id'] for c in r['claims']]")" = "['scan.scale']" ] || fail "known diameters give no scale"
[ "$(value known.out "r['noise']['form'], len(r['noise']['sd_of_discs']), min(r['noise']['sd_of_discs']) == r['noise']['sd']")" = "('white', 12, True)" ] ||
  fail "the noise of a plate is $(value known.out "r['noise']")"
near "absolute scale" "$(value known.out "r['claims'][0]['parameters']['value']")" 0.002 0.00001
near "radius at the known scale" "$(value known.out "max(d['radius_mm'] for d in r['after']['discs'])")" 3.006 0.0002
# Known diameters give the scale: nothing says that it is unknown. A model without them says so.
"$program" measure clean.png --form discs --model absolute.json --html absolute.html -o absolute.out || fail "measure by it"
[ "$(value absolute.out "r['model']['known_diameters']")" = 12 ] || fail "the model does not say that it knows diameters"
[ "$(value plate.out "r['model']['known_diameters']")" = 0 ] || fail "a model without known diameters says that it has some"
grep -q 'scale is that of 12 gauges of known diameter' absolute.html || fail "the page does not say whose scale it is"
grep -q 'error of scale is not in it\|without a known diameter' absolute.html && fail "the page says that the scale is not known"
grep -q 'without a known diameter' relative.html || fail "the page does not say that the scale is not known"

# Gauges that are not as known, by up to 2 um: the effects are found as without them, and bent by nothing.
python3 -c "
import json
pins = json.loads('[' + '''$pins''' + ']')
off = [0.5, -0.3, 2.0, 0.1, -0.6, 0.4, -0.2, 0.7, -0.5, 0.2, -0.1, 0.3]
json.dump({'schema': 'foilgauge/design/1', 'name': 'plate', 'form': 'discs',
           'diameters_mm': [2 * p[2] - 0.001 * o for p, o in zip(pins, off)]}, open('off.json', 'w'))"
"$program" loop all.png --design off.json -o off.out || fail "loop with gauges that are off"
[ "$(value off.out "sorted(c['id'] for c in r['claims'])")" = "['scan.carriage_ripple', 'scan.row_step', 'scan.scale_y', 'scan.shear']" ] ||
  fail "gauges that are off give $(value off.out "r['verdict'], [c['id'] for c in r['claims']]")"
near "scale beside gauges that are off" "$(value off.out "next(c for c in r['claims'] if c['id'] == 'scan.scale_y')['parameters']['value']")" 0.001 0.00001
python3 -c "import sys; sys.exit(not float(sys.argv[1]) < 2e-6)" \
  "$(value off.out "next(c for c in r['claims'] if c['id'] == 'scan.shear')['uncertainty']['value']")" || fail "gauges that are off make a shear uncertain"
near "radius beside gauges that are off" "$(error_of off.out after)" 0 0.15

# The same gauges under a picture that is too small by 0.2 %: a scale beside four other effects, whose numbers it does not make uncertain.
python3 -c "
import json
design = json.load(open('off.json'))
design['diameters_mm'] = [1.002 * d for d in design['diameters_mm']]
json.dump(design, open('small.json', 'w'))"
"$program" loop all.png --design small.json -o small.out || fail "loop on five effects"
[ "$(value small.out "sorted(c['id'] for c in r['claims'])")" = \
  "['scan.carriage_ripple', 'scan.row_step', 'scan.scale', 'scan.scale_y', 'scan.shear']" ] || fail "a scale beside four effects is $(value small.out "[c['id'] for c in r['claims']]")"
near "a scale beside four effects" "$(value small.out "next(c for c in r['claims'] if c['id'] == 'scan.scale')['parameters']['value']")" 0.002 0.0004
near "a shear beside a scale" "$(value small.out "next(c for c in r['claims'] if c['id'] == 'scan.shear')['parameters']['value']")" 0.0006 0.000004

# A keystone, which is no effect of plates by name: a map of the picture, and no quadratic of the carriage.
plate keystone 8 '{"id":"scan.keystone","amplitude_um":12}'
"$program" loop keystone.png --form discs -o keystone.out --model-out keystone.model || fail "loop on a plate with a keystone"
[ "$(value keystone.out "r['verdict'], [c['id'] for c in r['claims']], r['unattributed']['moves']")" = "('unattributed', [], 'x and y')" ] ||
  fail "a keystone is called $(value keystone.out "(r['verdict'], [c['id'] for c in r['claims']])")"
near "radius after a keystone" "$(error_of keystone.out after)" 0 0.1
# Its model holds that map, and no curve in place of it.
[ "$(value keystone.model "r['fields'], r['tied'], 0 < len(r['map']['modes']) <= 64")" = "([], False, True)" ] || fail "the keystone's model is no map"
valid scan_model.schema.json keystone.model
"$program" measure keystone.png --form discs --model keystone.model -o keystone.measured --html keystone.page || fail "measure by the keystone's model"
near "radius by the keystone's model" "$(error_of keystone.measured '')" 0 0.1
[ "$(value keystone.measured "4 < r['model']['map_half_range_um'] < 8")" = True ] || fail "the map moves $(value keystone.measured "r['model']['map_half_range_um']")"
grep -q "a smooth displacement of the picture without a name" keystone.page || fail "the page does not say what the map is"

# One ring: an oval and a scale with a shear are one and the same.
pins='[7,7,6]'
plate ring 3 '{"id":"scan.scale_y","value":0.001}'
"$program" loop ring.png --form discs -o ring.out || fail "loop on a ring"
[ "$(value ring.out "len(r['claims']) == 1 and r['claims'][0]['verdict'] == 'tied' and {'part.ovality', 'scan.scale_y'} <= set(r['claims'][0]['alias_class'])")" = True ] ||
  fail "a single ring is no tie"
[ "$(value ring.out "(lambda x: x[0] < 6 < x[1])(r['after']['discs'][0]['radius_range_mm'])")" = True ] ||
  fail "the ring's range does not hold its radius"

# Pins that are oval, each in its own direction, are no scanner.
reports="all known ring keystone"
if [ -n "${FOILGAUGE_TEST_LONG-}" ]; then
reports="$reports clean oval"
pins='[1.2,1.6,1],[5.0,2.2,1.5],[10.1,2.9,2],[16.2,3.2,2.5],[23.1,3.6,3],[29.8,2.9,2.25],[2.1,9.4,1.25],[7.2,10.1,2.75],[13.9,11.3,3],[20.8,12.0,2.5],[26.9,12.9,1.75],[6.2,16.9,1.5]'
plate oval 5 '' 3
"$program" loop oval.png --form discs -o oval.out || fail "loop on oval pins"
[ "$(value oval.out "len(r['claims'])")" = 0 ] || fail "oval pins are called $(value oval.out "[c['id'] for c in r['claims']]")"

# A ripple under which smooth effects and a period that is a little off cancel: no fit holds them
# together, and the ripple alone must be found.
cat >ripple.json <<'J'
{"schema": "foilgauge/render/1", "seed": 927490561, "discs": [
  {"centre_mm": [2.75, 3.118], "radius_mm": 1.75},
  {"centre_mm": [10.643, 4.945], "radius_mm": 3.5},
  {"centre_mm": [20.612, 4.067], "radius_mm": 2.75},
  {"centre_mm": [28.838, 2.966], "radius_mm": 1.5},
  {"centre_mm": [34.567, 2.371], "radius_mm": 1.0},
  {"centre_mm": [3.0, 11.621], "radius_mm": 2.0},
  {"centre_mm": [10.244, 12.03], "radius_mm": 2.25},
  {"centre_mm": [15.744, 10.148], "radius_mm": 0.5},
  {"centre_mm": [21.773, 12.539], "radius_mm": 3.0},
  {"centre_mm": [28.938, 10.327], "radius_mm": 0.75},
  {"centre_mm": [34.3, 11.021], "radius_mm": 1.25},
  {"centre_mm": [3.5, 19.397], "radius_mm": 2.5}],
 "scanner": {"dpi": 4800, "background": 35.6, "contrast": 162.7, "blur_px": 2.12, "noise": 1.47, "noise_correlation": 0.5,
  "rough": {"edge_roughness_um": 0.52, "edge_common_um": 0.15, "correlation_um": 12.5, "correlation_form": "gaussian",
            "one_sided_blur_px": 1.51, "one_sided_way": "+y"}},
 "effects": [{"id": "scan.carriage_ripple", "amplitude_um": 9.02, "period_mm": 3.666, "phase_deg": 93.4}]}
J
"$renderer" render ripple.json -o ripple.png || fail "ripple.json"
"$program" loop ripple.png --form discs -o ripple.out || fail "loop on a plate with a ripple"
[ "$(value ripple.out "[c['id'] for c in r['claims']]")" = "['scan.carriage_ripple']" ] ||
  fail "a ripple of 9 um is called $(value ripple.out "(r['verdict'], [c['id'] for c in r['claims']])")"
reports="$reports ripple"
fi

# Effects are fitted together: a ripple that is sought alone beside a step of two rows takes a period that speaks
# against all that comes later.
(
pins='[3.0,3.4,2],[12.2,5.0,3.5],[20.9,3.1,1.75],[26.7,2.3,1.25],[33.0,4.0,2.5],[3.2,12.0,2.25],[9.5,10.7,1],[13.6,9.9,0.5],[20.0,12.6,3],[27.9,11.0,1.5],[35.3,12.3,2.75],[1.8,17.6,0.75]'
plate together 3 '{"id":"scan.scale_y","value":-0.0005},{"id":"scan.shear","value":-0.0007},
 {"id":"scan.carriage_ripple","amplitude_um":11,"period_mm":2.8,"phase_deg":30},
 {"id":"scan.row_step","amplitude_um":-21.1668,"y_mm":11.715}'
"$program" loop together.png --form discs -o together.out || fail "loop on a plate with a step of two rows"
[ "$(value together.out "sorted(c['id'] + ' ' + c['verdict'] for c in r['claims'])")" = \
  "['scan.carriage_ripple found', 'scan.row_step found', 'scan.scale_y found', 'scan.shear found']" ] ||
  fail "effects beside a step of two rows: $(value together.out "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")"
near "radius after a step of two rows" "$(error_of together.out after)" 0 0.15
exit $failed
) || failed=1
reports="$reports together"

for report in $reports; do valid loop_scan.schema.json $report.out; done

"$program" loop --same-foil all.png ring.png --form discs >out.txt 2>err.txt
[ $? -eq 64 ] && grep -q "does not show how far it was turned" err.txt || fail "--same-foil on discs: $(cat err.txt)"
"$program" loop clean.png --form square >out.txt 2>err.txt
[ $? -eq 64 ] || fail "--form square is taken"

exit $failed
