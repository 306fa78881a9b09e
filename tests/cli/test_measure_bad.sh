#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge measure` and what cannot be measured: the exit code, words that help, and no file left.
. tests/support/cli.sh
cd "$root" || exit 1
folder=$work
out=$folder/out
mkdir "$out"

# check CODE WORDS FILE [OPTION...]: measure's exit code and words (a regular expression) on
# standard error. Where it wrote no report, nothing may lie in the folder of outputs.
check() {
  local code=$1 words=$2 scan=$3
  shift 3
  "$program" measure "$scan" -o "$out/a.json" --overlay "$out/a.png" --points "$out/a.csv" "$@" \
    >"$folder/stdout" 2>"$folder/stderr" </dev/null
  local got=$?
  [ $got = "$code" ] || fail "exit $got, not $code: $scan $* ($(head -c 300 "$folder/stderr"))"
  [ -z "$words" ] || grep -qE "$words" "$folder/stderr" || fail "$scan $*: no '$words' in: $(cat "$folder/stderr")"
  if [ $got -gt 2 ]; then
    [ -z "$(ls -A "$out")" ] || fail "$scan $*: left $(ls -A "$out")"
  else
    cp "$out/a.json" "$folder/last.json"
  fi
  rm -rf "$out"
  mkdir "$out"
}

# has WORDS: the last report holds them.
has() {
  grep -qE "$1" "$folder/last.json" || fail "no '$1' in the report of $2"
}

# render NAME MEMBERS: a foil of three bumps, or what MEMBERS say.
render() {
  echo "{\"schema\":\"foilgauge/render/1\",\"seed\":2,$2}" >"$folder/$1.spec"
  "$program" render "$folder/$1.spec" -o "$folder/$1.png" || fail "render $1"
}
foil='{"design":{"bump_count":3}}'
render good "\"foils\":[$foil]"
good=$folder/good.png
echo '{"schema":"foilgauge/design/1","bump_count":3}' >"$folder/three.design"

# Files that are no scan.
: >"$folder/empty.png"
check 65 'empty.png: is empty' "$folder/empty.png"
echo 'Dear scanner,' >"$folder/text.png"
check 65 'text.png: is a text' "$folder/text.png"
check 74 'is a folder' "$folder"
check 74 'is a folder; give the name of a file' "$good" --design "$folder"
check 74 'lost.png: cannot be opened' "$folder/lost.png"
"$program" measure - -o "$out/a.json" </dev/null 2>"$folder/stderr"
code=$?
[ $code = 65 ] && grep -q 'standard input: is empty' "$folder/stderr" || fail "exit $code of no input"

# Truncated anywhere; and one flipped bit in the header, in the data and in a checksum.
size=$(stat -c %s "$good")
for cut in 1 7 8 20 33 40 57 100 1000 $((size / 3)) $((size / 2)) $((size - 13)) $((size - 1)); do
  head -c "$cut" "$good" >"$folder/cut.png"
  check 65 'cut.png: ' "$folder/cut.png"
done
for at in 20 30 60 $((size / 2)) $((size - 14)); do
  cp "$good" "$folder/flip.png"
  byte=$(od -An -tu1 -j"$at" -N1 "$good" | tr -d ' ')
  printf "\\x$(printf %x $((byte ^ 16)))" |
    dd of="$folder/flip.png" bs=1 seek="$at" conv=notrunc status=none
  check 65 'flip.png: ' "$folder/flip.png"
done

# A header alone, that promises more pixels than the file can hold.
header() { # NAME WIDTH HEIGHT, as four bytes each in octal escapes
  printf '\211PNG\r\n\032\n\0\0\0\rIHDR'"$2$3"'\010\0\0\0\0' >"$folder/$1.png"
  local crc
  crc=$(tail -c +13 "$folder/$1.png" | gzip -c | tail -c 8 | od -An -tx1 -N4 | tr -d ' \n')
  printf "\\x${crc:6:2}\\x${crc:4:2}\\x${crc:2:2}\\x${crc:0:2}" >>"$folder/$1.png"
}
header huge '\077\377\377\377' '\077\377\377\377'
check 65 'huge.png: ' "$folder/huge.png"
header zero '\0\0\0\0' '\0\0\0\001'
check 65 'zero.png: ' "$folder/zero.png"

