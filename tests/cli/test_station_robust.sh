#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A station that is killed, whose disk is full, whose folder goes: nothing lost, nothing twice.
# Usage: test_station_robust.sh PROGRAM [KILLS [FAILURES]]
name=test_station_robust
. "$(dirname "$0")/../support/station.sh"
kills=${2:-3}
[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || kills=1
failures=${3:-12}
shims=$(realpath "$(dirname "$program")")/tests
at_end() {
  ! mountpoint -q "$work/full" || umount -l "$work/full"
}
# expect CODE WORDS COMMAND...: its exit code, and words of its messages.
expect() {
  local code=0 expected=$1 words=$2
  shift 2
  "$@" >/dev/null 2>"$work/said" || code=$?
  [ $code -eq "$expected" ] || fail "exit code $code, expected $expected: $*"
  grep -qF -- "$words" "$work/said" || fail "no word of '$words': $*"
}
once() {
  local folder=$1
  shift
  "$program" station "$folder" --once "$@"
}
# check FOLDER SCANS...: the database is whole, with so many scans, each once, with its foils and card.
check() {
  checks - "$@" <<'PY' || fail "the database of $1"
import sqlite3, sys
for folder, scans in zip(sys.argv[1::2], sys.argv[2::2]):
    database = sqlite3.connect(folder + "/foilgauge.sqlite")
    ask = lambda text: database.execute(text).fetchall()
    assert ask("PRAGMA integrity_check") == [("ok",)], (folder, ask("PRAGMA integrity_check"))
    assert not ask("PRAGMA foreign_key_check"), folder
    counts = ask("SELECT count(*), count(DISTINCT sha256) FROM scans")[0]
    assert counts == (int(scans),) * 2, (folder, counts)
    assert not ask("SELECT path FROM scans WHERE id NOT IN (SELECT scan FROM foils)"), folder
    assert not ask("SELECT id FROM foils WHERE id NOT IN (SELECT foil FROM measured)"), folder
    assert not ask("SELECT id FROM foils WHERE id NOT IN (SELECT foil FROM bumps)"), folder
    cards = sorted(card[0] for card in ask("SELECT scan FROM arrivals WHERE kind = 'measured'"))
    assert cards == [scan[0] for scan in ask("SELECT id FROM scans ORDER BY id")], (folder, cards)
PY
}
mkdir "$work/scans"
for seed in 1 2 3 4 5 6; do
  draw $seed "$work/scans/$seed.png"
done
tiff() { # FROM TO: a TIFF of strips, its pixels at the end
  python3 - "$1" "$2" <<'PY'
import struct, sys, zlib
data, at, pixels = open(sys.argv[1], "rb").read(), 8, b""
while at < len(data):
    length, kind = struct.unpack(">I4s", data[at:at + 8])
    body = data[at + 8:at + 8 + length]
    if kind == b"IHDR": width, height, depth, colour = struct.unpack(">IIBB", body[:10])
    if kind == b"IDAT": pixels += body
    at += length + 12
raw, channels = zlib.decompress(pixels), {0: 1, 2: 3}[colour]
stride, rows, last = width * channels, [], bytes(width * channels)
for y in range(height):
    kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
    for i in range(stride):
        a = line[i - channels] if i >= channels else 0
        b, c = last[i], last[i - channels] if i >= channels else 0
        p = a + b - c
        paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
        line[i] = (line[i] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
    last = bytes(line)
    rows.append(last[::channels])
tags = [(256, 3, 1, width), (257, 3, 1, height), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1),
        (273, 4, 1, 200), (277, 3, 1, 1), (278, 3, 1, height), (279, 4, 1, width * height),
        (282, 5, 1, 180), (283, 5, 1, 180), (296, 3, 1, 2)]
head = struct.pack("<2sHIH", b"II", 42, 8, len(tags))
head += b"".join(struct.pack("<HHII", *tag) for tag in tags) + bytes(4)
open(sys.argv[2], "wb").write((head.ljust(180, b"\0") + struct.pack("<II", 600, 1)).ljust(200, b"\0")
                              + b"".join(rows))
PY
}

# Files already in the folder: measured or refused once; a second run finds nothing new.
mkdir "$work/in"
cp "$work"/scans/[12].png "$work/in"
head -c 20000 "$work/scans/3.png" >"$work/in/half.png"
echo hello >"$work/in/notes.txt"
cp "$work/scans/1.png" "$work/in/copy.png"
head -c 3000 "$work/scans/4.png" >"$work/in/broken.png"
tail -c 12 "$work/scans/4.png" >>"$work/in/broken.png"
expect 2 "2 measured, 1 known, 3 refused" once "$work/in" $recipe
grep -q "half.png is not whole" "$work/said" || fail "half.png"
grep -q "notes.txt .*not" "$work/said" || fail "notes.txt"
expect 0 "0 measured, 0 known, 0 refused" once "$work/in" $recipe
cp "$work/scans/3.png" "$work/in/half.png"
expect 0 "1 measured, 0 known, 0 refused" once "$work/in" $recipe
check "$work/in" 3

# Databases of these versions are in use: a change of theirs is a new migration, never another of the same.
checks - "$work/in/foilgauge.sqlite" <<'PY' || fail "a version of the database is not what it was"
import hashlib, sqlite3, sys
database = sqlite3.connect(sys.argv[1])
digests = {1: "f95022470d3216694ba0dfcafafb27dc04586e7554e963ed10c5cc8a0bf1b01c"}
digests[2] = digests[1]
digests[3] = "ff984951a1c8a4cbd5d2fe83a32e11ac80671cd253bffeb3283ebf578ed95d64"
version = database.execute("PRAGMA user_version").fetchone()[0]
if version in digests:
    tables = database.execute("SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL AND name NOT LIKE "
                              "'sqlite_%' ORDER BY name").fetchall()
    digest = hashlib.sha256("\n".join(table[0] for table in tables).encode()).hexdigest()
    assert digest == digests[version], digest
PY

# Databases that are none of ours, and folders that are another's.
broken() { # WORDS STATEMENT: a database made by it
  mkdir -p "$work/other"
  rm -f "$work"/other/foilgauge.sqlite*
  python3 -c 'import sqlite3, sys
d = sqlite3.connect(sys.argv[1]); d.executescript(sys.argv[2])' "$work/other/foilgauge.sqlite" "$2"
  expect 65 "$1" once "$work/other"
}
broken "of a later program" "PRAGMA user_version = 9999"
broken "has version -1, which no program writes" "PRAGMA user_version = -1"
broken "has version -2147483648, which no program writes" "PRAGMA user_version = -2147483648"
broken "of another program" "CREATE TABLE theirs (a)"
rm -f "$work"/other/foilgauge.sqlite*
cp "$work/scans/1.png" "$work/other/foilgauge.sqlite"
expect 65 "foilgauge.sqlite: the database is damaged" once "$work/other"
expect 74 "nowhere" once "$work/nowhere"
if [ "$(id -u)" -eq 0 ]; then
  chmod 755 "$work" "$work/other"
  rm -f "$work"/other/foilgauge.sqlite*
  expect 74 "nothing can be written in this folder: Permission denied; results are kept in it: ask for permission" setpriv --reuid 65534 --clear-groups \
    "$(realpath "$program")" station "$work/other" --once
fi

# Two stations: the second is turned away.
start "$work/in" $recipe
expect 74 "another" once "$work/in" $recipe
expect 74 "another" "$program" station "$work/in" --port 0
stop

# Killed at any moment, while scans arrive.
mkdir "$work/killed" "$work/many"
python3 - "$work" $((2 * kills)) <<'PY'
import struct, sys, zlib
for i in range(int(sys.argv[2])): # the same picture with another comment is another scan
    data = open("%s/scans/%d.png" % (sys.argv[1], i % 6 + 1), "rb").read()
    text = b"tEXtComment\0%d" % i
    chunk = struct.pack(">I", len(text) - 4) + text + struct.pack(">I", zlib.crc32(text))
    open("%s/many/%d.png" % (sys.argv[1], i), "wb").write(data[:-12] + chunk + data[-12:])
PY
arrived=0
for ((kill = 0; kill < kills; kill++)); do
  start "$work/killed" $recipe
  for k in 1 2; do
    mv "$work/many/$arrived.png" "$work/killed"
    arrived=$((arrived + 1))
  done
  sleep "0.$((RANDOM % 150 + 100))"
  stop
done
once "$work/killed" $recipe 2>/dev/null || true
check "$work/killed" $arrived

# Disk full, at every few KiB of the database and its journal.
all=()
for ((kib = 2; kib < 400; kib += kib < 12 ? 5 : 75)); do
  limit=$work/limit$kib
  mkdir "$limit"
  cp "$work"/scans/[12].png "$limit"
  code=0
  (ulimit -f $kib && exec "$program" station "$limit" $recipe --once 2>&1 >/dev/null) | cat >"$work/said" || code=$?
  case $code in
    0) ;;
    74) grep -q '^foilgauge: .' "$work/said" || fail "$kib KiB without words" ;;
    *) fail "disk full at $kib KiB: exit code $code" ;;
  esac
  once "$limit" $recipe 2>/dev/null
  all+=("$limit" 2)
