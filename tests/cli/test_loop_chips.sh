#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Chips of the sensor that are mounted askew, under round pins: they break lines across the way of the lines, which a
# program that knows no such chips must not take for lost rows.
. tests/support/loop.sh

cat >tilted.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 5,
 "discs": [{"centre_mm": [1.2, 1.6], "radius_mm": 1}, {"centre_mm": [5.0, 2.2], "radius_mm": 1.5}, {"centre_mm": [10.1, 2.9], "radius_mm": 2},
           {"centre_mm": [16.2, 3.2], "radius_mm": 2.5}, {"centre_mm": [23.1, 3.6], "radius_mm": 3}, {"centre_mm": [29.8, 2.9], "radius_mm": 2.25},
           {"centre_mm": [7.2, 10.1], "radius_mm": 2.75}, {"centre_mm": [13.9, 11.3], "radius_mm": 3}, {"centre_mm": [20.8, 12.0], "radius_mm": 2.5}],
 "scanner": {"dpi": 2400, "background": 30, "contrast": 175, "blur_px": 1.3, "noise": 1.2},
 "effects": [{"id": "scan.chip_tilt", "amplitude_um": 12, "x_mm": 6.3, "pitch_mm": 10.5}]}
SPEC
"$renderer" render tilted.json -o tilted.png || fail "render"
"$program" loop tilted.png --form discs --without scan.chip_tilt -o tilted.out || fail "loop on a plate over tilted chips"
[ "$(value tilted.out "[c['id'] for c in r['claims'] if c['verdict'] == 'found'], r['unattributed']['moves']")" = "([], 'y')" ] ||
  fail "tilted chips are $(value tilted.out "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")"

# The same under pins of known diameters: the correction for such chips fits their edges and not their sizes, and is
# refused.
sed 's/"amplitude_um": 12/"amplitude_um": 24/' tilted.json >more.json
cat >pins.json <<'DESIGN'
{"schema": "foilgauge/design/1", "name": "pins", "form": "discs", "diameters_mm": [2, 3, 4, 4.5, 5, 5, 5.5, 6, 6]}
DESIGN
"$renderer" render more.json -o more.png || fail "render"
"$program" loop more.png --design pins.json --without scan.chip_tilt -o more.out || fail "loop on known pins over tilted chips"
off() { value more.out "max(min(abs(1000 * d['radius_mm'] - 250 * n) for n in range(16)) for d in r['$1']['discs'])"; }
near "largest error of a radius, um, before" "$(off before)" 0 0.05
near "largest error of a radius, um, after" "$(off after)" 0 0.05
exit $failed
