#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on scans states the form error of lands and bumps, right within U against the truth of renders,
# and a range where the edges do not tell the foil's deviation from the scanner's.
. tests/support/loop.sh
skip_when_slow # other loops on scans see the same code

rough='"rough":{"edge_roughness_um":1.2,"edge_common_um":0.6,"correlation_um":40},'
# draw NAME SEED ROTATION EFFECTS [MEMBERS OF THE SCANNER]
draw() {
  cat >"$1.json" <<SPEC
{"schema":"foilgauge/render/1","seed":$2,
 "foils":[{"overall_radius_mm":20.9,"radius_mm":[3.38,3.40,3.36,3.37,3.35,3.39,3.36,3.38,3.37],"rotate_deg":$3}],
 "scanner":{${5-}"dpi":4800,"blur_px":1.4,"noise":1},"effects":[$4]}
SPEC
  "$renderer" render "$1.json" -o "$1.png" --truth "$1.truth.json" || fail "render $1"
}

cat >judge.py <<'PYTHON'
import json, sys

name, most, expected = sys.argv[1], float(sys.argv[2]), sys.argv[3]
report, truth = json.load(open(name + ".out")), json.load(open(name + ".truth.json"))
assert "form_error_um" not in report["before"]["foils"][0]["overall"], "before has a form error"
for foil in report["after"]["foils"]:
    said, known = [foil["overall"], *foil["bumps"]], [truth, *truth["bumps"]]
    assert len(said) == len(known) == 10
    for circle, of in zip(said, known):
        um, u, right = circle["form_error_um"], circle["u_form_error_um"], of["measurand"]["form_error_um"]
        if um is None and circle.get("number") == 4 and expected == "cut":
            assert u is None and "form_error_range_um" not in circle
        elif um is None:
            low, high = circle["form_error_range_um"]
            assert u is None and 0 <= low <= right <= high, (name, low, right, high)
        else:
            assert "form_error_range_um" not in circle
            assert um >= 0 and abs(um - right) <= 2 * u <= 2 * most, (name, um, right, u)
cut = any("no circle at an end" in note for note in report["notes"])
unseen = [b for b in foil["bumps"] if b["form_error_um"] is None and "form_error_range_um" not in b]
assert cut == (expected == "cut") == (unseen == [foil["bumps"][3]]), report["notes"]
value = foil["overall"]["form_error_um"] is not None
states = {"value": value, "cut": value, "open": foil["overall"]["form_error_um"] is None}
assert states[expected], (name, foil["overall"])
assert any("form errors are ranges" in note for note in report["notes"]) == (expected == "open"), report["notes"]
PYTHON

# judged NAME LARGEST_U value|open [OPTIONS OF THE LOOP]: the loop on NAME.png
judged() {
  local name=$1 most=$2 expected=$3
  shift 3
  "$program" loop "${@:-$name.png}" -o "$name.out" --html "$name.html" || fail "loop on $name"
  python3 judge.py "$name" "$most" "$expected" || fail "form errors of $name"
  valid loop_scan.schema.json "$name.out"
}

# on_terminal NAME: the report that people read, in NAME.txt
on_terminal() { script -qec "'$program' loop $1.png" /dev/null </dev/null | tr -d '\r' >"$1.txt"; }

oval='{"id":"part.ovality","amplitude_um":20,"phase_deg":30}'
draw oval 7 -80 "$oval"
judged oval 0.3 value
value oval.out "all(x == y for x, y in zip(*([f['overall']['radius_mm']] + [b[q] for b in f['bumps'] for q in ('radius_mm', 'height_mm')] for s in ('before', 'after') for f in r[s]['foils'])))" |
  grep -q True || fail "the form of an oval foil is subtracted from its dimensions"
on_terminal oval
grep -q 'foil 1: R0 .*, form error 10\.[0-9]* +- 0\.[0-9]* um$' oval.txt || fail "the terminal does not state the form error: $(grep R0 oval.txt)"
grep -q 'form error, µm' oval.html || fail "the page does not state the form error"

# One rough scan of a slightly spiral foil: scanner or foil.
draw spiral 8 -150 '{"id":"part.spiral","amplitude_um":4}' "$rough"
judged spiral 1 open
on_terminal spiral
grep -q 'form error 0 to [0-9.]* um$' spiral.txt || fail "the terminal gives no range: $(grep R0 spiral.txt)"
grep -q 'do not tell whether the foil' spiral.html || fail "the page does not say why there is a range"

# Turned by 90 degrees the same foil tells.
draw turned 9 -60 '{"id":"part.spiral","amplitude_um":4}' "$rough"
cp spiral.truth.json pair.truth.json
judged pair 1 value --same-foil spiral.png turned.png

if [ -n "${FOILGAUGE_TEST_LONG-}" ]; then
  draw oval_rough 8 -80 "$oval" "$rough"
  judged oval_rough 2 open
  draw crown 7 30 '{"id":"part.bump_crown","amplitude_um":6}'
  judged crown 1 value
  draw shear 7 45 '{"id":"scan.shear","value":0.001}'
  judged shear 1 value
fi
draw clean 8 -80 '' "$rough"
judged clean 2 value
on_terminal clean
grep -q 'foil 1: R0 .*, form error below [0-9.]* um$' clean.txt || fail "a clean foil has no upper limit: $(grep R0 clean.txt)"

# A bump whose deviation passes for its fillets: a tenth of its arc is not seen.
draw raised 7 30 '{"id":"free.bump.index","amplitude_um":15,"bumps":[4]}'
judged raised 0.3 cut
on_terminal raised
grep -q 'bump 4: R .*, form error not known$' raised.txt || fail "the terminal says of a raised bump: $(grep 'bump 4: R' raised.txt)"
grep -q 'Not known: more than a tenth' raised.html || fail "the page does not say why a form error is not known"

exit $failed
