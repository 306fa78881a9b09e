#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge lot` and `merge`: kept, resumed, killed, out of space, sharded, and always the same report.
# FOILGAUGE_KILLS: how often a run is killed (default 12).
. tests/support/cli.sh
listened="stdout stderr"

# Eleven small foils, one of them with a name that would like to be markup, and a file that is no scan.
mkdir scans
render() {
  printf '{"schema":"foilgauge/render/1","seed":%d,"foils":[{"design":{"bump_count":3},"overall_radius_mm":20.9,
"radius_springback":{"mean":0.05,"sd":0.05},"rotate_deg":-90}],"scanner":{"dpi":1200,"blur_px":1.0,"noise":1}}' "$1" >spec.json
  "$renderer" render spec.json -o "$2" || fail "render $2"
}
for i in 1 2 3 4 5 6 7 8 9 10; do render "$i" "scans/foil$i.png"; done
strange=$'scans/<script>alert("1")</script>\'& \u00e4\u6f22.png'
mkdir -p "$(dirname "$strange")"
render 11 "$strange"
echo "not a scan" >scans/broken.png
cat >recipe.json <<'R'
{"schema": "foilgauge/recipe/1", "name": "Lot <b>\"7\"</b> & ä", "resamples": 2000,
 "pads": 3, "bumps_per_pad": 3, "assembly": {"bearings": 50, "seed": 3},
 "design": {"schema": "foilgauge/design/1", "bump_count": 3,
  "calibration": "not needed: the scan is rendered", "tolerances": {"height_mm": {"min": 0.50, "max": 0.60}, "overall.radius_mm": {"max": 20.95}}}}
R
lot() {
  "$program" lot scans --recipe recipe.json "$@"
}

# Nothing is touched by a dry run; the whole lot; the same with one job and with three.
expect 0 '12 scans, 12 to measure, 0 kept' lot -o one --dry-run
[ -e one ] && fail "a dry run made a folder"
expect 2 '11 foils of 12 scans' lot -o one
grep -q 'broken.png: is a text' stderr || fail "the bad scan is not named"
for name in lot.json foils.csv bumps.csv bearings.csv index.html results.qif results.dfq results.jsonl recipe.json manifest.csv; do
  [ -s "one/$name" ] || fail "no $name"
done
expect 2 '' lot -o jobs1 --jobs 1
expect 2 '' lot -o jobs3 --jobs 3
same one jobs1
same one jobs3
[ "$(wc -l <one/results.jsonl)" = 13 ] || fail "results.jsonl has not one line per scan"
[ "$(wc -l <one/foils.csv)" = 13 ] || fail "foils.csv"
[ "$(wc -l <one/bumps.csv)" = 34 ] || fail "bumps.csv"

grep -q '"assembled"' one/lot.json || fail "no bearings were drawn"
grep -q 'It is no rotordynamic simulation' stderr || fail "the terminal does not say what drawn bearings do not tell"
grep -q '"scope": "This is geometry' one/lot.json || fail "lot.json does not say what drawn bearings do not tell"
grep -q 'of 50 bearings drawn from' stderr || fail "the terminal does not say how many bearings assemble"

# A name is text wherever it stands.
grep -q '<script>' one/index.html one/results.qif && fail "a name became markup"
grep -qF '&lt;b&gt;&quot;7&quot;&lt;/b&gt; &amp; ä' one/index.html || fail "the lot's name is not shown as such"
grep -qF 'script&gt;&#39;&amp; ä漢.png' one/index.html || fail "the foil's name is not shown as such"

