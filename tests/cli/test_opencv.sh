#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# OpenCV is loaded where a picture is drawn, and nowhere else: a program that cannot load it measures all the same.
. tests/support/cli.sh

readelf -d "$program" | grep -q 'NEEDED.*opencv' && fail "the program itself needs OpenCV"

cat >"$work/spec.json" <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 5, "foils": [{"rotate_deg": -90}], "scanner": {"dpi": 1200}}
SPEC
"$renderer" render "$work/spec.json" -o "$work/foil.png" || fail "render"

# As it is installed: the module in ../lib/foilgauge. One that is broken is named, and harms nobody else.
mkdir -p "$work/bin" "$work/lib/foilgauge"
cp "$program" "$work/bin/foilgauge"
echo broken >"$work/lib/foilgauge/foilgauge-opencv.so"
expect 0 "" "$work/bin/foilgauge" measure "$work/foil.png" -o "$work/a.json"
expect 74 "OpenCV cannot be loaded.*lib/foilgauge/foilgauge-opencv.so" \
  "$work/bin/foilgauge" measure "$work/foil.png" -o "$work/b.json" --overlay "$work/b.png"
[ ! -e "$work/b.png" ] || fail "a picture that could not be drawn is there"
cp "$(dirname "$program")/foilgauge-opencv.so" "$work/lib/foilgauge/"
expect 0 "" "$work/bin/foilgauge" measure "$work/foil.png" -o "$work/b.json" --overlay "$work/b.png"
expect 0 "" "$program" measure "$work/foil.png" -o "$work/c.json" --overlay "$work/c.png"
cmp "$work/b.png" "$work/c.png" || fail "the installed program draws another picture"
exit $failed
