#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A dent in a land is flagged, wherever the foil lies; sound foils, a missing bump and dust are not.
. tests/support/cli.sh

# foil NAME FOIL SCANNER EFFECTS [CODE]: measures a scan with more members; NAME.flags has the flags of its foil.
foil() {
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": 3, \"foils\": [{\"overall_radius_mm\": 20.9$2}],
    \"scanner\": {\"dpi\": 1200, \"noise\": 1.5, \"blur_px\": 1.2$3}, \"effects\": [$4]}" >"$1.spec"
  "$renderer" render "$1.spec" -o "$1.png" || fail "render $1"
  expect "${5-0}" "" "$program" measure "$1.png" -o "$1.json"
  valid measure.schema.json "$1.json"
  value "$1.json" '" ".join(r["foils"][0]["flags"])' >"$1.flags"
}
# dent DEPTH_UM: a bell, 0.15 mm wide (standard deviation), in the fifth land.
dent() {
  python3 -c 'import math, sys
knots = [[-0.095 + 0.0065 * k / 5, float(sys.argv[1]) * math.exp(-k * k / 50) * (abs(k) < 20)] for k in range(-20, 21)]
print("{\"id\": \"free.foil.s\", \"along\": \"normal\", \"knots\": %s}" % knots)' "$1"
}
flagged() {
  grep -qw land_deviates "$1.flags" || fail "$1: a dent has no flag: $(cat "$1.flags")"
}
silent() {
  ! grep -qw land_deviates "$1.flags" || fail "$1: a flag without a dent: $(cat "$1.flags")"
}
foil out ', "rotate_deg": -90' '' "$(dent 4)" && flagged out
foil in ', "rotate_deg": 30, "mirror": true' '' "$(dent -10)" && flagged in
foil deep ', "rotate_deg": 160' ', "contrast": -175, "background": 210' "$(dent 40)" && flagged deep
foil clean ', "rotate_deg": -90' '' '' && silent clean
foil small ', "rotate_deg": -90' '' "$(dent 0.05)" && silent small
foil missing ', "missing": [5]' '' '' 1 && silent missing
foil dust ', "rotate_deg": -90' ', "dust": {"count": 200, "radius_px": 3, "contrast": 80}' '' && silent dust
expect 0 "" "$program" measure out.png --html out.html
grep -q 'a dent, a crease' out.html || fail "the page does not say what the flag means"
exit $failed
