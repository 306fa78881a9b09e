#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge doe` tests its residuals over the order of the runs, reports patterns, and advises how to find their cause.
. tests/support/cli.sh
listened="stdout stderr"

# table NAME DRIFT SLIP: 24 runs of y = T / 100 + noise of 0.05, a drift over the runs, a slip in run 9; the name is one that
# a shell would split.
table() {
  awk -v drift="$2" -v slip="$3" 'BEGIN { srand(7); print "run,T,y"
    for (i = 1; i <= 24; i++) { T = 500 + 50 * int(3 * rand())
      e = (rand() + rand() + rand() + rand() - 2) * 0.0866
      printf "%d,%d,%.4f\n", i, T, T / 100 + e + drift * i / 24 + slip * (i == 9) } }' >"$1"
}
table clean.csv 0 0
table "it's a drift.csv" 0.5 0
table slip.csv 0 0.5
awk -F, -v OFS=, 'NR == 1 { print "T,y"; next } { print $2, $3 }' "it's a drift.csv" >unnamed.csv
sort -t, -k3 -g "it's a drift.csv" >shuffled.csv
for name in clean "it's a drift" slip unnamed shuffled; do
  expect 0 '' "$program" doe "$name.csv" --response y --model T -o "$name.json"
  valid doe.schema.json "$name.json"
done
checks - <<'P' || fail "what is seen over the order"
import json
clean, drift, slip, unnamed, shuffled = (
    json.load(open(name + ".json")) for name in ("clean", "it's a drift", "slip", "unnamed", "shuffled"))
words = {id(r): " ".join(r["conclusions"]) for r in (clean, drift, slip)}
assert clean["order"]["column"] == "run" and clean["order"]["command"] is None, clean["order"]
assert not any(clean["order"][test]["shows"] for test in ("drift", "neighbours", "farthest")), clean["order"]
assert "Over the order of the runs (run) the residuals show no drift" in words[id(clean)], words
seen = drift["order"]["drift"]
assert seen["shows"] and abs(seen["change"] - 0.5 * 23 / 24) < 3 * seen["u_change"] < 0.2, seen
assert "The response drifts over the order of the runs" in words[id(drift)], words
assert drift["order"]["command"] in drift["conclusions"], drift["conclusions"]
# Without a run column the rows are the order; rows in another order change nothing where there is one.
assert unnamed["order"]["column"] is None and unnamed["order"]["drift"] == drift["order"]["drift"]
assert shuffled["order"]["column"] == "run"
for test in ("drift", "neighbours"):
    for name, value in drift["order"][test].items():
        if name != "p_value" or test == "drift":
            assert abs(shuffled["order"][test][name] - value) < 1e-7, (test, name)
assert slip["order"]["farthest"]["shows"] and slip["order"]["farthest"]["row"] == 9, slip["order"]
assert "Row 9 (run 9) stands out" in words[id(slip)], words
open("command", "w").write(drift["order"]["command"])
P
# The command that is named can be typed as it is.
command=$(sed "s#^foilgauge#'$program'#" command)
expect 0 '' bash -c "$command -o loop.json"
grep -q "\"path\": \"it's a drift.csv\"" loop.json || fail "the command is about another table"
grep -q '"model": "1 + T"' loop.json || fail "the command is about another model"

# On a terminal the command stands on a line of its own; the page has it as code.
if command -v script >/dev/null; then
  script -qec "'$program' doe unnamed.csv --response y --model T" typed >/dev/null
  grep -q "^    foilgauge loop --table unnamed.csv --response y --model '1 + T'" typed || fail "the command on the terminal"
fi
expect 0 '' "$program" doe unnamed.csv --response y --model T --html unnamed.html -o unnamed.json
grep -q '<code>foilgauge loop --table unnamed.csv' unnamed.html || fail "the command on the page"

# A test that is impossible is null: no degree of freedom, whole plots, a model that fits exactly.
printf 'A,B,y\n-1,-1,1\n1,-1,3\n-1,1,2\n1,1,5\n' >four.csv
expect 0 '"order": null' "$program" doe four.csv --response y --model 'A*B' -o -
awk -F, -v OFS=, '{ print $0, NR == 1 ? "load" : int((NR - 2) / 4) }' clean.csv >loads.csv
expect 0 '"order": null' "$program" doe loads.csv --response y --model T --whole-plot load -o -
awk -F, -v OFS=, 'NR > 1 { $3 = $2 / 100 } { print }' clean.csv >exact.csv
expect 0 '"order": null' "$program" doe exact.csv --response y --model T -o -

# The half-normal plot: its line goes through the small effects, wherever the large ones lie.
python3 - <<'P'
import itertools, random
random.seed(2)
with open("factorial.csv", "w") as out:
    print("A,B,C,D,y", file=out)
    for a, b, c, d in itertools.product((-1, 1), repeat=4):
        print(a, b, c, d, 10 + 4 * a - 3 * b + 2 * a * b + 1.8 * c + 0.3 * random.gauss(0, 1), sep=",", file=out)
P
expect 0 '' "$program" doe factorial.csv --response y --model 'A*B*C*D' --html factorial.html -o factorial.json
checks - <<'P' || fail "the half-normal line"
import re
page = open("factorial.html").read()
plot = page[page.index("Half-normal plot"):]
plot = plot[:plot.index("</figure>")]
line = [float(v) for v in re.search(r'class="hint" d="M([-\d.]+) ([-\d.]+)L([-\d.]+) ([-\d.]+)"', plot).groups()]
dots = [[float(v) for v in m] for m in re.findall(r'<circle class="s2" cx="([^"]*)" cy="([^"]*)"', plot)]
large = [[float(v) for v in m] for m in re.findall(r'<circle class="s1" cx="([^"]*)" cy="([^"]*)"', plot)]
slope = (line[2] - line[0]) / (line[1] - line[3])
off = lambda dot: dot[0] - line[0] - slope * (line[1] - dot[1])
assert len(dots) >= 9 and abs(sum(map(off, dots)) / len(dots)) < 3, (line, dots)  # px of some 300
assert max(abs(off(dot)) for dot in dots) < 10, (line, dots)
assert sorted(map(off, large))[-4] > 60, (line, large)
P
grep -q 'The dashed line belongs to the [0-9]* small effects' factorial.html || fail "what the line belongs to"

# Memory that ends anywhere on the way is said (exit code 71), and leaves no report.
shim=$(dirname "$program")/tests/libfailing_malloc.so
if [ -e "$shim" ] && [ -z "${FOILGAUGE_TEST_BRIEF:-}" ]; then
  failing() {
    rm -f out.json
    LD_PRELOAD=$shim FOILGAUGE_FAIL_AT=$1 "$program" doe slip.csv --response y --model T -o out.json 2>said
  }
  failing 0
  total=$(sed -n 's/^allocations: //p' said)
  for ((at = 10; at <= total; at += total / 60 + 1)); do
    code=0
    failing "$at" || code=$?
    [ $code = 0 ] || [ $code = 71 ] || fail "allocation $at of $total: exit code $code: $(head -c 200 said)"
    [ $code = 0 ] || [ ! -e out.json ] || fail "allocation $at of $total leaves a report behind"
  done
fi

exit $failed
