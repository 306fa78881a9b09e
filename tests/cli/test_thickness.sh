#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A strip that is not as thick as the design says: clearances are over the strip as it is, both are said where they
# differ by more than U, and the thickness has a tolerance of its own.
#   test_thickness.sh PROGRAM
. tests/support/cli.sh

cat >thick.json <<'J'
{"schema": "foilgauge/render/1", "seed": 4, "foils": [{"design": {"thickness_mm": 0.105}, "rotate_deg": 20}],
 "scanner": {"dpi": 2400, "blur_px": 1.1, "noise": 1.0}}
J
cat >limit.json <<'J'
{"schema": "foilgauge/design/1", "calibration": "not needed: the scan is rendered", "tolerances": {"thickness_mm": {"min": 0.098, "max": 0.102}}}
J
"$program" render thick.json -o thick.png --truth truth.json || fail "render"
sed 's/0.105/0.1/' thick.json >plain.json
"$program" render plain.json -o plain.png || fail "render"
for scan in thick plain; do
  "$program" measure "$scan.png" --tone linear -o "$scan.out" --html "$scan.html" || fail "$scan: $?"
  script -qec "'$program' measure $scan.png --tone linear" /dev/null >"$scan.txt" 2>/dev/null
done
checks - <<'P' || fail "clearances are not over the strip as it is"
import json
read = lambda name: json.load(open(name))["foils"][0]
foil, plain, truth = read("thick.out"), read("plain.out"), json.load(open("truth.json"))
assert abs(foil["thickness_mm"] - 0.105) < 2 * foil["u_thickness_mm"] < 0.002, foil["u_thickness_mm"]
assert foil["thickness_differs"] and not plain["thickness_differs"]
assert foil["thickness_design_mm"] == 0.1
for bump, true in zip(foil["bumps"], truth["bumps"]):
    clearance = 20.73 - true["height_mm"] - 20 - 0.105
    assert abs(bump["clearance_mm"] - clearance) < 2 * bump["u_clearance_mm"], (bump["clearance_mm"], clearance)
    assert abs(bump["clearance_mm"] + bump["height_mm"] - (0.73 - foil["thickness_mm"])) < 1e-9
    assert abs(bump["clearance_fitted_mm"] + bump["height_fitted_mm"] - (0.73 - foil["thickness_mm"])) < 1e-9
    assert bump["u_clearance_mm"] > foil["u_thickness_mm"]
P
for text in thick.txt thick.html; do
  grep -q 'the design says 0.1 mm: clearances are over the strip as measured' "$text" || fail "$text: not said"
done
grep -q 'the design says' plain.txt plain.html && fail "said of a strip that is as designed"
[ "$(wc -L <thick.txt)" -le 110 ] || fail "wider than the terminal's table: $(wc -L <thick.txt)"
"$program" measure thick.png --tone linear --design limit.json -o never.out
[ $? = 1 ] || fail "a thickness beyond its tolerance"
"$program" measure plain.png --tone linear --design limit.json -o ok.out || fail "a thickness within its tolerance: $?"
exit $failed
