#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge loop --table`: its output and files, refused input.
. tests/support/cli.sh
listened="stdout stderr"

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

expect 0 "copy: says the same as" "$program" loop --table t.csv "${model[@]}" -o - # one candidate
expect 0 "fits every row" "$program" loop --table exact.csv "${model[@]}" -o -
expect 0 '"verdict": "clean"' "$program" loop --table constant.csv --response y --model 1 -o -
expect 3 '"verdict": "suspected"' "$program" loop --table few.csv "${model[@]}" -o -
expect 65 "no rows" "$program" loop --table header.csv "${model[@]}"
expect 65 "row 3" "$program" loop --table word.csv "${model[@]}" -o never.json
expect 65 "row 3" "$program" loop --table hole.csv "${model[@]}" -o never.json
expect 65 "no column 'Q'" "$program" loop --table t.csv --response y --model "1 + Q" -o never.json
expect 65 "no column 'z'" "$program" loop --table t.csv --response z --model "1 + T" -o never.json
expect 64 "uses the response" "$program" loop --table t.csv --response y --model "1 + y" -o never.json
expect 64 "character 5" "$program" loop --table t.csv --response y --model "1 + * T" -o never.json
expect 64 "not 'y'" "$program" loop --table t.csv --response y --model arc_length -o never.json
expect 65 "leave 2 to judge it by" "$program" loop --table few.csv --response y --model "1 + T + run + run^2 + humidity"
expect 64 "a share from 0" "$program" loop --table t.csv "${model[@]}" --hold-out 0.9
expect 64 "no row has that value" "$program" loop --table t.csv "${model[@]}" --hold-out T=999
expect 64 "--table DATA.csv is missing" "$program" loop "${model[@]}"
expect 64 "--response COLUMN" "$program" loop --table t.csv --model 1
expect 64 "" "$program" loop --table t.csv "${model[@]}" --seed x
expect 74 "none.csv" "$program" loop --table none.csv "${model[@]}"
expect 74 "no/such" "$program" loop --table t.csv "${model[@]}" -o no/such/out.json
[ -e never.json ] && fail "a refused table leaves an output file"

# The same input gives the same bytes; another seed moves an interval.
"$program" loop --table t.csv "${model[@]}" -o a.json --html a.html --model-out a.model.json
"$program" loop --table t.csv "${model[@]}" -o b.json
cmp -s a.json b.json || fail "two runs differ"
"$program" loop --table t.csv "${model[@]}" --seed 9 -o c.json
cmp -s a.json c.json && fail "the seed changes nothing"
expect 0 '"rows_kept_aside": 12' "$program" loop --table t.csv "${model[@]}" --hold-out shelf=S1 -o -
grep -q "trend with humidity" a.html || fail "the page does not say what was found"
grep -qE "nan|inf[^a-z]" a.html && fail "the page holds numbers that are none"

# Plain words: the sentence for each kind of finding, and for none.
awk 'BEGIN { srand(3); print "run,x,y"
  for (i = 1; i <= 60; i++) { e = rand() + rand() + rand() - 1.5
    printf "%d,%.3f,%.4f\n", i, 15 + 45 * rand(), 3 + e + (i == 2) * 20 - (i == 54) * 15 } }' >wrong.csv
awk 'BEGIN { srand(4); print "run,x,y"
  for (i = 1; i <= 90; i++) { x = (i * 37) % 90; e = rand() + rand() + rand() - 1.5
    printf "%d,%d,%.4f\n", i, x, 3 + e * exp(x / 25) } }' >spread.csv
awk 'BEGIN { srand(6); print "run,y"
  for (i = 1; i <= 80; i++) { r = 0.8 * r + rand() + rand() + rand() - 1.5; printf "%d,%.4f\n", i, 3 + r } }' >alike.csv
awk 'BEGIN { srand(8); print "run,x,y"
  for (i = 1; i <= 40; i++) printf "%d,%.3f,%.4f\n", i, rand(), rand() + rand() + rand() }' >clean.csv
says() { # says FILE WORDS...: in the summary and on the page, without ids and without numbers that are none
  local file=$1 words
  shift
  "$program" loop --table $file.csv --response y --model 1 -o $file.json --html $file.html || fail "$file: exit code"
  grep '"summary"' $file.json >summary.txt
  for words in "$@"; do
    grep -qF -- "$words" summary.txt || fail "$file does not say '$words': $(cat summary.txt)"
  done
  grep -qE "table\.|nan|falls from ([^ ]*) to \1[;.]" summary.txt && fail "$file: ids or none: $(cat summary.txt)"
  sed 's/<style>.*<\/style>//' $file.html | grep -qE "[^a-z](nan|inf)[^a-z]" && fail "$file: the page holds numbers that are none"
}
# The advice can be followed, and helps.
grep -qF "Declare a trend with humidity: --model &#39;1 + T + humidity&#39;" a.html || fail "the page does not say what to do next"
grep -qF '"verdict": "explained"' a.json || fail "what is found is not explained"
expect 0 '"verdict": "clean"' "$program" loop --table t.csv --response y --model "1 + T + humidity" -o -
says wrong "Rows 2 and 54 are wrong: row 2 lies " "on rows that took no part in the search"
says spread "The scatter grows with x: " " times from the smallest to the largest" "No mean changes"
says alike "eighbouring runs are alike (correlation 0."
says clean "Nothing is claimed: in 40 rows" "steps" "cycles down to two rows" "lone wrong values"
# Advice that can be carried out: settings that were used, runs at the end of an order, or that no number helps.
awk 'BEGIN { srand(3); print "run,humidity,y"
  for (i = 1; i <= 24; i++)
    printf "%d,%.1f,%.4f\n", i, 15 + 2 * i + 1.5 * rand(), 3 + 0.1 * i + 0.6 * (rand() + rand() + rand() - 1.5) }' >drift.csv
