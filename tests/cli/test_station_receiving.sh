#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A writer that pauses is waited for: RECEIVING, no card; when nothing more comes, the error. A scan
# that comes again under the serial number of another foil is no measurement of that foil. Of a file
# of two images the page says that it shows one.
# Usage: test_station_receiving.sh PROGRAM
name=test_station_receiving
. "$(dirname "$0")/../support/station.sh"
for seed in 1 2 3; do
  printf '{"schema": "foilgauge/render/1", "seed": %s, "scanner": {"dpi": 1200},
    "foils": [{"rotate_deg": -90, "design": {"bump_count": 2}}]}' $seed >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$work/$seed.png"
done
mkdir "$work/in"
cat >"$work/recipe.json" <<'R'
{"schema": "foilgauge/recipe/1", "station": {"file_name": "{lot}_{serial}", "receive_s": 4},
 "design": {"schema": "foilgauge/design/1", "bump_count": 2, "calibration": "not needed: the scan is rendered", "tolerances": {"radius_mm": {"min": 3, "max": 3.6}}}}
R
"$program" station "$work/in" --recipe "$work/recipe.json" --port 0 >"$work/address" 2>"$work/err" &
station=$!
checks - "$work" >&2 <<'PY' || fail "$(cat "$work/err")"
import os, re, shutil, sqlite3, struct, sys, time, urllib.request, zlib
work = sys.argv[1]
folder = work + "/in/"
RECEIVE_S = 4
base = wait_until(lambda: open(work + "/address").read().strip()).rstrip("/")
def page(path="/"):
    return plain(urllib.request.urlopen(base + path).read().decode())
def call():
    found = re.search(r'<div class="call [^>]*><b>(.*?)</b><span>(.*?)<br>', page())
    return found.groups() if found else ("", "")
def cards():
    return [tuple(row) for row in sqlite3.connect(folder + "foilgauge.sqlite").execute(
        "SELECT path, kind FROM arrivals ORDER BY id")]

shutil.copy(work + "/1.png", folder + ".a")
os.rename(folder + ".a", folder + "7_1.png")
wait_until(lambda: call() == ("PASS", "7_1.png"))

# The writer closes the file and goes on three seconds later, twice; the large letters do not show the old PASS.
whole = open(work + "/2.png", "rb").read()
third = len(whole) // 3
for part in whole[:third], whole[third:2 * third]:
    open(folder + "7_2.png", "ab").write(part)
    wait_until(lambda: call() == ("RECEIVING", "7_2.png"))
    until = time.time() + RECEIVE_S - 1
    while time.time() < until:
        assert call() == ("RECEIVING", "7_2.png"), call()
        time.sleep(0.1)
    assert "Before it: 7_1.png PASS" in page()
open(folder + "7_2.png", "ab").write(whole[2 * third:])
wait_until(lambda: call() == ("PASS", "7_2.png"))
assert cards() == [("7_1.png", "measured"), ("7_2.png", "measured")], cards()

# A file that is received and taken away again leaves the earlier result.
open(folder + "7_x.png", "wb").write(whole[:third])
wait_until(lambda: call() == ("RECEIVING", "7_x.png"))
os.remove(folder + "7_x.png")
wait_until(lambda: call() == ("PASS", "7_2.png"))

# A writer that never goes on: after RECEIVE_S the page names the missing part.
open(folder + "7_3.png", "wb").write(whole[:third])
began = time.time()
wait_until(lambda: call() == ("RECEIVING", "7_3.png"))
wait_until(lambda: call() == ("SCAN AGAIN", "7_3.png"))
assert RECEIVE_S - 1 < time.time() - began < RECEIVE_S + 5, time.time() - began
assert "its end is missing" in page()

