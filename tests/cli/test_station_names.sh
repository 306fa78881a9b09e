#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Names of files, whatever bytes they have: other programs read the database, the log has a line for each file and none
# that a file's name has forged, and the scan is found again. Usage: test_station_names.sh PROGRAM
name=test_station_names
. "$(dirname "$0")/../support/station.sh"

mkdir "$work/in"
draw 1 "$work/in/"$'bytes\xff\xc3.png'
draw 2 "$work/in/"$'lines\nfoilgauge: forged.png was measured\r\e[31m\xc2\x9b5m.png'
draw 3 "$work/in/ünï%FF 100%.png"
echo no scan >"$work/in/"$'text\xfe\nfoilgauge: forged again'
mkfifo "$work/in/fifo.png"
mkdir "$work/in/folder.png"
ln -s /dev/zero "$work/in/zero.png"
ln -s nowhere "$work/in/nowhere.png"
ln -s loop.png "$work/in/loop.png"
ln -s "ünï%FF 100%.png" "$work/in/link.png"
long=$(printf 'x%.0s' {1..251}).png
ln "$work/in/ünï%FF 100%.png" "$work/in/$long"
code=0
timeout 60 "$program" station "$work/in" $recipe --once >"$work/out" 2>"$work/said" || code=$?
# Two of them are the bytes of a third under other names: nothing is measured again under another name.
[ $code -eq 2 ] || fail "exit code $code"
grep -q "3 measured, 2 known, 1 refused" "$work/said" || fail "counts"
[ "$(grep -c '^foilgauge: ' "$work/said")" -eq "$(wc -l <"$work/said")" ] || fail "a line that is none of the program's"
[ "$(wc -l <"$work/said")" -eq 7 ] || fail "lines: $(wc -l <"$work/said")"
! grep -q '^foilgauge: forged' "$work/said" || fail "a forged line"

# Every text of every table, and every name back to the bytes that it has.
cat >"$work/read.py" <<'PY'
import os, re, sqlite3, sys
database = sqlite3.connect(sys.argv[1] + "/foilgauge.sqlite")
assert database.execute("PRAGMA user_version").fetchone()[0] >= 2
for table, in database.execute("SELECT name FROM sqlite_schema WHERE type = 'table'").fetchall():
    for row in database.execute("SELECT * FROM " + table):
        assert not any(isinstance(value, bytes) for value in row), (table, row)
def bytes_of(name):
    return re.sub(rb"/([0-9A-F]{2})", lambda found: bytes([int(found[1], 16)]), name.encode())
files = set(os.listdir(sys.argv[1].encode()))
for table in "scans", "files", "arrivals":
    names = [name for name, in database.execute("SELECT path FROM " + table)]
    assert names and all(name.isprintable() for name in names), names
    assert {bytes_of(name) for name in names} <= files, (table, names)
names = {name for name, in database.execute("SELECT path FROM files")}
assert {"bytes/FF/C3.png", "ünï%FF 100%.png", "text/FE/0Afoilgauge: forged again"} <= names, names
assert {"fifo.png", "folder.png", "zero.png", "nowhere.png", "loop.png"} & names == set(), names
PY
checks "$work/read.py" "$work/in" || fail "the database, read by Python"
! command -v sqlite3 >/dev/null || sqlite3 "$work/in/foilgauge.sqlite" .dump | iconv -f utf-8 -t utf-8 >/dev/null ||
  fail "the database, read by sqlite3"

# A database of version 1 has the bytes themselves.
python3 tests/support/older_database.py "$work/in/foilgauge.sqlite" 1
! checks "$work/read.py" "$work/in" 2>/dev/null || fail "a database of version 1 reads as one of today"
: >"$work/said"
"$program" station "$work/in" $recipe --once 2>"$work/said" || fail "the second time: exit code $?"
grep -q "0 measured, 0 known, 0 refused" "$work/said" || fail "a file is not known any more"
checks "$work/read.py" "$work/in" || fail "the database of version 1, read by Python"

# The scan is found again, on the page and in a lot.
start "$work/in" $recipe
checks - "$(cat "$work/address")" <<'PY' || fail "a report"
import re, sys, urllib.request
ask = lambda path: plain(urllib.request.urlopen(sys.argv[1] + path).read().decode())
for foil in 1, 2, 3:
    page = ask("report?foil=%d" % foil)
    assert "Residual along the foil" in page and "From the record" not in page, page[:3000]
    assert re.search("bytes/FF/C3.png|lines/0Afoilgauge: forged.png was measured/0D/1B.31m/C2/9B5m|link.png",
                     ask("foil?id=%d" % foil)), foil
PY
stop
"$program" station "$work/in" $recipe --export "$work/lots" 2>"$work/said" || fail "--export: exit code $?"
grep -q "4 foils of 3 scans\|3 foils" "$work/said" || fail "--export"
echo "names: read by other programs, no forged line, found again"
