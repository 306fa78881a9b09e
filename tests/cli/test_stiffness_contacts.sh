#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge stiffness`: contacts of records with unsampled stretches. A rotor under load control jumps through the gap; a
# dropout hides a contact; the clearance is right within U, or withheld with its reason, and no limit passes for it.
. tests/support/cli.sh
listened="stdout stderr"

# records.py NAME: load or displacement control of a known bearing; gap 160 um, 500 N/mm and 5e4 N/mm^3 behind it, friction of
# 0.3 N + 0.06 |F| that turns round over 6 um, noise of 0.05 N and 0.2 um.
cat >records.py <<'END'
import bisect, json, math, random, sys

AMPLITUDE, GAP, THRESHOLD = 0.19, 0.16, 5.0


def force(x, sense):
    d = max(0.0, abs(x) - GAP / 2)
    f = math.copysign(500 * d + 5e4 * d**3, x)
    return f + sense * (0.3 + 0.06 * abs(f)) * (1 - 2 * math.exp(-(AMPLITUDE + sense * x) / 0.006))


grid = [AMPLITUDE * (i / 10000 - 1) for i in range(20001)]
branch = {}
for sense in (1, -1):
    highest, branch[sense] = -1e9, []
    for x in grid:
        highest = max(highest + 1e-9, force(x, sense))
        branch[sense].append(highest)


def place(f, sense):
    return grid[min(bisect.bisect_left(branch[sense], f), len(grid) - 1)]


def load_control(samples, cycles, within):
    """Equal steps of force; of what lies in the gap, `within` samples a crossing."""
    top, each = branch[1][-1], samples // (2 * cycles)
    for _ in range(cycles):
        for sense in (1, -1):
            fs = [sense * top * (2 * i / each - 1) for i in range(each)]
            xs = [(place(f, sense), f) for f in fs]
            jump = next(i for i in range(1, each) if sense * xs[i][0] > 0)
            for i, (x, f) in enumerate(xs):
                if i == jump:
                    for k in range(within):
                        y = sense * (2 * (k + 1) / (within + 1) - 1) * 0.07
                        yield y, force(y, sense)
                yield x, f


def displacement_control(samples, cycles, low, high):
    for i in range(samples):
        phase = 2 * math.pi * cycles * i / samples
        x = AMPLITUDE * math.sin(phase)
        if not low < x < high:
            yield x, force(x, 1 if math.cos(phase) >= 0 else -1)


def slipped(samples, cycles, low, high):
    """A probe that slips back by 4 um whenever the rotor turns: unloading lies inside of loading, though the loops lose energy."""
    before = 0
    for x, f in displacement_control(samples, cycles, low, high):
        yield (x, f) if x >= before else (x - 0.004, f)
        before = x


kind, *numbers = sys.argv[1:]
maker = {"load": load_control, "displacement": displacement_control, "slipped": slipped}[kind]
random.seed(7)
print("displacement_mm,force_N")
for x, f in maker(1800, 3, *(int(n) if kind == "load" else float(n) for n in numbers)):
    print(f"{x + random.gauss(0, 0.0002):.6f},{f + random.gauss(0, 0.05):.4f}")
json.dump({"clearance_mm": 2 * place(THRESHOLD, 1)}, open("truth.json", "w"))
END

# judged CODE FLAG LIMIT, record on standard input: exit code, a flag or none, and a clearance within U of the truth or none.
judged() { # NAME CODE FLAG [OPTION...]
  local name=$1 code=$2 flag=$3
  expect "$code" "" "$program" stiffness --azimuth 0 "$name.csv" -o "$name.json" "${@:4}"
  checks - "$name.json" "$flag" <<'END' || fail "$name: the clearance is not the truth"
import json, sys
a, truth = json.load(open(sys.argv[1]))["azimuths"][0], json.load(open("truth.json"))["clearance_mm"]
flags = {"unsampled", "same_side", "branches_apart"} & set(a["flags"])
print(a["clearance_mm"], a["u_clearance_mm"], truth, a["flags"])
right = a["clearance_mm"] is None or abs(a["clearance_mm"] - truth) <= 2 * a["u_clearance_mm"]
withheld = sys.argv[2] == "withheld"
assert right and withheld == (a["clearance_mm"] is None)
assert flags == ({"unsampled"} if withheld or sys.argv[2] == "unsampled" else set()), flags
END
}
record() { python3 records.py "${@:2}" >"$1.csv"; }

