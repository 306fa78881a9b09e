#!/bin/bash
# `foilgauge doe --model FILE.json`: what the loop found is taken out before the analysis.
. tests/support/cli.sh

# y = 3 + T/100 + humidity/10, and noise of sd 0.05; z is another response.
awk 'BEGIN { srand(5); print "run,T,humidity,y,z"
  for (i = 1; i <= 32; i++) { T = 500 + 50 * (i % 3); h = 15 + 45 * rand()
    e = (rand() + rand() + rand() + rand() - 2) * 0.0866
    printf "%d,%d,%.3f,%.4f,%.4f\n", i, T, h, 3 + T / 100 + h / 10 + e, rand() } }' >runs.csv
expect 0 '' "$program" loop --table runs.csv --response y --model '1 + T' --model-out better.json -o loop.json
grep -q '"table.linear' better.json || fail "the loop has not found the humidity"

expect 0 '' "$program" doe runs.csv --response y --model T --code none -o before.json
expect 0 '' "$program" doe runs.csv --response y --model better.json --code none -o after.json
python3 - <<'P' || fail "the analysis does not start from the better model"
import json
before, after = (json.load(open(name + ".json")) for name in ("before", "after"))
slope = lambda r: [c for c in r["coefficients"] if "T" in c["name"]][0]
assert [c["name"] for c in before["coefficients"]] == [c["name"] for c in after["coefficients"]]
assert slope(after)["standard_error"] < 0.15 * slope(before)["standard_error"], (slope(before), slope(after))
assert abs(slope(after)["estimate"] - 0.01) < 3 * slope(after)["standard_error"] < 0.002
assert after["runs"][0]["response"] != before["runs"][0]["response"]
P

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
expect 64 'response' "$program" doe runs.csv --model better.json
expect 65 'better.json' "$program" measure runs.csv --model better.json

exit $failed
