#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Between proven and clean: a table with a weak effect of its laboratories is `suspected`, with exit code 3, p-values, and
# the rows that would decide; --expect makes it clearer. The number of a row is no order where the file is sorted.
. tests/support/cli.sh

# Six laboratories in blocks, standard deviation 1 between them and 1.2 within.
cat > labs.csv <<'END'
row,lab,y
1,L1,8.60
2,L1,9.53
3,L1,7.42
4,L1,9.64
5,L1,9.63
6,L2,11.72
7,L2,10.21
8,L2,10.44
9,L2,8.03
10,L2,12.53
11,L3,9.36
12,L3,12.99
13,L3,11.27
14,L3,10.61
15,L3,10.88
16,L4,9.85
17,L4,11.12
18,L4,10.53
19,L4,12.44
20,L4,8.46
21,L5,8.35
22,L5,7.29
23,L5,9.29
24,L5,5.82
25,L5,7.95
26,L6,10.25
27,L6,8.21
28,L6,11.18
29,L6,10.21
30,L6,11.20
END

expect 3 '' "$program" loop --table labs.csv --response y --model 1 -o labs.json --html labs.html
python3 - <<'END' || fail "the report of a suspicion"
import json
r = json.load(open("labs.json"))
assert r["verdict"] == "suspected" and not r["claims"], r["verdict"]
first = r["suspects"][0]
assert first["name"] == "table.factor(lab)", first
assert first["p_alone"] < first["p_value"] <= 0.1 and r["family_p_value"] == first["p_value"]
assert first["more_rows"] > 1 and "lab = " in first["decides"], first["decides"]
assert "Suspected, not proven" in r["summary"]
assert "row: the rows are sorted by lab" in r["not_candidates"], r["not_candidates"]
assert abs(sum(r["family_shares"].values()) - 1) < 1e-9
END
grep -q 'class="verdict suspected">suspected' labs.html || fail "the page's verdict"
"$program" loop --table labs.csv --response y --model 1 > shown 2>&1
grep -q 'Suspected, not proven' shown || fail "the terminal's words"

# Said before the data are seen, half of the error rate is the columns'.
"$program" loop --table labs.csv --response y --model 1 --expect columns -o expected.json
python3 - <<'END' || fail "an expected kind"
import json
r = json.load(open("expected.json"))
assert abs(r["family_shares"]["columns"] - 0.65) < 1e-9, r["family_shares"]
assert r["family_p_value"] < 0.8 * json.load(open("labs.json"))["family_p_value"]
END
expect 64 'columns, interactions, curves, order' "$program" loop --table labs.csv --response y --model 1 --expect luck

# A declared order stands.
code=0
"$program" loop --table labs.csv --response y --model 1 --order row -o ordered.json || code=$?
[ "$code" = 0 ] || [ "$code" = 3 ] || fail "exit code $code"
grep -q 'table.order_drift(row)' ordered.json || fail "a declared order is a candidate"
# Rows that were gathered, though not sorted, by a column say nothing of time either: neighbours are
# alike in it, and the response follows a bend of it that is not declared.
python3 - <<'END'
import random
random.seed(11)
x, rows = 0.0, []
for i in range(60):
    x = 0.9 * x + random.gauss(0, 1)
    rows.append((i + 1, x, 2 * x + 0.25 * x * x + random.gauss(0, 1)))
with open("gathered.csv", "w") as out:
    out.write("row,chemical,y\n")
    for row in rows:
        out.write("%d,%.6f,%.6f\n" % row)
random.shuffle(rows)
with open("shuffled.csv", "w") as out:
    out.write("row,chemical,y\n")
    for i, row in enumerate(rows):
        out.write("%d,%.6f,%.6f\n" % (i + 1, *row[1:]))
END
for name in gathered shuffled; do
  "$program" loop --table $name.csv --response y --model chemical -o $name.json || [ $? = 3 ] || fail "$name"
done
python3 - <<'END' || fail "rows gathered by a column"
import json
r = json.load(open("gathered.json"))
assert "neighbouring rows are alike in chemical" in r["not_candidates"], r["not_candidates"]
assert not any("(row)" in c["name"] for c in r["claims"] + r["suspects"] + r["rejected"])
r = json.load(open("shuffled.json"))
assert any("(row)" in c["name"] for c in r["rejected"]), "rows in a random order keep their number"
END
# A row far out among others is neither claimed nor cleared: its number is that of the file, whatever the order of the runs.
python3 - <<'P'
import random
rng = random.Random(2)
rows = [(i + 1, 500 + 100 * (i * 5 % 2), 20 + rng.gauss(0, 1) + (8 if i == 7 else 0)) for i in range(32)]
rng.shuffle(rows)
rows.sort(key=lambda row: row[0] == 8, reverse=True)
rows[0], rows[2] = rows[2], rows[0]
with open("far.csv", "w") as out:
    out.write("run,T,y\n" + "".join(f"{run},{T},{y:.4f}\n" for run, T, y in rows))
P
expect 0 '' "$program" loop --table far.csv --response y --model T -o far.json --html far.html
python3 - <<'END' || fail "the row of the file"
import json
r = json.load(open("far.json"))
assert r["verdict"] == "clean" and not r["claims"], (r["verdict"], r["claims"])
assert any(n.startswith("Row 3 lies ") for n in r["notes"]), r["notes"]
assert "but row 3 lies farther out than normal noise reaches: a wrong value, or a scatter" in r["summary"], r["summary"]
assert "table.outlier(3)" in [one["name"] for one in r["rejected"]], [one["name"] for one in r["rejected"]]
assert r["next_steps"][0].startswith("Look up row 3 in the records: it lies farther out"), r["next_steps"]
END

exit $failed
