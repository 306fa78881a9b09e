#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Plain strips (form "arc"): reports, lots, refused input.
. tests/support/cli.sh
listened="stdout stderr"

cat >design.json <<'J'
{"schema": "foilgauge/design/1", "form": "arc", "overall_radius_mm": 15, "subtended_angle_deg": 40, "thickness_mm": 0.1,
 "calibration": "not needed: the scan is rendered", "tolerances": {"arc.subtended_angle_deg": {"min": 39, "max": 41}, "overall.radius_mm": {"max": 15.4}}}
J
# strip NAME MORE: a scan of a strip whose foil has more members.
strip() {
  cat >"$1.spec" <<J
{"schema": "foilgauge/render/1", "seed": ${3-1}, "scanner": {"dpi": 1200}, "foils": [{"design": {"form": "arc",
 "overall_radius_mm": 15, "subtended_angle_deg": 40}, "rotate_deg": -70$2}]}
J
  "$renderer" render "$1.spec" -o "$1.png" --truth "$1.truth" || fail "render $1"
}
mkdir lot
strip lot/a ', "overall_radius_mm": 15.2'
strip lot/b ', "overall_radius_mm": 15.3' 2
strip lot/c ', "overall_radius_mm": 15.25, "subtended_angle_deg": 38' 3
strip lip ', "lip": {}'

expect 0 "" "$program" measure lot/a.png --design design.json -o a.json --csv a.csv --html a.html
valid measure.schema.json a.json
valid design.schema.json design.json
near radius "$(value a.json 'r["foils"][0]["overall"]["radius_mm"]')" 15.2 0.002
near angle "$(value a.json 'r["foils"][0]["arc"]["subtended_angle_deg"]')" 39.473684 0.01
[ "$(head -n 1 a.csv | tr , '\n' | grep -c '^arc\.')" = 3 ] || fail "a.csv has not three columns of arcs"
grep -q 'Angle between the ends' a.html || fail "the page does not say the angle"
expect 1 "arc.subtended_angle_deg|OUT" "$program" measure lot/c.png --design design.json
expect 2 '"lip"' "$program" measure lip.png --design design.json
expect 0 "40.000000 deg" "$program" design design.json
expect 0 "design arc, form arc" "$program" design design.json
expect 65 "there is no curve" "$program" design --curve design.json

# A written design loads again.
"$program" design --json design.json | sed -n '/^ "design": {/,/^ }/p' | sed '1s/.*/{/; $s/.*/}/' >again.json
expect 0 "40.000000 deg" "$program" design again.json

echo '{"schema": "foilgauge/recipe/1", "name": "strips", "design": "design.json"}' >recipe.json
expect 1 "" "$program" lot lot -o out --recipe recipe.json
valid lot.schema.json out/lot.json
near mean "$(value out/lot.json 'r["quantities"]["overall.radius_mm"]["mean"]')" 15.25 0.003
[ "$(value out/lot.json '"height_mm" in r["quantities"]')" = False ] || fail "a lot of strips has bump heights"

expect 65 "form arc. has no radius_mm.*overall.radius_mm" "$program" loop --lot out
expect 2 "plain strip without bumps.*form.*arc" "$program" measure lot/a.png
expect 64 "the loop needs bumps or discs" "$program" loop lot/a.png --design design.json
expect 64 "no built-in design" "$program" measure lot/a.png --form arc
# refused WORDS MEMBERS
refused() {
  echo "{\"schema\": \"foilgauge/design/1\", \"form\": \"arc\"$2}" >bad.json
  expect 65 "$1" "$program" design bad.json
}
core=', "overall_radius_mm": 15, "thickness_mm": 0.1'
refused "subtended_angle_deg: is missing" "$core"
refused "thickness_mm: is missing" ', "overall_radius_mm": 15, "subtended_angle_deg": 40'
refused "subtended_angle_deg is 360" "$core, \"subtended_angle_deg\": 360"
refused "subtended_angle_deg is 0" "$core, \"subtended_angle_deg\": 0"
refused "bump_radius_mm: belongs to a foil with bumps" "$core, \"subtended_angle_deg\": 40, \"bump_radius_mm\": 3"
refused "top_foil_thickness_mm: belongs" "$core, \"subtended_angle_deg\": 40, \"top_foil_thickness_mm\": 0.1"
refused "tolerances.height_mm: no such quantity" "$core, \"subtended_angle_deg\": 40, \"tolerances\": {\"height_mm\": {\"max\": 1}}"
echo '{"schema": "foilgauge/design/1", "subtended_angle_deg": 40}' >bad.json
expect 65 "belongs to form .arc. only" "$program" design bad.json

exit $failed
