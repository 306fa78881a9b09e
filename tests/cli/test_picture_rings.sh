#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Rings around bumps that fail are whole, also where the foil lies at the edge of its scan.
# Usage: test_picture_rings.sh PROGRAM
set -euo pipefail
. "$(dirname "$0")/../support/checks.sh"
program=$1
renderer=${FOILGAUGE_RENDERER:-$program}
work=$(mktemp -d)
trap '[ "$BASHPID" != $$ ] || rm -rf "$work"' EXIT
cat >"$work/design.json" <<'D'
{"schema": "foilgauge/design/1", "bump_count": 5, "calibration": "not needed: the scan is rendered", "tolerances": {"height_mm": {"min": 1, "max": 9}}}
D
for turn in -90 0 90 135; do
  printf '{"schema": "foilgauge/render/1", "seed": 2, "scanner": {"dpi": 1200}, "foils": [{"rotate_deg": %s,
    "design": {"bump_count": 5}, "crushed": [{"bump": 3, "height_factor": 0.5}]}]}' $turn >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$work/$turn.png"
  "$program" measure "$work/$turn.png" --design "$work/design.json" --html "$work/$turn.html" >/dev/null 2>&1 || true
  checks - "$work/$turn.html" <<'PY' || { echo "test_picture_rings: at $turn degrees" >&2; exit 1; }
import re, sys
page = open(sys.argv[1]).read()
left, top, width, height = map(float, re.search(r'class="picture"[^>]*viewBox="([^"]*)"', page)[1].split())
rings = [(float(pen), [tuple(map(float, point.split())) for point in re.split("[ML]", line)[1:]])
         for pen, line in re.findall(r'stroke="#ff5252" stroke-width="([0-9.]+)"[^>]* d="([^"]+)"', page)]
rings = [ring for ring in rings if len(ring[1]) > 20]
assert len(rings) == 5, len(rings)
for pen, points in rings:
    for x, y in points:
        assert left + pen / 2 <= x <= left + width - pen / 2 and top + pen / 2 <= y <= top + height - pen / 2, \
            (x, y, left, top, width, height)
PY
done
echo "rings: whole in four poses"
