#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Effects of the scanner that other tests do not render: each is named with its numbers, and the dimensions come back.
. tests/support/loop.sh
skip_when_slow

# found NAME ID EFFECT: renders it, and the loop names it alone.
found() {
  render_foil "$1" 22 -70 "{\"id\":\"$2\",$3}" 2400
  "$program" loop "$1.png" -o "$1.out" --html "$1.html" --model-out "$1.model" || fail "loop on $1"
  [ "$(value "$1.out" "[c['id'] + ' ' + c['verdict'] for c in r['claims']]")" = "['$2 found']" ] ||
    fail "$1: $(value "$1.out" "r['verdict'], [c['id'] + ' ' + c['verdict'] for c in r['claims']]")"
  near "R0 after $1" "$(value "$1.out" "r['after']['foils'][0]['overall']['radius_mm']")" 20.95 "${4:-0.0002}"
  near "R after $1" "$(value "$1.out" "r['after']['foils'][0]['bumps'][3]['radius_mm']")" 3.44 "${5:-0.001}"
  valid loop_scan.schema.json "$1.out"
  "$program" measure "$1.png" --model "$1.model" >/dev/null || fail "the model of $1 is refused"
}
number() { value "$1.out" "r['claims'][0]['parameters']['$2']"; }

found seam scan.column_step '"amplitude_um":15,"x_mm":12.3'
near "the seam" "$(number seam amplitude_um)" 15 0.3
near "place of the seam" "$(number seam x_mm)" 12.3 0.1
grep -q "a seam between two chips" seam.html || fail "the page does not say what a seam is"

[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || exit $failed

found start scan.carriage_start '"amplitude_um":20,"length_mm":5'
near "the start" "$(number start amplitude_um)" 20 0.5
near "its length" "$(number start length_mm)" 5 0.1

exit $failed
