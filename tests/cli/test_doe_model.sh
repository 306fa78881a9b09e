#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge doe --model FILE.json`: what the loop found is taken out before the analysis.
. tests/support/cli.sh

# y = 3 + T/100 + humidity/10, and noise of sd 0.05; z is another response.
awk 'BEGIN { srand(5); print "run,T,humidity,y,z"
  for (i = 1; i <= 32; i++) { T = 500 + 50 * (i % 3); h = 15 + 45 * rand()
    e = (rand() + rand() + rand() + rand() - 2) * 0.0866
    printf "%d,%d,%.3f,%.4f,%.4f\n", i, T, h, 3 + T / 100 + h / 10 + e, rand() } }' >runs.csv
expect 0 '' "$program" loop --table runs.csv --response y --model '1 + T' --model-out better.json -o loop.json
valid loop_model.schema.json better.json
grep -q '"table.linear' better.json || fail "the loop has not found the humidity"

expect 0 '' "$program" doe runs.csv --response y --model T --code none -o before.json
expect 0 '' "$program" doe runs.csv --response y --model better.json --code none -o after.json
checks - <<'P' || fail "the analysis does not start from the better model"
import json
before, after = (json.load(open(name + ".json")) for name in ("before", "after"))
slope = lambda r: [c for c in r["coefficients"] if "T" in c["name"]][0]
assert [c["name"] for c in before["coefficients"]] == [c["name"] for c in after["coefficients"]]
assert slope(after)["standard_error"] < 0.15 * slope(before)["standard_error"], (slope(before), slope(after))
assert abs(slope(after)["estimate"] - 0.01) < 3 * slope(after)["standard_error"] < 0.002
assert after["runs"][0]["response"] != before["runs"][0]["response"]
P

# A removed effect is reported with its uncertainty, and the residual loses its degree of freedom.
checks - <<'P' || fail "what was taken out is not said or not paid for"
import json
before, after, model = (json.load(open(name + ".json")) for name in ("before", "after", "better"))
claim = model["claims"][0]
assert before["taken_out"] is None
taken = after["taken_out"]
assert taken["freedom"] == 1 and len(taken["effects"]) == 1, taken
effect = taken["effects"][0]
assert effect["id"] == "table.linear" and effect["words"] == "a trend with humidity" and effect["taken_out"]
assert effect["parameters"] == 1
for name in ("amplitude", "u_amplitude"):
    assert abs(effect[name] / claim[name] - 1) < 1e-8, (effect, claim)
assert abs(effect["range"][1] - effect["amplitude"]) < 1e-6 * effect["amplitude"], effect
assert before["fit"]["residual_freedom"] == 30 and after["fit"]["residual_freedom"] == 29
assert before["coefficients"][0]["freedom"] == 30 and after["coefficients"][0]["freedom"] == 29
error = {row["term"]: row["freedom"] for row in after["anova"]["error"]}
assert error["residual"] == error["lack of fit"] + error["pure error"] == 29, error
assert [i["path"] for i in after["inputs"]] == ["runs.csv", "better.json"], after["inputs"]
words = " ".join(after["conclusions"])
assert "Taken out before the analysis: a trend with humidity: it rises by 4." in words and "±" in words, words
assert "amplitude" not in words and claim["sentence"] in words, words
assert "29 degrees of freedom instead of 30" in words, words
P
valid doe.schema.json before.json after.json
grep -q "$(sha256sum better.json | cut -d' ' -f1)" after.json || fail "the sum of the model is not said"
expect 0 '' "$program" doe runs.csv --response y --model better.json --code none --html after.html -o after.json
grep -q 'Taken out before the analysis: a trend with humidity' after.html || fail "the page does not say what was taken out"
if command -v script >/dev/null; then
  script -qec "'$program' doe runs.csv --response y --model better.json --code none" typed >/dev/null
  grep -q 'Taken out before the analysis: a trend with humidity' typed || fail "the terminal does not say what was taken out"
fi
# A wrong row of the loop's own table is not taken out of another, and that is said; a curve costs its degrees of freedom.
python3 - <<'P'
import json
model = json.load(open("better.json"))
model["claims"].append({"id": "table.outlier", "name": "table.outlier(7)", "coordinates": [], "coefficients": [1.5],
                        "shape": [], "amplitude": 1.5, "u_amplitude": 0.1})
model["unattributed"] = {"coordinate": "run", "freedom": 3.4, "shape": [[1, 0.1], [16, -0.1], [32, 0.1]]}
json.dump(model, open("more.json", "w"))
P
expect 0 '' "$program" doe runs.csv --response y --model more.json --code none -o more.out.json
checks - <<'P' || fail "a lone row, a curve"
import json
report = json.load(open("more.out.json"))
lone, curve = report["taken_out"]["effects"][1:]
assert not lone["taken_out"] and report["taken_out"]["freedom"] == 5, report["taken_out"]
assert curve["words"] == "a smooth curve over run" and curve["parameters"] == 4 and curve["u_amplitude"] > 0, curve
assert report["fit"]["residual_freedom"] == 25
assert any("Not taken out: table.outlier(7)" in text for text in report["conclusions"]), report["conclusions"]
P
valid doe.schema.json more.out.json
# No more parameters than the runs can pay for.
head -5 runs.csv >few.csv
expect 65 'no freedom is left' "$program" doe few.csv --response y --model more.json --code none -o never.json

