#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on scans beyond one listed effect: curves that no effect stands for, four effects at once, and
# what the data cannot tell: on which side of a bump a step lies, and the scale beside a lens.
. tests/support/loop.sh
long_only

# render NAME SEED ROTATION EFFECTS X,Y [DPI]: the foil's centre in mm on 44 x 44 mm
render() {
  local dpi=${6-2400}
  render_foil "$1" "$2" "$3" "$4" "$dpi" "\"width_px\":$((dpi * 7 / 4)),\"height_px\":$((dpi * 7 / 4))," "\"centre_mm\":[$5],"
}

# says REPORT EXPRESSION: of a report r; e(side, name) is the rms error of R (um) or R0 on a side, within() the
# share of the corrected radii that lie within U of the truth.
says() {
  python3 - "$1" "$2" <<'PYTHON' || fail "$1: not so: $2"
import json, sys
r = json.load(open(sys.argv[1]))
true = [3.34, 3.41, 3.36, 3.44, 3.38, 3.35, 3.42, 3.37, 3.40]
def foil(side):
    return r[side]["foils"][0]
def e(side, name):
    if name == "R0":
        return 1000 * abs(foil(side)["overall"]["radius_mm"] - 20.95)
    off = [1000 * (b["radius_mm"] - t) for b, t in zip(foil(side)["bumps"], true)]
    return (sum(o * o for o in off) / len(off)) ** 0.5
def within():
    return sum(abs(b["radius_mm"] - t) <= 2 * b["u_radius_mm"] for b, t in zip(foil("after")["bumps"], true)) / 9
claims = {c["id"]: c for c in r["claims"]}
curve = r["unattributed"]
sys.exit(not eval(sys.argv[2]))
PYTHON
}

# A curve over the carriage's way that moves the picture across it.
render across 11 -75 '{"id":"free.scan.y","moves":"x","knots":[[2,0],[8,9],[15,-8],[22,10],[30,-9],[38,0]]}' 20,22
"$program" loop across.png -o across.out --model-out across.model || fail "loop on a curve over scan.y"
says across.out "r['verdict'] == 'unattributed' and not claims and (curve['coordinate'], curve['moves']) == ('scan.y', 'x')"
says across.out "e('after', 'R') < e('before', 'R') / 3 and within() >= 0.7"
says across.out "r['after']['rms'] < 1.3 * r['noise_floor'] and r['noise_floor'] < 0.05"
# Between the knots that lie on the foil, beside a shift and a turn, the curve is the one that was put in.
says across.out "(lambda s: max(v for _, v in s) - min(v for _, v in s))(curve['shape']) > 12"
render again 12 -80 '{"id":"free.scan.y","moves":"x","knots":[[2,0],[8,9],[15,-8],[22,10],[30,-9],[38,0]]}' 20,22
"$program" measure again.png -o plain.out && "$program" measure again.png --model across.model -o better.out ||
  fail "measure with a curve as a model"
python3 - <<'PYTHON' || fail "the curve of one foil does not correct another"
import json, sys
true = [3.34, 3.41, 3.36, 3.44, 3.38, 3.35, 3.42, 3.37, 3.40]
def rms(name):
    bumps = json.load(open(name))["foils"][0]["bumps"]
    return (sum((b["radius_mm"] - t) ** 2 for b, t in zip(bumps, true)) / 9) ** 0.5
sys.exit(not rms("better.out") < rms("plain.out") / 3)
PYTHON

reports="across step"
if [ -z "${FOILGAUGE_TEST_BRIEF-}" ]; then
reports="$reports radius phi"

# A curve along the foil, in both of its forms.
for along in radius ${FOILGAUGE_TEST_LONG:+normal}; do
  render $along 13 40 '{"id":"free.foil.s","along":"'$along'","knots":[[-1,0],[-0.5,10],[0,-9],[0.5,11],[1,0]]}' 22,22
  "$program" loop $along.png -o $along.out || fail "loop on a curve along the foil"
  says $along.out "curve['coordinate'] == 'foil.s' and curve['moves'] == 'along the $along' and not claims"
  says $along.out "curve['shape'][0][0] == -1 and curve['shape'][-1][0] == 1"
done

# Every bump alike, no crown and no skew.
render phi 14 10 '{"id":"free.bump.phi","knots":[[-1,0],[-0.98,0],[-0.6,7],[-0.2,-8],[0.25,8],[0.6,-7],[0.98,0],[1,0]]}' 22,22
"$program" loop phi.png -o phi.out || fail "loop on a curve over the bumps"
says phi.out "curve['coordinate'] == 'bump.phi' and not claims and r['after']['rms'] < r['before']['rms'] / 10"

if [ -n "${FOILGAUGE_TEST_LONG-}" ]; then
reports="$reports four faint sway lens"

