#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Lots of a station: --export writes the same as `lot` would have made of the same scans, to the
# byte; a lot is closed in the browser, and nothing but its report can be had there.
# Usage: test_station_lots.sh PROGRAM
name=test_station_lots
. "$(dirname "$0")/../support/station.sh"
said() {
  grep -qF -- "$2" "$1" || fail "$3: '$2' is not in: $(cat "$1")"
}
sql() {
  python3 - "$work/in/foilgauge.sqlite" "$@" <<'PY'
import sqlite3, sys
database = sqlite3.connect(sys.argv[1])
for statement in sys.argv[2:]:
    for row in database.execute(statement):
        print(*row, sep="|")
database.commit()
PY
}
one='[{"rotate_deg": -90, "design": {"bump_count": 2}}]'
draw() { # SEED FILE [FOILS [SIZE]]
  printf '{"schema": "foilgauge/render/1", "seed": %s, "scanner": {"dpi": 1200}, %s "foils": %s}' \
    "$1" "${4-}" "${3:-$one}" >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$2"
}

mkdir "$work/in" "$work/drawn"
draw 1 "$work/in/L 1-a.png"
draw 2 "$work/in/L 1-b.png"
draw 3 "$work/in"/$'M\xff-c.png'
draw 4 "$work/in/L 1-bed.png" '[{"rotate_deg": -90, "design": {"bump_count": 2}, "centre_mm": [24, 26]},
  {"rotate_deg": -90, "design": {"bump_count": 2}, "centre_mm": [72, 26]}]' '"width_px": 4600, "height_px": 2500,'
draw 5 "$work/drawn/late.png"
cat >"$work/recipe.json" <<'R'
{"schema": "foilgauge/recipe/1", "group_column": "coil", "station": {"file_name": "{lot}-{serial}"},
 "design": {"schema": "foilgauge/design/1", "bump_count": 2,
            "calibration": "not needed: the scan is rendered", "tolerances": {"radius_mm": {"min": 0.1, "max": 90}}}}
R
code=0
"$program" station "$work/in" --recipe "$work/recipe.json" --once 2>"$work/said" || code=$?
[ $code -eq 0 ] || fail "--once: exit code $code: $(cat "$work/said")"
said "$work/said" "4 measured, 0 known, 0 refused" "--once"

