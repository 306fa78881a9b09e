#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tables as they come from elsewhere: moments out of order, gaps in a column, a skewed response, tiny numbers, a table
# that is named without its option.
. tests/support/cli.sh

cat >made.py <<'P'
import datetime, math, random
rng = random.Random()
def write(name, head, rows):
    with open(name + ".csv", "w") as out:
        out.write(head + "\n")
        out.writelines(",".join(map(str, row)) + "\n" for row in rows)
start = datetime.datetime(2026, 3, 1, 8)
rng.seed(5)
hours = sorted(rng.uniform(0, 120) for i in range(40))
stamp = [(start + datetime.timedelta(hours=h)).strftime("%Y-%m-%d %H:%M:%S") for h in hours]
drift = [(stamp[i], rng.uniform(1, 5), 10 + 2.5 * hours[i] / 120 + rng.gauss(0, 0.5)) for i in range(40)]
daily = [(stamp[i], rng.uniform(1, 5), 10 + 1.2 * math.sin(2 * math.pi * hours[i] / 24) + rng.gauss(0, 0.5)) for i in range(40)]
gaps = [(i, "" if i % 7 == 3 else p, "" if i % 5 else "bent", 10 + 0.6 * p + rng.gauss(0, 0.4)) for i in range(1, 41) for p in [rng.uniform(1, 5)]]
skewed = [(rng.uniform(1, 5), math.exp(rng.gauss(0, 1))) for i in range(40)]
wrong = [(x, 10 + rng.gauss(0, 1) + (25 if i == 17 else 0)) for i, (x, y) in enumerate(skewed)]
rng.shuffle(drift)
rng.shuffle(daily)
write("drift", "time,bar,y", drift)
write("daily", "time,bar,y", daily)
write("drift_run", "run,time,y", [(i + 1, t, y) for i, (t, bar, y) in enumerate(drift)])
rng.seed(5)
days = sorted(rng.sample(range(1, 100), 20)) # fewer than 24 rows, out of order
march = [(start + datetime.timedelta(days=d), 10 + 0.03 * d + rng.gauss(0, 0.3)) for d in days]
rng.shuffle(march)
write("few", "date,y", [(d.strftime("%Y-%m-%d"), y) for d, y in march])
write("us", "date,y", [(d.strftime("%m/%d/%Y"), y) for d, y in march])
write("both", "date,y", [(a, y) for a, (d, y) in zip(["03/04/2026", "05/04/2026", "04/07/2026", "06/05/2026", "01/02/2026", "11/12/2026"], march)])
write("mil", "strip_um,y", [((98.5 + i % 7 / 2) / (25.4 if i == 7 else 1), 10 + rng.gauss(0, 0.3)) for i in range(30)])
write("twice", "run,y", [row for i in range(20) for row in [(i, rng.gauss(0, 1))] * (1 + (i % 9 == 4))])
write("gaps", "run,bar,remark,y", gaps)
write("tiny", "bar,y", [(p, 1e-9 * y) for r, p, m, y in gaps if p])
write("skewed", "bar,y", skewed)
write("wrong", "bar,y", wrong)
rng.seed(905) # two humps over the rows
spare = [rng.uniform(15, 45), rng.uniform(5, 55)]
humps = [(rng.uniform(1, 5), 10 + 2 * sum(s * math.exp(-(i - c) ** 2 / 98) for s, c in zip((1, -1), spare)) + rng.gauss(0, 0.5)) for i in range(60)]
write("humps", "bar,y", humps)
P
python3 made.py

# finds NAME EXPRESSION OPTION...: `loop` of NAME.csv with --model 1; EXPRESSION holds for its report j.
finds() {
  local name=$1 holds=$2
  shift 2
  "$program" loop "$name.csv" --response y --model 1 -o report.json "$@" || [ $? -eq 3 ] || fail "$name $*: exit $?"
  python3 - "$holds" <<'P' || fail "$name $*: not $holds"
import json, sys
j = json.load(open("report.json"))
names = [claim["name"] for claim in j["claims"]]
said = " ".join(j["notes"]) + " " + str(j["not_candidates"])
if not eval(sys.argv[1]):
    print(j["verdict"], names, said, [claim["sentence"] for claim in j["claims"]])
    sys.exit(1)
P
}

# The moments are the order, though the rows are shuffled; a column of runs comes first, and stays the order.
finds drift 'names == ["table.order_drift(time)"] and "time counts days since 2026-03-01" in said'
"$program" loop --table drift.csv --response y --model '1 + bar' --model-out model.json -o /dev/null || fail "no model"
"$program" doe drift.csv --response y --model model.json -o doe.json || fail "doe does not read the loop's moments"
grep -q '"id": "table.order_drift"' doe.json || fail "doe took no drift out"
finds daily 'names == ["table.periodic(time)"] and abs(j["claims"][0]["parameters"]["period"] - 1) < 0.05'
# Few moments are an order, too, and so are those with the month first where a row tells.
finds few 'names == ["table.order_drift(date)"] and "date counts days since 2026-03-" in said'
finds us 'names == ["table.order_drift(date)"] and "read with the month first" in said'
# The summary's errors have the response's unit.
sed 's/y$/y_um/' few.csv >few_um.csv
"$program" loop few_um.csv --response y_um --model 1 -o report.json || fail "few_um: exit $?"
grep -Eq '"summary": .*The error falls from [0-9.]+ to [0-9.]+ µm;' report.json || fail "the summary's errors have no unit"
expect 65 'date is not counted as time: dates such as 03/04/2026 may have the day or the month first' \
  "$program" loop both.csv --response y --model 1 --order date
# Oddities that no model sees are told.
finds mil '"strip_um is 3.87795 in row 8, and 98.5 to 101.5 in all others" in said'
finds twice '"rows 5 and 6, 15 and 16 are alike in every cell: take copies out" in said'
finds drift_run 'names == ["table.linear(time)"]'
# A column with gaps is no candidate unless their rows are left out; a comment in a few rows costs none. Rows keep the
# numbers of the file.
finds gaps 'names == [] and "bar: cells are missing in 6 of 40 rows (--complete" in said and "32 of 40 rows;" not in said'
finds gaps 'names == ["table.linear(bar)"] and "left out: 6 of 40 rows" in said and "remark: cells are missing in 27 of 34 rows" in said' --complete
expect 64 'complete belongs to --table' "$program" loop --lot . --complete
# Digits of a response far below 1.
finds tiny 're.search(r"rises by [0-9.]+e-09 ± [0-9.]+e-10 from", j["claims"][0]["sentence"]) if (re := __import__("re")) else 0'
# The largest values of a skewed response are right on its own scale; a wrong one is wrong on every scale.
finds skewed 'all(claim["verdict"] == "tied" for claim in j["claims"]) and j["response_scale"]["chosen_power"] == 0'
finds wrong 'names == ["table.outlier(18)"] and j["claims"][0]["verdict"] == "found"'
# A curve over the rows leaves no correlation of neighbours beside it, however that looked before.
finds humps 'j["unattributed"]["coordinate"] == "row" and names == []'
# A table without its option.
expect 64 'which column was measured' "$program" loop drift.csv

exit $failed
