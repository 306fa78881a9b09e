#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The channels of a colour scan against each other: distances, the flag, the profile along y, and scans that have no such.
. tests/support/cli.sh
skip_when_slow # test_loop_scan.sh and the tests of pictures see the same code

# draw NAME LINES [EFFECTS]: a coarse foil with those colour lines.
draw() {
  cat >"$1.spec.json" <<SPEC
{"schema": "foilgauge/render/1", "seed": 5, "effects": [${3-}],
 "scanner": {"dpi": 1200, "colour_lines": {$2}}}
SPEC
  "$renderer" render "$1.spec.json" -o "$1.png" --truth "$1.truth.json" || fail "$1 is not drawn"
}

# within NAME QUANTITY CHANNEL TRUTH: the value lies within 4 u of it, and u is small.
within() {
  value "$1.report.json" "(lambda c: abs(c['$2'] - ($4)) < 4 * c['u_$2'] < ${5-0.05})(r['colour_lines']['$3'])" | grep -q True ||
    fail "$1: $2 of $3 is $(value "$1.report.json" "[r['colour_lines']['$3'][n] for n in ('$2', 'u_$2')]"), not $4"
}

draw apart '"gap_px": [8, 0, -8], "dx_px": [0.3, 0, -0.2], "dy_px": [0.15, 0, -0.4], "magnification_ppm": [50, 0, -80]'
expect 0 "the colour channels lie 0\.[45][0-9] px apart: one was measured" "$program" measure --channel green apart.png -o apart.report.json
valid measure.schema.json apart.report.json
away=$(value apart.report.json "(r['colour_lines']['x0_mm'] - json.load(open('apart.truth.json'))['colour_lines']['middle_x_mm']) / 25.4e6 * 1200")
within apart dx_px red "0.3 + 50 * $away"
within apart dx_px blue "-0.2 - 80 * $away"
within apart dy_px red 0.15
within apart dy_px blue -0.4
within apart magnification_ppm red 50 50
within apart magnification_ppm blue -80 50
[ "$(value apart.report.json "r['colour_lines']['apart']")" = True ] || fail "0.4 px is not flagged"
[ "$(value apart.report.json "r['colour_lines']['red']['p_constant'] > 0.001")" = True ] || fail "an even carriage is called uneven"
expect 0 "their mean was measured" "$program" measure apart.png --channel luminance -o mean.json
# From a pipe, one thread: the same numbers. One that need not be stored is not, and shows none.
expect 0 "" "$program" measure --threads 1 - -o piped.json < <(cat apart.png)
expect 0 "" "$program" measure apart.png -o sought.json
[ "$(value piped.json "r['colour_lines']")" = "$(value sought.json "r['colour_lines']")" ] || fail "a pipe shows other lines"
expect 0 "" "$program" measure --channel green - -o streamed.json < <(cat apart.png)
[ "$(value streamed.json "'colour_lines' in r")" = False ] || fail "a stream was stored"

# Channels that differ in magnification are told, whichever of them was measured, and none is called right.
for ppm in "1000, 1000, 0" "0, 1000, 0" "0, 0, 1000"; do
  draw scale "\"magnification_ppm\": [$ppm]"
  expect 0 "" "$program" measure --channel green scale.png -o scale.report.json
  value scale.report.json "'channel_scale' in r['foils'][0]['flags']" | grep -q True || fail "magnifications of $ppm ppm are not told"
done

draw near '"dx_px": [0.04, 0, -0.03], "dy_px": [-0.03, 0, 0.02]'
expect 0 "" "$program" measure near.png --channel green -o near.report.json
[ "$(value near.report.json "r['colour_lines']['apart']")" = False ] || fail "0.08 px is flagged"
within near dx_px red 0.04

# A ripple of the carriage shows between the lines: 2 a sin(pi gap / p) = 4.97 um peak.
draw uneven '"gap_px": [8, 0, -8]' '{"id": "scan.carriage_ripple", "amplitude_um": 10, "period_mm": 2, "phase_deg": 0}'
listened=stdout expect 0 "uneven along y" script -qc "$program measure uneven.png" /dev/null
expect 0 "" "$program" measure uneven.png --channel green -o uneven.report.json
[ "$(value uneven.report.json "r['colour_lines']['red']['p_constant'] < 1e-6")" = True ] || fail "a ripple is not seen"
near "the course's rms" "$(value uneven.report.json "r['colour_lines']['red']['course_rms_um']")" 3.5 0.5