# Finished records are kept; changed scans are measured again; a tolerance changes no measurement.
expect 64 '--resume' lot -o one
expect 0 '12 scans, 0 to measure, 12 kept' lot -o one --resume --dry-run
expect 2 '' lot -o one --resume
same one jobs1
cp -r one changed
render 21 scans/foil4.png
expect 0 '12 scans, 1 to measure, 11 kept' lot -o changed --resume --dry-run
expect 2 '' lot -o changed --resume
cmp -s one/lot.json changed/lot.json && fail "a changed scan changes nothing"
render 4 scans/foil4.png
expect 2 '' lot -o changed --resume
same one changed
sed 's/0.60/0.61/' recipe.json >wider.json
expect 0 ' 0 to measure' "$program" lot scans --recipe wider.json -o changed --resume --dry-run
sed 's/"bump_count": 3/"bump_count": 3, "pitch_deg": 13.3/' recipe.json >pitch.json
expect 0 ' 12 to measure' "$program" lot scans --recipe pitch.json -o changed --resume --dry-run

# The same bytes under the names of two foils: the first counts, once, and the second was not measured.
mkdir copied
cp scans/foil1.png scans/foil2.png scans/foil3.png copied/
expect 0 '' "$program" lot copied --recipe recipe.json -o without
cp scans/foil2.png copied/foil9.png
expect 2 'the same scan under another name, counted once: 1 scan; the first: .*foil9.png.* as that of foil2.png' \
  "$program" lot copied --recipe recipe.json -o with
for i in 1 2; do "$program" lot copied --recipe recipe.json -o part$i --shard $i/2 2>stderr; done
expect 2 'counted once: 1 scan' "$program" merge part1 part2 -o joined
same with joined
valid with/lot.json
checks - without/lot.json with/lot.json <<'P' || fail "a copy of a scan changes the lot's statistics"
import json, sys
a, b = (json.load(open(name)) for name in sys.argv[1:])
assert a["quantities"] == b["quantities"] and a["foils"] == b["foils"], "statistics"
assert b["counts"]["scans_repeated"] == 1 and b["counts"]["scans_not_measured"] == 1, b["counts"]
assert [i.get("repeat_of") for i in b["inputs"]] == [None, None, None, 1], b["inputs"]
P
grep -q '^copied/foil9.png,,,not_measured,repeated_scan,' with/foils.csv || fail "foils.csv: $(tail -1 with/foils.csv)"
grep -q 'the same scan, byte by byte, as that of foil2.png' with/index.html || fail "the page does not say what was copied"
expect 2 'counted once: 1 scan' "$program" lot copied --recipe recipe.json -o with --resume
same with joined

# A scan that goes away keeps its record; one that is missing from the start is a record as well.
cp -r one gone
mv scans/foil2.png kept.png
printf 'scan\nscans/foil1.png\nscans/foil2.png\n' >list.csv
expect 2 'foil2.png' "$program" lot list.csv --recipe recipe.json -o missing
mv kept.png scans/foil2.png
expect 0 '' "$program" lot list.csv --recipe recipe.json -o missing --resume
(sleep 0.03 && mv scans/foil9.png away.png) &
lot -o removed --jobs 1 >/dev/null 2>&1
wait
mv away.png scans/foil9.png
expect 2 '' lot -o removed --resume
same one removed

# Two runs at once: the lock turns one away, the other's report is whole.
exec 9>one/.lock
flock -x 9
expect 74 'another run' lot -o one --resume
exec 9>&-
lot -o both >/dev/null 2>first.log &
lot -o both >/dev/null 2>second.log
wait
expect 2 '' lot -o both --resume
same one both

# Killed at any moment, then resumed: the same bytes.
# Sanitizers make every run many times slower: fewer cases of the same.
kills=6 limits="1 3 8 16 32" shards="1 2 7 20"
[ -z "${FOILGAUGE_TEST_LONG-}" ] || { kills=12 limits="1 2 3 5 8 12 16 24 32"; }
brief && { kills=1 limits="1 16" shards=20; }
for i in $(seq "${FOILGAUGE_KILLS:-$kills}"); do
  rm -rf killed
  for again in 1 2; do
    "$program" lot scans --recipe recipe.json -o killed --resume >/dev/null 2>&1 &
    victim=$!
    sleep "0.$(printf '%03d' $((RANDOM % 120)))"
    kill -9 "$victim" 2>/dev/null
    wait "$victim" 2>/dev/null
  done
  expect 2 '' lot -o killed --resume
  same one killed
