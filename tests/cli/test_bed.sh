#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A bed of foils through the program: reading order and places, one foil that cannot be measured, limits.
. tests/support/cli.sh

cat >"$work/spec.json" <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 5, "width_px": 6400, "height_px": 3200, "foils": [
  {"rotate_deg": -90, "centre_mm": [24, 26]}, {"rotate_deg": -90, "centre_mm": [72, 27]},
  {"rotate_deg": -90, "centre_mm": [110, 30], "design": {"bump_count": 1}, "first_land_mm": 0.2, "last_land_mm": 0.2},
  {"rotate_deg": -90, "centre_mm": [26, 60]}, {"rotate_deg": 90, "centre_mm": [75, 30]}],
 "scanner": {"dpi": 1200}}
SPEC
"$renderer" render "$work/spec.json" -o "$work/bed.png" || fail "render"
expect 2 "" "$program" measure "$work/bed.png" -o "$work/bed.json" --csv "$work/bed.csv"
checks - "$work/bed.json" <<'CHECK' || fail "the report is wrong"
import json, sys
foils = json.load(open(sys.argv[1]))["foils"]
assert [f["number"] for f in foils] == [1, 2, 3, 4, 5]
bad = [f["number"] for f in foils if "not_measured" in f["flags"]]
assert bad == [3] and foils[2]["error"], bad
assert all(len(f["bumps"]) == 9 and f["bumps"][0]["radius_mm"] for f in foils if f["number"] != 3)
for foil, (x, y) in zip(foils, [(24, 26), (72, 27), (110, 30), (26, 60), (75, 30)]):
    left, top, width, height = foil["place_mm"]
    assert left < x < left + width, foil["place_mm"]
    edge = top + height - 21 if foil["number"] == 5 else top + 21
    assert foil["number"] == 3 or abs(edge - y) < 2, foil["place_mm"]
CHECK
head -1 "$work/bed.csv" | grep -q ',foil_x_mm,foil_y_mm,foil_width_mm,foil_height_mm$' || fail "no place in the CSV"

# The same with one thread, and with eight.
for threads in 1 8; do
  expect 2 "" "$program" measure "$work/bed.png" --threads $threads -o "$work/again.json"
  cmp "$work/bed.json" "$work/again.json" || fail "$threads threads give another report"
done

expect 65 "max-memory" "$program" measure "$work/bed.png" --max-memory 1
expect 65 "more than the 20000000 that are read" "$program" measure "$work/bed.png" --max-pixels 20000000
expect 64 "channel" "$program" measure "$work/bed.png" --channel infrared
grep -q . "$work/stdout" && fail "an error wrote results"
exit $failed
