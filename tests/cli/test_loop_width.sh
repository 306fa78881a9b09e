#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A strip whose thickness changes along the foil: named with its size and its sign, whatever else is there, and never
# where it does not.
. tests/support/loop.sh
long_only
id=part.thickness_taper

# loop NAME [OPTIONS]
loop() {
  local name=$1
  shift
  local model=(--model-out "$name.model")
  [ "$name" != rough ] || model=()
  "$program" loop "$name.png" "$@" -o "$name.out" --html "$name.html" "${model[@]}" || fail "loop on $name"
  valid loop_scan.schema.json "$name.out"
}
# agree NAME: a terminal, which gets the text, the page and the JSON say the same.
agree() {
  local name=$1
  script -qec "'$program' loop '$name.png'" /dev/null </dev/null | tr -d '\r' >"$name.text"
  python3 "$root/tests/support/loop_statements.py" "$name.out" "$name.html" "$name.text" || fail "$name says different things"
}
claims() { value "$1.out" "' '.join(c['id'] for c in r['claims'] if c['verdict'] == 'found')"; }
taper() { value "$1.out" "[c for c in r['claims'] if c['id'] == '$id'][0]$2"; }
# right NAME CHANGE: found, and right within its U, which is small.
right() {
  near "the change of $1" "$(taper "$1" "['parameters']['thickness_change_um']")" "$2" \
    "$(taper "$1" "['uncertainty']['thickness_change_um'] * 2")"
  near "its U" "$(taper "$1" "['uncertainty']['thickness_change_um'] * 2")" 0.25 0.25
}

render_foil thicker 21 25 "{\"id\":\"$id\",\"thickness_change_um\":6}" 2400
loop thicker
agree thicker
[ "$(value thicker.out "r['verdict']") $(claims thicker)" = "explained $id" ] || fail "thicker: $(claims thicker)"
right thicker 6
near "half width before" "$(value thicker.out "r['before']['half_width']['rms']")" 0.87 0.1
near "half width after" "$(value thicker.out "r['after']['half_width']['rms']")" 0 0.1
near "R after it" "$(value thicker.out "r['after']['foils'][0]['bumps'][3]['radius_mm']")" 3.44 0.001
grep -q "the strip is thicker towards the free end" thicker.html || fail "the page does not say which end is thicker"
[ "$(value thicker.model "len(r['fields'])")" = 0 ] || fail "a part's thickness is in the scanner's model"

[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || exit $failed

# Clean, and rough: nothing is claimed, and what would have been seen is told.
render_foil clean 5 60 "" 2400
loop clean
[ "$(value clean.out "r['verdict']") $(claims clean)" = "clean " ] || fail "clean: $(claims clean)"
[ "$(value clean.out "[c['verdict'] for c in r['rejected'] if c['id'] == '$id']")" = "['absent']" ] || fail "not absent"
near "smallest change" "$(value clean.out "[c for c in r['rejected'] if c['id'] == '$id'][0]['smallest_amplitude']")" 1 0.6
[ "$(value clean.out "'half_width' in r['before']")" = False ] || fail "widths without a claim"

[ -n "${FOILGAUGE_TEST_LONG-}" ] || exit $failed

# The other way round, mirrored, beside a scanner that is wrong as well.
render_foil thinner 4 -120 "{\"id\":\"$id\",\"thickness_change_um\":-4},{\"id\":\"scan.carriage_ripple\",\"amplitude_um\":8,\"period_mm\":2.2}" \
  2400 '' '"mirror":true,'
loop thinner
[ "$(claims thinner)" = "scan.carriage_ripple $id" ] || fail "thinner: $(claims thinner)"
right thinner -4
grep -q "the strip is thinner towards the free end" thinner.html || fail "the page does not say which end is thinner"
[ "$(value thinner.model "' '.join(f['id'] for f in r['fields'])")" = scan.carriage_ripple ] || fail "model of thinner"

agree thinner

"$renderer" render "$root/samples/render/rough.json" -o rough.png || fail "render rough"
loop rough # once a JPEG: there is a report, and no model
[[ "$(claims rough)" != *$id* ]] || fail "rough: $(claims rough)"

# Discs have no thickness.
cat >discs.json <<SPEC
{"schema":"foilgauge/render/1","seed":1,"width_px":2600,"height_px":2600,
 "foils":[],
 "discs":[{"centre_mm":[7,7],"radius_mm":4},{"centre_mm":[20,7],"radius_mm":4.5},{"centre_mm":[13,19],"radius_mm":4}],
 "scanner":{"dpi":2400,"background":30,"contrast":175,"blur_px":1.3,"noise":1.2}}
SPEC
"$renderer" render discs.json -o discs.png || fail "render discs"
loop discs --form discs
grep -q "$id" discs.out && fail "a disc's thickness is looked for"

exit $failed
