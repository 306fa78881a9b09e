#!/bin/bash
# `foilgauge loop --table`: what it prints and writes, what it refuses.
set -u
program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
  echo "FAIL: $*"
  failures=$((failures + 1))
}

# expect CODE WORDS ARGUMENT...: exit code, and words on standard output or error.
expect() {
  local code=$1 words=$2
  shift 2
  "$program" loop "$@" >"$folder/out" 2>"$folder/err"
  local got=$?
  [ "$got" = "$code" ] || fail "$*: exit $got, not $code"
  grep -qF -- "$words" "$folder/out" "$folder/err" || fail "$*: does not say '$words'"
}

cd "$folder" || exit 1
awk 'BEGIN { srand(3); print "run,T,humidity,copy,shelf,y"
  for (i = 1; i <= 24; i++) { T = 500 + 50 * (i % 3); h = 15 + 45 * rand()
    e = (rand() + rand() + rand() - 1.5) * 0.6
    printf "%d,%d,%.3f,%.3f,S%d,%.4f\n", i, T, h, h, i % 2, 3 + T / 100 + h / 10 + e } }' >t.csv
awk -F, 'NR == 1 { print; next } { print $1 "," $2 "," $3 "," $4 "," $5 "," $2 / 100 }' t.csv >exact.csv
awk -F, 'NR == 1 { print; next } { print $1 "," $2 "," $3 "," $4 "," $5 ",5" }' t.csv >constant.csv
awk -F, 'NR == 1 { print; next } NR == 4 { print $1 ",x," $3 "," $4 "," $5 "," $6; next } { print }' t.csv >word.csv
awk -F, 'NR == 4 { print $1 "," $2 "," $3 "," $4 "," $5 ","; next } { print }' t.csv >hole.csv
head -8 t.csv >few.csv
head -1 t.csv >header.csv
model=(--response y --model "1 + T")

expect 0 '"name": "table.linear(copy)"' --table t.csv "${model[@]}" -o - # a tie, not a winner
grep -q '"verdict": "tied"' out || fail "copies of a column do not tie"
expect 0 "fits every row" --table exact.csv "${model[@]}" -o -
expect 0 '"verdict": "clean"' --table constant.csv --response y --model 1 -o -
expect 0 "can give no p-value below 0.0156" --table few.csv "${model[@]}" -o -
expect 65 "no rows" --table header.csv "${model[@]}"
expect 65 "row 3" --table word.csv "${model[@]}" -o never.json
expect 65 "row 3" --table hole.csv "${model[@]}" -o never.json
expect 65 "no column 'Q'" --table t.csv --response y --model "1 + Q" -o never.json
expect 65 "no column 'z'" --table t.csv --response z --model "1 + T" -o never.json
expect 64 "uses the response" --table t.csv --response y --model "1 + y" -o never.json
expect 64 "character 5" --table t.csv --response y --model "1 + * T" -o never.json
expect 64 "not 'y'" --table t.csv --response y --model arc_length -o never.json
expect 65 "leave 2 to judge it by" --table few.csv --response y --model "1 + T + run + run^2 + humidity"
expect 64 "a share from 0" --table t.csv "${model[@]}" --hold-out 0.9
expect 64 "no row has that value" --table t.csv "${model[@]}" --hold-out T=999
expect 64 "--table DATA.csv is missing" "${model[@]}"
expect 64 "--response COLUMN" --table t.csv --model 1
expect 64 "" --table t.csv "${model[@]}" --seed x
expect 74 "none.csv" --table none.csv "${model[@]}"
expect 74 "no/such" --table t.csv "${model[@]}" -o no/such/out.json
[ -e never.json ] && fail "a refused table leaves an output file"

# The same input gives the same bytes; another seed keeps other rows aside.
"$program" loop --table t.csv "${model[@]}" -o a.json --html a.html --model-out a.model.json
"$program" loop --table t.csv "${model[@]}" -o b.json
cmp -s a.json b.json || fail "two runs differ"
"$program" loop --table t.csv "${model[@]}" --seed 9 -o c.json
cmp -s a.json c.json && fail "the seed changes nothing"
expect 0 '"rows_kept_aside": 12' --table t.csv "${model[@]}" --hold-out shelf=S1 -o -
grep -q "trend with humidity" a.html || fail "the page does not say what was found"
grep -qE "nan|inf[^a-z]" a.html && fail "the page holds numbers that are none"
grep -q "table.linear" a.model.json || fail "the model file lacks the effect"

echo '{"response": "y", "model": "1 + T"}' >declared.json
expect 0 '"model": "1 + T"' --table t.csv --declared declared.json -o -
echo '{"response": 3}' >declared.json
expect 65 "response must be a text" --table t.csv --declared declared.json

/usr/bin/env python3 "$root/tests/support/validate_schema.py" "$root/reports/schema" \
  loop.schema.json a.json b.json c.json
code=$?
[ "$code" = 0 ] || [ "$code" = 77 ] || fail "the report does not validate"

[ "$failures" = 0 ]
