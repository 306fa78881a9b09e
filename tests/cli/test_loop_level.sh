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
exit $failed