# Four effects of one scanner, told on one foil.
four='{"id":"scan.scale_y","value":-0.0009},{"id":"scan.shear","value":0.0007},
{"id":"scan.carriage_ripple","amplitude_um":6,"period_mm":2.6,"phase_deg":70},
{"id":"scan.row_step","amplitude_um":14,"y_mm":24.3}'
render four 15 10 "$four" 6,20 4800
"$program" loop four.png -o four.out || fail "loop on four effects"
says four.out "sorted(claims) == ['scan.carriage_ripple', 'scan.row_step', 'scan.scale_y', 'scan.shear']"
says four.out "e('after', 'R') < e('before', 'R') / 10 and e('after', 'R0') < e('before', 'R0') / 10"

# On rough edges a small curve could be one over another coordinate: the claim names them, and moves nothing.
python3 - "$root/samples/render/rough.json" >faint.json <<'PYTHON'
import json, sys
spec = json.load(open(sys.argv[1]))
spec["scanner"]["dpi"] = 2400
for dirt in ("dust", "specks", "scratches"):
    del spec["scanner"][dirt]
knots = [[-1, 0], [-0.7, 1.5], [-0.35, -1.5], [0, 1.5], [0.35, -1.5], [0.7, 1.5], [1, 0]]
print(json.dumps({**spec, "seed": 5, "effects": [{"id": "free.foil.s", "along": "radius", "knots": knots}]}))
PYTHON
"$renderer" render faint.json -o faint.png && "$program" loop faint.png -o faint.out || fail "loop on a faint curve"
says faint.out "r['verdict'] == 'unattributed' and not claims and 'free.foil.s' in curve['alias_class']"
says faint.out "len(curve['alias_class']) > 1 and 'radius_range_mm' in foil('after')['overall']"

# A carriage that runs unevenly and sways: two curves, from two scans.
sway='{"id":"free.scan.y","moves":"x","knots":[[2,0],[8,9],[15,-8],[22,10],[30,-9],[38,0]]},
{"id":"free.scan.y","moves":"y","knots":[[2,0],[6,-5],[12,6],[19,-7],[27,5],[33,-6],[38,0]]}'
render sway_a 5 -75 "$sway" 20,22
render sway_b 6 15 "$sway" 22,21
"$program" loop --same-foil sway_a.png sway_b.png -o sway.out || fail "loop on two curves"
says sway.out "not claims and curve['moves'] == 'x' and [(o['coordinate'], o['moves']) for o in curve['others']] == [('scan.y', 'y')]"
says sway.out "e('after', 'R') < e('before', 'R') / 10"

# A lens and a scale of the carriage leave the same edges as a lens elsewhere on a larger foil.
lens='{"id":"scan.optical_quadratic","amplitude_um":9,"centre_mm":18},{"id":"scan.scale_y","value":0.0008}'
render lens_a 16 -75 "$lens" 21,22 4800
render lens_b 17 15 "$lens" 22,21 4800
"$program" loop --same-foil lens_a.png lens_b.png -o lens.out --html lens.html || fail "loop on a lens and a scale"
says lens.out "claims['part.stretch']['verdict'] == 'tied' and 'scan.optical_quadratic + scan.scale_y' in claims['part.stretch']['alias_class']"
says lens.out "foil('after')['overall']['radius_range_mm'][0] <= 20.95 <= foil('after')['overall']['radius_range_mm'][1]"
says lens.out "any('known diameter' in s for s in r['separating_measurement'])"

fi

fi

# A step in the fillet beside a bump may as well lie on the bump's other side.
cat >step.json <<'SPEC'
{"schema":"foilgauge/render/1","seed":18,"width_px":4000,"height_px":5400,
 "foils":[{"design":{"bump_count":6,"bump_radius_mm":2.9,"bump_angle_deg":58,"overall_radius_mm":15,"pitch_deg":16,
   "fillet_radius_mm":0.35,"thickness_mm":0.1,"rotor_diameter_mm":28.8},
   "overall_radius_mm":15.2,"centre_mm":[0.88,18.34],"rotate_deg":-26}],
 "effects":[{"id":"scan.row_step","amplitude_um":-25,"y_mm":11.46}]}
SPEC
cat >step.design <<'SPEC'
{"schema":"foilgauge/design/1","form":"classical","bump_count":6,"bump_radius_mm":2.9,"bump_angle_deg":58,
 "overall_radius_mm":15,"pitch_deg":16,"fillet_radius_mm":0.35,"thickness_mm":0.1,"rotor_diameter_mm":28.8}
SPEC
"$renderer" render step.json -o step.png && "$program" loop step.png --design step.design -o step.out ||
  fail "loop on a step beside a bump"
says step.out "list(claims) == ['scan.row_step'] and claims['scan.row_step']['verdict'] == 'found'"
says step.out "abs(claims['scan.row_step']['parameters']['y_mm'] - 11.46) <= 2 * claims['scan.row_step']['uncertainty']['y_mm']"

for report in $reports; do valid loop_scan.schema.json $report.out; done
exit $failed
