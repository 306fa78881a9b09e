#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# An end of the scale that cuts the edges, however deep, leaves no thickness off by more than U, and no wrong verdict.
#   test_clipped_levels.sh PROGRAM
. tests/support/cli.sh

echo '{"schema": "foilgauge/design/1", "bump_count": 3, "calibration": "not needed: the scan is rendered", "tolerances": {"thickness_mm": {"min": 0.095, "max": 0.105}}}' >limits.json
# clip BRIGHT(1, 0) LOW HIGH THICKNESS DPI: counts below LOW and beyond HIGH of 31 to 199 are cut off
clip() {
  local levels='"background": 31, "contrast": 168'
  ((${1})) || levels='"background": 199, "contrast": -168'
  cat >scan.json <<J
{"schema": "foilgauge/render/1", "seed": 6, "foils": [{"design": {"bump_count": 3, "thickness_mm": $4}, "rotate_deg": 25}],
 "scanner": {"dpi": $5, "blur_px": 1.2, "noise": 1, $levels, "tone_curve": [[0, 0], [$2, 0], [$3, 255]$([[ $3 == 255 ]] || echo ', [255, 255]')]}}
J
  "$renderer" render scan.json -o scan.png || fail "render $*"
  "$program" measure scan.png --design limits.json -o scan.out 2>/dev/null
  checks - "$4" <<'P' || fail "clipped $*: wrong beyond U, or a wrong verdict"
import json, sys
foil, truth = json.load(open("scan.out"))["foils"][0], float(sys.argv[1])
assert "clipped_levels" in foil["flags"], foil["flags"]
off, u = foil["thickness_mm"] - truth, foil["u_thickness_mm"]
assert abs(off) <= 2 * u, (off, u)
assert foil["verdict"] != ("fail" if 0.095 <= truth <= 0.105 else "pass"), (foil["verdict"], off, u)
P
}
for bright in 1 0; do
  clip $bright 48 255 0.1 2400
  clip $bright 115 255 0.108 2400
  clip $bright 165 255 0.1 2400
  clip $bright 1 150 0.1 2400
  clip $bright 1 65 0.108 2400
done
clip 1 150 255 0.108 4800

# A pin of two levels: its threshold may lie anywhere, and the blur that turns it into length is hidden.
echo '{"schema": "foilgauge/design/1", "form": "discs", "calibration": "not needed: the scan is rendered", "tolerances": {"diameter_mm": {"min": 0.996, "max": 1.004}}}' >pin.json
for threshold in 60 180; do
  cat >bit.json <<J
{"schema": "foilgauge/render/1", "seed": 3, "foils": [], "discs": [{"centre_mm": [2.5, 2.5], "radius_mm": 0.5}],
 "scanner": {"dpi": 2400, "noise": 1, "levels": 2, "threshold": $threshold}}
J
  "$renderer" render bit.json -o bit.png || fail "render 1 bit"
  "$program" measure bit.png --design pin.json -o bit.out 2>/dev/null
  checks - <<'P' || fail "a pin of two levels, threshold $threshold"
import json
disc = json.load(open("bit.out"))["discs"][0]
assert "few_levels" in disc["flags"] and disc["verdict"] == "cannot_tell", (disc["flags"], disc["verdict"])
assert abs(disc["diameter_mm"] - 1) <= 2 * disc["u_diameter_mm"], disc["u_diameter_mm"]
P
done
exit $failed