# Nothing to measure.
render blank '"width_px":900,"height_px":700,"foils":[],"discs":[{"centre_mm":[-5,-5],"radius_mm":0.1}]'
check 65 'no foil in the picture' "$folder/blank.png"
render noise '"width_px":900,"height_px":700,"foils":[],"discs":[{"centre_mm":[-5,-5],"radius_mm":0.1}],
  "scanner":{"background":100,"contrast":100,"noise":15}'
check 65 'no foil in the picture' "$folder/noise.png"
render dust '"width_px":1500,"height_px":1200,"foils":[],"discs":[{"centre_mm":[-5,-5],"radius_mm":0.1}],
  "scanner":{"dust":{"count":300,"radius_px":4,"contrast":100},
  "specks":{"count":40,"radius_px":14,"contrast":150}}'
check 65 'no foil in the picture \([1-9][0-9]* specks' "$folder/dust.png"
render coin '"width_px":1500,"height_px":1200,"foils":[],"discs":[{"centre_mm":[4,3],"radius_mm":2}]'
check 65 'no foil in the picture \([1-9]' "$folder/coin.png"
render coarse "\"foils\":[$foil],\"scanner\":{\"dpi\":150}"
check 65 'at 150 dpi a strip of 0.1 mm is 0.6 pixels wide; is .* wrong\? if not, scan at 600 dpi or more' "$folder/coarse.png"

# 12 bits in a file of 16 are dark. They are not few levels; where no foil stands out, they are named. A dark picture of 8 bits gets no such words.
python3 - "$good" "$folder" <<'PY' || fail "12 bits"
import struct, sys, zlib
data, at, packed = open(sys.argv[1], "rb").read(), 8, b""
while at < len(data):
    size, kind = struct.unpack(">I4s", data[at:at + 8])
    body, at = data[at + 8:at + 8 + size], at + 12 + size
    if kind == b"IHDR":
        width, height, bits, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
        assert (bits, colour, interlaced) == (8, 0, 0)
    packed += body if kind == b"IDAT" else b""
raw, row, rows = zlib.decompress(packed), bytes(width), []
def predict(kind, left, up, corner):
    near = sorted((left, up, corner), key=lambda value: abs(left + up - corner - value))
    return (0, left, up, (left + up) // 2, near[0])[kind]
for y in range(height):
    kind, line, left, corner = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1:(y + 1) * (width + 1)]), 0, 0
    if kind:
        for x in range(width):
            line[x] = (line[x] + predict(kind, left, row[x], corner)) & 255
            left, corner = line[x], row[x]
    row = bytes(line)
    rows.append(row)
for name, factor in ("dark", 16), ("bright", 256), ("darker", 4):
    with open(f"{sys.argv[2]}/{name}.pgm", "wb") as out:
        out.write(b"P5 %d %d 65535\n" % (width, height))
        for row in rows:
            out.write(struct.pack(">%dH" % width, *(value * factor for value in row)))
PY
check 0 '' "$folder/bright.pgm" --dpi 4800
cp "$folder/last.json" "$folder/bright.json"
check 0 '' "$folder/dark.pgm" --dpi 4800
grep -q few_levels "$folder/last.json" "$folder/stderr" && fail "12 bits are called few levels"
python3 - "$folder/bright.json" "$folder/last.json" <<'PY' || fail "12 bits: other radii"
import json, sys
bright, dark = ([bump["radius_mm"] for bump in json.load(open(path))["foils"][0]["bumps"]] for path in sys.argv[1:])
assert len(bright) == len(dark) == 3 and all(abs(a - b) < 1e-4 for a, b in zip(bright, dark)), (bright, dark)
PY
check 65 'brightest place has [0-9]{3} of 65535: are they 12 bits in a file of 16\? if so, multiply all values by 16' \
  "$folder/darker.pgm" --dpi 4800
render black '"width_px":900,"height_px":700,"foils":[],"discs":[{"centre_mm":[-5,-5],"radius_mm":0.1}],
  "scanner":{"background":5,"contrast":3}'
check 65 'is the scan empty' "$folder/black.png"

# A foil that is cut, or touches another: measured as far as it goes, and flagged.
render cut "\"width_px\":4300,\"height_px\":1200,
  \"foils\":[{\"design\":{\"bump_count\":5},\"centre_mm\":[6,24]}]"
