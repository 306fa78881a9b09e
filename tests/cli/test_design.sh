#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge design`: its output, refused designs, and the committed clearance curve.
. tests/support/cli.sh
listened="stdout stderr"

expect 0 "0.564527 mm" "$program" design
expect 0 '"height_mm": 0.5645266892' "$program" design --json
expect 0 "--curve" "$program" design --help
expect 64 "" "$program" design --no-such-option
expect 64 "one DESIGN at a time" "$program" design a b
expect 64 "drop --json" "$program" design --json --curve
expect 74 "no/such.json" "$program" design no/such.json
expect 74 "no/such/out.json" "$program" design -o no/such/out.json

echo '{"schema": "foilgauge/design/1", "pitch_deg": -3}' >"$work/bad.json"
expect 65 "$work/bad.json: pitch_deg is -3" "$program" design "$work/bad.json" -o "$work/never.json"
[ -s "$work/stdout" ] && fail "a refused design prints on standard output"
[ -e "$work/never.json" ] && fail "a refused design leaves an output file"

echo '{"schema": "foilgauge/design/1", "form": "discs", "diameters_mm": [4]}' >"$work/discs.json"
expect 0 "4.000000 mm" "$program" design "$work/discs.json"
expect 65 "there is no curve" "$program" design --curve "$work/discs.json"

# A board to print: as many marks as the sheet holds, at the stated pitch, with their numbers; three of a corner are left out.
expect 0 "" "$program" design grid --svg "$work/board.svg"
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "chessboard", "pitch_mm": 4}' >"$work/squares.json"
expect 0 "" "$program" design "$work/squares.json" --svg "$work/squares.svg" --sheet 120x90
for marks in crosses lines; do
  echo "{\"schema\": \"foilgauge/design/1\", \"form\": \"grid\", \"marks\": \"$marks\", \"pitch_mm\": 2}" >"$work/$marks.json"
  expect 0 "" "$program" design "$work/$marks.json" --svg "$work/$marks.svg" --sheet 100x60
done
python3 - "$work" <<'P' || fail "the boards are not as stated"
import re, sys
import xml.etree.ElementTree as tree
SVG = '{http://www.w3.org/2000/svg}'
def board(name):
    root = tree.parse('%s/%s.svg' % (sys.argv[1], name)).getroot()
    return root, root.find(SVG + "g[@id='marks']")
root, marks = board('board')
assert (root.get('width'), root.get('viewBox')) == ('210mm', '0 0 210 297'), root.attrib
dots = [(float(c.get('cx')), float(c.get('cy'))) for c in marks]
assert len(dots) == 37 * 54 - 3, len(dots)
steps = {(round((x - 15) / 5, 6), round((y - 16) / 5, 6)) for x, y in dots}
assert steps == {(i, j) for i in range(37) for j in range(54) if i + j > 1}, sorted(steps)[:5]
words = [t.text for t in root.iter(SVG + 'text')]
assert '35' in words and '50' in words and any('pitch 5 mm, 37 × 54' in w for w in words), words
_, marks = board('squares')
squares = re.findall(r'M([-0-9.]+) ([-0-9.]+)h4.0000v4.0000h-4.0000z', marks[0].get('d'))
assert len(squares) == (24 * 16) // 2 and all(abs((float(x) - float(squares[0][0])) % 4) < 1e-6 for x, _ in squares), len(squares)
assert len(board('crosses')[1]) == 2 * (37 * 17 - 3) and len(board('lines')[1]) == 37, (len(board('crosses')[1]), len(board('lines')[1]))
P
expect 65 "needs a design of form" "$program" design --svg "$work/never.svg"
expect 65 "no room for" "$program" design grid --svg "$work/never.svg" --sheet 30x30
expect 64 "like 210x297" "$program" design grid --svg "$work/never.svg" --sheet 210
[ -e "$work/never.svg" ] && fail "a refused board leaves a file"

# Stiffness: three models in the table, the JSON and the page; the numbers that a user gives count.
expect 0 "Heshmat, Walowit and Anno" "$program" design
expect 64 "is not a number from 0 to 10" "$program" design --friction -1
expect 64 "is not a number from 0 to 0.499" "$program" design --poisson-ratio 0.3x
expect 65 "has no bumps" "$program" design "$work/discs.json" --html "$work/never.html"
[ -e "$work/never.html" ] && fail "a page of a design without bumps"
expect 0 "<!doctype html>" "$program" design --html -
expect 64 "two outputs cannot go to one file" "$program" design --html - --json
expect 64 "two outputs cannot go to one file" "$program" design --html "$work/a" -o "$work/a"
"$program" design --html "$work/page.html" -o "$work/stiff.json" || fail "design --html"
# A model that the field names and that is no row is named with the reason.
grep -q "Iordanoff</dt><dd>Not a row" "$work/page.html" || fail "the page does not say why Iordanoff's formulas are not there"
"$program" design --youngs-modulus-gpa 100 -o "$work/soft.json" || fail "design --youngs-modulus-gpa"
"$program" design "$work/discs.json" -o "$work/none.json" || fail "design of discs"
echo '{"schema": "foilgauge/design/1", "form": "sinusoidal"}' >"$work/sinus.json"
"$program" design "$work/sinus.json" --friction 5 --html "$work/sinus.html" -o "$work/sinus-out.json" ||
  fail "a sinusoidal design"
