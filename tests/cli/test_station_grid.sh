#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The station's check by a grid of known pitch: the first one is the baseline, a scanner whose scale has changed is told, and the page
# draws the largest residual beside scale and shear.
# Usage: test_station_grid.sh PROGRAM
. tests/support/cli.sh
skip_when_slow

# plate FILE SEED TURN SCALE: a scan of the plate on a scanner with that error along its carriage's way
plate() {
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": $2, \"scanner\": {\"dpi\": 600}, \"effects\": [{\"id\": \"scan.scale_y\", \"value\": $4}],
 \"grids\": [{\"marks\": \"dots\", \"centre_mm\": [17, 17], \"pitch_mm\": 2.5, \"columns\": 11, \"rows\": 11, \"rotate_deg\": $3}]}" >spec.json
  "$renderer" render spec.json -o scan.png && mv scan.png "$1"
}
once() {
  "$program" station in --recipe recipe.json --once >said 2>&1 || [ $? -le 3 ] || fail "--once: $(cat said)"
}
mkdir in
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "pitch_mm": 2.5, "u_pitch_mm": 0.00002}' >plate.json
cat >recipe.json <<'R'
{"schema": "foilgauge/recipe/1",
 "station": {"file_name": "{serial}", "check": {"design": "plate.json", "file_name": "check*", "scale_max_ppm": 1500}},
 "design": {"schema": "foilgauge/design/1"}}
R
plate in/check_1.png 1 0 0.0005
once
grep -q 'in order: 121 marks, x .*; the baseline of scale, shear and blur' said || fail "no baseline: $(cat said)"
plate in/check_2.png 2 3 0.0005
once
grep -q 'scale, shear and blur as in the baseline' said || fail "the plate laid elsewhere: $(cat said)"
plate in/check_3.png 3 1 0.0008
once
grep -q 'check_3.png CHANGED since the baseline of .*scale along y' said || fail "a changed scanner is not told: $(cat said)"
sed -i 's/, "u_pitch_mm": 0.00002//' plate.json
"$program" station in --recipe recipe.json --once >said 2>&1 && fail "a grid of unknown uncertainty checks a scanner"
grep -q 'pitch_mm and u_pitch_mm' said || fail "the refusal does not say what is missing: $(cat said)"
exit $failed
