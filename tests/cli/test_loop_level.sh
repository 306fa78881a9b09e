#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Lost rows change the radii of known pins, the small ones otherwise than the large: that is no level of the edges, which
# is sought on the corrected radii.
. tests/support/loop.sh

cat >steps.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 3,
 "discs": [{"centre_mm": [4, 4.1], "radius_mm": 3},
           {"centre_mm": [12.5, 2.8], "radius_mm": 1.75},
           {"centre_mm": [19.6, 4], "radius_mm": 2.5},
           {"centre_mm": [27.2, 3.3], "radius_mm": 2},
           {"centre_mm": [33.5, 3], "radius_mm": 1.5},
           {"centre_mm": [13.9, 9.1], "radius_mm": 0.75},
           {"centre_mm": [18.8, 9], "radius_mm": 0.5},
           {"centre_mm": [25.6, 12.2], "radius_mm": 3.5},
           {"centre_mm": [3.8, 19.5], "radius_mm": 2.75}],
 "scanner": {"dpi": 2400, "background": 30, "contrast": 175, "blur_px": 1.3, "noise": 1.0},
 "effects": [{"id": "scan.row_step", "amplitude_um": -8, "y_mm": 8.79}, {"id": "scan.row_step", "amplitude_um": -8, "y_mm": 5.46},
             {"id": "scan.row_step", "amplitude_um": -8, "y_mm": 3.06}]}
SPEC
cat >pins.json <<'DESIGN'
{"schema": "foilgauge/design/1", "name": "pins", "form": "discs", "diameters_mm": [1, 1.5, 3, 3.5, 4, 5, 5.5, 6, 7]}
DESIGN
"$renderer" render steps.json -o steps.png || fail "render"
"$program" loop steps.png --design pins.json -o steps.out || fail "loop on known pins and lost rows"
[ "$(value steps.out "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")" = "['scan.row_step found', 'scan.row_step found', 'scan.row_step found']" ] ||
  fail "lost rows are $(value steps.out "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")"
near "largest error of a radius, um" "$(value steps.out "max(min(abs(1000 * d['radius_mm'] - 250 * n) for n in range(16)) for d in r['after']['discs'])")" 0 0.1

# A ripple moves the radii of five pins so that a level and a scale explain them nearly: a level that was taken from them is
# taken again once the ripple is known.
cat >ripple.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 371740109,
 "discs": [{"centre_mm": [11.3729, 4.5133], "radius_mm": 1},
           {"centre_mm": [20.5994, 4.7955], "radius_mm": 1.5},
           {"centre_mm": [11.8372, 12.0794], "radius_mm": 3},
           {"centre_mm": [3.499, 11.9104], "radius_mm": 2.5},
           {"centre_mm": [20.3443, 12.3694], "radius_mm": 2}],
 "scanner": {"dpi": 2400, "blur_px": 1.3219, "noise": 1.0,
             "rough": {"edge_roughness_um": 1.2, "edge_common_um": 0.6, "correlation_um": 45, "correlation_form": "exponential"}},
 "effects": [{"id": "scan.carriage_ripple", "amplitude_um": 8.164, "period_mm": 3.3176, "phase_deg": 202.72}]}
SPEC
cat >five.json <<'DESIGN'
{"schema": "foilgauge/design/1", "name": "pins", "form": "discs", "diameters_mm": [2, 3, 4, 5, 6]}
DESIGN
"$renderer" render ripple.json -o ripple.png || fail "render a ripple"
"$program" loop ripple.png --design five.json -o ripple.out || fail "loop on known pins and a ripple"
[ "$(value ripple.out "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")" = "['scan.carriage_ripple found']" ] ||
  fail "a ripple is $(value ripple.out "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")"
near "largest error of a radius beside a ripple, um" "$(value ripple.out "max(min(abs(1000 * d['radius_mm'] - 500 * n) for n in range(8)) for d in r['after']['discs'])")" 0 1
exit $failed
