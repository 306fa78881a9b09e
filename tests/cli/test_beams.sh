#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Flat foils with beams (form "cantilever"): combs and slits, their defects, refused input.
. tests/support/cli.sh
listened="stdout stderr"

cat >design.json <<'J'
{"schema": "foilgauge/design/1", "form": "cantilever", "beam_count": 4, "beam_length_mm": 4, "beam_width_mm": 1, "thickness_mm": 0.1,
 "sagitta_mm": 0.5, "clearance_mm": 0.1, "calibration": "not needed: the scan is rendered", "tolerances": {"length_mm": {"min": 3.9, "max": 4.1}, "compliance_error_pct": {"max": 8}}}
J
# sheet NAME BEAMS [SCANNER] [DIRECTION]: a scan of a foil whose beams have these members.
sheet() {
  cat >"$1.spec" <<J
{"schema": "foilgauge/render/1", "seed": 3, "scanner": {"dpi": 1200${3-}}, "foils": [{"design": {"form": "cantilever",
 "beam_count": 4, "beam_length_mm": 4, "beam_width_mm": 1, "thickness_mm": 0.1}, "beams": {"pitch_mm": 1.8, $2}, "rotate_deg": ${4--70}}]}
J
  "$renderer" render "$1.spec" -o "$1.png" --truth "$1.truth" || fail "render $1"
}
# agrees NAME WIDEST: every beam of a report beside its truth, in um.
agrees() {
  checks - "$1" "$2" <<'P' || fail "$1 is not as rendered"
import json, sys
truth, found = json.load(open(sys.argv[1] + ".truth")), json.load(open(sys.argv[1] + ".json"))
beams = found["foils"][0]["beams"]
assert len(beams) == len(truth["beams"]), len(beams)
for beam in beams:
    near = min(truth["beams"], key=lambda t: sum(abs(a * 25.4 / 1200 - b) for a, b in zip(t["tip_px"], beam["tip_mm"])))
    for name in ("length_mm", "width_mm"):
        assert abs(beam[name] - near[name]) < float(sys.argv[2]) / 1000, (beam["number"], name, beam[name], near[name])
    for name in ("compliance_error_pct", "sagitta_error_pct"):
        assert abs(beam[name] - near[name]) < 5 * beam["u_" + name] + 0.01, (beam["number"], name, beam[name], near[name])
P
}
spread='"length": {"mean_um": 10, "sd_um": 20}, "width": {"mean_um": -5, "sd_um": 10}'
sheet comb "$spread"
sheet slits "$spread, \"layout\": \"slits\"" ', "contrast": -175, "background": 225'
for name in comb slits; do
  expect 0 "" "$program" measure $name.png --design design.json -o $name.json --csv $name.csv --points $name.points
  valid measure.schema.json $name.json
  agrees $name 1.0
done
[ "$(head -n 1 comb.csv | tr , '\n' | grep -c '^u_')" = 12 ] || fail "comb.csv has not twelve uncertainties"
[ "$(wc -l <comb.csv)" = 5 ] || fail "comb.csv has not a line per beam"
[ "$(cut -d , -f 4 comb.points | sort -u | wc -l)" = 6 ] || fail "comb.points has not five sides"
# Numbers follow the foil: from left to right with the tips up, however it lies.
sheet turned "$spread" "" 100
"$program" measure turned.png --design design.json -o turned.json
for k in 0 3; do
  near "beam $k turned" "$(value turned.json "r['foils'][0]['beams'][$k]['length_mm']")" \
    "$(value comb.json "r['foils'][0]['beams'][$k]['length_mm']")" 0.002
done

# Traces of a scanner's driver are found beside beams that are a few hundred pixels long: a tone curve is held, or
# reported where the tone is stated to be linear; sharpening and rows that jump are reported.
seen() { # NAME FINDINGS UM [OPTION...]: flags of the foil, and every beam within 2 u of its truth and within UM.
  "$program" measure $1.png --design design.json -o $1.json "${@:4}" >/dev/null
  [ "$(value $1.json 'sorted(f["finding"] for f in r["picture"]["findings"])')" = "$2" ] ||
    fail "$1: $(value $1.json '[f["finding"] for f in r["picture"]["findings"]]')"
  checks - $1 $3 <<'P' || fail "$1 is farther off than is said"
import json, sys
truth, found = json.load(open(sys.argv[1] + ".truth")), json.load(open(sys.argv[1] + ".json"))
dpi = found["inputs"][0]["dpi"][0]
for beam in found["foils"][0]["beams"]:
    near = min(truth["beams"], key=lambda t: sum(abs(a * 25.4 / dpi - b) for a, b in zip(t["tip_px"], beam["tip_mm"])))
    for name in ("length_mm", "width_mm"):
        off = abs(beam[name] - near[name])
        assert off < 2 * beam["u_" + name] + 2e-4 and off < float(sys.argv[2]) / 1000, (beam["number"], name, off, beam["u_" + name])
P
}
gammas="0.3 1 2.2 3" all_beams="1 2 3 4"
brief && gammas=2.2 all_beams="1 4"
for gamma in $gammas; do
  sheet gamma "$spread" ", \"gamma\": $gamma"
  seen gamma "[]" 1.0
