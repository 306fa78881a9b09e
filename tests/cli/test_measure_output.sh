#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge measure`: its output and files, its exit codes, and that nothing half-written remains.
shared=${FOILGAUGE_SHARED:-../shared}
scan=$(ls samples/*.png "$shared"/scans/p1_classical.png 2>/dev/null | head -n 1)
if [ -z "$scan" ]; then
  echo "skipped: no sample scan"
  exit 77
fi
. tests/support/cli.sh
cd "$root" || exit 1
folder=$work

# only NAME...: nothing but these lies in the folder of outputs.
only() {
  local there
  there=$(cd "$folder/out" && find . -mindepth 1 -printf '%P\n' | sort | tr '\n' ' ')
  [ "$there" = "$*${*:+ }" ] || fail "in the output folder: '$there', not '$*'"
  rm -rf "$folder/out"
  mkdir "$folder/out"
}

mkdir "$folder/out"
out=$folder/out

expect 0 '' "$program" measure "$scan" -o "$out/a.json" --csv "$out/a.csv" --points "$out/p.csv" \
  --overlay "$out/a.png" --html "$out/a.html"
[ -s "$folder/stdout" ] && fail "standard output is not empty beside -o"
head -n 1 "$out/a.csv" | grep -q '^scan,foil,bump,flags,radius_mm,u_radius_mm,' || fail "CSV heading"
head -n 1 "$out/p.csv" | grep -q '^scan,foil,station,s_mm,side,' || fail "heading of the points"
head -c 8 "$out/a.png" | od -An -tx1 | grep -q '89 50 4e 47 0d 0a 1a 0a' || fail "overlay is no PNG"
width=$((16#$(od -An -tx1 -j16 -N4 "$out/a.png" | tr -d ' ')))
[ "$width" -le 8000 ] || fail "overlay is $width px wide"
grep -q 'data:image/png;base64,' "$out/a.html" || fail "the page has no picture"
if python3 -c 'import jsonschema' 2>/dev/null; then
  python3 tests/support/validate_schema.py reports/schema measure.schema.json "$out/a.json" ||
    fail "the report does not validate"
fi
cp "$out/a.json" "$folder/first.json"
only a.csv a.html a.json a.png p.csv

# The same again, and to standard output: the same bytes, whatever the number of threads.
expect 0 '' "$program" measure "$scan" --threads 1
cmp -s "$folder/stdout" "$folder/first.json" || fail "standard output and -o differ"
expect 0 '' "$program" measure "$scan" --threads 2 -o -
cmp -s "$folder/stdout" "$folder/first.json" || fail "two threads and one differ"

# Tolerances: one that holds, one that does not, one that does not exist.
design() {
  printf '{"schema": "foilgauge/design/1", "calibration": "not needed: the scan is rendered", "tolerances": {%s}}' "$1" >"$folder/design.json"
}
design '"height_mm": {"min": 0.1, "max": 1}'
expect 0 '' "$program" measure "$scan" -d "$folder/design.json"
grep -q '^ "verdict": "pass"' "$folder/stdout" || fail "the verdict is not pass"
design '"height_mm": {"min": 0.9}'
expect 1 '' "$program" measure "$scan" -d "$folder/design.json" -o "$out/a.json"
grep -q '^ "verdict": "fail"' "$out/a.json" || fail "the verdict is not fail"
grep -q '"out_of_tolerance"' "$out/a.json" || fail "no bump is flagged"
only a.json
design '"hight_mm": {"min": 0.9}'
expect 65 'hight_mm.*no such quantity' "$program" measure "$scan" -d "$folder/design.json" \
  -o "$out/a.json"
only

# Several scans, one of which is not there.
expect 2 'lost.png' "$program" measure "$scan" "$folder/lost.png" -o "$out/two.json"
grep -q '^ "scans": \[' "$out/two.json" || fail "no scans in the report of two"
only two.json

# Nothing measured: no output.
expect 74 'lost.png' "$program" measure "$folder/lost.png" -o "$out/a.json" --csv "$out/a.csv"
: >"$folder/empty.png"
expect 65 'empty.png' "$program" measure "$folder/empty.png" -o "$out/a.json" --html "$out/a.html"
head -c 50000 "$scan" >"$folder/cut.png"
expect 65 'cut.png' "$program" measure "$folder/cut.png" -o "$out/a.json" --overlay "$out/a.png"
expect 65 'none of 2' "$program" measure "$folder/empty.png" "$folder/cut.png" -o "$out/a.json"
only

# Outputs that cannot be: known before measuring, and none of the others remains.
expect 74 'none/a.csv' "$program" measure "$scan" -o "$out/a.json" --csv "$out/none/a.csv"
expect 74 'folder|directory' "$program" measure "$scan" -o "$out"
only
if [ -e /dev/full ]; then
  for kind in --csv --points --overlay --html; do
    expect 74 '/dev/full.*space' "$program" measure "$scan" -o "$out/a.json" $kind /dev/full
    only
  done
  "$program" measure "$scan" >/dev/full 2>"$folder/stderr"
  [ $? = 74 ] || fail "a full standard output is no error"
fi
echo old >"$out/a.json"
limited() {
  (ulimit -f 1 && exec "$@") # KiB
}
expect 74 'a.json' limited "$program" measure "$scan" -o "$out/a.json"
[ "$(cat "$out/a.json")" = old ] || fail "a failed run replaced an earlier report"
only a.json

# Interrupted: no temporary file remains.
"$program" measure "$scan" -o "$out/a.json" --overlay "$out/a.png" 2>"$folder/stderr" &
pid=$!
for _ in $(seq 100); do
  [ -n "$(ls -A "$out")" ] && break
  sleep 0.01
done
kill -TERM $pid
wait $pid
code=$?
[ "$code" = 130 ] || fail "exit $code, not 130, when interrupted"
only

# Misuse.
expect 64 'no SCAN' "$program" measure
expect 64 'dpi' "$program" measure --dpi 0 "$scan"
expect 64 'dpi' "$program" measure --dpi -4800 "$scan"
expect 64 'dpi' "$program" measure --dpi nan "$scan"
expect 64 'form' "$program" measure --form round "$scan"
expect 64 'two outputs' "$program" measure "$scan" -o "$out/a" --csv "$out/a"
expect 64 'one scan' "$program" measure "$scan" "$scan" --overlay "$out/a.png"
# A narrow scan: the legend below it is whole, and the words of the residuals' scale stand in two rows.
echo '{"schema": "foilgauge/render/1", "scanner": {"dpi": 600}, "foils": [{"rotate_deg": 0, "design": {"bump_count": 2}}]}' >"$folder/narrow.json"
echo '{"schema": "foilgauge/design/1", "bump_count": 2}' >"$folder/two.json"
"$renderer" render "$folder/narrow.json" -o "$folder/narrow.png" || fail "render"
expect 0 '' "$program" measure "$folder/narrow.png" -d "$folder/two.json" --overlay "$out/a.png" --html "$out/a.html" -o "$out/a.json"
width=$((16#$(od -An -tx1 -j16 -N4 "$out/a.png" | tr -d ' ')))
[ "$width" -ge 944 ] || fail "a legend of $width px is cut"
grep -q '>(drawn × ' "$out/a.html" || fail "the scale's words of a narrow picture stand in one row"
only a.html a.json a.png

cp "$scan" "$folder/scan.png"
expect 64 'overwrite' "$program" measure "$folder/scan.png" -o "$folder/./scan.png"
cmp -s "$scan" "$folder/scan.png" || fail "the scan was overwritten"
only

exit $failed