# An effect of the model's own factors is part of every response: no best setting without it. Declared, it has one.
python3 - <<'P'
import random
rng = random.Random(4)
with open("cross.csv", "w") as out:
    out.write("run,T,D,y\n")
    for i in range(32):
        T, D = 500 + 100 * (i * 5 % 2), 3 + 2 * (i // 2 % 2)
        out.write(f"{i + 1},{T},{D},{20 + (T - 550) / 50 + 3 * (T - 550) / 50 * (D - 4) + rng.gauss(0, 0.5):.4f}\n")
P
expect 0 '' "$program" loop --table cross.csv --response y --model 'T + D' --model-out cross.json -o cross.loop.json
expect 0 '' "$program" doe cross.csv --response y --model cross.json -o cross.out.json --html cross.html
checks - <<'P' || fail "a best setting without an interaction of its factors"
import json
report = json.load(open("cross.out.json"))
assert report["surface"] is None, report["surface"]
assert any(t.startswith("No best setting: an interaction of T and D is of the model's own factors") for t in report["conclusions"])
assert any("declare it in the formula" in n for n in report["notes"]), report["notes"]
assert not any("Expected response" in t for t in report["conclusions"]), report["conclusions"]
P
valid doe.schema.json cross.out.json
grep -q 'No best setting: an interaction of T and D' cross.html || fail "the page does not say why there is no best setting"
expect 64 'declare it in the formula' "$program" doe cross.csv --response y --model cross.json --at 'T=500, D=5' -o never.json
expect 0 '' "$program" doe cross.csv --response y --model 'T + D + T:D' -o cross.declared.json
[ "$(value cross.declared.json 'r["surface"]["optimum"]["real"]')" = '[500, 5]' ] || fail "the declared interaction's optimum"

# The same rows without the column, under another name, beyond what the model has seen.
cut -d, -f1,2,4,5 runs.csv >without.csv
sed '1s/humidity/damp/' runs.csv >renamed.csv
awk -F, 'NR == 5 { print $1 "," $2 ",95," $4 "," $5; next } { print }' runs.csv >wet.csv
awk -F, 'NR == 5 { print $1 "," $2 ",," $4 "," $5; next } { print }' runs.csv >hole.csv
# Files that are no such model.
head -c 300 better.json >cut.json
sed 's/"coefficients": \[[^]]*\]/"coefficients": [null]/' better.json >null.json
sed 's/"coefficients": \[[^]]*\]/"coefficients": [1, 2]/' better.json >two.json
sed 's/"response": "y"/"response": "w"/' better.json >other.json
printf '{"schema":"foilgauge/scan-model/1","fields":[]}' >scanner.json
printf '{"schema":"foilgauge/design/1"}' >design.json
while IFS='|' read -r code words data response model; do
  expect "$code" "$words" "$program" doe $data --response $response --model $model -o never.json
  [ ! -e never.json ] || fail "$data with $model leaves a report behind"
done <<'TABLE'
65|no column 'humidity'|without.csv|y|better.json
65|no column 'humidity'|renamed.csv|y|better.json
65|row 4: humidity is 95; the model has seen|wet.csv|y|better.json
65|row 4.*humidity|hole.csv|y|better.json
65|of the response 'y', not of 'z'|runs.csv|z|better.json
65|of the response 'w', not of 'y'|runs.csv|y|other.json
65|cut.json|runs.csv|y|cut.json
65|null.json.*not complete|runs.csv|y|null.json
65|another number of coefficients|runs.csv|y|two.json
65|scanner.json|runs.csv|y|scanner.json
65|design.json|runs.csv|y|design.json
74|missing.json|runs.csv|y|missing.json
TABLE
# Dates that hardly recur are a trend in a formula, as they are to the loop, and no level in every row.
awk 'BEGIN { print "date,T,y"; for (i = 1; i <= 20; i++) printf "%d.3.26,%d,%.3f\n", i, 500 + 50 * (i % 3), 3 + 0.5 * i + 0.01 * ((i * 7) % 5) }' >dated.csv
expect 0 '' "$program" doe dated.csv --response y --model 'T + date' --code none -o dated.json
near "slope over days" "$(value dated.json '[c["estimate"] for c in r["coefficients"] if c["name"] == "date"][0]')" 0.5 0.001
[ "$(value dated.json '"date counts days since 1.3.26" in r["notes"]')" = True ] || fail "the dates' reading is not told"
expect 64 'response' "$program" doe runs.csv --model better.json
expect 65 'better.json' "$program" measure runs.csv --model better.json

exit $failed