done
check "${all[@]}"
echo "disk full: $((${#all[@]} / 2)) places; killed: $kills times, $arrived scans"

# A header that comes byte by byte, for ever, holds no place for longer than half a minute.
if [ -n "${FOILGAUGE_TEST_LONG-}" ]; then
  start "$work/in" $recipe
  checks - "$work/address" <<'PY' || fail "a header that never ends"
import socket, sys, time, urllib.parse, urllib.request
base = open(sys.argv[1]).read().strip()
where = urllib.parse.urlparse(base)
drips = [socket.create_connection((where.hostname, where.port)) for _ in range(40)]
for drip in drips:
    drip.sendall(b"GET / HTTP/1.1\r\nX-Slow: ")
end = time.monotonic() + 36
while time.monotonic() < end:
    time.sleep(3)
    for drip in drips:
        try:
            drip.sendall(b"x")
        except OSError:
            pass
for _ in range(2):
    assert b"foilgauge" in urllib.request.urlopen(base).read()
time.sleep(0.5)
for drip in drips:
    drip.settimeout(5)
    try:
        assert drip.recv(1) == b"", "still open"
    except ConnectionResetError:
        pass
PY
  stop
fi

# A station that runs gets over a full disk.
if [ "$(id -u)" -eq 0 ] && mkdir "$work/full" && mount -t tmpfs -o size=1m tmpfs "$work/full" 2>/dev/null; then
  start "$work/full" $recipe
  # More than fits into what the journal has already.
  for scan in 1 2 3 4; do cp "$work/scans/$scan.png" "$work/full/.$scan"; done
  dd if=/dev/zero of="$work/full/.fill" bs=4k 2>/dev/null || true
  for scan in 1 2 3 4; do mv "$work/full/.$scan" "$work/full/$scan.png"; done
  wait_for 20 grep -q "(it is tried again)" "$work/said"
  checks - "$work/address" <<'PY' || fail "the page does not say that the disk is full"