# All of a lot, and the same as `lot` makes of it.
"$program" station "$work/in" --export "$work/out" 2>"$work/said" || fail "--export: $(cat "$work/said")"
said "$work/said" "out/L 1 4 foils of 3 scans: 4 pass" "--export"
"$program" lot "$work/out/L 1/manifest.csv" --recipe "$work/out/L 1/recipe.json" -o "$work/ref/lot" --pages none 2>/dev/null
diff -r "$work/ref/lot" "$work/out/L 1" >&2 || fail "--export and lot differ"
for folder in "$work/out"/*; do
  "$program" lot "$folder/manifest.csv" --recipe "$folder/recipe.json" -o "$folder" --resume --pages none \
    --dry-run >"$work/said"
  grep -q " 0 to measure" "$work/said" || fail "--resume after --export: $(cat "$work/said")"
done
"$program" merge "$work/out/L 1" -o "$work/ref/merged" 2>/dev/null
diff -r "$work/ref/merged" "$work/ref/lot" >&2 || fail "merge of what was exported differs"
"$program" lot --index "$work/index.html" "$work/out"/*
grep -q 'L%201\|L 1' "$work/index.html" || fail "the index does not name the lot"
code=0
"$program" station "$work/in" --export "$work/out" 2>"$work/said" || code=$?
[ $code -eq 64 ] || fail "--export over results: exit code $code"

# One foil of a bed is another lot's; a lot's name is no path.
sql "UPDATE foils SET lot = '../../up' WHERE serial = 'bed.2'" \
  "UPDATE foils SET lot = '' WHERE serial = 'c'"
"$program" station "$work/in" --export "$work/beds" 2>"$work/said" || fail "$(cat "$work/said")"
[ "$(ls "$work/beds" | LC_ALL=C sort | tr '\n' ' ')" = "%2E.%2F..%2Fup L 1 without_lot " ] ||
  fail "folders of lots: $(ls "$work/beds")"
grep -q 'bed.png,bed.1,L 1,,,1 of 2$' "$work/beds/L 1/manifest.csv" || fail "$(cat "$work/beds/L 1/manifest.csv")"
[ "$(wc -l <"$work/beds/L 1/foils.csv")" -eq 4 ] || fail "a bed's foil of another lot is in the lot"
"$program" merge "$work/beds/L 1" -o "$work/merged2" 2>/dev/null || fail "a part of a bed does not merge"

# A scanner that always writes the same name: every scan counts, and a replaced one is not taken for its successor.
mkdir "$work/same"
for seed in 21 22 23; do
  draw $seed "$work/same/L-x.png"
  "$program" station "$work/same" --recipe "$work/recipe.json" --once 2>/dev/null
done
cp "$work/same/L-x.png" "$work/third.png"
draw 22 "$work/same/L-x.png"
"$program" station "$work/same" --recipe "$work/recipe.json" --once 2>/dev/null
"$program" station "$work/same" --recipe "$work/recipe.json" --export "$work/same_out" 2>"$work/said" ||
  fail "--export of replaced scans: $(cat "$work/said")"
said "$work/said" "same_out/L 3 foils of 3 scans: 3 pass" "replaced scans"
checks - "$work/same_out/L/manifest.csv" "$work/third.png" <<'PY' || fail "the names of replaced scans"
import csv, hashlib, os, sys
names = [row["scan"] for row in csv.DictReader(open(sys.argv[1]))]
assert [os.path.exists(name) for name in names] == [False, True, False], names
assert len(set(names)) == 3, names
third = hashlib.sha256(open(sys.argv[2], "rb").read()).hexdigest()
assert names[2].endswith("L-x.png.overwritten-" + third[:12]), names
PY

# Another setup: measured again with the lot's newest; scans that are gone count as not measured.
sed 's/"group/"dpi": 1201, "group/' "$work/recipe.json" >"$work/other.json"
cp "$work/drawn/late.png" "$work/in/L 1-late.png"
"$program" station "$work/in" --recipe "$work/other.json" --once 2>/dev/null
mv "$work/in/L 1-b.png" "$work/b.png"
code=0
"$program" station "$work/in" --export "$work/again" 2>"$work/said" || code=$?
[ $code -eq 2 ] || fail "a scan of another setup that is gone: exit code $code"
said "$work/said" "2 scans were measured again with the lot's newest setup; 1 scan is of another setup and cannot be measured again" "--export"
mv "$work/b.png" "$work/in/L 1-b.png"
"$program" lot "$work/again/L 1/manifest.csv" --recipe "$work/again/L 1/recipe.json" --pages none \
  -o "$work/again/L 1" --resume --dry-run >"$work/said"
grep -q "4 scans, 1 to measure, 3 kept" "$work/said" || fail "--resume of two setups: $(cat "$work/said")"

# In the browser.
"$program" station "$work/in" --recipe "$work/other.json" --port 0 >"$work/address" 2>"$work/err" &
station=$!
checks - "$work" "$program" >&2 <<'PY' || fail "pages: $(cat "$work/err")"
import os, re, sys, time, urllib.error, urllib.parse, urllib.request
work = sys.argv[1]
base = wait_until(lambda: open(work + "/address").read().strip())
def ask(path, **fields):
    data = urllib.parse.urlencode(fields).encode() if fields else None
    try:
        with urllib.request.urlopen(urllib.request.Request(base + path.lstrip("/"), data)) as answer:
            return answer.status, answer.headers, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read()
def page(path):
    code, _, body = ask(path)
    assert code == 200, (path, code, body)
    return body.decode()
lots = page("/lots")
assert "Open lots" in lots and "L 1" in lots and "Closed lots" not in lots, lots
question = page("/lots?close=1&lot=L%201")
form = re.search('name="form" value="([0-9a-f]+)"', question)[1]
assert ask("/close", lot="L 1", by="Ann")[0] == 403
assert ask("/close", form=form, lot="L 1", by=" ")[0] == 422
assert ask("/close", form=form, lot="nothing", by="Ann")[0] == 404
assert ask("/lot?name=L%201")[0] == 404
for lot in "L 1", "../../up":
    wait_until(lambda: "being closed" not in page("/lots")) # one at a time
    assert ask("/close", form=form, lot=lot, by="Ann <b>", open="99")[0] == 200
wait_until(lambda: "being closed" not in page("/lots"))
lots = page("/lots")
assert "Closed lots" in lots and "Ann &lt;b&gt;" in lots and "since" not in lots, lots
folders = sorted(os.listdir(work + "/in/lots"))
assert folders == ["%2E.%2F..%2Fup", "L 1"], folders
code, headers, body = ask("/lot?name=L%201")
assert code == 200 and body == open(work + "/in/lots/L 1/index.html", "rb").read()
assert "script" not in headers["Content-Security-Policy"]
for name in "foils.csv", "bumps.csv", "results.qif", "results.dfq":
    code, headers, body = ask("/download", form=form, lot="L 1", file=name)
    assert code == 200 and body == open(work + "/in/lots/L 1/" + name, "rb").read(), name
    assert headers["Content-Disposition"] == 'attachment; filename="L 1-%s"' % name, headers
    assert "results.qif" != name or b"QIFDocument" in body
for name in "../../foilgauge.sqlite", "results.jsonl", "/etc/passwd", "", ".lock":
    assert ask("/download", form=form, lot="L 1", file=name)[0] == 404, name
for lot in "..", ".", "", "L 1/..", "L 1/../L 1":
    assert ask("/download", form=form, lot=lot, file="foils.csv")[0] == 404, lot
os.remove(work + "/in/lots/L 1/foils.csv")
os.symlink("/etc/passwd", work + "/in/lots/L 1/foils.csv")
assert ask("/download", form=form, lot="L 1", file="foils.csv")[0] == 404
PY
# A foil that comes too late is said, on its card and beside the lot.
draw 6 "$work/in/L 1-late2.png"
checks - "$work" >&2 <<'PY' || fail "late: $(cat "$work/err")"
import os, re, sys, time, urllib.parse, urllib.request
base = open(sys.argv[1] + "/address").read().strip()
get = lambda path: plain(urllib.request.urlopen(base + path).read().decode())
# The page names the file from its arrival on, its foil when it is measured.
wait_until(lambda: "comes after its lot &#39;L 1&#39; was closed by Ann" in get("").replace("'", "&#39;"))
lots = get("lots")
assert "been corrected since" in lots, lots
form = re.search('name="form" value="([0-9a-f]+)"', lots)[1]
# A report that cannot be written leaves that of before.
before = get("lot?name=L%201")
blocked = sys.argv[1] + "/in/lots/.closing/L 1/results.jsonl"
os.makedirs(blocked)
urllib.request.urlopen(base + "close", urllib.parse.urlencode(dict(form=form, lot="L 1", by="Cem")).encode()).read()
wait_until(lambda: "being closed" not in get("lots"))
assert "could not be closed" in get("lots") and "by Cem" not in get("lots"), get("lots")
assert get("lot?name=L%201") == before
os.rmdir(blocked)
fields = urllib.parse.urlencode(dict(form=form, lot="L 1", by="Bob")).encode()
urllib.request.urlopen(base + "close", fields).read()
wait_until(lambda: "being closed" not in get("lots"))
lots = get("lots")
assert "been corrected since" not in lots and "by Bob" in lots and ", 1 time before" in lots, lots
assert get("lot?name=L%201") != before and not os.path.exists(sys.argv[1] + "/in/lots/.closing")
PY
kill "$station"
wait "$station" 2>/dev/null || true
station=

# A foil that was scanned again counts with its later scan, failed foils stay; verdicts given while
# the scanner's check was due are reported.
sql "UPDATE foils SET serial = 'again'" \
  "UPDATE foils SET verdict = 'cannot_tell' WHERE id = (SELECT min(id) FROM foils WHERE lot = 'L 1')" \
  "UPDATE foils SET verdict = 'fail' WHERE lot = 'L 1' AND verdict <> 'cannot_tell'" \
  "UPDATE scans SET withheld = 'due' WHERE id = (SELECT max(id) FROM scans)"
"$program" station "$work/in" --export "$work/last" 2>"$work/said" || true
said "$work/said" "4 foils of 4 scans: 4 pass, 0 fail, 0 cannot be told; 1 foil counts with its later scan; 1 verdict does not hold: the scanner's check was due" "--export"
# The table of foils says which one.
table=$(grep -l 'withheld' "$work"/last/*/foils.csv) || fail "no column of verdicts that do not hold"
[ "$(grep -c ',due,' "$table")" = 1 ] || fail "withheld: $(cut -d, -f1-12 "$table")"
echo "lots: exported, closed, closed again"
