#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge stiffness`: the gap that lies under a clearance, against known truth of foils of several laws with play
# operators; bearings that press their rotor have none; a lot's rigid travel against the gap, whatever the threshold.
. tests/support/cli.sh
skip_when_slow # the other tests of load tests see the same code
listened="stdout stderr"
run() { expect "$1" "$2" "$program" stiffness "${@:3}"; }

# make.py OUT.csv KIND...: a row of BEARINGS each, along three azimuths. A foil's force over its compression y is
# c y^n (1 + sum of share_i s_i), s_i the stop of a play operator of half-width r_i; it pushes only. Shares no code with
# the program.
cat >make.py <<'END'
import json, math, random, sys
BEARINGS = {  # n, force at 10 um in N, gap of both sides in um, rig's friction in N, control
    "spring": (1.0, 9.5, 160, 0, "x"), "hertz": (1.5, 6, 160, 0, "x"), "bumps": (1.9, 4, 160, 0, "x"),
    "rig": (1.0, 9.5, 160, 1, "x"), "weights": (1.2, 8, 160, 0, "force"), "narrow": (1.0, 9.5, 20, 0, "x"),
    "pressed": (1.0, 20, -20, 0, "x"), "pressed_rig": (1.0, 20, -20, 1, "x"), "pressed_hertz": (1.5, 12, -20, 0, "x"),
    "pressed_bumps": (1.9, 6, -12, 0, "x"), "pressed_weights": (1.2, 12, -16, 0, "force"), "touching": (1.0, 9.5, 0, 0, "x")}
SHARES, WIDTHS, MOST_N = (0.03, 0.05), (0.0004, 0.0012), 80.0

class Foil:
    def __init__(self, n, c):
        self.n, self.c, self.play = n, c / 0.010**n, [0.0] * len(WIDTHS)
    def press(self, y):
        y = max(y, 0.0)
        self.play = [min(max(p, y - r), y + r) for p, r in zip(self.play, WIDTHS)]
        return max(0.0, self.c * y**self.n * (1 + sum(a * (y - p) / r for a, p, r in zip(SHARES, self.play, WIDTHS))))

