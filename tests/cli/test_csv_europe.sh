#!/bin/bash
# Tables as Europe writes them (semicolons, decimal commas) say what the same tables with points say, and a column that
# may mean something else is refused with its line.
. tests/support/cli.sh

# european FILE: the file with semicolons, decimal commas, a byte order mark and CRLF.
european() {
  printf '\xef\xbb\xbf'
  sed 's/,/;/g; s/\([0-9]\)\.\([0-9]\)/\1,\2/g; s/$/\r/' "$1"
}
# alike A B: reports that differ in nothing but the name and sum of their input.
alike() {
  python3 - "$@" <<'P' || fail "$1 and $2 differ"
import json, sys
a, b = (json.load(open(name)) for name in sys.argv[1:])
for report in (a, b):
    report.pop("inputs")
assert a == b
P
}

awk 'BEGIN { srand(5); print "run,T_C,humidity,y"
  for (i = 1; i <= 32; i++) { T = 500.5 + 50 * (i % 3); h = 15 + 45 * rand()
    printf "%d,%.1f,%.3f,%.4f\n", i, T, h, 3 + T / 100 + h / 10 + (rand() + rand() - 1) * 0.1 } }' >point.csv
european point.csv >comma.csv
for name in point comma; do
  expect 0 '' "$program" doe $name.csv --response y --model T_C -o doe.$name.json
  expect 0 '' "$program" loop --table $name.csv --response y --model T_C -o loop.$name.json
done
alike doe.point.json doe.comma.json
alike loop.point.json loop.comma.json
grep -q '"table.linear(humidity)"' loop.comma.json || fail "the humidity is not found"

# What is refused, and where: line 4 is row 3.
awk -F, 'NR == 4 { sub(/\./, ",", $4); print $1 "," $2 "," $3 ",\"" $4 "\""; next } { print }' point.csv >quoted.csv
awk -F, -v OFS=, 'NR > 1 { sub(/\./, ",", $3); $3 = "\"" $3 "\"" } { print }' point.csv >words.csv
sed '4s/,\([0-9]*\)\(\r\)$/.\1\2/' comma.csv >mixed.csv
awk -F, -v OFS=, 'NR == 4 { $3 = "damp" } { print }' point.csv >damp.csv
awk -F, -v OFS=, 'NR == 4 { $3 = "NA" } { print }' point.csv >missing.csv
awk -F, -v OFS=, '{ $3 = NR == 1 ? "shelf" : NR % 3 ? NR % 3 : "S" } { print }' point.csv >shelf.csv
while IFS='|' read -r code words data model; do
  for tool in "doe $data" "loop --table $data"; do
    expect "$code" "$words" "$program" $tool --response y --model "$model" -o out.json
    [ "$code" = 0 ] || [ ! -e out.json ] || fail "$tool leaves a report behind"
    rm -f out.json
  done
done <<'TABLE'
65|quoted.csv: row 3 \(line 4\), column 'y': '[0-9]*,[0-9]*' is a number to people|quoted.csv|T_C
65|words.csv: row 1 \(line 2\), column 'humidity': .*semicolons|words.csv|T_C + humidity
65|mixed.csv: row 3 \(line 4\), column 'y': a point, but a comma in line 2|mixed.csv|T_C
65|damp.csv: row 3 \(line 4\), column 'humidity': 'damp' is not a number|damp.csv|T_C + humidity
65|shelf.csv: row 2 \(line 3\), column 'shelf': 'S' is not a number|shelf.csv|T_C + shelf
0||shelf.csv|T_C + factor(shelf)
TABLE
# A column that the analysis does not use refuses nothing; to the loop every column is a candidate.
for data in words damp; do
  expect 0 '' "$program" doe $data.csv --response y --model T_C -o -
  expect 65 "$data.csv: row [13] .line [24].*humidity" "$program" loop --table $data.csv --response y --model T_C -o -
done
listened=stdout
expect 0 'humidity: cells are missing' "$program" loop --table missing.csv --response y --model T_C -o -
listened=stderr

# A manifest: what it says of numbers is written with points in the lot's own tables.
printf '\xef\xbb\xbfscan;coil_mm;die\r\nnone.png;0,102;A, new\r\n' >lot.csv
expect 2 '' "$program" lot lot.csv -o lot
grep -q '^none.png,0.102,"A, new",' lot/foils.csv || fail "the lot's table: $(tail -1 lot/foils.csv)"

exit $failed
