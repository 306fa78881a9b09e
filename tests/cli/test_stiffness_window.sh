#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge stiffness`: the largest stiffness under dead weights, where the gap is not sampled and a loaded branch has few places: a
# window that is wider than the branch tells nothing of its own bias, which must be in u all the same.
. tests/support/cli.sh

# weights.py EXPONENT SEED: foils of 60 N at 20 um whose force rises with the power EXPONENT, behind a gap of 0.1 mm, loaded and let go
# in 16 levels, three readings each; friction of 6 %.
cat >weights.py <<'END'
import random, sys

exponent = float(sys.argv[1])
random.seed(int(sys.argv[2]))
LEVELS = 16
print("displacement_mm,force_N")
for cycle in range(6):
    side = 1 if cycle % 2 == 0 else -1
    way = [(k, 1.06) for k in range(LEVELS)] + [(k, 0.94) for k in range(LEVELS - 1)][::-1]
    for k, share in way:
        f = 60 * (k + 0.5) / (LEVELS - 0.5)
        d = min(0.02, 0.02 * (f / (60 * share / 1.06)) ** (1 / exponent))
        for _ in range(3):
            print(f"{side * (0.05 + d) + random.gauss(0, 0.0002):.6f},{side * f + random.gauss(0, 0.2):.4f}")
END

for exponent in 1.3 1.5 1.7; do
  for seed in 1 2 3 4 5 6; do
    python3 weights.py "$exponent" "$seed" >test.csv
    expect 0 "" "$program" stiffness --azimuth 0 test.csv -o "r_$seed.json"
  done
  checks - "$exponent" r_?.json <<'END' || fail "exponent $exponent"
import json, sys
n, within, known = float(sys.argv[1]), 0, 0
for path in sys.argv[2:]:
    a = json.load(open(path))["azimuths"][0]
    truth = 60 * n / 0.02 * ((abs(a["stiffness_at_mm"]) - 0.05) / 0.02) ** (n - 1)
    value, u = a["stiffness_n_mm"], a["u_repeat_stiffness_n_mm"]
    print(path, value / truth - 1, u / truth)
    within += abs(value - truth) <= 2 * u
    known += u < 0.05 * truth
assert within >= 5 and known >= 5
END
done

exit $failed
