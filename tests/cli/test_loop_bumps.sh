#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on a scan of a foil of which single bumps deviate: told as that, not as steps of the carriage.
. tests/support/loop.sh
skip_when_slow # test_loop_scan.sh sees the same search

# says REPORT EXPRESSION: of a report r, its curve and its claims.
says() {
  python3 - "$1" "$2" <<'PYTHON' || fail "$1: not so: $2"
import json, sys
r = json.load(open(sys.argv[1]))
claims, curve = [c["id"] for c in r["claims"]], r["unattributed"]
height = {b["number"]: b["height_mm"] for b in r["after"]["foils"][0]["bumps"]}
true = {b["index"]: b["height_mm"] for b in json.load(open(sys.argv[1][:-4] + ".truth.json"))["bumps"]}
off = {n: 1000 * (height[n] - true[n]) for n in true}
sys.exit(not eval(sys.argv[2]))
PYTHON
}

# Every third bump raised at its middle leaves a P4 beside its circle.
render_foil middle 31 34 '{"id":"free.bump.index","form":"crown","amplitude_um":4,"every":3}' 4800
"$program" loop middle.png -o middle.out || fail "loop on bumps that are raised at their middle"
says middle.out "r['verdict'] == 'unattributed' and not claims and curve['coordinate'] == 'bump.index'"
# Of single bumps other bumps tell nothing: stretches of every arc take turns.
says middle.out "r['error_ratio']['fold_of'] == 'stretches of the edge' and r['error_ratio']['held_out'] < 0.5"
says middle.out "r['after']['rms'] < 1.5 * r['noise_floor'] and r['before']['rms'] > 4 * r['after']['rms']"
# The curve is drawn over number and place: it is there on bumps 3, 6, 9, and nowhere else.
says middle.out "all((max(abs(v) for x, v in curve['shape'] if abs(x - n) < 0.45) > 0.2) == (n % 3 == 0) for n in true)"
# The circles' heights hold what circles take of it.
says middle.out "all(abs(off[n] - (3.66 if n % 3 == 0 else 0)) < 0.6 for n in true)"

# The whole of it: that is another bump for the geometry, and the bumps are held against each other.
render_foil whole 32 -61 '{"id":"free.bump.index","form":"whole","amplitude_um":4,"every":3}' 2400
"$program" loop whole.png -o whole.out --html whole.html || fail "loop on bumps that are raised"
says whole.out "r['verdict'] == 'unattributed' and not claims and curve['coordinate'] == 'bump.index'"
says whole.out "[n for n, v in curve['shape'] if abs(v) > 0.1] == [3, 6, 9] and curve['moves'] == 'bump_angle_deg'"
says whole.out "any('bumps 3, 6, 9, every 3rd' in n for n in r['notes']) and all(abs(off[n]) < 0.3 for n in true)"
grep -q 'every 3rd' whole.html || fail "the page does not say which bumps"

[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || exit $failed

# Beside the scatter of real edges: one bump, and a seam between two chips of the sensor.
rough='"bits":8,"noise":1.8,"noise_correlation":0.6,"blur_px":1.9,"rough":{"edge_roughness_um":1,"edge_common_um":0.5,"correlation_um":40}'
# render_rough NAME SEED EFFECTS [MEMBERS OF THE SCANNER, each with a comma behind it]
render_rough() {
  cat >"$1.json" <<SPEC
{"schema":"foilgauge/render/1","seed":$2,"foils":[{"overall_radius_mm":20.95,"rotate_deg":-61,
 "radius_springback":{"mean":0.02,"sd":0.007}}],"scanner":{${4-}$rough},"effects":[$3]}
SPEC
  "$renderer" render "$1.json" -o "$1.png" --truth "$1.truth.json" || fail "render $1"
}
render_rough lone 33 '{"id":"free.bump.index","form":"crown","amplitude_um":36,"bumps":[4]}'
cp lone.truth.json named.truth.json
"$program" loop lone.png -o named.out || fail "loop on a rough scan of a foil with one bump that is raised"
says named.out "claims == ['part.dent'] or not claims and curve['coordinate'] == 'bump.index'"
"$program" loop lone.png --without part.dent -o lone.out || fail "loop on a raised bump, without dents"
says lone.out "r['verdict'] == 'unattributed' and not claims and curve['coordinate'] == 'bump.index'"
# Of the midline's scatter, 0.87 um over some 0.06 mm, a row's mean keeps the larger part.
says lone.out "r['noise']['form'] == 'gaussian' and 0.55 < r['noise']['correlated_sd'] < 0.87 and 0.04 < r['noise']['range_mm'] < 0.08"
if [ -n "${FOILGAUGE_TEST_LONG-}" ]; then
render_rough seam 34 '' '"chip_seams":[{"x_mm":20,"shift_um":14}],'
"$program" loop seam.png -o seam.out || fail "loop on a rough scan with a seam"
says seam.out "'scan.column_step' in claims + [m for c in r['claims'] for m in c.get('alias_class') or []]"

valid loop_scan.schema.json seam.out
fi

for report in middle whole named lone; do valid loop_scan.schema.json $report.out; done
exit $failed
