#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A folder with very many files, most of which are none of the station's business: it goes on, says so, and a scan that
# comes is measured at once; a folder that is removed and made again, twice, is found again.
# Usage: test_station_crowd.sh PROGRAM [FILES]
name=test_station_crowd
. "$(dirname "$0")/../support/station.sh"
files=${2:-100500}

# In memory where there is room: so many files take a disk its time.
many=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
at_end() {
  rm -rf "$many"
}
# FILES small files, all but the last 600 known as another day's.
draw 1 "$work/scan.png"
"$program" station "$many" $recipe --once 2>/dev/null
python3 - "$many" "$files" <<'PY'
import os, sqlite3, sys
folder, files = sys.argv[1], int(sys.argv[2])
database = sqlite3.connect(folder + "/foilgauge.sqlite")
database.execute("INSERT INTO arrivals (id, at, path, kind, message) VALUES (1, 0, 'all', 'foreign', '')")
for i in range(files):
    name = "%06d.txt" % i
    with open(folder + "/" + name, "w") as file:
        file.write("text")
    if i < files - 600:
        status = os.stat(folder + "/" + name)
        database.execute("INSERT INTO files VALUES (?, ?, ?, 1)", (name, status.st_size, status.st_mtime_ns))
database.commit()
PY
ms() {
  date +%s%3N
}
began=$(ms)
start "$many" $recipe
cp "$work/scan.png" "$many/.scan"
mv "$many/.scan" "$many/scan.png"
wait_for 30 measured "$many" 1
first=$(($(ms) - began))
[ "$(grep -cE "The folder holds [0-9]{6,} files; looking" "$work/said")" -eq 1 ] || fail "no word of many files, or too many"
began=$(ms)
checks - "$(cat "$work/address")" <<'PY' || fail "the page does not say that there are very many files"
import sys, urllib.request
page = plain(urllib.request.urlopen(sys.argv[1]).read().decode())
assert "Very many files" in page, page
PY
page=$(($(ms) - began))
memory=$(awk '/VmHWM/ { print int($2 / 1024) }' "/proc/$station/status")
[ "$memory" -lt 200 ] || fail "$memory MiB"
find "$many" -name '*.txt' -newermt 2000-01-01 -delete
draw 2 "$work/scan2.png"
cp "$work/scan2.png" "$many/scan2.png"
wait_for 20 measured "$many" 2
stop TERM
[ $code -eq 130 ] || fail "exit code $code"

# Removed and made again, twice, while somebody else stands in it. Beside other tests it may take its two seconds longer.
again=0
most=${FOILGAUGE_TEST_LONG:+2000}
most=${most:-8000}
for gap in 0 0.3 1; do
  rm -rf "$work/gone"
  mkdir "$work/gone"
  start "$work/gone" $recipe
  (cd "$work/gone" && exec sleep 60) &
  inside=$!
  sleep 0.3
  for round in 1 2; do
    while ! rm -rf "$work/gone" 2>/dev/null; do :; done
    sleep $gap
    mkdir "$work/gone"
    sleep $gap
  done
  began=$(ms)
  cp "$work/scan.png" "$work/gone/scan.png"
  wait_for 20 measured "$work/gone" 1
  took=$(($(ms) - began))
  [ $took -lt $most ] || fail "the folder was back after $took ms"
  [ $took -lt $again ] || again=$took
  stop
  kill $inside && wait $inside 2>/dev/null || true
done
echo "crowd: $files files, scan after $first ms, page after $page ms, $memory MiB; folder back after $again ms at most"
