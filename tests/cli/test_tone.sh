#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Lengths between two edges hold an unknown tone curve; a micrometer or the user's word makes it known. No verdict is wrong
# because of what a scanner's driver does to the tone.
#   test_tone.sh PROGRAM
. tests/support/cli.sh
skip_when_slow # the gauges' tests see the same code

# strip NAME THICKNESS SCANNER [DPI]
strip() {
  cat >"$1.json" <<J
{"schema": "foilgauge/render/1", "seed": 6, "foils": [{"design": {"bump_count": 3, "thickness_mm": $2}, "rotate_deg": 25}],
 "scanner": {"dpi": ${4-2400}, "blur_px": 1.1, "noise": 1.0${3:+, $3}}}
J
  "$renderer" render "$1.json" -o "$1.png" || fail "render $1"
}
design() {
  echo "{\"schema\": \"foilgauge/design/1\", \"bump_count\": 3$1}" >"$2"
}
strip plain 0.1 ''
design '' design.json
design ', "tone": "linear"' linear.json
design ', "thickness_measured": {"value_mm": 0.1003, "u_mm": 0.0005}' measured.json
design ', "thickness_measured": {"value_mm": 0.13, "u_mm": 0.0005}' other.json
for name in design linear measured other; do
  said=
  [ $name != other ] || said='the scan shows a thickness of 0.1000 mm, and 0.1300 mm is stated as measured: one of them is wrong'
  expect 0 "$said" "$program" measure plain.png --design $name.json -o $name.out --html $name.html
  valid measure.schema.json $name.out
done
expect 0 '' "$program" measure plain.png --design design.json --tone linear -o by_option.out
expect 0 '' "$program" measure plain.png --design design.json --thickness-measured 0.1003±0.0005 -o pm.out
expect 0 '' "$program" measure plain.png --design design.json --thickness-measured 0.1003:0.0005 -o colon.out
same pm.out colon.out
same pm.out measured.out
same by_option.out linear.out
checks - <<'P' || fail "what is known of the tone is not in the uncertainties"
import json
read = lambda name: json.load(open(name + ".out"))
unknown, linear, measured, other = (read(n)["foils"][0] for n in ("design", "linear", "measured", "other"))
# 8 % of the contrast at a blur of 1.14 px, on two edges: 4.8 um at 2400 dpi.
assert 0.0040 < unknown["u_thickness_mm"] < 0.0060 and unknown["thickness_by"] == "scan", unknown["u_thickness_mm"]
assert linear["u_thickness_mm"] < 0.0005 and abs(linear["thickness_mm"] - 0.1) < 2 * linear["u_thickness_mm"] + 0.0002
assert measured["thickness_mm"] == 0.1003 and measured["u_thickness_mm"] == 0.0005 and measured["thickness_by"] == "statement"
for foil in (unknown, linear, measured, other):
    assert abs(foil["thickness_scan_mm"] - 0.1) < 0.0005
    for bump in foil["bumps"]:
        assert bump["u_radius_mm"] < 0.0005 and bump["u_height_mm"] < 0.0001
        assert bump["u_clearance_mm"] >= foil["u_thickness_mm"]
        assert abs(bump["clearance_mm"] + bump["height_mm"] - (0.73 - foil["thickness_mm"])) < 1e-9
assert [f["flags"].count("thickness_contradicts") for f in (unknown, linear, measured, other)] == [0, 0, 0, 1]
assert read("measured")["design"]["thickness_measured"] == {"value_mm": 0.1003, "u_mm": 0.0005}
assert read("linear")["design"]["tone"] == "linear"
P
grep -q 'differ by more than their uncertainty' other.html || fail "the page does not say that the thicknesses contradict"
grep -q 'thickness as measured .*0.1003' <("$program" design measured.json) || fail "the design does not show what was measured"
grep -q 'linear, as stated' <("$program" design linear.json) || fail "the design does not show its tone"

# An edge as datum moves with the tone, and its radii; a height, between two places of one edge, does not.
design ', "datum": "inner"' inner.json
"$program" measure plain.png --design inner.json -o inner.out
checks - <<'P' || fail "radii of an edge do not hold the tone"
import json
foil = json.load(open("inner.out"))["foils"][0]
half = foil["thickness_tone_u_mm"] / 2
for bump in foil["bumps"]:
    assert abs(bump["u_radius_mm"] / half - 1) < 0.1 and bump["u_height_mm"] < half / 10, (bump["u_radius_mm"], bump["u_height_mm"], half)
assert abs(foil["overall"]["u_radius_mm"] / half - 1) < 0.1
P

# An overruled member is reported; impossible values are refused, with their unit.
expect 0 'overrules the design.s thickness_measured, 0.1003 mm' "$program" measure plain.png --design measured.json --thickness-measured 0.1:0.001 -o over.out
[ "$(value over.out "r['design']['thickness_measured']['value_mm']")" = 0.1 ] || fail "the option does not overrule"
expect 0 'overrules the design.s tone' "$program" measure plain.png --design linear.json --tone unknown -o over.out
for bad in 0.1 0.1:0 -0.1:0.001 nan:0.001 0.1:nan inf:0.001 0.1+0.001 0.1:0.001x : ''; do
  expect 64 'no thickness with its standard uncertainty' "$program" measure plain.png --thickness-measured "$bad"