# PNM is read to its end before it is known to be cut off. A file that is damaged otherwise is known at once.
def pnm(source):
    data, at, pixels = open(source, "rb").read(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR": width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        at += length + 12
    return b"P5\n# resolution 1200\n%d %d\n255\n" % (width, height) + bytes(width * height)
empty = pnm(work + "/1.png")
open(folder + "7_4.pgm", "wb").write(empty[:len(empty) // 2])
wait_until(lambda: call() == ("RECEIVING", "7_4.pgm"))
time.sleep(RECEIVE_S - 1)
assert call() == ("RECEIVING", "7_4.pgm"), call()
wait_until(lambda: call() == ("SCAN AGAIN", "7_4.pgm"))
assert "cannot hold" in page()
began = time.time()
open(folder + "7_5.pgm", "wb").write(empty)
wait_until(lambda: call() == ("SCAN AGAIN", "7_5.pgm"))
assert time.time() - began < RECEIVE_S - 1, time.time() - began

# The bytes of another foil's scan: no PASS, and no colour of one. Of the same foil: measured before.
shutil.copy(work + "/1.png", folder + "7_8.png")
wait_until(lambda: call() == ("SAME SCAN", "7_8.png"))
assert "it shows foil 1, and says nothing of foil 8" in page()
assert 'class="call pass' not in page() and "<h2 id=\"foil" not in page()
shutil.copy(work + "/1.png", folder + "8_1.png")
wait_until(lambda: call() == ("SAME SCAN", "8_1.png"))
os.utime(folder + "7_1.png")
wait_until(lambda: call() == ("MEASURED BEFORE", "7_1.png"))
shutil.copy(work + "/2.png", folder + "7_2.PNG")
wait_until(lambda: call() == ("MEASURED BEFORE", "7_2.PNG"))
assert sorted(set(kind for path, kind in cards())) == ["duplicate", "known", "measured", "unfinished", "unreadable"]

# A TIFF of two images, as scanners write several pages: the second foil is not measured, and the page says so.
def rows_of(path):
    data, at, packed = open(path, "rb").read(), 8, b""
    while at < len(data):
        length, = struct.unpack_from(">I", data, at)
        kind, chunk = data[at + 4:at + 8], data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height = struct.unpack_from(">II", chunk)
        packed += chunk if kind == b"IDAT" else b""
        at += 12 + length
    raw, above, rows = zlib.decompress(packed), bytes(width), []
    paeth = lambda a, b, c: min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
    for y in range(height):
        kind, row = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1:(y + 1) * (width + 1)])
        for x in range(width if kind else 0):
            a, b, c = row[x - 1] if x else 0, above[x], above[x - 1] if x else 0
            row[x] = row[x] + (a, b, (a + b) // 2, paeth(a, b, c))[kind - 1] & 255
        rows.append(bytes(row))
        above = row
    return width, height, b"".join(rows)
tiff, images = b"II*\0\0\0\0\0", [rows_of(work + "/%d.png" % seed) for seed in (2, 3)]
next_at = 4
for width, height, pixels in images:
    place = len(tiff)
    tiff += pixels + struct.pack("<II", 1200, 1) + b"\0" * (len(pixels) % 2)
    directory = len(tiff)
    tags = [(256, 4, width), (257, 4, height), (258, 3, 8), (259, 3, 1), (262, 3, 1), (273, 4, place), (277, 3, 1), (278, 4, height),
            (279, 4, len(pixels)), (282, 5, place + len(pixels)), (283, 5, place + len(pixels)), (296, 3, 2)]
    tiff += struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags) + b"\0" * 4
    tiff = tiff[:next_at] + struct.pack("<I", directory) + tiff[next_at + 4:]
    next_at = len(tiff) - 4
open(folder + "7_9.tif", "wb").write(tiff)
wait_until(lambda: call()[1] == "7_9.tif" and call()[0] in ("PASS", "FAIL", "MEASURED"))
assert "it holds more than one image: only the first was measured" in page()
PY
kill "$station"
wait "$station" 2>/dev/null || true
station=
code=0
mkdir "$work/once"
cp "$work/1.png" "$work/once/7_1.png"
cp "$work/1.png" "$work/once/7_2.png"
"$program" station "$work/once" --recipe "$work/recipe.json" --once >/dev/null 2>"$work/err" || code=$?
[ $code -eq 2 ] || fail "--once with a scan under two serial numbers: exit code $code"
echo "receiving: pauses, gone files, missing ends, the same scan again"
