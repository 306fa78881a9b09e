#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The end of a station: after a signal everything is in the database's one file, whoever else reads it, whatever hangs on;
# and while it runs, every measurement is in that file some seconds later. Usage: test_station_ends.sh PROGRAM
name=test_station_ends
. "$(dirname "$0")/../support/station.sh"
reader=
at_end() {
  [ -z "$reader" ] || kill -9 "$reader" 2>/dev/null || true
}

# alone COUNT: so many scans in the file itself, without its journal.
alone() {
  rm -rf "$work/copy"
  mkdir "$work/copy"
  cp "$work/in/foilgauge.sqlite" "$work/copy"
  measured "$work/copy" "$1"
}

mkdir "$work/in"
scans=0
for signal in INT TERM HUP; do
  start "$work/in" $recipe
  scans=$((scans + 1))
  draw $scans "$work/in/$scans.png"
  wait_for 20 measured "$work/in" $scans
  stop $signal
  [ $code -eq 130 ] || fail "$signal: exit code $code"
  alone $scans || fail "$signal: not all is in the file"
  [ ! -e "$work/in/foilgauge.sqlite-wal" ] || fail "$signal: the journal is still there"
done

# While it runs.
start "$work/in" $recipe
scans=$((scans + 1))
draw $scans "$work/in/$scans.png"
wait_for 20 measured "$work/in" $scans
wait_for 12 alone $scans

# Another program has the database open, somebody waits for news, somebody sends half a request, a scan command runs.
stop TERM
cat >"$work/recipe.json" <<'R'
{"schema": "foilgauge/recipe/1", "station": {"scan_command": "sleep 300; touch {file}"},
 "design": {"schema": "foilgauge/design/1", "bump_count": 2}}
R
start "$work/in" $recipe
scans=$((scans + 1))
draw $scans "$work/in/$scans.png"
wait_for 20 measured "$work/in" $scans
cat >"$work/hang.py" <<'PY'
import re, socket, sqlite3, sys, time, urllib.parse, urllib.request
base, file = sys.argv[1:]
where = urllib.parse.urlparse(base)
database = sqlite3.connect(file)
database.execute("SELECT count(*) FROM scans").fetchone()
form = re.search('name="form" value="([0-9a-f]+)"', urllib.request.urlopen(base).read().decode())[1]
urllib.request.urlopen(base + "scan", ("form=" + form).encode()).read()
last = re.search(rb"id: (\d+)", urllib.request.urlopen(base + "events").read())[1]
open_ = [socket.create_connection((where.hostname, where.port)) for _ in range(8)]
for one in open_[:4]:
    one.sendall(b"GET /events HTTP/1.1\r\nHost: %s\r\nLast-Event-ID: %s\r\n\r\n" % (where.netloc.encode(), last))
for one in open_[4:]:
    one.sendall(b"POST /close HTTP/1.1\r\nHost: %s\r\nContent-Length: 9\r\n\r\nx" % where.netloc.encode())
print("ready", flush=True)
time.sleep(60)
PY
python3 "$work/hang.py" "$(cat "$work/address")" "$work/in/foilgauge.sqlite" >"$work/hangs" 2>>"$work/said" &
reader=$!
wait_for 20 grep -q ready "$work/hangs"
began=$SECONDS
stop TERM
[ $code -eq 130 ] || fail "exit code $code"
[ $((SECONDS - began)) -lt 8 ] || fail "took $((SECONDS - began)) s to end"
alone $scans || fail "not all is in the file while another program reads"
kill -9 $reader && wait $reader 2>/dev/null || true
reader=

# In the middle of many scans, measured once.
mkdir "$work/many"
for ((i = 0; i < 40; i++)); do
  cp "$work/in/1.png" "$work/many/$i.png"
  printf '%s' $i >>"$work/many/$i.png"
  tail -c 12 "$work/in/1.png" >>"$work/many/$i.png"
done
env --default-signal=INT "$program" station "$work/many" $recipe --once 2>>"$work/said" &
station=$!
wait_for 20 test -e "$work/many/foilgauge.sqlite"
stop INT
[ $code -eq 130 ] || [ $code -eq 0 ] || fail "--once: exit code $code"
"$program" station "$work/many" $recipe --once 2>"$work/said" || fail "--once again: exit code $?"
echo "ends: by signals, beside readers, in the middle"