check 0 '' "$folder/cut.png"
has '"touches_border"' cut
has '"radius_mm": 3\.[34]' cut
render touch "\"width_px\":7400,\"height_px\":1400,\"foils\":[
  {\"design\":{\"bump_count\":4},\"centre_mm\":[14,24]},
  {\"design\":{\"bump_count\":4},\"centre_mm\":[29.5,24]}]"
"$program" measure "$folder/touch.png" >"$folder/last.json" 2>"$folder/stderr"
code=$?
[ $code -le 2 ] || fail "exit $code of touching foils"
has '"touches_other"' touch
# Foils that cross are good foils: the line goes over from one to the other (7 bumps), or ends (1 bump). Neither fails.
cat >"$folder/five.design" <<'J'
{"schema":"foilgauge/design/1","bump_count":5,"calibration":"not needed: the scan is rendered",
 "tolerances":{"height_mm":{"min":0.5,"max":0.6}}}
J
five='{"design":{"bump_count":5},"centre_mm":[24,24]}'
for second in '24.615],"rotate_deg":-83.33' '24.3],"rotate_deg":-85'; do
  render cross "\"foils\":[$five,{\"design\":{\"bump_count\":5},\"centre_mm\":[24,$second}],\"scanner\":{\"dpi\":1200}"
  check 2 '' "$folder/cross.png" --design "$folder/five.design"
  has 'another part touches it, and its line has [0-9]+ bumps? where the design has 5: lay the parts apart' "$second"
  if grep -q '"verdict": "fail"' "$folder/last.json"; then fail "a foil that crosses another fails: $second"; fi
done

# The resolution: impossible, missing, and one that makes the foil another size than its design.
for dpi in 0 -4800 nan inf x 1e9 ''; do
  check 64 'dpi' "$good" --dpi "$dpi"
done
{ head -c 33 "$good"; tail -c +55 "$good"; } >"$folder/unknown.png" # without its pHYs chunk
check 65 'unknown.png: .*resolution.*--dpi' "$folder/unknown.png"
check 0 '' "$folder/unknown.png" --dpi 4800
for dpi in 100 300 1200 2400 9600 19200; do
  check 65 "resolution of $dpi dpi wrong" "$good" --dpi "$dpi"
done
check 2 'good.png: foil 1 could not be measured: .*resolution.*--dpi' "$good" --dpi 3600
has '"not_measured"' 3600

# Designs.
bad_design() { # WORDS MEMBERS
  echo "{\"schema\":\"foilgauge/design/1\"$2}" >"$folder/bad.design"
  check 65 "bad.design: .*$1" "$good" -d "$folder/bad.design"
}
four='"bump_radius_mm":3.32,"bump_angle_deg":63.15,"overall_radius_mm":20.73,"thickness_mm":0.1'
bad_design bump_angle_deg ',"bump_radius_mm":3.32,"overall_radius_mm":20.73,"thickness_mm":0.1'
bad_design bump_radius_mm ",${four/3.32/-3.32}"
bad_design thickness_mm ",${four/0.1/0}"
bad_design bump_angle_deg ",${four/63.15/400}"
bad_design 'overall|bump_radius_mm' ",${four/3.32/332}"
bad_design pitch_deg ',"pitch_deg":2'
bad_design bump_count ',"bump_count":-3'
check 74 'lost.design' "$good" -d "$folder/lost.design"
echo '{"schema":"foilgauge/design/1",' >"$folder/bad.design"
check 65 'bad.design' "$good" -d "$folder/bad.design"

# Outputs that cannot be written.
check 74 'none/b.csv' "$good" --csv "$out/none/b.csv"
[ -e /dev/full ] && check 74 '/dev/full' "$good" --html /dev/full

# One bad scan among good ones: the good are reported, the bad are named.
for bad in empty lost cut; do
  [ $bad = cut ] && head -c 1000 "$good" >"$folder/cut.png"
  "$program" measure "$folder/$bad.png" "$good" -d "$folder/three.design" -o "$out/a.json" \
    2>"$folder/stderr"
  code=$?
  [ $code = 2 ] || fail "exit $code, not 2, with $bad.png among the scans"
  grep -q "$bad.png" "$folder/stderr" || fail "$bad.png is not named"
  [ "$(grep -c '"bump_angle_deg"' "$out/a.json")" -ge 3 ] || fail "the good scan is not reported"
  rm -f "$out/a.json"
done

exit $failed