import sys, urllib.request
wait_until(lambda: "Nothing is kept now" in urllib.request.urlopen(open(sys.argv[1]).read().strip()).read().decode(), 20)
PY
  rm "$work/full/.fill"
  wait_for 20 measured "$work/full" 4
  wait_for 20 grep -q "the station goes on" "$work/said"
  stop
  check "$work/full" 4
  umount -l "$work/full"
fi

# The folder goes and comes back; another comes in its place; the database is taken away.
: >"$work/said"
mkdir "$work/moves"
start "$work/moves" $recipe
cp "$work/scans/1.png" "$work/moves/1.png"
wait_for 20 measured "$work/moves" 1
mv "$work/moves" "$work/away"
wait_for 20 grep -q "the folder is gone" "$work/said"
cp "$work/scans/2.png" "$work/away/2.png"
mv "$work/away" "$work/moves"
wait_for 20 measured "$work/moves" 2
mv "$work/moves" "$work/first"
mkdir "$work/moves"
cp "$work/scans/3.png" "$work/moves/3.png"
wait_for 20 measured "$work/moves" 1
rm "$work"/moves/foilgauge.sqlite*
cp "$work/scans/4.png" "$work/moves/4.png"
wait_for 20 measured "$work/moves" 2
check "$work/first" 2
expect 0 "0 measured" once "$work/first" $recipe
mv "$work/moves" "$work/second"
mv "$work/first" "$work/moves"
cp "$work/scans/5.png" "$work/moves/5.png"
wait_for 20 measured "$work/moves" 3
stop
check "$work/moves" 3
check "$work/second" 2

