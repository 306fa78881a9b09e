#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge doe`: plans, analyses, messages on bad tables, and that nothing half-written remains.
. tests/support/cli.sh
cd "$root" || exit 1
folder=$work
out=$folder/out
mkdir "$out"

# only NAME...: nothing but these lies in the folder of outputs.
only() {
  local there
  there=$(cd "$out" && find . -mindepth 1 -printf '%P\n' | sort | tr '\n' ' ')
  [ "$there" = "$*${*:+ }" ] || fail "in the output folder: '$there', not '$*'"
  rm -rf "$out"
  mkdir "$out"
}

table() {
  printf "$1" >"$folder/t.csv"
}

# bad WORDS MODEL TABLE: exit 65, the words, no output.
bad() {
  table "$3"
  expect 65 "$1" "$program" doe "$folder/t.csv" --response y --model "$2" -o "$out/a.json" \
    --html "$out/a.html"
  only
}

# number NAME: the first number of that name in the report.
number() {
  sed -n "s/^ *\"$1\": \([^,]*\),*$/\1/p" "$out/a.json" | head -n 1
}

sample=samples/doe/springback_factorial.csv
composite=samples/doe/springback_composite.csv
second='temperature_C*duration_h + temperature_C^2 + duration_h^2'

# Table 5.3 of the thesis: the magnitude by default, the sign as it is when asked for.
expect 0 '' "$program" doe $sample --response springback_error_pct \
  --model 'temperature_C*duration_h' -o "$out/a.json" --html "$out/a.html"
[ -s "$folder/stdout" ] && fail "standard output is not empty beside -o"
[ "$(number estimate)" = 7.10875 ] || fail "the constant is $(number estimate), not 7.10875"
grep -q '"relative_effect_pct": -47.7404607' "$out/a.json" || fail "no -47.74 % of temperature"
grep -q '^ "sign": "magnitude"' "$out/a.json" || fail "the sign is not said"
grep -q '<svg' "$out/a.html" || fail "the page has no plots"
grep -qiE '<script|https?://' "$out/a.html" && fail "the page is not self-contained"
cp "$out/a.json" "$folder/first.json"
only a.html a.json
expect 0 '' "$program" doe $sample --response springback_error_pct --model 'temperature_C*duration_h'
cmp -s "$folder/stdout" "$folder/first.json" || fail "standard output and -o differ"
expect 0 '' "$program" doe - --response springback_error_pct --model 'temperature_C*duration_h' \
  --sign as-is -o "$out/a.json" <$sample
[ "$(number estimate)" = -7.10875 ] || fail "--sign as-is gives $(number estimate)"
only a.json

# The optimum obeys the limits that are set, and only those that can be.
awk -F, 'BEGIN { OFS = FS; print "temperature_C,duration_h,y" } NR > 1 {
  print $2, $3, 80 - 0.1 * $2 - 2 * $3 + NR % 3 / 10 }' $composite >"$folder/slope.csv"
expect 0 '' "$program" doe "$folder/slope.csv" --response y \
  --model 'temperature_C + duration_h' --constraint 'temperature_C <= 610' \
  --constraint '2*duration_h <= 10' -o "$out/a.json"
grep -A6 'duration_h <= 10"' "$out/a.json" | grep -q '"real": \[610, 5\]' ||
  fail "the optimum is not at the corner of the limits"
only a.json
expect 64 'leave nothing' "$program" doe $composite --response springback_error_pct \
  --model "$second" --constraint 'temperature_C <= 300' -o "$out/a.json"
expect 64 'character 1: this is no numeric factor' "$program" doe $composite \
  --response springback_error_pct --model "$second" --constraint 'temp <= 300' -o "$out/a.json"
only

# Saturated: Lenth's method; no degree of freedom and few effects; a column that is another one.
expect 0 '' "$program" doe $sample --response springback_error_pct \
  --model 'pressure_bar*temperature_C*duration_h' -o "$out/a.json"
grep -q '"pseudo_standard_error": [0-9]' "$out/a.json" || fail "a saturated design has no Lenth"
grep -q 'no residual freedom' "$out/a.json" || fail "saturation is not said"
table 'a,y\n1,3\n2,4\n'
expect 0 '' "$program" doe "$folder/t.csv" --response y --model a -o "$out/a.json"
grep -q 'No effect can be judged' "$out/a.json" || fail "two runs: nothing is said"
table 'a,b,y\n1,2,3\n2,4,5\n1,2,3.5\n2,4,5.5\n'
expect 0 '' "$program" doe "$folder/t.csv" --response y --model a+b -o "$out/a.json"
grep -q 'b cannot be told apart' "$out/a.json" || fail "an alias is not said"
only a.json
table 'a,day,y\n-1,mon,4.1\n-1,mon,3.9\n1,tue,6.1\n1,tue,5.8\n'
expect 0 '' "$program" doe "$folder/t.csv" --response y --model a --block day -o "$out/a.json"
grep -q 'No effect can be judged: none can be told apart from the blocks' "$out/a.json" || fail "a factor that the blocks hide"
only a.json

