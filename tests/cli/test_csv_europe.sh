#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
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
  checks - "$@" <<'P' || fail "$1 and $2 differ"
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

# Refused tables, each with its place: line 4 is row 3.
awk -F, 'NR == 4 { sub(/\./, ",", $4); print $1 "," $2 "," $3 ",\"" $4 "\""; next } { print }' point.csv >quoted.csv
awk -F, -v OFS=, 'NR > 1 { sub(/\./, ",", $3); $3 = "\"" $3 "\"" } { print }' point.csv >words.csv
sed '4s/,\([0-9]*\)\(\r\)$/.\1\2/' comma.csv >mixed.csv
awk -F, -v OFS=, 'NR == 4 { $3 = "damp" } { print }' point.csv >damp.csv
awk -F, -v OFS=, 'NR == 4 { $3 = "NA" } { print }' point.csv >missing.csv
awk -F, -v OFS=, 'BEGIN { srand(9) }
  { $3 = NR == 1 ? "shelf" : NR % 4 ? NR % 4 : "S"; if (NR > 1) $4 = 3 + $2 / 100 + (rand() + rand() - 1) * 0.1 } { print }' point.csv >shelf.csv
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
65|shelf.csv: row 3 \(line 4\), column 'shelf': 'S' is not a number|shelf.csv|T_C + shelf
0||shelf.csv|T_C + factor(shelf)
TABLE
# Decimal commas between commas: said as such with a name in the row, a sign, an exponent, and in a manifest.
for row in 'a,500,5,3,25' '1,500,5,3,25' 'a,500,-0,5' 'a,500,3,5e-1'; do
  printf 'run,T_C,y\n%s\n%s\n' "$row" "$row" >commas.csv
  expect 65 'commas.csv: row 1 \(line 2\) has . cells.*; decimal commas\? Then separate the cells by semicolons' \
    "$program" doe commas.csv --response y --model T_C -o -
done
printf 'run,T_C,y\na,x,3,b\n' >commas.csv
expect 65 'has 4 cells, the header names 3 columns$' "$program" doe commas.csv --response y --model T_C -o -
printf 'scan,coil_mm,die\nnone.png,0,102,A\n' >commas.csv
expect 65 'decimal commas\? Then separate the cells by semicolons' "$program" lot commas.csv -o commas
# A column that the analysis does not use refuses nothing; to the loop every column is a candidate.
for data in words damp; do
  expect 0 '' "$program" doe $data.csv --response y --model T_C -o -
  expect 65 "$data.csv: row [13] .line [24].*humidity" "$program" loop --table $data.csv --response y --model T_C -o -
done
listened=stdout
expect 0 'humidity: cells are missing' "$program" loop --table missing.csv --response y --model T_C -o -
listened=stderr

# A manifest: its numbers are written with points in the lot's own tables.
printf '\xef\xbb\xbfscan;coil_mm;die\r\nnone.png;0,102;A, new\r\n' >lot.csv
expect 2 '' "$program" lot lot.csv -o lot
grep -q '^none.png,0.102,"A, new",' lot/foils.csv || fail "the lot's table: $(tail -1 lot/foils.csv)"

# Written so: semicolons, decimal commas, a byte order mark; every cell is that of the table with points, a number where
# that has one, and a text where that has one.
cat >read.py <<'P'
import csv, re, sys
point, comma = (open(name, encoding="utf-8", newline="").read() for name in sys.argv[1:])
assert comma.startswith("\ufeff") and not point.startswith("\ufeff"), "byte order mark"
a, b = list(csv.reader(point.splitlines())), list(csv.reader(comma[1:].splitlines(), delimiter=";"))
assert len(a) == len(b) and [len(r) for r in a] == [len(r) for r in b], "other rows or cells"
number = re.compile(r"[-+]?\d+(\.\d+)?([eE][-+]?\d+)?$")
found = 0
for one, other in zip(sum(a, []), sum(b, [])):
    if number.match(one):
        assert other == one.replace(".", ","), (one, other)
        found += "." in one
    else:
        assert other == one, (one, other)
assert found, "no number with decimals"
P
# written FILE COMMAND...: the command writes FILE; with --decimal-comma the same otherwise.
written() {
  local file=$1 code=0
  shift
  rm -rf "$file" point.out out.d
  "$@" >said 2>&1 || code=$?
  mv "$file" point.out || fail "$* writes no $file: $(cat said)"
  rm -rf out.d
  "$@" --decimal-comma >said 2>&1
  [ $? = $code ] || fail "$* --decimal-comma: another exit code: $(cat said)"
  checks read.py point.out "$file" || fail "$* --decimal-comma: $file"
}
mkdir scans
for i in 1 2 3; do
  echo "{\"schema\":\"foilgauge/render/1\",\"seed\":$i,\"foils\":[{\"design\":{\"bump_count\":3},\"radius_springback\":{\"mean\":0.05,\"sd\":0.01}}],\"scanner\":{\"dpi\":1200,\"noise\":1}}" >spec.json
  "$renderer" render spec.json -o "scans/a;b, $i.png" || fail render
done
written b.csv "$program" measure scans/*1.png -o m.json --csv b.csv
written p.csv "$program" measure scans/*1.png -o m.json --points p.csv
written c.csv "$program" design --curve -o c.csv
written plan.csv "$program" doe plan --factor T=500.5:600.5 --factor p=1.5:2.5 --seed 1 -o plan.csv
written t.csv "$program" forming --temperature 600 --time 1 -o f.json --table-out t.csv
written st.csv "$program" forming --temperature 600 --time 1 -o f.json --strip-out st.csv
for file in foils bumps bearings; do
  written out.d/$file.csv "$program" lot scans -o out.d --name L
done
"$program" lot scans -o points --name L 2>said
for i in 1 2; do "$program" lot scans -o s$i --shard $i/2 --name L 2>said; done
written out.d/bumps.csv "$program" merge s1 s2 -o out.d
# A lot whose tables are written so is compared with others as any other is.
"$program" lot --index a.html points -o a.json 2>said || fail "index: $(cat said)"
rm -rf commas && "$program" lot scans -o commas --name L --decimal-comma 2>said || fail "lot: $(cat said)"
"$program" lot --index a.html commas -o b.json 2>said || fail "index: $(cat said)"
checks - a.json b.json <<'P' || fail "an index of a lot with decimal commas"
import json, sys
a, b = (json.load(open(name))["lots"][0]["quantities"] for name in sys.argv[1:])
assert a == b
P
written i.csv "$program" lot --index i.html points commas --csv i.csv
# The tables of a station's lots.
mkdir st && cp scans/*.png st/
for i in point comma; do
  [ $i = point ] && option= || option=--decimal-comma
  # shellcheck disable=SC2086
  "$program" station st --once $option >said 2>&1 || fail "station: $(cat said)"
  # shellcheck disable=SC2086
  "$program" station st --export lots.$i $option >said 2>&1 || fail "station --export: $(cat said)"
done
for file in foils bumps; do
  checks read.py "$(find lots.point -name $file.csv)" "$(find lots.comma -name $file.csv)" || fail "the station's $file.csv"
done

exit $failed