awk 'BEGIN { srand(9); print "temperature_C,y"
  for (i = 1; i <= 60; i++) { T = 500 + 5 * ((i * 7) % 12)
    printf "%d,%.4f\n", T, T / 20 + rand() + rand() + rand() } }' >bent.csv
says drift "a trend with humidity" "which these data cannot tell from: " "a drift over the runs"
advice=$(grep -o '"advice": "[^"]*"' drift.json)
[[ $advice =~ 'At the end, '([0-9]+)' more runs at humidity = '([0-9.]+)' and as many at humidity = '([0-9.]+)' part ' ]] || fail "no advice: $advice"
for value in "${BASH_REMATCH[2]}" "${BASH_REMATCH[3]}"; do
  grep -q ",$value," drift.csv || fail "advice for a humidity that nobody set: $value"
done
says bent "a trend with temperature_C"
grep -q '"advice": "No number of runs that one would make parts ' bent.json || fail "advice that cannot be carried out: $(grep advice bent.json)"

# The page draws each kind of finding in its own way: a band, joined neighbours, rows with their numbers, a line.
grep -q '>row 54</text>' wrong.html || fail "a wrong row has no number on the page"
[ "$(grep -c 'class="mark"' wrong.html)" = 2 ] || fail "not both wrong rows are marked"
grep -q 'class="band"' spread.html || fail "the spread is not drawn as a band"
grep -q 'class="joined"' alike.html || fail "neighbours are not joined"
[ "$(grep -o 'class="effect" d="[^"]*' a.html | tr -cd L | wc -c)" -gt 100 ] || fail "a trend is not drawn as a line"
grep -qE 'class="(effect|band|mark)"' clean.html && fail "something is drawn where nothing was found"
grep -q "table.linear" a.model.json || fail "the model file lacks the effect"

echo '{"response": "y", "model": "1 + T"}' >declared.json
expect 0 '"model": "1 \+ T"' "$program" loop --table t.csv --declared declared.json -o -
echo '{"response": 3}' >declared.json
expect 65 "response must be a text" "$program" loop --table t.csv --declared declared.json

echo '{"design": 5}' >declared.json
expect 65 "design must be an object" "$program" loop --table t.csv "${model[@]}" --declared declared.json
echo '{"design": {"bump_radius": 3}}' >declared.json
expect 65 "design.bump_radius" "$program" loop --table t.csv "${model[@]}" --declared declared.json
expect 74 "none.json" "$program" loop --table t.csv "${model[@]}" --declared none.json

# A search that would take too long is refused before it starts, with the limit and the way out.
awk 'BEGIN { print "x,y"; for (i = 0; i < 300000; i++) print i % 97 "," i % 89 }' >long.csv
expect 65 "512 MiB. Leave out columns" "$program" loop --table long.csv --response y --model 1 -o never.json
expect 65 "the limit is 0.001 minutes" "$program" loop --table t.csv "${model[@]}" --minutes 0.001 -o never.json
expect 64 "above 0" "$program" loop --table t.csv "${model[@]}" --minutes 0
[ -e never.json ] && fail "a refused search leaves an output file"

# A bar where standard error is a terminal, and only there.
if [ -z "${FOILGAUGE_TEST_BRIEF:-}" ] && command -v script >/dev/null; then
  awk 'BEGIN { srand(5); print "run,T,a,b,c,d,e,f,g,y"
    for (i = 1; i <= 60000; i++) {
      printf "%d", i
      for (k = 0; k < 8; k++) printf ",%s", rand()
      print "," rand() + rand() } }' >slow.csv
  script -qec "'$program' loop --table slow.csv --response y --model '1 + T' -o bar.json" typed >/dev/null
  grep -q "0 found, next \[" typed || fail "no bar on a terminal"
fi
expect 0 '"verdict"' "$program" loop --table t.csv "${model[@]}" -o -
[ -s stderr ] && fail "a bar where there is no terminal"

# Units: numbers far from 1 give the same verdict; squares that are no numbers are refused.
for power in -300 300; do
  awk -F, -v OFS=, -v power=$power 'NR > 1 { $6 = $6 "e" power } { print }' t.csv >far.csv
  expect 0 '"name": "table.linear\(humidity\)"' "$program" loop --table far.csv "${model[@]}" --html far.html -o -
  grep -qE "nan|inf[^a-z]" stdout far.html && fail "1e$power: numbers that are none"
  "$program" doe far.csv --response y --model "1 + T" >out 2>err
  [ $? = 65 ] || fail "doe takes responses of 1e$power"
  grep -q "give it in another unit" err || fail "doe does not say what to do with 1e$power"
done

/usr/bin/env python3 "$root/tests/support/validate_schema.py" "$root/reports/schema" \
  loop.schema.json a.json b.json c.json wrong.json spread.json alike.json clean.json
code=$?
[ "$code" = 0 ] || [ "$code" = 77 ] || fail "the report does not validate"
valid loop_model.schema.json a.model.json

exit $failed
