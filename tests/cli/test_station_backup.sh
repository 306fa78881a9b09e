#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Backups: by command beside a station that runs, by the recipe with the old ones removed, and restored: with its foils, under a
# new identity, the scans after it measured again; a damaged one, one of another program, and a running station are refused.
# Usage: test_station_backup.sh PROGRAM
name=test_station_backup
. "$(dirname "$0")/../support/station.sh"
mkdir "$work/scans" "$work/kept"
for seed in 1 2; do draw $seed "$work/$seed.png"; done
sed -i 's/"design"/"station": {"backup": {"folder": "kept", "every_h": 24, "keep_days": 3}}, "design"/' "$work/recipe.json"
old=$work/kept/foilgauge-20200101-000000.sqlite
touch -d '5 days ago' "$old"
touch -d '5 days ago' "$work/kept/notes.sqlite"
# Of a clock that was ahead: it does not stand for the backups to come.
touch "$work/kept/foilgauge-20990101-000000.sqlite"
# query FILE SQL
query() {
  python3 -c 'import sqlite3, sys; print(*sqlite3.connect(sys.argv[1]).execute(sys.argv[2]).fetchone())' "$1" "$2"
}
cp "$work/1.png" "$work/scans/F1.png"
start "$work/scans" $recipe
wait_for 20 measured "$work/scans" 1
wait_for 20 test ! -e "$old"
[ -e "$work/kept/notes.sqlite" ] || fail "another file was removed"
[ "$(ls "$work/kept"/foilgauge-*.sqlite | wc -l)" = 2 ] || fail "$(ls -la "$work/kept")"
rm "$work/kept/foilgauge-20990101-000000.sqlite"
[ "$(query "$work/kept"/foilgauge-*.sqlite 'PRAGMA integrity_check')" = ok ] || fail "the recipe's backup"
"$program" station "$work/scans" --backup "$work/copy.sqlite" || fail "a backup beside the station"
! "$program" station "$work/scans" --backup "$work/copy.sqlite" 2>"$work/out" || fail "a backup was overwritten"
[ "$(query "$work/copy.sqlite" 'SELECT count(*), (SELECT count(*) FROM events) FROM foils')" = "1 1" ] || fail "the copy"
cp "$work/2.png" "$work/scans/F2.png"
wait_for 20 measured "$work/scans" 2
! "$program" station "$work/scans" --restore "$work/copy.sqlite" 2>"$work/out" || fail "restored under a station that runs"
stop INT
head -c 20000 "$work/copy.sqlite" >"$work/damaged.sqlite"
echo none >"$work/none.sqlite"
for bad in damaged none missing; do
  ! "$program" station "$work/scans" --restore "$work/$bad.sqlite" 2>"$work/out" || fail "$bad was restored"
done
[ "$(query "$work/scans/foilgauge.sqlite" 'SELECT count(*) FROM foils')" = 2 ] || fail "a refused backup changed the database"
identity=$(query "$work/copy.sqlite" 'SELECT id FROM identity')
"$program" station "$work/scans" --restore "$work/copy.sqlite" || fail "the restore"
[ "$(query "$work/scans/foilgauge.sqlite" 'SELECT count(*) FROM foils')" = 1 ] || fail "the backup's foils"
[ "$(query "$work/scans/foilgauge.sqlite" 'SELECT id FROM identity')" != "$identity" ] || fail "the old identity"
[ "$(query "$work"/scans/foilgauge.sqlite.before-* 'SELECT count(*) FROM foils')" = 2 ] || fail "the database before is gone"
start "$work/scans" $recipe
wait_for 20 measured "$work/scans" 2
[ "$(query "$work/scans/foilgauge.sqlite" "SELECT group_concat(serial) FROM (SELECT serial FROM foils ORDER BY id)")" = F1,F2 ] || fail "the scans after it"
stop INT
# A folder that cannot be written is told.
rm -r "$work/kept"
touch "$work/kept"
start "$work/scans" $recipe
wait_for 20 grep -q 'backup:' "$work/said"
python3 -c 'import sys, urllib.request; assert b"No backup." in urllib.request.urlopen(sys.argv[1]).read()' "$(cat "$work/address")" || fail "the page does not tell"
stop INT
echo "$name: by command, by the recipe, restored"
