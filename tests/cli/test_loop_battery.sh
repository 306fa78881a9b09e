#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Basis of `clean`: a table that shows no named effect, but is not noise either, is not called clean.
. tests/support/cli.sh

python3 - <<'PYTHON'
import itertools, random
def write(name, header, rows):
    with open(name + ".csv", "w") as file:
        file.write(header + "\n" + "".join(",".join(f"{v:.6g}" for v in row) + "\n" for row in rows))
def seasons(n, share, seed=5, years=20):
    """Each month leans on the same month a year before, and on no other."""
    random.seed(seed)
    e = [random.gauss(0, 1) for _ in range(12 * years + n)]
    for i in range(12, len(e)):
        e[i] += share * e[i - 12]
    return [(i + 1, 10 + v) for i, v in enumerate(e[-n:])]
def cube(size, copies=False):
    """Two levels of three columns, thrice; what the model lacks has no name: an interaction of all three."""
    random.seed(7)
    points = [p for _ in range(3) for p in itertools.product((-1, 1), repeat=3)]
    once = {p: random.gauss(0, 0.4) for p in points}
    random.shuffle(points)
    noise = lambda p: once[p] if copies else random.gauss(0, 0.4)
    return [(i + 1, *p, 50 + 3 * p[0] + 2 * p[1] + size * p[0] * p[1] * p[2] + noise(p)) for i, p in enumerate(points)]
write("season", "month,y", seasons(144, 0.55))
write("seasons", "month,y", seasons(612, 0.4, 6))
write("months", "month,y", seasons(144, 0))
write("cube", "run,A,B,C,y", cube(1.5))
write("flat", "run,A,B,C,y", cube(0))
write("copies", "run,A,B,C,y", cube(0, True))
PYTHON

look() { # look NAME MODEL
  local code=0
  "$program" loop --table "$1.csv" --response y --model "$2" -o "$1.json" --html "$1.html" || code=$?
  [ $code = 0 ] || [ $code = 3 ] || fail "$1: exit code $code"
}
look season 1
look seasons 1
look months 1
look cube A+B+C
look flat A+B+C
look copies A+B+C
checks - <<'PYTHON' || fail "clean is said of what is no noise, or not of what is"
import json
def report(name):
    r = json.load(open(name + ".json"))
    return r, {b["test"]: b for b in r["battery"]}
def unattributed(name, test):
    r, battery = report(name)
    left, page = r["unattributed"], open(name + ".html").read()
    assert r["verdict"] == "unattributed" and not r["claims"] and left["kind"] == test, (name, r["summary"])
    assert not battery[test]["passed"] and battery[test]["p_value"] < battery[test]["level"] < 0.001, (name, battery)
    assert left["p_value"] == battery[test]["p_value"] and left["rms"] > 0 and r["next_steps"], (name, left)
    assert "in which nothing shows" not in page and ">no<" in page and "nan" not in page.replace("nano", ""), name
    return r, battery[test], left
for name in ("season", "seasons"):
    r, test, left = unattributed(name, "correlation_at_one_lag")
    assert test["lag"] == 12 and test["correlation"] > 0.3 and left["coordinate"] == "month", (name, test)
    assert "12 apart along month are alike" in r["summary"], r["summary"]
r, test, left = unattributed("cube", "lack_of_fit")
assert test["degrees_of_freedom"] == [4, 16] and test["statistic"] > 50 and left["coordinate"] == "A, B, C", test
assert 1.2 < left["rms"] < 1.8, left  # 1.5, as it was made
r, battery = report("months")
assert r["verdict"] == "clean" and len(battery) == 2 and all(b["passed"] for b in battery.values()), battery
assert "rows further apart that are alike" in r["summary"], r["summary"]
r, battery = report("flat")
assert r["verdict"] == "clean" and battery["lack_of_fit"]["passed"], battery
assert "lack of fit where settings repeat" in r["summary"], r["summary"]
assert "lack_of_fit" not in report("copies")[1]  # repeats that were copied have no scatter to compare with
PYTHON

valid loop.schema.json season.json cube.json months.json flat.json
exit "$failed"
