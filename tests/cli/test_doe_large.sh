#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tables that are large in one way: a limit with its reason before anything is computed, and no step whose time
# grows with the square of the columns.
. "$(dirname "$0")/../support/loop.sh"
seconds=20
[ -z "${FOILGAUGE_TEST_BRIEF:-}" ] || seconds=100

# refuse WORDS COMMAND...: exit code 65, at once, with little memory, and says WORDS.
refuse() {
  local words=$1 code=0
  shift
  (ulimit -v ${limit:-4000000} && timeout $seconds "$program" "$@" -o report.json) >said 2>&1 || code=$?
  [ $code -eq 65 ] || fail "$*: exit code $code: $(head -c 300 said)"
  grep -q "$words" said || fail "$*: says $(head -c 300 said)"
  [ ! -e report.json ] || fail "$*: a report"
}
ldd "$program" | grep libasan >/dev/null && limit=unlimited

# A factor, a block, whole plots that name the rows.
python3 - <<'PY'
for levels in (2000, 16000):
    with open(f"levels_{levels}.csv", "w") as out:
        out.write("name,x,y\n")
        for i in range(2 * levels):
            out.write(f"L{i % levels},{i * i % 97},{i * 7 % 101}\n")
names = [f"c{i}" for i in range(100000)]
for file, head in (("wide.csv", names), ("doubled.csv", names[:-1] + ["c17"])):
    with open(file, "w") as out:
        out.write(",".join(head) + "\n")
        for row in range(6):
            out.write(",".join(str(i * row % 7) for i in range(len(head))) + "\n")
with open("tall.csv", "w") as out:
    out.write("name,y\n")
    for i in range(100000):
        out.write(f"L{i % 400},{i * 7 % 101}\n")
PY
for levels in 2000 16000; do
  words="levels_$levels.csv: the model has $((levels + 1)) columns, $((levels - 1)) of them for the levels of"
  refuse "$words factor(name); 500 are the most" doe levels_$levels.csv --response y --model 'factor(name) + x'
  refuse "$words factor(name); 500 are the most" doe levels_$levels.csv --response y --model x --block name
  refuse "$words name; 500" loop --table levels_$levels.csv --response y --model 'name + x'
  refuse "columns, $levels of them for the levels of name; 500" \
    doe levels_$levels.csv --response y --model x --whole-plot name
done
printf 'a,b,c,d,e,f,g,h,i,j,y\n1,2,3,1,2,3,1,2,3,1,2\n2,1,4,2,1,4,2,1,4,2,5\n' >terms.csv
refuse 'the model has 1024 columns; 500 are the most' doe terms.csv --response y --model '(a+b+c+d+e+f+g+h+i+j)^10'
refuse 'tall.csv: 100000 rows of 400 model columns are too many' doe tall.csv --response y --model name

# 100,000 columns.
refuse "doubled.csv: columns 18 and 100000 are both called 'c17'" doe doubled.csv --response c1 --model c2
refuse "no column 'lost'; the columns are c0, c1, .* (100000)" doe wide.csv --response lost --model c2
timeout $seconds "$program" doe wide.csv --response c1 --model c2 -o report.json || fail "doe of 100,000 columns"

# A manifest is no wide table.
sed '1s/c0,/scan,/' wide.csv >manifest.csv
code=0
timeout $seconds "$program" lot manifest.csv -o lot >said 2>&1 || code=$?
[ $code -eq 65 ] && grep -q 'manifest.csv: more than 1000 columns' said ||
  fail "lot of 100,000 columns: exit code $code: $(head -c 300 said)"
exit $failed
