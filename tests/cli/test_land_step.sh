#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Rows that jump across the lands make R0 wrong: its u holds that, and the foil is flagged. Sound foils are not. A row that stands
# twice is found by its noise.
. tests/support/cli.sh

# foil NAME TURN EFFECTS: measures a scan; R0 within U of 20.9 mm; NAME.flags has its flags.
foil() {
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": 37, \"foils\": [{\"overall_radius_mm\": 20.9, \"rotate_deg\": $2}],
    \"scanner\": {\"dpi\": 1200, \"noise\": 2, \"blur_px\": 1.3}, \"effects\": [$3]}" >"$1.spec"
  "$renderer" render "$1.spec" -o "$1.png" || fail "render $1"
  expect 0 "" "$program" measure "$1.png" -o "$1.json"
  value "$1.json" '" ".join(r["foils"][0]["flags"])' >"$1.flags"
  near "R0 of $1" "$(value "$1.json" 'r["foils"][0]["overall"]["radius_mm"]')" 20.9 \
    "$(value "$1.json" '2 * r["foils"][0]["overall"]["u_radius_mm"]')"
}
# The last one displaces lands in the middle of the foil.
for jump in -35,18.5 -24,19.4 -13,20.3 -90,3; do
  foil "jump_$jump" "${jump%,*}" "{\"id\": \"scan.row_step\", \"amplitude_um\": -12, \"y_mm\": ${jump#*,}}"
  grep -qw land_deviates "jump_$jump.flags" || fail "rows that jump at ${jump#*,} mm have no flag: $(cat "jump_$jump.flags")"
done
for turn in -90 -35 20; do
  foil "sound_$turn" $turn ""
  [ ! -s "sound_$turn.flags" ] || [ "$(cat "sound_$turn.flags")" = "" ] || fail "a sound foil has flags: $(cat "sound_$turn.flags")"
  near "u of R0 of sound_$turn" "$(value "sound_$turn.json" '1000 * r["foils"][0]["overall"]["u_radius_mm"]')" 0.2 0.2
done

# Two scans of the sound foil, in each of which a row stands twice: doubled_455.png, doubled_640.png.
/usr/bin/python3 - sound_-35.png 455 640 <<'P'
import struct, sys, zlib

data = open(sys.argv[1], "rb").read()
chunks, at = [], 8
while at < len(data):
    size = struct.unpack(">I", data[at:at + 4])[0]
    chunks.append((data[at + 4:at + 8], data[at + 8:at + 8 + size]))
    at += size + 12
width, height, bits, colour = struct.unpack(">IIBB", chunks[0][1][:10])
raw = zlib.decompress(b"".join(body for name, body in chunks if name == b"IDAT"))
before, rows = bytes(width), []
for y in range(height):
    kind, line = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1:(y + 1) * (width + 1)])
    for x in range(width):
        a, b, c = (line[x - 1] if x else 0), before[x], (before[x - 1] if x else 0)
        p = a + b - c
        paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
        line[x] = (line[x] + [0, a, b, (a + b) // 2, paeth][kind]) & 255
    before = bytes(line)
    rows.append(b"\0" + before)
head = struct.pack(">II", width, height + 1) + chunks[0][1][8:]
for row in map(int, sys.argv[2:]):
    body = zlib.compress(b"".join([*rows[:row], rows[row], *rows[row:]]), 1)
    with open(f"doubled_{row}.png", "wb") as out:
        out.write(data[:8])
        for name, part in [(b"IHDR", head), *[c for c in chunks if c[0] == b"pHYs"], (b"IDAT", body), (b"IEND", b"")]:
            out.write(struct.pack(">I", len(part)) + name + part + struct.pack(">I", zlib.crc32(name + part)))
P
for row in 455 640; do
  "$program" measure "doubled_$row.png" -o doubled.json || [ $? = 1 ] || fail "measure doubled_$row.png"
  value doubled.json '" ".join(r["foils"][0]["flags"])' | grep -qw row_jumps || fail "row $row stands twice and has no flag"
done
exit $failed