done

# No space, at every size of a file: an error with words, and the next run goes on.
for blocks in $limits; do
  rm -rf full
  (ulimit -f $blocks && lot -o full --jobs 2 >/dev/null 2>full.log)
  code=$?
  [ $code = 74 ] || [ $code = 2 ] || fail "limit of $blocks KiB: exit $code ($(head -c 200 full.log))"
  [ $code = 2 ] || grep -qE 'cannot be (written|made)' full.log || fail "limit of $blocks KiB: no words"
  [ $code = 2 ] || [ ! -e full/lot.json ] || fail "limit of $blocks KiB: lot.json beside an error"
  ls -A full 2>/dev/null | grep -q '\.tmp$' && fail "limit of $blocks KiB: a temporary file is left"
  expect 2 '' lot -o full --resume
  same one full
done

# A torn line is measured again.
cp -r one torn
truncate -s -40 torn/results.jsonl
expect 2 'not whole' lot -o torn --resume
same one torn

# A lot of one foil over and over: nothing varies, and the report is there all the same.
mkdir equal # the same pixels; other bytes behind them, or they would be one scan
for i in $(seq 12); do (cat scans/foil1.png && echo "$i") >"equal/$i.png"; done
expect 0 '' timeout 60 "$program" lot equal --recipe recipe.json -o same
[ -s same/lot.json ] || fail "a lot of equal foils has no report"
checks - same/lot.json <<'P' || fail "a lot of equal foils shows signals"
import json, sys
for quantity in json.load(open(sys.argv[1]))["quantities"].values():
    assert not quantity["individuals"]["signals"], quantity["individuals"]
P

# Shards in any number give the same lot; what does not belong together is refused.
for count in $shards; do
  rm -rf shards merged
  mkdir shards
  for i in $(seq $count); do
    [ $count = 1 ] && expect 2 '' lot -o shards/1
    [ $count = 1 ] || lot -o "shards/$i" --shard "$i/$count" >/dev/null 2>&1
  done
  expect 2 '11 foils' "$program" merge shards/* -o merged
  same one merged
done
expect 65 'missing: 1 of 20 shards, the first is 3/20' "$program" merge $(ls -d shards/* | grep -v '/3$') -o no
cp -r shards/5 twice
expect 65 'there twice' "$program" merge shards/* twice -o no
"$program" lot scans --recipe wider.json -o other --shard 3/20 2>/dev/null
expect 65 'recipes differ' "$program" merge $(ls -d shards/* | grep -v '/3$') other -o no
head -n 1 shards/4/results.jsonl >x && mv x shards/4/results.jsonl
expect 65 'without a record' "$program" merge shards/* -o no
expect 64 'overwrite' "$program" merge one -o one
expect 64 '1/0|from 1' lot -o no --shard 1/0
expect 64 '' lot -o no --shard 3/2

# Settings: all of them can be printed, and the printed recipe can be read.
lot --print-recipe >printed.json
expect 0 '' "$program" lot --recipe printed.json --print-recipe
same stdout printed.json

# An index over lots; formats that others read.
expect 0 '' "$program" lot --index index.html one merged
grep -q 'href="one/index.html"' index.html || fail "the index has no link"
if command -v xmllint >/dev/null; then
  xmllint --noout --schema "$root/tests/support/qif3_results.xsd" one/results.qif 2>xmllint.log ||
    fail "results.qif: $(head -n 3 xmllint.log)"
fi
valid lot.schema.json one/lot.json
checks - one/results.dfq <<'P' || fail "results.dfq"
import re, sys
lines = open(sys.argv[1], "rb").read().decode().split("\r\n")
assert lines[-1] == "" and lines[0].startswith("K0100 ")
count = int(lines[0].split()[1])
assert all(re.match(r"K\d{4}(/\d+)? .", line) for line in lines[:-1]), "a line is no K field"
values = [line for line in lines if line.startswith("K0001/")]
assert len(values) == 11 * count and len({v.split()[0] for v in values}) == count
P

exit $failed
