#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scans that exist only as JPEG: refused by every command unless loss is allowed, then flagged, and wider.
. tests/support/cli.sh
to_jpeg=$(dirname "$program")/tests/to_jpeg

cat >spec.json <<'J'
{"schema": "foilgauge/render/1", "seed": 19, "foils": [{"design": {"bump_count": 3}}],
 "scanner": {"dpi": 2400, "blur_px": 1.2, "noise": 1}}
J
echo '{"schema": "foilgauge/design/1", "name": "three", "bump_count": 3, "tone": "linear"}' >design.json
echo '{"schema": "foilgauge/recipe/1", "design": "design.json", "allow_lossy": true}' >recipe.json
"$renderer" render spec.json -o scan.png || fail "render"
mkdir lot
"$to_jpeg" scan.png lot/scan.jpg 80 && "$to_jpeg" lot/scan.jpg pixels.pgm 0 || fail "no JPEG"

measure() {
  "$program" measure --design design.json "$@"
}

# Refused by name, with the way out, wherever scans are read.
printf 'scan,D\nlot/scan.jpg,1\nlot/scan.jpg,2\nlot/scan.jpg,3\n' >runs.csv
expect 65 'lot/scan.jpg: is compressed with loss \(JPEG\).*"allow_lossy": true in a recipe, or the option --allow-lossy' \
  measure lot/scan.jpg
expect 65 '--allow-lossy' "$program" loop --design design.json lot/scan.jpg
expect 65 '--allow-lossy' "$program" doe runs.csv --scans scan --design design.json --response radius_mm --model '1 + D'
expect 2 '--allow-lossy' "$program" lot lot --design design.json -o refused
value refused/lot.json 'r["inputs"][0]["error"]' | grep -q 'allow-lossy' || fail "lot.json does not say why"

mkdir watched
cp lot/scan.jpg watched/s1.jpg
expect 2 '--allow-lossy' "$program" station watched --design design.json --once
touch -d "1 hour ago" watched/s1.jpg # a file that was refused is looked at again when it changes
expect 0 '1 measured' "$program" station watched --design design.json --once --allow-lossy

# Allowed: in every form of the report, and wider than the same pixels that do not tell where they are from.
expect 0 'note: lot/scan.jpg: compressed with loss \(JPEG, quality 80\)' \
  measure lot/scan.jpg --allow-lossy -o lossy.json --csv lossy.csv --html lossy.html
measure pixels.pgm --dpi 2400 -o pixels.json || fail "the pixels are not measured"
valid measure.schema.json lossy.json
[ "$(value lossy.json 'r["inputs"][0]["format"], r["inputs"][0]["jpeg_quality"]')" = "('JPEG', 80)" ] || fail "inputs"
[ "$(value lossy.json '"lossy" in r["foils"][0]["flags"]')" = True ] || fail "no flag in the JSON"
[ "$(grep -c ',lossy,' lossy.csv)" = 3 ] || fail "no flag in the CSV"
grep -q '<li>The scan was compressed with loss (JPEG)' lossy.html || fail "the page does not say it"
foil='r["foils"][0]'
near "radius, all the same" "$(value lossy.json "$foil['bumps'][1]['radius_mm']")" \
  "$(value pixels.json "$foil['bumps'][1]['radius_mm']")" 1e-12
checks - <<'P' || fail "the uncertainties do not hold the loss"
import json
# The quality is found in the pixels alone, too: their uncertainties are as those of the JPEG.
lossy, pixels = (json.load(open(f"{name}.json"))["foils"][0] for name in ("lossy", "pixels"))
wide = [lossy["u_thickness_mm"] / pixels["u_thickness_mm"]]
wide += [a[n] / b[n] for a, b in zip(lossy["bumps"], pixels["bumps"]) for n in ("u_radius_mm", "u_bump_angle_deg")]
assert {"block_noise", "lossy"} <= set(pixels["flags"]), pixels["flags"]
assert min(wide) > 0.95 and max(wide) < 1.05, wide
P

