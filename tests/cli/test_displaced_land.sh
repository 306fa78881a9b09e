#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The end lands of an oval foil belong to its overall circle. A land that the scan's rows have moved is flagged, and is not in it.
. tests/support/cli.sh

# foil NAME EFFECT [EXPECTED_FLAGS]: measures a scan; R0 within 3 u of the truth.
foil() {
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": 3,
    \"foils\": [{\"overall_radius_mm\": 20.95, \"radius_mm\": [3.34,3.41,3.36,3.44,3.38,3.35,3.42,3.37,3.40]}],
    \"scanner\": {\"dpi\": 1200, \"noise\": 1.2, \"blur_px\": 1.3}, \"effects\": [$2]}" >"$1.spec"
  "$renderer" render "$1.spec" -o "$1.png" -t "$1.truth" || fail "render $1"
  expect 0 "" "$program" measure "$1.png" -o "$1.json"
  local flags
  flags=$(value "$1.json" '" ".join(r["foils"][0]["flags"])')
  [ "$flags" = "${3-}" ] || fail "$1: the flags are '$flags', not '${3-}'"
  near "R0 of $1" "$(value "$1.json" 'r["foils"][0]["overall"]["radius_mm"]')" \
    "$(value "$1.truth" 'r["foils"][0]["measurand"]["radius_mm"] if "foils" in r else r["measurand"]["radius_mm"]')" \
    "$(value "$1.json" '3 * r["foils"][0]["overall"]["u_radius_mm"]')"
}
for oval in 12,10 9,80 20,0 20,80; do
  foil "oval_$oval" "{\"id\": \"part.ovality\", \"amplitude_um\": ${oval%,*}, \"phase_deg\": ${oval#*,}}"
done
# One row of the scan is lost: beside the first and the last bump, at their feet, and in the end lands' fillets.
for row in 8.5 9 11.6; do
  foil "row_$row" "{\"id\": \"scan.row_step\", \"amplitude_um\": 21, \"y_mm\": $row}" land_deviates
done
foil clean ""
exit $failed