# Quotes, a byte order mark and CRLF are no obstacle.
table '\xef\xbb\xbf"a","the ""y"""\r\n1,"3"\r\n2,4\r\n1,3.5\r\n2,5\r\n'
expect 0 '' "$program" doe "$folder/t.csv" --response 'the "y"' --model a -o "$out/a.json"
[ "$(number estimate)" = 3.875 ] || fail "quotes, BOM, CRLF: $(number estimate), not 3.875"
only a.json

# Bad tables.
bad "no column 'c'" 'a+c' 'a,b,y\n1,1,3\n2,1,4\n'
bad "no column 'y'" 'a' 'a,b,z\n1,1,3\n2,1,4\n'
bad "row 2 \(line 3\), column 'y': 'x' is not a number" 'a' 'a,y\n1,3\n1,x\n2,4\n'
bad "row 3 \(line 4\), column 'a': 'l' is not a number" 'a' 'a,y\n1,3\n1,4\nl,4\n'
bad "row 2 \(line 3\), column 'y'" 'a' 'a,y\n1,3\n1,NaN\n2,4\n'
bad "row 1 \(line 2\), column 'a'" 'a' 'a,y\n,3\n1,3\n2,4\n'
bad 'one run only' 'a' 'a,y\n1,3\n'
bad "column 'y': all 3 values \(rows 1 to 3\) are 4" 'a' 'a,y\n1,4\n2,4\n3,4\n'
bad "column 'b': the factor is 1 in all 2 rows" 'a+b' 'a,b,y\n1,1,3\n2,1,4\n'
bad "'g' has one level" 'g' 'g,y\nu,3\nu,4\n'
bad "both called 'a'" 'a' 'a,a,y\n1,1,3\n2,1,4\n'
bad 'no rows|no runs|only' 'a' 'a,y\n'
bad 'empty|header' 'a' ''
bad 'row 2' 'a' 'a,y\n1,3\n2\n'

# Misuse, and outputs that cannot be.
table 'a,y\n1,3\n2,4\n'
expect 64 'model' "$program" doe "$folder/t.csv" --response y
expect 64 'DATA' "$program" doe --response y --model a
expect 64 'response' "$program" doe "$folder/t.csv" --model a -o "$out/a.json"
expect 64 'formula.*character' "$program" doe "$folder/t.csv" --response y --model 'a +' -o "$out/a"
expect 64 'LOW must be below' "$program" doe "$folder/t.csv" --response y --model a --code a=2:1
expect 64 'no numeric factor' "$program" doe "$folder/t.csv" --response y --model a --code b=1:2
expect 64 'overwrite' "$program" doe "$folder/t.csv" --response y --model a -o "$folder/t.csv"
expect 74 'none.csv' "$program" doe "$folder/none.csv" --response y --model a -o "$out/a.json"
expect 74 'none/a' "$program" doe "$folder/t.csv" --response y --model a -o "$out/none/a.json"
[ -e /dev/full ] && expect 74 '/dev/full' "$program" doe "$folder/t.csv" --response y --model a \
  -o "$out/a.json" --html /dev/full
only

# Plans: the same seed, the same sheet; what cannot be.
plan=("$program" doe plan --factor T=500:600 --factor D=3:5 --centre 2)
expect 0 '6 runs' "${plan[@]}" -o "$out/runs.csv"
[ "$(head -n 1 "$out/runs.csv")" = run,standard_order,point,T,D,scan ] || fail "heading of the sheet"
[ "$(wc -l <"$out/runs.csv")" = 7 ] || fail "the sheet has not 6 runs"
cp "$out/runs.csv" "$folder/runs.csv"
valid plan.schema.json "$out/runs.plan.json"
expect 0 '' "${plan[@]}"
cmp -s "$folder/stdout" "$folder/runs.csv" || fail "one seed gives two sheets"
expect 0 '' "${plan[@]}" --seed 2
cmp -s "$folder/stdout" "$folder/runs.csv" && fail "two seeds give one sheet"
expect 0 'whole plots' "${plan[@]}" --hard T
head -n 1 "$folder/stdout" | grep -q whole_plot || fail "a hard factor makes no whole plots"
only runs.csv runs.plan.json

# Settings that the oven can be given; a page to print; the plan's limits and steps go with the sheet, not in it.
oven=("$program" doe plan --factor T=500:600 --factor D=3:5 --kind composite --centre 3 --round T=5 --round D=0.25)
expect 0 '' "${oven[@]}" -o "$out/runs.csv" --html "$out/runs.html"
grep -q ',465,4,' "$out/runs.csv" && fail "an axial run of two factors at the distance of three"
cut -d, -f4 "$out/runs.csv" | tail -n +2 | sort -u | tr '\n' ' ' | grep -qx '480 500 550 600 620 ' ||
  fail "settings of T: $(cut -d, -f4 "$out/runs.csv" | sort -u | tr '\n' ' ')"
