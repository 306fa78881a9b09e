#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Effects of the scanner that other tests do not render: each is named with its numbers, and the dimensions come back.
. tests/support/loop.sh
skip_when_slow

# found NAME ID EFFECT [LIMIT OF R0] [OF R] [ROTATION]: renders it, and the loop names it alone; -: the part's own form is in its radii.
found() {
  render_foil "$1" 22 "${6--70}" "{\"id\":\"$2\",$3}" 2400
  "$program" loop "$1.png" -o "$1.out" --html "$1.html" --model-out "$1.model" || fail "loop on $1"
  [ "$(value "$1.out" "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")" = "['$2 found']" ] ||
    fail "$1: $(value "$1.out" "r['verdict'], [c['id'] + ' ' + c['verdict'] for c in r['claims']]")"
  [ "${4-}" = - ] || near "R0 after $1" "$(value "$1.out" "r['after']['foils'][0]['overall']['radius_mm']")" 20.95 "${4:-0.0002}"
  [ "${5-}" = - ] || near "R after $1" "$(value "$1.out" "r['after']['foils'][0]['bumps'][3]['radius_mm']")" 3.44 "${5:-0.001}"
  valid loop_scan.schema.json "$1.out"
  "$program" measure "$1.png" --model "$1.model" >/dev/null || fail "the model of $1 is refused"
}
number() { value "$1.out" "r['claims'][0]['parameters']['$2']"; }

found seam scan.column_step '"amplitude_um":15,"x_mm":12.3'
near "the seam" "$(number seam amplitude_um)" 15 0.3
near "place of the seam" "$(number seam x_mm)" 12.3 0.1
grep -q "a seam between two chips" seam.html || fail "the page does not say what a seam is"

# On one arc a fault of the picture at one place makes a dent as well: a second scan tells.
for turn in -70 20; do
  render_foil "dent$turn" 22 "$turn" '{"id":"part.dent","amplitude_um":12,"place_deg":-13.3,"width_deg":1.5,"along":"normal"}' 2400
done
mv dent-70.png dent.png
"$program" loop --same-foil dent.png dent20.png -o dent.out || fail "loop on a dent"
[ "$(value dent.out "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")" = "['part.dent found']" ] || fail "a dent, seen twice, is not found"
near "the dent" "$(number dent amplitude_um)" 12 0.5
near "place of the dent" "$(number dent place_deg)" -13.3 0.1
near "width of the dent" "$(number dent width_deg)" 1.5 0.1
"$program" loop dent.png -o once.out || fail "loop on a dent seen once"
[ "$(value once.out "[c['verdict'] for c in r['claims'] if c['id'] == 'part.dent'], any('free.scan' in a for c in r['claims'] for a in c['alias_class'])")" = \
  "(['tied'], True)" ] || fail "a dent, seen once, is not tied with the picture"
# Without its name it is not the picture's either: nothing is subtracted from the bump.
"$program" loop dent.png --without part.dent -o nameless.out || fail "loop on a dent without its name"
[ "$(value nameless.out "max(abs(a['radius_mm'] - b['radius_mm']) for a, b in zip(r['after']['foils'][0]['bumps'], r['before']['foils'][0]['bumps'])) < 1e-5")" = True ] ||
  fail "a dent without its name is taken out of the bump"
"$program" loop dent.png --without part.dent,scan.yaw -o without.out >/dev/null || [ $? = 2 ] || fail "loop without a dent"
[ "$(value without.out "r['without'], 'part.dent' in str(r['claims']), 'not looked for: part.dent,scan.yaw' in str(r['notes'])")" = \
  "('part.dent,scan.yaw', False, True)" ] || fail "a dent is found though it is left out"
"$program" loop dent.png --without part.dint >refused.out 2>&1
[ $? = 64 ] || fail "an effect that does not exist is left out"
grep -q 'no effect is called "part.dint"' refused.out || fail "nothing says which effect does not exist"

found growth scan.ripple_growth '"amplitude_um":6,"period_mm":7,"phase_deg":30,"growth_per_mm":0.05' 0.0002 0.001 10
near "the growing ripple" "$(number growth amplitude_um)" 6 0.2
near "its growth" "$(number growth growth_per_mm)" 0.05 0.003

# More of the kind.
[ -n "${FOILGAUGE_TEST_LONG-}" ] || exit $failed

found tilt scan.chip_tilt '"amplitude_um":16,"x_mm":12.3,"pitch_mm":9.4' 0.0002 0.001 10
near "the tilt" "$(number tilt amplitude_um)" 16 1
near "the chips" "$(number tilt pitch_mm)" 9.4 0.1

found quintic scan.optical_quintic '"amplitude_um":25,"centre_mm":18'
near "the quintic" "$(number quintic amplitude_um)" 25 0.5

found yaw scan.yaw '"amplitude_um":8,"period_mm":12,"phase_deg":40'
near "the yaw" "$(number yaw amplitude_um)" 8 0.2
near "its period" "$(number yaw period_mm)" 12 0.1

found start scan.carriage_start '"amplitude_um":20,"length_mm":5'
near "the start" "$(number start amplitude_um)" 20 0.5
near "its length" "$(number start length_mm)" 5 0.1

exit $failed
