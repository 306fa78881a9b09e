#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# At 600 dpi a strip is two blurs wide, and its edges err by more than the noise: sound foils are clean, a wrong scale is seen.
# At 1200 dpi it is three: noise in its level and blur is no change of the strip's width.
. tests/support/cli.sh

# foil NAME SEED EFFECTS: runs the loop on a scan.
foil() {
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": $2, \"foils\": [{\"rotate_deg\": $((40 * $2)), \"overall_radius_mm\": 20.9}],
    \"scanner\": {\"dpi\": 600, \"noise\": 2, \"blur_px\": 1.3}, \"effects\": [$3]}" >"$1.spec"
  "$renderer" render "$1.spec" -o "$1.png" || fail "render $1"
  "$program" loop "$1.png" -o "$1.json" || [ $? = 3 ] || fail "$1: exit code"
}
for seed in 3 4 5; do
  foil "sound_$seed" $seed ""
  [ "$(value "sound_$seed.json" "r['verdict']")" = clean ] || fail "sound foil $seed: $(value "sound_$seed.json" "r['summary']")"
done
foil scale 7 '{"id": "scan.scale_y", "value": 0.002}'
value scale.json "r['verdict']" | grep -q explained || fail "a wrong scale: $(value scale.json "r['summary']")"
value scale.json "str(r['claims'])" | grep -q scan.scale_y ||
  fail "a wrong scale is not among the causes: $(value scale.json "r['summary']")"
for seed in 102 110 120; do
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": $seed, \"foils\": [{\"rotate_deg\": $((47 * seed % 360)), \"overall_radius_mm\": 20.9,
    \"radius_springback\": {\"mean\": 0.02, \"sd\": 0.007}}], \"scanner\": {\"dpi\": 1200, \"noise\": 3, \"blur_px\": 1.5}}" >"wide_$seed.spec"
  "$renderer" render "wide_$seed.spec" -o "wide_$seed.png" || fail "render wide_$seed"
  "$program" loop "wide_$seed.png" -o "wide_$seed.json" || fail "wide $seed: exit code"
  [ "$(value "wide_$seed.json" "r['verdict']")" = clean ] || fail "wide foil $seed: $(value "wide_$seed.json" "r['summary']")"
done
exit $failed