# The loop says it before and after.
expect 0 '' "$program" loop --design design.json --allow-lossy lot/scan.jpg -o loop.json --html loop.html
[ "$(value loop.json '["lossy" in r[w]["foils"][0]["flags"] for w in ("before", "after")]')" = '[True, True]' ] || fail "loop: no flag"
value loop.json 'r["notes"]' | grep -q 'lot/scan.jpg was compressed with loss (JPEG, quality 80)' || fail "loop: no note"
grep -q 'was compressed with loss' loop.html || fail "the loop's page does not say it"

# A lot takes them by its recipe or by the option, and says how many.
expect 0 '1 foil of 1 scan' "$program" lot lot --recipe recipe.json -o taken
[ "$(value taken/lot.json '"lossy" in r["foils"][0]["flags"]')" = True ] || fail "lot.json: no flag"
grep -q '"allow_lossy": true' taken/recipe.json || fail "the lot's recipe forgets it"
grep -q 'compressed with loss (JPEG), which moves edges: 1 of 1 foils' taken/index.html || fail "the lot's page is silent"
expect 0 '1 foil of 1 scan' "$program" lot lot --design design.json --allow-lossy -o by/option
sed 's/true/1/' recipe.json >wrong.json
expect 65 'allow_lossy must be true or false' "$program" lot lot --recipe wrong.json -o no


# Sharp and noisy edges: what JPEG leaves of them is no tone curve of a wider edge.
cat >sharp.json <<'J'
{"schema": "foilgauge/render/1", "seed": 4, "foils": [{"design": {"bump_count": 3}}],
 "scanner": {"dpi": 4800, "blur_px": 0.77, "noise": 2.4, "background": 33.7, "contrast": 167}}
J
echo '{"schema": "foilgauge/design/1", "name": "three", "bump_count": 3}' >asked.json
"$renderer" render sharp.json -o sharp.png --truth sharp_truth.json && "$to_jpeg" sharp.png sharp.jpg 85 || fail "render"
"$program" measure --design asked.json --allow-lossy sharp.jpg -o sharp_report.json || fail "the sharp JPEG is not measured"
checks - <<'P' || fail "a JPEG of sharp edges is measured wrongly"
import json
measured, truth = json.load(open("sharp_report.json"))["foils"][0]["bumps"], json.load(open("sharp_truth.json"))["bumps"]
wrong = [1000 * (m["radius_mm"] - t["radius_mm"]) for m, t in zip(measured, truth)]
assert max(map(abs, wrong)) < 1, wrong
P

# A plate whose picture once was a JPEG gives a model of the scanner as one without loss does.
cat >plate.json <<'J'
{"schema": "foilgauge/render/1", "seed": 6, "effects": [{"id": "scan.scale_y", "value": 0.0015}],
 "discs": [{"centre_mm": [4, 4], "radius_mm": 2.5}, {"centre_mm": [12, 4], "radius_mm": 3}, {"centre_mm": [5, 13], "radius_mm": 3.5},
           {"centre_mm": [14, 13], "radius_mm": 2}],
 "scanner": {"dpi": 2400, "blur_px": 1.4, "noise": 1.5, "background": 33, "contrast": 167, "rough": {"jpeg": {"quality": 85}}}}
J
"$renderer" render plate.json -o plate.png || fail "render"
expect 0 'block_noise' "$program" loop plate.png --form discs --model-out plate.model
checks - <<'P' || fail "the model of a plate that once was a JPEG"
import json
field, = json.load(open("plate.model"))["fields"]
off = field["amplitude_mm"][0] - 18 * 0.0015
assert field["id"] == "scan.scale_y" and abs(off) < 2 * field["u_amplitude_mm"][0] < 18 * 0.0003, (off, field)
P

exit $failed
