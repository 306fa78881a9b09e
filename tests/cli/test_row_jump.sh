#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Rows that a scanner lost move bumps against the lands. Wherever they cut the foil, it is flagged; sound foils are not.
. tests/support/cli.sh

# foil NAME FOIL SCANNER EFFECTS [CODE]: measures a scan; NAME.flags has the flags of its foil.
foil() {
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": 3, \"foils\": [{\"overall_radius_mm\": 20.95$2}],
    \"scanner\": {\"noise\": 1.2, \"blur_px\": 1.3$3}, \"effects\": [$4]}" >"$1.spec"
  "$renderer" render "$1.spec" -o "$1.png" || fail "render $1"
  expect "${5-0}" "" "$program" measure "$1.png" -o "$1.json"
  value "$1.json" '" ".join(r["foils"][0]["flags"])' >"$1.flags"
}
radii=', "radius_mm": [3.34,3.41,3.36,3.44,3.38,3.35,3.42,3.37,3.40]'
# At a foot, 7 % and 14 % into an arc, where the whole fillet is hidden, in the middle of an arc, on a land.
for row in 3.1 3.4 4.2 5 5.5 6 7 8; do
  foil "row_$row" "$radii" ', "dpi": 1200' "{\"id\": \"scan.row_step\", \"amplitude_um\": 21, \"y_mm\": $row}"
  grep -qw land_deviates "row_$row.flags" || fail "rows that jump at $row mm have no flag: $(cat "row_$row.flags")"
done
silent() {
  foil "$@"
  ! grep -qw land_deviates "$1.flags" || fail "$1: a flag without a jump: $(cat "$1.flags")"
}
dust=', "dust": {"count": 200, "radius_px": 3, "contrast": 80}'
rough=', "noise_correlation": 0.6, "rough": {"edge_roughness_um": 1.4, "edge_common_um": 0.7, "correlation_um": 50}'
silent clean "$radii" ', "dpi": 1200' ''
silent fine "$radii" ', "dpi": 2400' ''
silent coarse "$radii" ', "dpi": 600' ''
silent dust "$radii" ", \"dpi\": 1200$dust" ''
silent rough "$radii" ", \"dpi\": 1200$rough" ''
silent crushed ', "crushed": [{"bump": 4, "height_factor": 0.6}]' ', "dpi": 1200' ''
silent missing ', "missing": [5]' ', "dpi": 1200' '' 1
silent sinusoidal ', "design": {"form": "sinusoidal", "fillet_radius_mm": 1.1, "bump_angle_deg": 60}' ', "dpi": 1200' ''
silent crown "$radii" ', "dpi": 1200' '{"id": "part.bump_crown", "amplitude_um": 3}'
silent ripple "$radii" ', "dpi": 1200' '{"id": "scan.carriage_ripple", "amplitude_um": 6, "period_mm": 3.1}'
exit $failed