# A strong colour: red shows no edges, the others stand.
draw strong '"contrast": [0, 165, 120], "background": [200, 30, 40], "dx_px": [0, 0, 0.2]'
expect 0 "" "$program" measure strong.png --channel green -o strong.report.json
[ "$(value strong.report.json "[r['colour_lines'][c]['state'] for c in ('red', 'blue')]")" = "['no_contrast', 'measured']" ] ||
  fail "a channel without contrast"
within strong dx_px blue 0.2
valid measure.schema.json strong.report.json
draw magenta '"contrast": [150, 0, 120], "background": [30, 200, 40], "dx_px": [0, 0, 0.2]'
expect 0 "" "$program" measure magenta.png -o magenta.report.json
[ "$(value magenta.report.json "(r['colour_lines']['against'], r['colour_lines']['green']['state'])")" = "('red', 'no_contrast')" ] ||
  fail "green without contrast"
within magenta dx_px blue 0.2

# Gray saved as RGB; gray; half a file.
checks - <<'PYTHON'
import struct, zlib
data = open("near.png", "rb").read()
at, chunks = 8, []
while at < len(data):
    length, kind = struct.unpack(">I4s", data[at:at + 8])
    chunks.append((kind, data[at + 8:at + 8 + length]))
    at += 12 + length
width, height = struct.unpack(">II", chunks[0][1][:8])
rows = zlib.decompress(b"".join(c for k, c in chunks if k == b"IDAT"))
stride = 3 * width + 1
assert all(rows[y * stride] == 0 for y in range(height))
gray = [rows[y * stride + 2:(y + 1) * stride:3] for y in range(height)]
with open("gray.pgm", "wb") as out:
    out.write(b"P5 %d %d 255\n" % (width, height) + b"".join(gray))
with open("same.ppm", "wb") as out:
    out.write(b"P6 %d %d 255\n" % (width, height) + b"".join(bytes(v for p in row for v in (p, p, p)) for row in gray))
with open("cut.png", "wb") as out:
    out.write(data[:len(data) // 2])
PYTHON
expect 0 "" "$program" measure same.ppm --dpi 1200 --channel green -o same.json
valid measure.schema.json same.json
[ "$(value same.json "[(c['state'], c['dx_px'], c['u_dx_px'], c['course']) for c in (r['colour_lines']['red'], r['colour_lines']['blue'])]")" = \
  "[('identical', 0, None, []), ('identical', 0, None, [])]" ] || fail "a gray picture saved as RGB"
listened=stdout expect 0 "red is the same picture; blue is the same picture" script -qc "$program measure same.ppm --dpi 1200 --channel green" /dev/null
expect 0 "" "$program" measure gray.pgm --dpi 1200 -o gray.json
[ "$(value gray.json "'colour_lines' in r")" = False ] || fail "a gray scan has colour lines"
[ "$(value gray.json "r['foils']")" = "$(value same.json "r['foils']")" ] || fail "gray saved as RGB is measured otherwise"
expect 65 "cut off|damaged" "$program" measure cut.png

# Round features.
cat >discs.spec.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 5, "margin_px": 60,
 "discs": [{"centre_mm": [3, 3], "radius_mm": 1.5}, {"centre_mm": [9, 4], "radius_mm": 2}],
 "scanner": {"dpi": 1200, "colour_lines": {"dx_px": [0.3, 0, -0.2], "dy_px": [0.15, 0, -0.4]}}}
SPEC
"$renderer" render discs.spec.json -o discs.png || fail "discs are not drawn"
expect 0 "" "$program" measure --form discs --channel green discs.png -o discs.report.json
valid measure.schema.json discs.report.json
within discs dx_px red 0.3
within discs dy_px blue -0.4

# Members that a spec refuses.
bad() {
  echo '{"schema": "foilgauge/render/1", "scanner": {"colour_lines": '"$1"'}}' >bad.json
  expect 65 "$2" "$program" render bad.json -o bad.png
}
bad '{"gap_px": [8, 0]}' "colour_lines.gap_px .*3 numbers|colour_lines.gap_px"
bad '{"gap": [8, 0, 8]}' "colour_lines.gap .*no such member"
bad '{"dx_px": [0, 0, 50]}' "colour_lines.dx_px"
bad '{"contrast": [175, 240, 175]}' "background \\+ contrast must lie within 0 and 255 for every line"
bad '3' "must be an object"
exit $failed