grep -q 'multiples of 0.25' "$out/runs.html" || fail "the page does not say the steps"
[ "$(grep -c '<td class="blank">' "$out/runs.html")" = 11 ] || fail "the page has not a line per run"
# Levels are limits: rounded inwards, and told; so is a setting below 0 of what lies above.
expect 0 'note: T: multiples of 7, so 504 for 500, 553 for 550, 595 for 600' \
  "$program" doe plan --factor T=500:600 --centre 1 --round T=7 --html "$out/s.html"
[ "$(tail -n +2 "$folder/stdout" | cut -d, -f4 | sort -u | tr '\n' ' ')" = "504 553 595 " ] || fail "limits: $(cat "$folder/stdout")"
grep -q '<li>T: multiples of 7, so 504 for 500' "$out/s.html" || fail "the page does not say what is rounded"
rm "$out/s.html"
expect 0 'note: D: an axial run is at -1, below 0: .* --axial below 2' "$program" doe plan --factor D=1:3 --kind thesis
grep -q multiples "$folder/stderr" && fail "nothing is rounded"
expect 64 'both become' "$program" doe plan --factor T=500:600 --round T=500
expect 64 'no factor of that name' "$program" doe plan --factor T=500:600 --round D=5
expect 64 'STEP must be' "$program" doe plan --factor T=500:600 --round T=-5
respond() { # respond FROM TO: the sheet with a response, as a spreadsheet writes it back: other quotes, other order
  python3 - "$1" "$2" <<'P'
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
for row in rows:
    t, d = (float(row["T"]) - 563) / 50, float(row["D"]) - 4.3
    row["y"] = 4 + t * t + d * d + 0.3 * t * d + 0.01 * (int(row["run"]) % 3)
rows.sort(key=lambda row: float(row["T"]))
writer = csv.DictWriter(open(sys.argv[2], "w"), rows[0], delimiter=";", quoting=csv.QUOTE_ALL)
writer.writeheader()
writer.writerows(rows)
P
}
quadratic='T*D + T^2 + D^2'
respond "$out/runs.csv" "$out/runs.csv"
expect 0 '' "$program" doe "$out/runs.csv" --response y --model "$quadratic" -o "$out/a.json" --html "$out/a.html"
valid doe.schema.json "$out/a.json"
[ "$(value "$out/a.json" '[(f["low"], f["high"]) for f in r["factors"]]')" = '[(500, 600), (3, 5)]' ] ||
  fail "the factors are not coded as planned"
[ "$(value "$out/a.json" 'r["surface"]["rounded"]["real"]')" = '[565, 4.25]' ] || fail "the best setting is not rounded"
[ "$(value "$out/a.json" '[r["plan"][-14:], r["plan_note"]]')" = "['runs.plan.json', None]" ] || fail "the plan is not named"
grep -q 'class="set">T 565, D 4.25<' "$out/a.html" || fail "the page does not answer first"
sed -i '2s/"T"/"T"/; s/"620"/"625"/' "$out/runs.csv"
expect 0 '' "$program" doe "$out/runs.csv" --response y --model "$quadratic" -o "$out/a.json" --round T=20 --code D=2:6
value "$out/a.json" 'r["plan_note"]' | grep -q '^1 run made at another setting' || fail "another setting is not told"
[ "$(value "$out/a.json" '[r["factors"][1]["low"], r["surface"]["rounded"]["real"]]')" = '[2, [560, 4.25]]' ] ||
  fail "options do not go before the plan"
mv "$out/runs.csv" "$out/renamed.csv"
expect 0 '' "$program" doe "$out/renamed.csv" --response y --model "$quadratic" -o "$out/a.json"
value "$out/a.json" 'r["plan_note"]' | grep -q 'is not beside it' || fail "a plan that is lost is not told"
[ "$(value "$out/a.json" 'r["surface"]["rounded"]')" = None ] || fail "steps of a plan that is lost"
expect 0 '' "$program" doe "$out/renamed.csv" --response y --model "$quadratic" -o "$out/a.json" --plan "$out/runs.plan.json"
[ "$(value "$out/a.json" 'r["factors"][0]["low"]')" = 500 ] || fail "--plan does not code the factors"
expect 65 'line 1, column 6: this is not JSON' "$program" doe "$out/renamed.csv" --response y --model "$quadratic" -o "$out/a.json" --plan "$out/renamed.csv"
echo '{"schema": "foilgauge/plan/1", "factors": [{"name": "T", "low": 6, "high": 5}], "settings": []}' >"$out/runs.plan.json"
expect 65 'LOW must be below.*move it away and give the limits with --code' "$program" doe "$out/renamed.csv" --response y --model "$quadratic" --plan "$out/runs.plan.json"
expect 64 'no numeric factor' "$program" doe "$out/renamed.csv" --response y --model "$quadratic" --round E=5
[ -e /dev/full ] && expect 74 '/dev/full' "${oven[@]}" --html /dev/full
rm -rf "$out" && mkdir "$out"
expect 64 'no factor of that name' "$program" doe plan --factor T=1:2 --hard D
expect 64 'factor' "$program" doe plan
expect 64 'LOW must be below' "$program" doe plan --factor T=2:1
expect 64 '' "$program" doe plan --factor T=1:2 --kind box-behnken
only