# Told of nothing: files are taken when they are at rest, and no card comes before.
mkdir "$work/poll"
sed 's/1200/600/' "$work/spec.json" >"$work/small.json"
"$renderer" render "$work/small.json" -o "$work/small.png"
tiff "$work/small.png" "$work/whole.tif"
start "$work/poll" $recipe --poll 0.2
cp "$work/scans/2.png" "$work/poll/b.png"
wait_for 20 measured "$work/poll" 1
half=$(($(stat -c %s "$work/whole.tif") / 2))
began_ms=$(date +%s%3N)
head -c $half "$work/whole.tif" >"$work/poll/a.tif"
sleep 0.7
tail -c +$((half + 1)) "$work/whole.tif" >>"$work/poll/a.tif"
paused_ms=$(($(date +%s%3N) - began_ms))
wait_for 20 measured "$work/poll" 2
stop
check "$work/poll" 2
[ $paused_ms -gt 1800 ] || checks - "$work/poll/foilgauge.sqlite" <<'PY' || fail "a card before the scan was whole"
import sqlite3, sys
cards = sqlite3.connect(sys.argv[1]).execute("SELECT path, kind FROM arrivals").fetchall()
assert sorted(cards) == [("a.tif", "measured"), ("b.png", "measured")]
PY

# Memory that runs out, and a disk that is full, at any call.
if ldd "$program" | grep libasan >/dev/null || [ ! -e "$shims/libfailing_malloc.so" ]; then
  exit 0
fi
failing() { # SHIM VARIABLE AT FOLDER [VARIABLE=VALUE]
  mkdir "$4"
  cp "$work/scans/1.png" "$4"
  code=0
  env LD_PRELOAD="$shims/$1" "$2=$3" "${@:5}" "$program" station "$4" $recipe --once \
    >/dev/null 2>"$work/said" || code=$?
}
# at_calls SHIM VARIABLE NAME [VARIABLE=VALUE]: one failure after the other; nothing is lost by any.
at_calls() {
  failing "$1" "$2" 0 "$work/$3"
  local total all=()
  total=$(sed -En 's/^(allocations|writes): //p' "$work/said")
  for ((at = 1; at <= total; at += total / failures + 1)); do
    failing "$1" "$2" $at "$work/$3$at" "${@:4}"
    case $code in
      0) ;;
      2 | 71 | 74) grep -q '^foilgauge: .' "$work/said" || fail "$3 at $at of $total: no words" ;;
      *) fail "$3 at $at of $total: exit code $code" ;;
    esac
    once "$work/$3$at" $recipe 2>/dev/null || true
    all+=("$work/$3$at" 1)
  done
  check "${all[@]}"
  echo "$3: $((${#all[@]} / 2)) failures over $total"
}
at_calls libfailing_malloc.so FOILGAUGE_FAIL_AT allocations
at_calls libfull_disk.so FOILGAUGE_FULL_AT writes
at_calls libfull_disk.so FOILGAUGE_FULL_AT single_writes FOILGAUGE_FULL_ONCE=1
