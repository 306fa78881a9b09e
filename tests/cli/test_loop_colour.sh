#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The colour lines of a scan check an effect of the carriage that the loop found; a plate of gauges shows it quickest.
. tests/support/cli.sh
skip_when_slow

# draw NAME GAP EFFECTS
draw() {
  cat >"$1.spec.json" <<SPEC
{"schema": "foilgauge/render/1", "seed": 4, "margin_px": 60, "effects": [$3],
 "discs": [{"centre_mm": [3, 3], "radius_mm": 1.8}, {"centre_mm": [8, 3.3], "radius_mm": 2}, {"centre_mm": [3, 8], "radius_mm": 2},
  {"centre_mm": [8, 8.4], "radius_mm": 1.9}, {"centre_mm": [13, 5], "radius_mm": 2}],
 "scanner": {"dpi": 1200, "colour_lines": {"gap_px": [$2, 0, -$2]}}}
SPEC
  "$renderer" render "$1.spec.json" -o "$1.png" || fail "$1 is not drawn"
}

# witness REPORT ID VERDICT: the channel check beside the claim.
witness() {
  [ "$(value "$1" "[c['witness']['verdict'] for c in r['claims'] if c['id'] == '$2']")" = "['$3']" ] ||
    fail "$1: of $2: $(value "$1" "[(c['id'], c.get('witness')) for c in r['claims']]")"
}

ripple='{"id": "scan.carriage_ripple", "amplitude_um": 12, "period_mm": 2, "phase_deg": 30}'
draw seen 8 "$ripple"
expect 0 "" "$program" loop --form discs seen.png -o seen.json --html seen.html
valid loop_scan.schema.json seen.json
witness seen.json scan.carriage_ripple for
grep -q "the colour lines show it as well" seen.html || fail "the page does not say it"
# The gaps that fit are those that were drawn: of one line 8 rows, of the other 8 or 16, against the one that was measured.
near "the lines' gap" "$(value seen.json "min(abs(v) for v in r['claims'][0]['witness']['gap_px'].values() if v)")" 8 0.6
listened=stdout expect 0 "the colour lines show it as well" "$program" loop --form discs seen.png --colour-gap 8
expect 0 "" "$program" loop --form discs seen.png --colour-gap 8 -o stated.json
valid loop_scan.schema.json stated.json
witness stated.json scan.carriage_ripple for
near "the size between the lines" "$(value stated.json "r['claims'][0]['witness']['factor']")" 1 0.05

# Lines that see the same: what looks like a ripple is none of the carriage's. Without the gap nobody can know.
draw unseen 0 "$ripple"
expect 0 "" "$program" loop --form discs unseen.png --colour-gap 8,-8 -o unseen.json
witness unseen.json scan.carriage_ripple against
expect 0 "" "$program" loop --form discs unseen.png -o unknown.json
witness unknown.json scan.carriage_ripple cannot_tell
# A scale makes the same between the lines everywhere.
draw scale 8 '{"id": "scan.scale_y", "value": 0.002}'
expect 0 "" "$program" loop --form discs scale.png --colour-gap 8 -o scale.json
witness scale.json scan.scale_y cannot_tell
valid loop_scan.schema.json scale.json
# Effects of other parts than the carriage have no channel check.
draw optics 8 '{"id": "scan.optical_quadratic", "amplitude_um": 30}'
expect 0 "" "$program" loop --form discs optics.png -o optics.json
[ "$(value optics.json "[c['id'] for c in r['claims'] if 'witness' in c]")" = "[]" ] || fail "the optics have a witness"

for gap in x 0 0,0 8, 8,x 5000 nan 8,8,8; do
  expect 64 "--colour-gap: '$gap' is not one or two numbers of rows" "$program" loop seen.png --colour-gap "$gap"
done
exit $failed