"$program" design "$root/samples/top_foil_design.json" -o "$work/arc.json" || fail "design of a plain strip"
expect 65 "has no bumps" "$program" design "$root/samples/top_foil_design.json" --html "$work/never.html"
valid nominal.schema.json "$work/arc.json" "$work/stiff.json" "$work/soft.json" "$work/none.json" "$work/sinus-out.json"
checks - "$work" <<'END' || fail "the stiffness of a design"
import json, sys
one, soft, none, sinus = (json.load(open(f"{sys.argv[1]}/{name}.json")) for name in ("stiff", "soft", "none", "sinus-out"))
assert "stiffness" not in none
models = one["stiffness"]["models"]
assert [m["id"] for m in models] == ["arch", "heshmat", "link_spring"]
for model, half in zip(models, soft["stiffness"]["models"]):
    assert abs(half["design"]["stiffness_n_mm2"] / model["design"]["stiffness_n_mm2"] - 0.5) < 1e-9
map = one["stiffness"]["map"]
at = lambda r, a: map["normalised"][map["bump_angle_over_design"].index(a)][map["radius_over_design"].index(r)]
assert at(0.9, 0.7) > 2 and at(1.35, 1.1) < 0.4
assert "long fillets" in sinus["stiffness"]["note"] and one["stiffness"]["note"] is None
assert all(r is not None for row in map["normalised"] for r in row)
link = sinus["stiffness"]["models"][2]["design"]
assert link["stiffness_n_mm2"] is None and "holds links" in link["reserve"]
END
grep -q 'long fillets' "$work/sinus.html" || fail "the page of a sinusoidal design has no reserve"
grep -q 'bump radius over the design' "$work/page.html" || fail "the page has no map"

# A cantilever: its numbers, those of the thesis, and who refuses it.
cantilever=$root/samples/cantilever_design.json
expect 0 'compliance [+]3.59 %, sagitta [+]0.88 %, clearance -0.0088 mm [(]-7.0 %' "$program" design "$cantilever"
expect 0 "compliance -3.43 %, sagitta -0.88 %" "$program" design "$cantilever"
expect 0 "4.542056 mm/N" "$program" design "$cantilever"
"$program" design "$cantilever" -o "$work/cantilever.json" || fail "design of a cantilever"
echo '{"schema": "foilgauge/design/1", "form": "cantilever", "beam_length_mm": 9, "beam_width_mm": 3, "thickness_mm": 0.1}' >"$work/flat.json"
expect 0 'sagitta [+]2.01 %' "$program" design "$work/flat.json"
grep -q "mm/N\|clearance" "$work/stdout" && fail "what nobody stated is told of a cantilever"
"$program" design "$work/flat.json" -o "$work/flat-out.json" || fail "design of a bare cantilever"
valid nominal.schema.json "$work/cantilever.json" "$work/flat-out.json"
expect 65 "there is no curve" "$program" design --curve "$cantilever"
expect 64 "form is cantilever" "$program" loop "$root/samples/gen2_foil.png" --design "$cantilever"
expect 64 "a cantilever has no built-in design" "$program" measure "$root/samples/gen2_foil.png" --form cantilever
expect 65 "lies flat" "$program" form "$cantilever"

# A written design loads again and gives the same.
"$program" design -o "$work/first.json" || fail "design -o"
sed -n '/^ "design": {/,/^ }/p' "$work/first.json" | sed '1s/.*/{/; $s/.*/}/' >"$work/again.json"
expect 0 "0.564527 mm" "$program" design "$work/again.json"

"$program" design --curve >"$work/curve.csv" || fail "design --curve"
[ "$(wc -l <"$work/curve.csv")" = 37 ] || fail "the curve has not 36 rows"
cmp "$work/curve.csv" "$root/reports/thesis/clearance_curve.csv" ||
  fail "reports/thesis/clearance_curve.csv is not what 'foilgauge design --curve' writes"

exit $failed
