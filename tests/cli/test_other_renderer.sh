#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scans of a renderer that has nothing in common with the program's, rough as real ones are: they are measured right, and
# what a scanner did to one of them is named with its numbers.
. tests/support/loop.sh
[ -n "${FOILGAUGE_TEST_LONG-}" ] || { echo "skipped: of accuracy only, of the long tests"; exit 77; }
for python in python3 /usr/bin/python3 ""; do
  "$python" -c "import numpy" 2>/dev/null && break
done
[ -n "$python" ] || { echo "numpy is not on this machine"; exit 77; }

other() { "$python" "$root/tests/bench/other_scanner.py" . "$@" >/dev/null || fail "other_scanner.py $*"; }

other --seed 6 --name clean
"$program" measure clean.png -o clean.json || fail "measure"
valid measure.schema.json clean.json
checks - <<'PYTHON' || fail "the scan of the second renderer is measured wrong"
import json
foil, truth = json.load(open("clean.json"))["foils"][0], json.load(open("clean.truth.json"))
places = [4800 / 25.4 * v for v in foil["overall"]["centre_mm"]]
assert all(abs(a - b) < 1.5 for a, b in zip(places, truth["overall_centre_px"])), (places, truth["overall_centre_px"])
assert abs(foil["thickness_mm"] - 0.1) < 0.003, foil["thickness_mm"]
pairs = [(foil["overall"], truth["overall_radius_mm"], "radius_mm", 0.001)]
for bump, known in zip(foil["bumps"], truth["bumps"], strict=True):
    pairs += [(bump, known["radius_mm"], "radius_mm", 0.015), (bump, known["height_mm"], "height_mm", 0.001)]
    pairs += [(bump, known["bump_angle_deg"], "bump_angle_deg", 0.3)]
for circle, right, name, most in pairs:
    error = abs(circle[name] - right)
    assert error < most and error < 4 * circle["u_" + name], (name, error, circle["u_" + name])
PYTHON

other --seed 6 --name ripple --effect scan.carriage_ripple=25,period_mm=3.3,phase_deg=40
"$program" loop ripple.png -o ripple.json || fail "loop"
claim="[c for c in r['claims'] if c['id'] == 'scan.carriage_ripple'][0]['parameters']"
near "the ripple" "$(value ripple.json "${claim}['amplitude_um']")" 25 1
near "its period" "$(value ripple.json "${claim}['period_mm']")" 3.3 0.01
near "its phase" "$(value ripple.json "${claim}['phase_deg']")" 40 5

exit $failed
