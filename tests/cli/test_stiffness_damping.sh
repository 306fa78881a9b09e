#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge stiffness`: secant and loss factors. The same foil behind four gaps has one loss factor of its own, while that of
# the test falls; friction of the rig does not count as the foil's; the secant is that of the loading branches' ends.
. tests/support/cli.sh

# damped.py GAP_MM RIG_N: foils of 500 N/mm and 5e4 N/mm^3 with friction of 8 % of their force, pressed by 80 um; after a turn
# friction reverses within 2 um. Truth by the integrals over both branches.
cat >damped.py <<'END'
import json, math, random, sys

gap, rig = float(sys.argv[1]), float(sys.argv[2])
DEPTH, CYCLES, EACH = 0.08, 3, 800
amplitude = gap / 2 + DEPTH


def foil(x, sense):
    d = max(0.0, abs(x) - gap / 2)
    f = math.copysign(500 * d + 5e4 * d**3, x)
    return f + sense * 0.08 * abs(f) * (1 - 2 * math.exp(-(amplitude + sense * x) / 0.0005))


def whole(x, sense):
    return foil(x, sense) + sense * rig * (1 - 2 * math.exp(-(amplitude + sense * x) / 0.0005))


def work(force, sense, low):
    n = 20000
    xs = [low + (amplitude - low) * (i + 0.5) / n for i in range(n)]
    return sum(force(x, sense) for x in xs) * (amplitude - low) / n


random.seed(5)
print("displacement_mm,force_N")
for i in range(CYCLES * EACH):
    phase = 2 * math.pi * i / EACH
    x, sense = amplitude * math.sin(phase), 1 if math.cos(phase) >= 0 else -1
    print(f"{x + random.gauss(0, 0.0001):.6f},{whole(x, sense) + random.gauss(0, 0.05):.4f}")
press, let_go = work(foil, 1, 0.0), work(foil, -1, 0.0)
area = work(whole, 1, -amplitude) - work(whole, -1, -amplitude)
secant = whole(amplitude, 1) / amplitude
truth = {"loss_factor_foil": (press - let_go) / (math.pi * (press + let_go)), "stiffness_secant_n_mm": secant,
         "loop_area_n_mm": area, "loss_factor_secant": area / (math.pi * secant * amplitude**2)}
json.dump(truth, open("truth.json", "w"))
END

for case in "0.02 0" "0.06 0" "0.10 0" "0.16 0" "0.10 1"; do
  read -r gap rig <<<"$case"
  python3 damped.py "$gap" "$rig" >test.csv
  expect 0 "" "$program" stiffness --azimuth 0 test.csv -o "r_${gap}_$rig.json"
  checks - "r_${gap}_$rig.json" <<'END' || fail "gap $gap mm, rig $rig N"
import json, sys
a, truth = json.load(open(sys.argv[1]))["azimuths"][0], json.load(open("truth.json"))
for name, true in truth.items():
    value, u = a[name], a["u_" + name]
    print(name, value, u, true)
    assert abs(value - true) <= 2 * u and u < 0.06 * true, name
assert a["u_repeat_stiffness_secant_n_mm"] < 0.01 * a["stiffness_secant_n_mm"]
END
done
# Of the test: falls with the gap. Of the foil: the same within 3 %.
checks - r_0.02_0.json r_0.06_0.json r_0.10_0.json r_0.16_0.json <<'END' || fail "loss factors over the gap"
import json, sys
found = [json.load(open(path))["azimuths"][0] for path in sys.argv[1:]]
test, foil = [a["loss_factor"] for a in found], [a["loss_factor_foil"] for a in found]
print(test, foil)
assert all(a > 1.15 * b for a, b in zip(test, test[1:])) and max(foil) < 1.03 * min(foil)
END
expect 0 "" "$program" stiffness --azimuth 0 test.csv --text r.txt --csv r.csv --html r.html
grep -q "(secant) *(foil)" r.txt && grep -q "loss_factor_foil,u_loss_factor_foil" r.csv && grep -q "loss factor<br>(foil)" r.html ||
  fail "the foil's loss factor is not in the table, the CSV and the page"

exit $failed
