#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A reference curve over the errors per bump of a lot: drawn, kept in the lot's recipe; bad files refused.
. tests/support/cli.sh
listened="stdout stderr"

mkdir lot
for i in 1 2 3; do
  echo '{"schema": "foilgauge/render/1", "seed": '$i', "scanner": {"dpi": 1200}, "foils": [{"design": {"bump_count": 3},
   "radius_springback": {"mean": 0.03, "sd": 0.01}}]}' >$i.spec
  "$renderer" render $i.spec -o lot/$i.png || fail "render $i"
done
echo '{"schema": "foilgauge/design/1", "bump_count": 3}' >design.json
# As Europe writes it, bumps in any order, a column more.
printf 'bump;radius_error_pct;note;intersection_angle_error_pct\n3;2,5;x;-2,25\n1;3,5;;-3,25\n' >curve.csv

expect 0 "" "$program" lot lot -o out --name curved --design design.json --reference-curve curve.csv
valid lot.schema.json out/lot.json
[ "$(value out/lot.json 'r["reference_curve"]["points"]')" = "[[1, 3.5, -3.25], [3, 2.5, -2.25]]" ] ||
  fail "lot.json has another curve: $(value out/lot.json 'r["reference_curve"]')"
[ "$(grep -o 'class="hypothesis" style="[^"]*" d="M[^"]*z"' out/index.html | wc -l)" = 4 ] || fail "the page has not four diamonds"
grep -q 'the reference curve curve.csv' out/index.html || fail "the page does not name the curve"
# Without its file the lot reads the same.
mv curve.csv away.csv
cp -r out again
expect 0 "" "$program" lot lot -o again --name curved --resume --recipe out/recipe.json
same out/index.html again/index.html
same out/lot.json again/lot.json
mv away.csv curve.csv
echo '{"schema": "foilgauge/recipe/1", "design": "design.json", "reference_curve": "curve.csv"}' >recipe.json
expect 0 '"reference_curve": [{]' "$program" lot --print-recipe --recipe recipe.json

# refused WORDS TEXT
refused() {
  printf "$2" >bad.csv
  expect 65 "bad.csv.*$1|$1.*bad.csv" "$program" lot lot -o never --design design.json --reference-curve bad.csv
  [ -e never ] && fail "a refused curve leaves a folder"
}
head=bump,radius_error_pct,intersection_angle_error_pct
refused "intersection_angle_error_pct" "bump,radius_error_pct\n1,2\n"
refused "bump 4; the design has 3" "$head\n1,2,3\n4,2,3\n"
refused "bump is 0; it must be" "$head\n0,2,3\n"
refused "bump is 1.5; it must be" "$head\n1.5,2,3\n"
refused "bump 2 is there twice" "$head\n2,1,1\n2,2,3\n"
refused "row 1" "$head\n1,nan,3\n"
refused "row 2" "$head\n1,2,3\n2,x,3\n"
refused "empty|header|rows" ""
refused "rows" "$head\n"
expect 74 "gone.csv" "$program" lot lot -o never --design design.json --reference-curve gone.csv
echo '{"schema": "foilgauge/recipe/1", "reference_curve": {"name": "a", "points": []}}' >bad.json
expect 65 "reference_curve: points are missing" "$program" lot lot -o never --recipe bad.json
echo '{"schema": "foilgauge/recipe/1", "reference_curve": 3}' >bad.json
expect 65 "must be the path of a CSV" "$program" lot lot -o never --recipe bad.json

exit $failed