done
seen gamma "['edge_profile', 'tone_curve']" 60 --tone linear
# Ends of slits that are a few pixels wide: blur does not move them.
for end in "0.2 -70 0.7" "0.2 5 0.7" "0.15 41 1.2"; do
  set -- $end
  sheet ends "$spread, \"layout\": \"slits\", \"kerf_mm\": $1" ', "contrast": -175, "background": 225, "noise": 1' $2
  seen ends "[]" $3 --tone linear
done
sheet plain "$spread"
seen plain "[]" 1.0 --tone linear
sheet sharp "$spread" ', "unsharp_mask": {"amount_pct": 100}'
seen sharp "['sharpened']" 1.0
sheet rows "$spread" ', "rows_lost": [{"y_mm": 3.2, "count": 1}]' -80
seen rows "['row_jumps']" 23
[ "$(value rows.json 'abs(r["picture"]["row_jump_px"] + 1) < 0.1')" = True ] || fail "one row is lost, and not found so"

# Defects of a foil are reported and judged.
sheet torn '"torn": [{"beam": 2}]'
expect 2 'torn_tip' "$program" measure torn.png --design design.json
sheet missing '"missing": [3]'
expect 1 'beam 3 is missing' "$program" measure missing.png --design design.json
for lost in $all_beams; do # numbers follow places, at the ends as well
  sheet lost "\"missing\": [$lost]"
  expect 1 "" "$program" measure lost.png --design design.json -o lost.json
  valid measure.schema.json lost.json
  [ "$(value lost.json '[b["number"] for b in r["foils"][0]["beams"]]')" = "$(python3 -c "print([i for i in range(1, 5) if i != $lost])")" ] ||
    fail "beam $lost is missing, and the others are numbered $(value lost.json '[b["number"] for b in r["foils"][0]["beams"]]')"
  [[ "$(value lost.json 'r["foils"][0]["flags"]')" = *missing_beam* ]] || fail "no flag says that beam $lost is missing"
done
sheet soft '"length": {"mean_um": 150}'
expect 1 "out_of_tolerance" "$program" measure soft.png --design design.json

sheet narrow '"layout": "slits", "kerf_mm": 0.1'
expect 2 'narrow_cut' "$program" measure narrow.png --design design.json

# Calibration widens; a u of 1e-3 of lengths is one of 2e-3 of a compliance's error. A tone curve that is not known moves
# the two long edges apart, and both ends of a length alike.
sed 's/"calibration": "[^"]*"/"calibration": {"scale": {"u_rel": 0.001}}, "tone": "linear"/' design.json >doubted.json
"$program" measure comb.png --design doubted.json -o doubted.json.out
near "u of a length" "$(value doubted.json.out 'r["foils"][0]["beams"][0]["u_length_mm"]')" 0.004 0.0002
checks - <<'P' || fail "an unknown tone curve is in a width, not in a length"
import json
known, unknown = (json.load(open(name))["foils"][0]["beams"][0] for name in ("doubted.json.out", "comb.json"))
assert unknown["u_width_mm"] > 0.005 > 4 * known["u_width_mm"], (unknown["u_width_mm"], known["u_width_mm"])
assert unknown["u_length_mm"] < 0.0005
P
near "u of a compliance" "$(value doubted.json.out 'r["foils"][0]["beams"][0]["u_compliance_error_pct"]')" 0.2 0.02

expect 0 "" "$program" measure slits.png --design design.json --html page.html --overlay picture.png
grep -q "Every beam against its limits" page.html || fail "the page has no plots of beams"
grep -q "How a beam is measured" page.html || fail "the page does not say how"

# A foil of several islands: its numbers do not depend on which thread is first with one.
"$renderer" render "$root/samples/render/cantilever.json" -o islands.png
"$program" measure islands.png --design "$root/samples/cantilever_design.json" --threads 1 -o alone.json >alone.txt
for repeat in 1 2 3 4 5 6 7 8 9 10 11 12; do
  "$program" measure islands.png --design "$root/samples/cantilever_design.json" --threads 16 -o together.json >together.txt
  cmp -s alone.json together.json && cmp -s alone.txt together.txt || fail "threads change the report, repeat $repeat"
done

# Other parts, other designs, other commands.
expect 65 "no foil with beams in the picture" "$program" measure "$root/samples/gen2_foil.png" --design design.json
expect 65 "no foil" "$program" measure comb.png
expect 64 "the loop needs bumps or discs" "$program" loop comb.png --design design.json
head -c 20000 comb.png >cut.png
expect 65 "cut.png" "$program" measure cut.png --design design.json
exit $failed