def record(name, azimuth, rng, shift_mm=0.0, cycles=3, step_mm=5e-5):
    n, c, gap, rig, control = BEARINGS[name]
    half = gap / 2000 + shift_mm / 2
    plus, minus, x, sense, rows = Foil(n, c), Foil(n, c), 0.0, 1, []
    end = half + 0.010 * (MOST_N / c) ** (1 / n)
    for turn in range(2 * cycles + 1):
        while (turn < 2 * cycles or x < 0) and sense * x < end:
            x += sense * step_mm
            force = plus.press(x - half) - minus.press(-x - half) + sense * rig
            rows.append((turn // 2 + 1, x, force))
        sense = -sense
    kept, last = [], -1e9
    for row in rows:  # along the way in x, or in equal steps of force: then the rotor jumps through the gap
        if control == "force" and abs(row[2] - last) < 1.0 or control == "x" and abs(row[1] - last) < 4e-4:
            continue
        last = row[2] if control == "force" else row[1]
        kept.append(row)
    for i, (cycle, x, force) in enumerate(kept):
        yield f"{name},{azimuth},{cycle},{i},{1000 * x + rng.gauss(0, 0.1):.3f},{force + rng.gauss(0, 0.05):.3f}"

if __name__ == "__main__":
    rng = random.Random(160)
    with open(sys.argv[1], "w") as out:
        out.write("bearing,azimuth_deg,cycle,time_s,displacement_um,force_N\n")
        for name in sys.argv[2:] or BEARINGS:
            for azimuth in 0, 60, 120:
                out.write("\n".join(record(name, azimuth, rng)) + "\n")
END
python3 make.py test.csv
run 2 "no gap: the foils of both sides touch the rotor at once" test.csv --text -
run 2 "" test.csv -o r.json
cat >check.py <<'END'
import json, sys
from make import BEARINGS
bad = []
for a in json.load(open(sys.argv[1]))["azimuths"]:
    true, name = BEARINGS[a["bearing"]][2], a["bearing"]
    if true <= 0:  # never a positive clearance
        right = a["clearance_mm"] is None and a["gap_mm"] is None and "no_gap" in a["flags"]
    else:
        right = abs(1000 * a["gap_mm"] - true) <= 2000 * a["u_gap_mm"] <= 12 and a["clearance_mm"] > a["gap_mm"] \
            and not {"no_gap", "gap_not_known"} & set(a["flags"])
    if not right:
        bad.append((name, a["azimuth_deg"], a["clearance_mm"], a["gap_mm"], a["u_gap_mm"], a["flags"]))
for b in json.load(open(sys.argv[1]))["bearings"]:  # without load there is the rig's friction alone
    true, row = BEARINGS[b["name"]][3], BEARINGS[b["name"]]
    value, u = b["radial_hysteresis_n"], b["u_radial_hysteresis_n"]
    if b["preload_n"] is not None or (row[2] > 0 and row[4] == "x" and not abs(value - true) <= 3 * u < 0.1):
        bad.append((b["name"], "radial hysteresis", value, u, b["preload_n"]))
print(*bad, sep="\n")
sys.exit(bool(bad))
END
PYTHONPATH=. python3 check.py r.json || fail "gaps are not the truth"
# A bearing without a gap fails no limit of its clearance by a number that it does not have.
python3 make.py pressed.csv pressed
run 2 "not measured" pressed.csv --limit clearance_mm=:0.001 --text -
run 2 "" pressed.csv --html pressed.html
grep -q "no gap: the foils of both sides" pressed.html || fail "the page does not say no gap"

# A lot whose foils leave a rotor exactly these gaps: the difference is 0 within U at 5 N and at 20 N, and so is the response
# that goes to the loop.
mkdir -p lot
PYTHONPATH=. python3 - <<'END'
import json
from make import BEARINGS
json.dump({"schema": "foilgauge/lot/1", "bearings": [
    {"name": name, "number": i, "pads": ["a", "b", "c"], "angle_deg": list(range(0, 360, 10)), "u_clearance_mm": [0.0002] * 36,
     "clearance_mm": [row[2] / 2000] * 36} for i, (name, row) in enumerate(BEARINGS.items()) if row[2] > 50]}, open("lot/lot.json", "w"))
END
python3 make.py gaps.csv spring hertz bumps rig weights
for threshold in 5 20; do
  run 0 "" gaps.csv --lot lot --threshold $threshold -o at_$threshold.json --table-out at_$threshold.csv --csv rows.csv --html at.html
  python3 - at_$threshold.json at_$threshold.csv <<'END' || fail "a lot's own gaps differ from the lot at $threshold N"
import csv, json, sys
bad = []
azimuths = json.load(open(sys.argv[1]))["azimuths"]
for a, row in zip(azimuths, csv.DictReader(open(sys.argv[2])), strict=True):
    off = a["clearance_difference_mm"]
    if not (abs(off) <= 2 * a["u_clearance_difference_mm"] < 0.012 and abs(1000 * off - float(row["difference_um"])) < 1e-6):
        bad.append((a["bearing"], a["azimuth_deg"], off, a["u_clearance_difference_mm"], row["difference_um"]))
print(*bad, sep="\n")
sys.exit(bool(bad))
END
done
gaps='[(a["gap_mm"], a["u_gap_mm"]) for a in r["azimuths"]]'
python3 -c 'import sys
at = [eval(text) for text in sys.argv[1:]]
sys.exit(any(abs(a[0] - b[0]) > 0.1 * a[1] for a, b in zip(*at)))' "$(value at_5.json "$gaps")" "$(value at_20.json "$gaps")" ||
  fail "the gap depends on the threshold"
grep -q "difference<br>of gaps" at.html && head -1 rows.csv | grep -q "gap_mm,u_gap_mm" || fail "page or CSV has no gap"
valid load_test.schema.json r.json at_5.json
exit $failed
