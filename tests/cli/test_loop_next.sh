#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on scans says what to do next: a part's form is subtracted from nothing, and rows that
# jump are of one scan. Every disc has its U on the terminal, every bump one number in a drawing,
# every table a head.
. tests/support/loop.sh
skip_when_slow

told() { # told FILE ARGUMENTS...: what the terminal shows
  local file=$1
  shift
  script -qec "$program loop $*" /dev/null >"$file" 2>&1 || fail "loop $*: $(cat "$file")"
}

render_foil a 3 -90 '{"id":"part.ovality","amplitude_um":15,"phase_deg":30}' 1200
render_foil b 3 0 '{"id":"part.ovality","amplitude_um":15,"phase_deg":30}' 1200
told oval.txt --same-foil a.png b.png
grep -q 'found part.ovality' oval.txt || fail "an oval foil is not found: $(cat oval.txt)"
grep -q 'next: Correct the part.*stand as measured' oval.txt || fail "an oval foil: $(grep next: oval.txt)"
"$program" loop --same-foil a.png b.png -o oval.out || fail "loop on a pair"
[ "$(value oval.out "r['before']['foils'][0]['overall']['radius_mm'] == r['after']['foils'][0]['overall']['radius_mm']")" = True ] ||
  fail "the form is subtracted from R0"

cat >plate.json <<'SPEC'
{"schema":"foilgauge/render/1","seed":2,"scanner":{"dpi":1200},
 "discs":[{"centre_mm":[4,4],"radius_mm":3},{"centre_mm":[12,5],"radius_mm":3.5},{"centre_mm":[20,4],"radius_mm":2.5},
          {"centre_mm":[4,13],"radius_mm":2.5},{"centre_mm":[12,14],"radius_mm":3},{"centre_mm":[20,13],"radius_mm":3.5}],
 "effects":[{"id":"scan.scale_y","value":0.002}]}
SPEC
"$renderer" render plate.json -o plate.png || fail "render plate"
told plate.txt --form discs plate.png
grep -q 'next: Correct the scanner.*every scan of this scanner' plate.txt || fail "a scale: $(grep next: plate.txt)"
grep -Eq 'disc 1: D [0-9.]+ -> [0-9.]+ \+- [0-9.]+ mm, rms ' plate.txt || fail "discs without U: $(grep 'disc 1' plate.txt)"

# No model is advised of a picture of which none would be written.
render_foil whole 3 -90 '{"id":"scan.carriage_ripple","amplitude_um":8,"period_mm":5}' 2400
sed 's/"blur_px"/"tone_curve":[[0,0],[48,0],[255,255]],"blur_px"/' whole.json >clipped.json
"$renderer" render clipped.json -o clipped.png || fail "render a foil whose dark counts are cut off"
told clipped.txt clipped.png
grep -q 'next: Scan again.*(clipped_levels)' clipped.txt || fail "clipped counts: $(grep next: clipped.txt)"
"$program" loop clipped.png --model-out no.json -o clipped.out 2>said && fail "a model of clipped counts"
grep -q 'no model is written: clipped.png: clipped_levels' said || fail "clipped counts: $(cat said)"

render_foil jump 3 -90 '{"id":"scan.row_step","amplitude_um":12,"y_mm":9}' 2400
told jump.txt jump.png --without scan.row_step
grep -q 'state of the picture: row_jumps' jump.txt && grep -q '^unattributed' jump.txt || fail "rows that jump: $(cat jump.txt)"
grep -q 'next: Scan again without a pause' jump.txt || fail "rows that jump: $(grep next: jump.txt)"
grep -q 'every scan of this scanner' jump.txt && fail "lost rows are taken for every scan's"
render_foil cut 3 -90 '{"id":"scan.row_step","amplitude_um":21,"y_mm":9}' 1200
told cut.txt cut.png
grep -q 'next: Scan again.*land_deviates' cut.txt || fail "a bump that a lost row cuts: $(grep next: cut.txt)"
"$program" loop jump.png --html jump.html -o jump.out || fail "a page of lost rows"
[ "$(grep -o '<text class="bump"[^>]*>1<' jump.html | wc -l)" = 2 ] ||
  fail "bump 1 has $(grep -o '<text class="bump"[^>]*>1<' jump.html | wc -l) numbers in the drawings before and after"
# On paper a table that runs on repeats its head.
grep -qE '<table[^>]*><tr>' jump.html && fail "a table of the page has no head: $(grep -oE '<table[^>]*><tr>.{60}' jump.html | head -1)"
exit $failed