done
expect 64 "none of linear, unknown" "$program" measure plain.png --tone straight
expect 64 "none of linear, unknown" "$program" loop plain.png --tone straight
expect 65 'is it in mm. 100 µm is 0.1 mm' "$program" measure plain.png --thickness-measured 100:0.5
expect 65 'u_mm is 0.5; .*in mm' "$program" measure plain.png --thickness-measured 0.1:0.5
refused() {
  design ", $1" bad.json
  expect 65 "bad.json: .*$2" "$program" measure plain.png --design bad.json
  expect 65 "bad.json: .*$2" "$program" design bad.json
}
refused '"tone": "gamma"' 'tone: must be "unknown" or "linear"'
refused '"tone": 1' 'tone: must be'
refused '"thickness_measured": 0.1' 'must be an object with value_mm, u_mm'
refused '"thickness_measured": {"value_mm": 0.1}' 'u_mm is missing'
refused '"thickness_measured": {"value_mm": 0, "u_mm": 0.001}' 'value_mm: is 0; it must be above 0'
refused '"thickness_measured": {"value_mm": 0.1, "u_mm": 0}' 'u_mm: is 0; it must be above 0'
refused '"thickness_measured": {"value_mm": -0.1, "u_mm": 0.001}' 'must be above 0'
refused '"thickness_measured": {"value_mm": "0.1", "u_mm": 0.001}' 'must be a number'
refused '"thickness_measured": {"value_mm": 100, "u_mm": 0.5}' 'is it in mm'
refused '"thickness_measured": {"value_mm": 0.1, "u_mm": 0.001, "U_mm": 1}' 'U_mm: is not known; there are value_mm, u_mm'
refused '"form": "discs", "thickness_measured": {"value_mm": 0.1, "u_mm": 0.001}' 'belongs to strips'

# A strip five times as thick as the design is not silent.
strip thick 0.5 ''
expect 0 '' "$program" measure thick.png --design design.json -o thick.out
value thick.out 'r["foils"][0]["flags"]' | grep -q 'other_thickness' || fail "a strip of 0.5 mm for one of 0.1 has no flag: $(value thick.out 'r["foils"][0]["flags"]')"
value design.out 'r["foils"][0]["flags"]' | grep -q 'thickness' && fail "a strip as designed has a flag"

# Verdicts: a good strip never fails, a bad one never passes, whatever the driver does; what decides it is said.
design ', "calibration": "not needed: the scan is rendered", "tolerances": {"thickness_mm": {"max": 0.105}}' limit.json
design ', "calibration": "not needed: the scan is rendered", "tolerances": {"thickness_mm": {"max": 0.105}, "clearance_mm": {"min": 0.0755}}' both.json
sharp='"unsharp_mask": {"amount_pct": 100, "radius_px": 1}'
curve='"tone_curve": [[0, 0], [40, 12], [65, 38], [90, 78], [115, 125], [140, 175], [165, 213], [190, 236], [255, 255]]'
posterised='"levels": 2, "threshold": 90'
for effect in sharp curve posterised; do
  for dpi in ${FOILGAUGE_TEST_LONG:+4800} 2400; do
    for um in 100 108.5; do
      strip s "$(python3 -c "print($um / 1000)")" "${!effect}" $dpi
      "$program" measure s.png --design limit.json -o s.out
      verdict=$(value s.out 'r["foils"][0]["verdict"]')
      [ "$um $verdict" = "100 fail" ] && fail "$effect, $dpi dpi: a strip of 100 um fails a limit of 105"
      [ "$um $verdict" = "108.5 pass" ] && fail "$effect, $dpi dpi: a strip of 108.5 um passes a limit of 105"
    done
  done
done
listened="stdout stderr"
"$program" measure plain.png --design both.json -o both.out --html both.html
value both.out '[j["cure"] for j in r["foils"][0]["judgements"] if j["verdict"] == "cannot_tell"][0]' | grep -q 'micrometer and state it' ||
  fail "no cure for a thickness that cannot be told"
grep -q 'What decides it:</b> Measure the strip' both.html || fail "the page does not say what decides it"
script -qec "'$program' measure plain.png --design both.json" /dev/null >both.txt 2>/dev/null
grep -q 'What decides it: Measure the strip' both.txt || fail "the terminal does not say what decides it"
expect 0 '' "$program" measure plain.png --design limit.json --thickness-measured 0.1:0.0005 -o decided.out
expect 1 '' "$program" measure plain.png --design limit.json --thickness-measured 0.1085:0.0005 -o decided.out

# Discs alike.
cat >pin.json <<'J'
{"schema": "foilgauge/render/1", "seed": 3, "discs": [{"centre_mm": [1.4, 1.5], "radius_mm": 1.0}], "scanner": {"dpi": 2400, "noise": 1}}
J
"$renderer" render pin.json -o pin.png || fail "render a pin"
echo '{"schema": "foilgauge/design/1", "form": "discs", "calibration": "not needed: the scan is rendered", "tolerances": {"diameter_mm": {"max": 2.003}}}' >pins.json
expect 3 '' "$program" measure pin.png --design pins.json -o pin.out
value pin.out 'r["discs"][0]["judgements"][0]["cure"]' | grep -q 'gauge of known diameter' || fail "no cure for a diameter"
expect 0 '' "$program" measure pin.png --design pins.json --tone linear -o pin.out
exit $failed