# Load control: 0, 1, 3 and 10 samples a crossing in the gap. Nothing is withheld, and U is no larger for it.
for within in 0 1 3 10; do
  record "load$within" load "$within" && judged "load$within" 0 ""
  [ "$(value "load$within.json" '[a["u_repeat_clearance_mm"] < 0.0005 for a in r["azimuths"]]')" = "[True]" ] || fail "load$within: U"
done
# One reading, or two together, that jumps away and back, anywhere in the record: told, and no value moves by it.
record clean displacement 9 9
"$program" stiffness --azimuth 0 clean.csv -o clean.json
for wrong in "150 2 -60" "700 2 -45" "901 2 100" "333 1 0.3" "1200 1 -0.3" "600 1 1000"; do
  for run in 1 2; do
    awk -F, -v OFS=, -v wrong="$wrong" -v run=$run 'BEGIN {split(wrong, w, " ")} NR - 1 >= w[1] && NR - 1 < w[1] + run {$(w[2]) = w[3]} 1' \
      clean.csv >jumped.csv
    judged jumped 0 ""
    checks - <<'END' || fail "$wrong, $run times: another result"
import json
a, b = (json.load(open(name))["azimuths"][0] for name in ("jumped.json", "clean.json"))
assert "outliers" in a["flags"] and "outliers" not in b["flags"], a["flags"]
for name in ("clearance_mm", "stiffness_n_mm", "stiffness_secant_n_mm", "loss_factor", "loss_factor_secant", "loss_factor_foil"):
    assert abs(a[name] - b[name]) <= a["u_" + name] / 2, (name, a[name], b[name], a["u_" + name])
END
  done
done
expect 0 "jump away from their neighbours" "$program" stiffness --azimuth 0 jumped.csv --text -
# Dropouts: beside the contact; over it; over all of the gap.
record clean displacement 9 9 && judged clean 0 ""
record gap displacement -0.06 0.06 && judged gap 0 ""
record beside displacement 0.095 0.130 && judged beside 0 ""
record contact displacement 0.070 0.100 && judged contact 1 unsampled --limit clearance_mm=:0.05
expect 0 "a stretch that the record did not sample: U holds the stretch" "$program" stiffness --azimuth 0 contact.csv --text -
record all displacement -0.12 0.12 && judged all 2 withheld
judged all 3 withheld --limit clearance_mm=:0.05
judged all 3 withheld --limit clearance_mm=:5
expect 3 "cannot tell.*with a limit within U or withheld" "$program" stiffness --azimuth 0 all.csv --limit clearance_mm=:5 --text -
"$program" stiffness --azimuth 0 all.csv --html all.html >/dev/null 2>&1
grep -q "that leaves nothing known there is no clearance" all.html || fail "the page has no reason"
# A probe that runs out of its range behind one contact: little of that branch is left, which does not mean no gap.
record range displacement 0.115 9 && judged range 0 ""
[ "$(value range.json '["no_gap" in a["flags"] for a in r["azimuths"]]')" = "[False]" ] || fail "a gap is taken for none"
# Contacts that contradict each other.
record slipped slipped 9 9
expect 2 "loading and unloading pass the threshold further apart" "$program" stiffness --azimuth 0 slipped.csv --text -
expect 3 "" "$program" stiffness --azimuth 0 slipped.csv --limit clearance_mm=0.1:0.3 -o slipped.json
[ "$(value slipped.json '[(a["clearance_mm"], "branches_apart" in a["flags"], "energy_gained" in a["flags"]) for a in r["azimuths"]]')" = \
  "[(None, True, False)]" ] || fail "branches apart"

exit $failed
