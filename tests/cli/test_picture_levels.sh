#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Gray levels that are missing: told where a tone curve after rounding has left gaps that differ along the
# scale, not of levels that few pixels left out by chance, nor of a straight stretch, which moves no edge.
# Usage: test_picture_levels.sh PROGRAM
set -euo pipefail
program=$1
renderer=${FOILGAUGE_RENDERER:-$program}
work=$(mktemp -d)
trap '[ "$BASHPID" != $$ ] || rm -rf "$work"' EXIT
fail() {
  echo "test_picture_levels: $*" >&2
  exit 1
}
echo '{"schema": "foilgauge/design/1", "form": "discs", "diameters_mm": [1, 2, 3, 4]}' >"$work/plate.json"
foil='"foils": [{"rotate_deg": -90, "design": {"bump_count": 2}}]'
plate='"discs": [{"centre_mm": [3.1, 3], "radius_mm": 0.5}, {"centre_mm": [8.2, 3.2], "radius_mm": 1},
  {"centre_mm": [3.3, 8.1], "radius_mm": 1.5}, {"centre_mm": [9, 9], "radius_mm": 2}]'
# gaps SEED DPI SCENE SCANNER [MEASURE'S OPTIONS]: 1 where they are told, else 0
gaps() {
  printf '{"schema": "foilgauge/render/1", "seed": %s, "scanner": {"dpi": %s, "blur_px": 1, %s}, %s}' "$1" "$2" "$4" "$3" >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$work/scan.png"
  shift 4
  "$program" measure "$work/scan.png" "$@" -o "$work/scan.json" 2>"$work/said" || [ $? -le 3 ] || fail "$(cat "$work/said")"
  grep -c '"finding": "level_gaps"' "$work/scan.json" || true
}
s_shape='"tone_curve": [[0, 0], [64, 30], [128, 128], [192, 226], [255, 255]], "tone_bits": 8'
power='"tone_curve": [[0, 0], [16, 56], [32, 83], [64, 122], [128, 180], [192, 222], [255, 255]], "tone_bits": 8'
straight='"tone_curve": [[0, 0], [40, 0], [215, 255], [255, 255]], "tone_bits": 8'
for seed in 1 2 3 5 8; do
  [ "$(gaps $seed 1200 "$plate" '"noise": 1.5' --design "$work/plate.json")" = 0 ] || fail "a plain plate, seed $seed"
done
[ "$(gaps 2 2400 "$plate" '"noise": 0.5' --design "$work/plate.json")" = 0 ] || fail "a plain plate with little noise"
[ "$(gaps 1 2400 "$plate" "\"noise\": 1.5, $power" --design "$work/plate.json")" = 1 ] || fail "a plate through a power of the light"
[ "$(gaps 1 2400 "$foil" '"noise": 1.5')" = 0 ] || fail "a plain foil"
[ "$(gaps 1 1200 "$foil" "\"noise\": 1.5, $power")" = 1 ] || fail "a foil through a power of the light"
[ "$(gaps 1 2400 "$foil" "\"noise\": 1.5, $s_shape")" = 1 ] || fail "a foil through an S-shaped curve"
[ "$(gaps 1 2400 "$foil" "\"noise\": 1.5, $straight")" = 0 ] || fail "a foil that was stretched"
