#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge stiffness`: the secant of a rotor that is loaded in steps of force, where samples crowd in the displacement's noise
# about the turns: within 2 u_repeat of the truth, whether a level is read once or three times.
. tests/support/cli.sh

# stepped.py STEPS READINGS SEED: foils of 500 N/mm and 4e6 N/mm^3 behind a gap of 0.1 mm, loaded to 60 N in STEPS steps; friction
# of 8 % of the force reverses within 0.5 um. The last step is the turn.
cat >stepped.py <<'END'
import json, math, random, sys

steps, readings = int(sys.argv[1]), int(sys.argv[2])
random.seed(int(sys.argv[3]))
GAP, TOP, CYCLES = 0.1, 60.0, 3


def foil(d, depth):
    return (500 * d + 4e6 * d**3) * (1.08 if depth is None else 1 - 0.08 * (1 - 2 * math.exp(-(depth - d) / 0.0005)))


def depth_at(force, depth, high):
    low = 0.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if foil(middle, depth) < force else (low, middle)
    return low


deepest = depth_at(TOP, None, 0.1)
loading = [depth_at(TOP * (k + 0.5) / (steps + 0.5), None, 0.1) for k in range(steps + 1)]
letting = [depth_at(TOP * (k + 0.5) / (steps + 0.5), deepest, deepest) for k in range(steps)]
print("displacement_mm,force_N")
for cycle in range(2 * CYCLES):
    side = 1 if cycle % 2 == 0 else -1
    levels = list(enumerate(loading)) + list(enumerate(letting))[::-1]
    for k, d in levels:
        for _ in range(readings):
            x, f = side * (GAP / 2 + d), side * TOP * (k + 0.5) / (steps + 0.5)
            print(f"{x + random.gauss(0, 0.0002):.6f},{f + random.gauss(0, 0.2):.4f}")
json.dump(TOP / (GAP / 2 + deepest), open("truth.json", "w"))
END

for case in "150 1" "25 3"; do
  read -r steps readings <<<"$case"
  for seed in 1 2 3 4 5 6; do
    python3 stepped.py "$steps" "$readings" "$seed" >test.csv
    expect 0 "" "$program" stiffness --azimuth 0 test.csv -o "r_$seed.json"
  done
  checks - r_?.json <<'END' || fail "$steps steps, $readings readings"
import json, sys
truth, within = json.load(open("truth.json")), 0
for path in sys.argv[1:]:
    a = json.load(open(path))["azimuths"][0]
    value, u = a["stiffness_secant_n_mm"], a["u_repeat_stiffness_secant_n_mm"]
    print(path, value / truth - 1, u / truth)
    within += abs(value - truth) <= 2 * u
    assert abs(value - truth) < 0.008 * truth and u < 0.01 * truth
assert within >= 5
END
done

exit $failed
