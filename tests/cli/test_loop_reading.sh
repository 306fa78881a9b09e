#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A finding of `foilgauge loop --table` is stated as a difference that its reader can check, with U in the unit of the
# response; a p-value between proven and common is neither proof nor all clear.
. tests/support/cli.sh
skip_when_slow # test_loop_table.sh sees the same search and reports

# One effect in each table, of a size that is known: response in um, scatter 0.15.
cat >made.py <<'P'
import math, random
rng = random.Random()
n = 60
def write(name, head, row, noise=0.15):
    rng.seed(name)
    with open(name + ".csv", "w") as out:
        out.write(head + "\n")
        for i in range(n):
            *causes, y = row(i, rng.uniform(0, 1))
            out.write(",".join(f"{c:.4f}" if isinstance(c, float) else str(c) for c in causes) + f",{y + rng.gauss(0, noise):.4f}\n")
write("factor", "run,x,operator,gap_um", lambda i, x: (i, x, o := rng.choice("AB"), 3 + 2 * x + 0.5 * (o == "B")))
write("levels", "run,x,die,gap_um", lambda i, x: (i, x, d := "KLMN"[i * 7 % 4], 3 + 2 * x + {"K": 0, "L": 0.2, "M": 0.8, "N": -0.4}[d]))
write("drift", "run,x,gap_um", lambda i, x: (i, x, 3 + 2 * x + 0.7 * i / (n - 1)))
write("fall", "run,x,gap_pct", lambda i, x: (i, x, 3 + 2 * x - 0.7 * i / (n - 1)))
write("trend", "run,x,humidity_pct,gap_um", lambda i, x: (i, x, h := (30.0, 60.0)[i] if i < 2 else rng.uniform(30, 60), 3 + 2 * x - 0.9 * (h - 30) / 30))
write("step", "run,x,gap_um", lambda i, x: (i, x, 3 + 2 * x + 0.8 * (i >= 35)))
write("cycle", "run,x,gap_um", lambda i, x: (i, x, 3 + 2 * x + 0.4 * math.sin(2 * math.pi * i / 9)))
write("bend", "run,x,t_C,gap_um", lambda i, x: (i, x, t := (400.0, 700.0)[i] if i < 2 else rng.uniform(400, 700), 3 + 2 * x + 1.5 * ((t - 500) / 150) ** 2))
write("heats", "run,x,t_C,gap_um", lambda i, x: (i, x, t := (500.0, 550.0, 600.0, 650.0)[i * 7 % 4], 3 + 2 * x + 0.6 * (t in (550, 650))))
write("arch", "run,x,t_C,gap_um", lambda i, x: (i, x, t := (400.0, 700.0)[i] if i < 2 else rng.uniform(400, 700), 3 + 2 * x + 0.01 * (t - 550) - 0.6 * ((t - 550) / 150) ** 2))
write("product", "run,t_C,d_h,gap_um", lambda i, x: (i, t := (500.0, 600.0)[i] if i < 2 else rng.uniform(500, 600), d := (3.0, 5.0)[i] if i < 2 else rng.uniform(3, 5), 3 + (t - 550) / 50 - 0.5 * (d - 4) + 0.4 * (t - 550) / 50 * (d - 4)))
write("slopes", "run,t_C,die,gap_um", lambda i, x: (i, t := (500.0, 600.0)[i] if i < 2 else rng.uniform(500, 600), d := "KL"[i * 3 % 2], 3 + (t - 550) / 50 * (1.6 if d == "L" else 1)))
write("cells", "run,operator,die,gap_um", lambda i, x: (i, o := "AB"[i % 2], d := "KL"[i // 2 % 2], 3 + 0.5 * (o == "B") + 0.4 * (d == "L") + 0.6 * (o == "B" and d == "L")))
write("outlier", "run,x,gap_um", lambda i, x: (i, x, 3 + 2 * x - 1.5 * (i == 22)))
rng.seed(1)
rows = [(i, x, 3 + 4 * x) for i in range(n) for x in [rng.uniform(0, 1)]]
rows[10], rows[41] = (10, 0.1, 3 + 4 * 0.9), (41, 0.9, 3 + 4 * 0.1)
write("exchange", "run,x,gap_um", lambda i, x: rows[i], 0.1)
P
python3 made.py

# terminal NAME COMMAND...: what a terminal shows, into NAME.txt
terminal() {
  local name=$1
  shift
  script -qec "$(printf '%q ' "$@")" /dev/null </dev/null | tr -d '\r' >"$name.txt"
}

# reads NAME MODEL WORDS NUMBER [RESPONSE]: the sentence in JSON, terminal, page and model file holds WORDS with #, a
# number with its U, in place of # and the number is NUMBER within 1.5 U, which is not all of it.
reads() {
  local name=$1 response=${5:-gap_um}
  expect 0 '' "$program" loop --table "$name.csv" --response "$response" --model "$2" -o "$name.json" --html "$name.html" \
    --model-out "$name.model.json"
  terminal "$name" "$program" loop --table "$name.csv" --response "$response" --model "$2"
  valid loop.schema.json "$name.json"
  checks - "$@" <<'P' || fail "$name: not '$3' with $4"
import html, json, re, sys
name, _, words, expected = sys.argv[1:5]
report = json.load(open(name + ".json"))
text = " ".join(open(name + ".txt").read().split())
page = " ".join(html.unescape(re.sub("<[^>]+>", " ", open(name + ".html").read())).split())
pattern = re.escape(words).replace(r"\#", r"([0-9.]+) ± ([0-9.]+)")
claims = [c for c in report["claims"] if re.search(pattern, c["sentence"])]
assert claims, [c["sentence"] for c in report["claims"]] or report["summary"]
value, U = map(float, re.search(pattern, claims[0]["sentence"]).groups())
assert abs(value - float(expected)) < 1.5 * U < 0.8 * float(expected), (value, U)
for where, said in (("summary", report["summary"]), ("terminal", text), ("page", page)):
    assert re.search(pattern, said, re.IGNORECASE), (where, said)
    assert "amplitude" not in said.lower(), where
assert any(re.search(pattern, c["sentence"]) for c in json.load(open(name + ".model.json"))["claims"])
P
}
reads factor x 'operator B reads # µm higher than operator A' 0.5
reads levels x 'die M reads # µm higher than die N, the lowest of 4' 1.2
reads drift x 'it rises by # µm from the first run to the last' 0.7
reads fall x 'it falls by # % from the first run to the last' 0.7 gap_pct
reads trend x 'it falls by # µm from humidity 30 % to 60 %' 0.9
reads step x 'beyond it the response is # µm higher' 0.8
reads cycle x 'it swings by # µm from peak to valley' 0.8
reads bend x '°C, and # µm higher at t 700 °C' 2.6667
# Beside the declared slope the response itself may rise where the effect falls. All that a slope explains of the levels is the slope.
reads heats 'x + t_C' "beside the model's own terms in t, t 550 °C reads # µm higher than t 600 °C, the lowest of 4" 0.72
checks - <<'P' || fail "the slope beside the levels"
import json
slope, = [p for p in json.load(open("heats.json"))["declared_parameters"] if p["name"] == "t_C"]
assert abs(slope["value"] - 0.12 / 50) < 4 * slope["u_value"] < 0.002, slope
P
reads arch 'x + t_C' "°C, and # µm lower at t 700 °C" 0.6
grep -q "a bent trend with t_C: beside the model's own terms in t, it is highest near" arch.json || fail "a bend beside a slope"
reads product 't_C + d_h' 'the change from t 500 °C to 600 °C is # µm higher at d 5 h than at d 3 h' 1.6
reads slopes 't_C + die' 'the change from t 500 °C to 600 °C is # µm higher for die L than for die K' 1.2
reads cells 'operator + die' 'operator B over operator A is # µm higher for die L than for die K' 0.6
reads outlier x 'row 23 is wrong: it lies # µm below what the others say' 1.5
reads exchange x 'rows 11 and 42 changed places: their responses are # µm apart' 3.2

# Between proven (p < 0.01) and what noise does in one table of ten: neither "noise" nor "yes".
cat >suspected.py <<'P'
import random, sys
rng = random.Random(int(sys.argv[1]))
print("run,x,z,y")
for i in range(30):
    x, z = rng.uniform(0, 1), rng.uniform(0, 1)
    print(f"{i + 1},{x:.4f},{z:.4f},{3 + 2 * x + float(sys.argv[2]) * z + rng.gauss(0, 0.3):.4f}")
P
found=
for seed in $(seq 1 40); do
  python3 suspected.py "$seed" 0.45 >s.csv
  "$program" loop --table s.csv --response y --model x -o s.json --html s.html || [ $? = 3 ] || fail "exit $?"
  [ "$(value s.json '0.012 < r["family_p_value"] < 0.09 and r["verdict"] == "suspected"')" = True ] && found=$seed && break
done
[ -n "$found" ] || fail "no table is suspected"
terminal s "$program" loop --table s.csv --response y --model x
grep -q 'Suspected, not proven' s.txt || fail "nothing is suspected at $(value s.json 'r["family_p_value"]')"
grep -q 'is noise as far' s.txt s.html s.json && fail "p = $(value s.json 'r["family_p_value"]') is called noise"
grep -q 'Something is suspected, nothing is proven' s.html || fail "the page says that all is well"
grep -q 'class="verdict clean"' s.html && fail "the page is green"
checks - <<'P' || fail "a test of what is left says yes to a small p"
import json, re
text = open("s.txt").read()
for check in json.load(open("s.json"))["battery"]:
    line = " ".join(next(l for l in text.splitlines() if check["asks"] in l).split())
    says = "not sure" if check["passed"] and check["p_value"] <= 0.1 else "yes" if check["passed"] else "NO"
    assert line.startswith(says), line
P

# Runs five apart that are a little alike: a p of a few per cent is "not sure".
cat >apart.py <<'P'
import random, sys
rng = random.Random(int(sys.argv[1]))
print("run,x,y")
e = [rng.gauss(0, 1) for _ in range(80)]
for i in range(80):
    x = rng.uniform(0, 1)
    print(f"{i + 1},{x:.4f},{3 + 2 * x + e[i] + 0.45 * e[i - 5]:.4f}")
P
found=
for seed in $(seq 1 40); do
  python3 apart.py "$seed" >a.csv
  "$program" loop --table a.csv --response y --model x -o a.json --html a.html || [ $? = 3 ] || fail "exit $?"
  [ "$(value a.json 'any(c["passed"] and 0.0004 < c["p_value"] < 0.09 for c in r["battery"])')" = True ] && found=$seed && break
done
[ -n "$found" ] || fail "no test is undecided"
terminal a "$program" loop --table a.csv --response y --model x
grep -q '^  not sure ' a.txt || fail "the terminal answers yes"
grep -q '>not sure<' a.html || fail "the page answers yes"

exit $failed
