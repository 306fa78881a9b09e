#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Rows or columns that jump where a bump's tangent runs along them make its R wrong: its u holds that, and it is flagged. Sound
# bumps keep their u.
. tests/support/cli.sh

# foil NAME TURN EFFECTS: measures a scan; the R of every bump lies within U of 3.32 mm; NAME.flags has the flags of bump 5.
foil() {
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": 11, \"foils\": [{\"overall_radius_mm\": 20.9, \"rotate_deg\": $2}],
    \"scanner\": {\"dpi\": 1200, \"noise\": 2, \"blur_px\": 1.3}, \"effects\": [$3]}" >"$1.spec"
  "$renderer" render "$1.spec" -o "$1.png" || fail "render $1"
  expect 0 "" "$program" measure "$1.png" -o "$1.json"
  value "$1.json" '" ".join(r["foils"][0]["bumps"][4]["flags"])' >"$1.flags"
  near "largest deviation of R from 3.32 mm, in u, of $1" \
    "$(value "$1.json" 'max(abs(b["radius_mm"] - 3.32) / b["u_radius_mm"] for b in r["foils"][0]["bumps"])')" 0 ${4-2.2}
}
# The crown of bump 5 lies at y 2.229 mm, turned by a quarter at x 12.925 mm.
for jump in 2.029,-5 2.179,-5 2.229,8; do
  foil "row_$jump" -90 "{\"id\": \"scan.row_step\", \"amplitude_um\": ${jump#*,}, \"y_mm\": ${jump%,*}}"
  grep -qw poor_fit "row_$jump.flags" || fail "rows that jump at ${jump%,*} mm: bump 5 has no flag"
done
foil column 0 '{"id": "scan.column_step", "amplitude_um": 6, "x_mm": 13.025}'
grep -qw poor_fit column.flags || fail "columns that jump: bump 5 has no flag"
for turn in -90 0 40; do
  foil "sound_$turn" $turn "" 3
  [ -z "$(cat "sound_$turn.flags")" ] || fail "a sound bump has flags: $(cat "sound_$turn.flags")"
  near "largest u of R of sound_$turn, um" "$(value "sound_$turn.json" '1000 * max(b["u_radius_mm"] for b in r["foils"][0]["bumps"])')" 0.9 0.4
done
exit $failed