# Scans: relative to the sheet; one that is missing costs its run, and exit code 2.
spec() {
  printf '{"schema": "foilgauge/render/1", "seed": 1, "foils": [{"design": {"bump_count": 4}, '
  printf '"overall_radius_mm": %s}], "scanner": {"dpi": 1200}}' "$1"
}
mkdir "$folder/scans"
echo 'T,scan' >"$folder/scans/runs.csv"
for run in '1 21.0' '2 21.4' '3 21.1' '4 21.5'; do
  set -- $run
  spec "$2" >"$folder/spec.json"
  "$program" render "$folder/spec.json" -o "$folder/scans/$1.png" || fail "render"
  echo "$((500 + 100 * (($1 - 1) % 2))),$1.png" >>"$folder/scans/runs.csv"
done
echo '550,1.png;2.png' >>"$folder/scans/runs.csv"
echo '{"schema": "foilgauge/design/1", "bump_count": 4}' >"$folder/four.json"
measured=("$program" doe "$folder/scans/runs.csv" --scans scan --design "$folder/four.json" --model T)
expect 0 '' "${measured[@]}" --response overall.springback_error_pct -o "$out/a.json"
checks - "$out/a.json" <<'PYTHON' || fail "the measured springback is not the rendered one"
import json, sys
report = json.load(open(sys.argv[1]))
truth = [100 * (r / 20.73 - 1) for r in (21.0, 21.4, 21.1, 21.5, 21.2)]
assert [len(report["inputs"]), report["sign"]] == [7, "magnitude"]
for run, value in zip(report["runs"], truth):
    assert abs(run["response"] - value) < 0.05 and 0 < run["u"] < 0.05, (run, value)
assert all(c["u_measurement"] > 0 for c in report["coefficients"])
PYTHON
echo '600,lost.png' >>"$folder/scans/runs.csv"
echo '600,' >>"$folder/scans/runs.csv"
expect 2 'row 6.*lost.png' "${measured[@]}" --response radius_mm -o "$out/a.json"
only a.json
expect 65 'no quantity.*overall.radius_mm' "${measured[@]}" --response radius -o "$out/a.json"
expect 65 "no column 'picture'" "$program" doe "$folder/scans/runs.csv" --scans picture \
  --response radius_mm --model T -o "$out/a.json"
only

# The reports validate.
for model in 'temperature_C' "$second"; do
  "$program" doe $composite --response springback_error_pct --model "$model" >"$folder/v.json"
  valid doe.schema.json "$folder/v.json"
done

# Runs of a split plot are missing: restricted likelihood, which says so; a complete one keeps its strata.
split=("$program" doe tests/data/split_plot/plan_4.csv --response y --model 'T*D + group' --whole-plot load)
expect 0 '' "${split[@]}" -o - --html "$out/split.html"
cp "$folder/stdout" "$folder/v.json"
valid doe.schema.json "$folder/v.json"
grep -q '"method": "restricted_likelihood"' "$folder/v.json" || fail "missing runs are not analysed by restricted likelihood"
grep -q 'own variance is estimated as 0' "$folder/v.json" || fail "a variance of 0 is not said"
grep -q 'df of<br>its error' "$out/split.html" || fail "the page has no tests of the terms"
script -qc "${split[*]@Q}" /dev/null | grep -q 'error df' || fail 'the terminal has no tests of the terms'
rm "$out/split.html"

# A million runs.
runs=1000000
brief && runs=100000
awk -v runs=$runs 'BEGIN { print "a,b,y"; for (i = 0; i < runs; i++) { a = i % 3; b = int(i / 3) % 2;
  print a "," b "," 5 + a - b + (i * 7919 % 101) / 100 } }' >"$folder/t.csv"
expect 0 '' "$program" doe "$folder/t.csv" --response y --model 'a*b' --html "$out/a.html"
grep -q "\"runs\": $runs" "$folder/stdout" || fail "not $runs runs"
[ "$(stat -c %s "$out/a.html")" -lt 4000000 ] || fail "the page of $runs runs is too large"
only a.html

exit $failed
