#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The model of a scanner: its own scanner, lots corrected by it, and every wrong model refused with words.
. tests/support/loop.sh
listened="stdout stderr"

# render NAME SEED ROTATION EFFECTS [DPI]: every scan shows the same piece of glass.
render() { render_foil "$1" "$2" "$3" "$4" "${5:-1200}" '"width_px":1900,"height_px":1900,'; }

scale='{"id":"scan.scale_y","value":0.002}'
render a 1 -75 "$scale"
render b 2 15 "$scale"
mkdir scans
for i in 1 2 3; do render scans/s$i 1$i $((i * 100)) "$scale"; done
rm scans/*.json
expect 0 '' "$program" loop --same-foil a.png b.png --scanner 'left desk' --model-out left.json
[ "$(value left.json "r['scanner'], r['tied'], r['level'], [f['id'] for f in r['fields']]")" = \
  "('left desk', False, 'points', ['scan.scale_y'])" ] || fail "left.json is not what was asked for"
[ "$(value left.json "r['inputs'][1]['sha256']")" = "$(sha256sum b.png | cut -c1-64)" ] || fail "left.json: inputs"

# A model corrects scans of its own scanner.
expect 0 '' "$program" measure scans/s1.png --model left.json --scanner 'left desk' -o s1.out
near "R0 corrected" "$(value s1.out "r['foils'][0]['overall']['radius_mm']")" 20.95 0.001
[ "$(value s1.out "r['inputs'][0]['model_sha256']")" = "$(sha256sum left.json | cut -c1-64)" ] || fail "model_sha256"
[ "$(value s1.out "r['foils'][0]['place_mm'][2] > 10")" = True ] || fail "a corrected foil has lost its place"
# Corrected values are marked, with the model and the change: on the page, in the JSON, in the table, in the CSV.
expect 0 '' "$program" measure scans/s1.png --model left.json --html s1.html --csv s1.csv -o s1.out
expect 0 '' "$program" measure scans/s1.png --html plain.html --csv plain.csv -o plain.out
script -qec "$program measure scans/s1.png --model left.json" s1.txt >/dev/null </dev/null
script -qec "$program measure scans/s1.png" plain.txt >/dev/null </dev/null
day=$(value left.json "r['date'][:10]") sum=$(sha256sum left.json | cut -c1-64)
[ "$day" = "$(date -u -r b.png +%F)" ] || fail "left.json: the date is not its newest scan's but $day"
for file in s1.html s1.txt; do
  for words in 'left.json' 'left desk' "$day" "$sum" 'a wrong scale along the carriage' \
    '\(199[0-9.]*\|200[0-9.]*\) ± [0-9.]* ppm' 'moved R0 by [-+][0-9.]* µm, R by up to' 'h by up to' 'to u of R0' \
    'without a known diameter' 'x 0 to 40.2'; do
    grep -q "$words" $file || fail "$file does not say '$words'"
  done
  grep -q 'own error of scale is not in it' $file && fail "$file says what a model has made untrue"
done
grep -qi 'corrected by' plain.html plain.txt && fail "what is not corrected says that it is"
grep -q 'own error of scale is not in it' plain.html || fail "plain.html does not speak of the scale"
grep -q 'own error of scale is not in it' plain.txt || fail "plain.txt does not speak of the scale"
[ "$(value plain.out "r['model'], 'correction' in r['foils'][0]")" = '(None, False)' ] || fail "plain.out names a model"
[ "$(python3 -c "import csv; print(next(csv.DictReader(open(\"s1.csv\")))[\"model_sha256\"])")" = "$sum" ] || fail "s1.csv does not name the model"
[ "$(python3 -c "import csv; print(next(csv.DictReader(open(\"plain.csv\")))[\"model_sha256\"])")" = "" ] || fail "plain.csv names a model"
checks - "$sum" <<'P' || fail "s1.out: the model and what it did"
import json, sys
r, plain = json.load(open("s1.out")), json.load(open("plain.out"))["foils"][0]
m, foil = r["model"], r["foils"][0]
assert m["path"] == "left.json" and m["sha256"] == sys.argv[1] and m["scanner"] == "left desk" and m["scans"] == 2
assert m["known_diameters"] == 0 and not m["tied"] and m["region_mm"][2] > 40
assert [e["id"] for e in m["effects"]] == ["scan.scale_y"] and abs(m["effects"][0]["parameters"]["value"] - 0.002) < 1e-4
c, digits = foil["correction"], 2e-8  # ten digits of 20.95
assert abs(c["overall_radius_mm"] - (foil["overall"]["radius_mm"] - plain["overall"]["radius_mm"])) < digits
for name in "radius_mm", "height_mm":
    moves = [a[name] - b[name] for a, b in zip(foil["bumps"], plain["bumps"])]
    assert abs(c[name] - max(moves, key=abs)) < digits, (name, c[name], moves)
    assert 0 < c["u_" + name] < 1e-4
P

expect 65 "scanner 'left desk', not of 'right desk'" "$program" measure a.png --model left.json --scanner 'right desk'
sed 's/"left desk"/null/' left.json >nameless.json
expect 65 'does not say which scanner' "$program" measure a.png --model nameless.json --scanner 'left desk'
expect 0 '' "$program" measure a.png --model nameless.json -o x.out
expect 64 'give one' "$program" measure a.png --scanner 'left desk'
expect 64 'name must have 1 to' "$program" loop a.png --scanner ''
render half 3 -75 "$scale" 600
expect 65 '600 dpi and the model is of a scanner at 1200' "$program" measure half.png --model left.json -o never.out
[ ! -e never.out ] || fail "a refused model leaves a report behind"

# Its region: outside it is said, at twice that far it is refused.
region() {
  python3 - "$1" "$2" <<'P'
import json, sys
model = json.load(open("left.json"))
model["region_mm"] = [0, 0, float(sys.argv[2]), float(sys.argv[2])]
json.dump(model, open(sys.argv[1], "w"))
P
}
region small.json 30 && region tiny.json 15
expect 0 'reaches beyond the 30 x 30 mm' "$program" measure a.png --model small.json -o x.out
[ "$(value x.out "r['foils'][0]['flags']")" = "['beyond_model_region']" ] || fail "a foil beyond the region has no flag"
expect 0 'reaches beyond' "$program" measure a.png --model small.json --html x.html
grep -q 'reaches beyond the region' x.html || fail "the page does not say that the foil reaches beyond the region"
expect 65 'times as far on the glass as the 15 x 15 mm' "$program" measure a.png --model tiny.json

# In a tie of a scale and nothing at all no dimension is moved to what one of them says: it stays as scanned, the
# truth is inside its U, and the report says so.
python3 - <<'P'
import json
model = json.load(open("left.json"))
model["tied"], model["alternatives"], model["weights"] = True, [[]], [0.99, 0.01]
json.dump(model, open("likely.json", "w"))
del model["weights"]
json.dump(model, open("tied.json", "w"))
P
expect 0 'other explanations' "$program" measure scans/s1.png --model likely.json -o likely.out
expect 0 'other explanations did as well' "$program" measure scans/s1.png --model tied.json -o tied.out
expect 0 '' "$program" measure scans/s1.png -o scanned.out
expect 0 '' "$program" measure scans/s1.png --model tied.json --html tied.html
python3 - <<'P'
import json
model = json.load(open("left.json"))
for field in model["fields"]:
    field["u_amplitude_mm"] = [30 * u for u in field["u_amplitude_mm"]]
json.dump(model, open("vague.json", "w"))
P
expect 0 '' "$program" measure scans/s1.png --model vague.json -o vague.out
checks - <<'P' || fail "a tied model does not widen the uncertainty to what its alternative would change"
import json
read = lambda name: json.load(open(name))["foils"][0]
tied, sure, scanned = read("tied.out"), read("s1.out"), read("scanned.out")
import subprocess
move = 0.002 * 20.95 / 2  # the scale along one axis, on a circle seen over some 120 degrees: half and more
assert tied["overall"]["radius_mm"] == scanned["overall"]["radius_mm"] != sure["overall"]["radius_mm"]
assert [b["height_mm"] for b in tied["bumps"]] == [b["height_mm"] for b in scanned["bumps"]]
off = abs(scanned["overall"]["radius_mm"] - sure["overall"]["radius_mm"])
assert tied["overall"]["u_radius_mm"] > 0.6 * off > 0.3 * move > 10 * sure["overall"]["u_radius_mm"]
assert tied["correction"]["overall_radius_mm"] == 0
# The mean by weight is the correction; its u holds the rest of the doubt.
likely, move_made = read("likely.out"), sure["overall"]["radius_mm"] - scanned["overall"]["radius_mm"]
assert abs(likely["correction"]["overall_radius_mm"] - 0.99 * move_made) < 1e-6, (likely["correction"], move_made)
assert abs(likely["correction"]["u_overall_radius_mm"] / (0.0995 * abs(move_made)) - 1) < 0.05, likely["correction"]
assert {c["quantity"]: c["moved"] for c in tied["corrections"]} == dict.fromkeys(["overall_radius_mm", "radius_mm", "height_mm"], False)
assert all(c["reason"].startswith("differs between explanations") for c in tied["corrections"])
assert abs(tied["corrections"][0]["move_mm"]) > 0.4 * off  # the mean of all and nothing
assert all(c["moved"] for c in sure["corrections"]) and "radius_not_corrected" in tied["flags"]
page = open("tied.html").read()
for words in "R0 left as measured", "R left as measured", "h left as measured", "cannot tell apart", "It moved nothing":
    assert words in page, words
for other in tied, read("vague.out"):  # every quantity with an uncertainty is widened
    pairs = list(zip(other["bumps"], sure["bumps"]))
    for name in pairs[0][0]:  # of a clearance beside the thickness' far larger u, not to be seen for every bump
        if name.startswith("u_") and name != "u_centre_mm":
            assert all(wide[name] >= narrow[name] for wide, narrow in pairs), name
            assert any(wide[name] > narrow[name] for wide, narrow in pairs), name
P

# Everything that is no model: measure and lot both refuse it, and say why.
printf 'not a model' >text.json
head -c 400 left.json >cut.json
sed 's/"dpi": \[[^]]*\]/"dpi": [NaN, 1200]/' left.json >nan.json
sed 's/scan\.scale_y/scan.wormhole/' left.json >unknown.json
sed 's/"u_amplitude_mm": \[[^]]*\]/"u_amplitude_mm": [null]/' left.json >null.json
sed 's/"u_amplitude_mm": \[[^]]*\]/"u_amplitude_mm": [-0.001]/' left.json >negative.json
sed 's/"u_amplitude_mm": \[[^]]*\]/"u_amplitude_mm": [1e200]/' left.json >huge.json
sed 's/"amplitude_mm": \[[^]]*\]/"amplitude_mm": [5]/' left.json >far.json
sed 's/"dpi": \[[^]]*\]/"dpi": [0, 1200]/' left.json >zero.json
sed 's/"region_mm": \[[^]]*\]/"region_mm": [0, 0, -1, 40]/' left.json >inside_out.json
sed 's/"scanner": "left desk"/"scanner": 7/' left.json >number.json
printf '{"schema":"foilgauge/design/1"}' >design.json
printf '[]' >list.json
python3 - <<'P'
import json
model = json.load(open("left.json"))
model["fields"] *= 9
json.dump(model, open("many.json", "w"))
del model["fields"]
json.dump(model, open("empty.json", "w"))
P
while IFS='|' read -r file code words; do
  expect "$code" "$words" "$program" measure a.png --model "$file" -o never.out
  grep -q "$file" $work/stderr || fail "$file is not named"
  expect "$code" "$words" "$program" lot scans --model "$file" -o never
  [ ! -e never.out ] && [ ! -e never ] || fail "$file leaves something behind"
done <<'TABLE'
text.json|65|line 1, column 1: this is not JSON
cut.json|65|line 14, column .*: this is not JSON
nan.json|65|line 7, column .*: this is not JSON
unknown.json|65|effect that is not known: scan.wormhole
null.json|65|`fields.0..u_amplitude_mm.0.` is null; 0 to 1 mm is allowed .scan.scale_y
negative.json|65|`fields.0..u_amplitude_mm.0.` is -0.001; 0 to 1 mm is allowed .scan.scale_y
huge.json|65|`fields.0..u_amplitude_mm.0.` is 1e.200; 0 to 1 mm is allowed .scan.scale_y
far.json|65|`fields.0..amplitude_mm.0.` is 5; -1 to 1 mm is allowed .scan.scale_y
zero.json|65|`dpi.0.` is 0; 1 to 1e.06 dpi is allowed
inside_out.json|65|`region_mm` must be
number.json|65|`scanner` must be
design.json|65|not a model of a scanner
list.json|65|not a model of a scanner
many.json|65|`fields` holds 9 effects; at most 8 are allowed
empty.json|65|`fields` is missing
missing.json|74|missing.json
TABLE

[ -n "${FOILGAUGE_TEST_LONG-}" ] || exit $failed

# A lot corrected by it: the same numbers as one by one, and the report says by what.
expect 0 '' "$program" lot scans -o plain
expect 0 '' "$program" lot scans --model left.json --scanner 'left desk' -o one
[ "$(value one/lot.json "r['model_sha256']")" = "$(sha256sum left.json | cut -c1-64)" ] || fail "lot.json: model_sha256"
[ "$(value plain/lot.json "r['model_sha256']")" = None ] || fail "lot.json without a model"
for words in "$sum" 'left desk' "$day" 'Corrected by' 'a wrong scale along' 'It moved R0 by [-+]' 'without a known diameter'; do
  grep -q "$words" one/index.html || fail "the lot's page does not say '$words'"
done
grep -q 'Corrected by' plain/index.html && fail "a lot that is not corrected says that it is"
[ "$(value one/lot.json "r['model']['scanner'], r['model']['path'], r['correction']['u_height_mm'] > 0")" = \
  "('left desk', 'scanner_model.json', True)" ] || fail "lot.json: the model"
[ "$(value plain/lot.json "r['model'], 'correction' in r")" = "(None, False)" ] || fail "lot.json without a model: model"
expect 0 '' "$program" lot scans --model small.json -o beyond
grep -q 'model was found in: 3 of 3 foils' beyond/index.html || fail "the lot's page does not say that foils reach beyond the region"
[ "$(value beyond/lot.json "all('beyond_model_region' in f['flags'] for f in r['foils'])")" = True ] || fail "lot.json: no flag"
cmp -s left.json one/scanner_model.json || fail "the lot does not keep its model"
grep -q model plain/recipe.json && fail "a lot without a model has a recipe that speaks of one"
checks - one plain <<'P' || fail "the lot's radii"
import csv, json, sys
r0 = [[float(row["overall.radius_mm"]) for row in csv.DictReader(open(f"{folder}/foils.csv"))] for folder in sys.argv[1:]]
measured = json.load(open("s1.out"))["foils"][0]["overall"]["radius_mm"]
assert abs(r0[0][0] - measured) < 1e-8, (r0[0][0], measured)
assert all(abs(v - 20.95) < 0.001 for v in r0[0]), r0[0]
assert max(abs(v - 20.95) for v in r0[1]) > 0.02, r0[1]
P

# Quantities that a tied model knows too poorly stay as scanned in a lot as well: the table flags it, the page counts it.
expect 0 '' "$program" lot scans --model tied.json -o open
checks - open plain <<'P' || fail "a lot corrects by a tied model, or does not say that it does not"
import csv, sys
rows = [list(csv.DictReader(open(f"{folder}/foils.csv"))) for folder in sys.argv[1:]]
for tied, plain in zip(*rows):
    for flag in "overall_radius_not_corrected", "radius_not_corrected", "height_not_corrected":
        assert flag in tied["flags"] and flag not in plain["flags"], tied["flags"]
    assert tied["overall.radius_mm"] == plain["overall.radius_mm"]
    assert float(tied["overall.u_radius_mm"]) > float(plain["overall.u_radius_mm"])
P
grep -q 'Left as measured: the bump radii R of 3 of 3 foils' open/index.html || fail "the lot's page does not say what was left"

# Kept while the model stays; another one, or none, is another measurement.
sed 's/0\.036/0.035/' left.json >other.json
cmp -s left.json other.json && sed 's/"version"/ "version"/' left.json >other.json
expect 0 ' 0 to measure, 3 kept' "$program" lot scans --model left.json -o one --resume --dry-run
expect 0 ' 3 to measure, 0 kept' "$program" lot scans --model other.json -o one --resume --dry-run
expect 0 ' 3 to measure, 0 kept' "$program" lot scans -o one --resume --dry-run
cp -r one again
expect 0 '' "$program" lot scans -o again --resume
diff -r again plain || fail "a lot resumed without its model is not the lot without it"
expect 0 ' 0 to measure, 3 kept' "$program" lot scans --recipe one/recipe.json -o one --resume --dry-run
cp -r one swapped && cp other.json swapped/scanner_model.json
expect 65 'not the model that' "$program" lot scans --recipe swapped/recipe.json -o no
expect 65 "not of 'right desk'" "$program" lot scans --recipe one/recipe.json --scanner 'right desk' -o no

# Shards: wherever the model's file lies, the lot is the same; other models do not mix.
mkdir elsewhere && cp left.json elsewhere/renamed.json
mkdir part
expect 0 '' "$program" lot scans --model left.json -o part/1 --shard 1/2
expect 0 '' "$program" lot scans --model elsewhere/renamed.json -o part/2 --shard 2/2
expect 0 '3 foils' "$program" merge part/1 part/2 -o merged
diff -r one merged || fail "shards with a model are not the lot"
expect 0 '' "$program" lot scans --model other.json -o foreign --shard 2/2
expect 65 "scanner's models differ" "$program" merge part/1 foreign -o no
expect 0 '' "$program" lot scans -o bare --shard 2/2
expect 65 "scanner's models differ" "$program" merge part/1 bare -o no

# A scan that the model does not fit is not measured; the others are.
cp half.png scans/half.png
expect 2 '600 dpi' "$program" lot scans --model left.json -o mixed
[ "$(value mixed/lot.json "r['counts']['foils'], r['counts']['scans_not_measured']")" = "(3, 1)" ] || fail "mixed lot"

# Input that the loop refuses.
cp a.png copy.png
render third 8 -70 ''
sed -i 's/3.34,3.41/4.24,3.41/' third.json && "$program" render third.json -o third.png || fail "render another foil"
while IFS='|' read -r code words arguments; do
  # shellcheck disable=SC2086
  expect "$code" "$words" "$program" loop $arguments
done <<'TABLE'
65|one resolution|a.png half.png
65|one resolution|a.png --hold-out half.png
64|given twice|a.png --hold-out a.png
64|given twice|a.png a.png
65|the same scan|a.png ./a.png
65|the same scan|b.png a.png --hold-out copy.png
64|give a scan|
64|give a scan|--hold-out a.png
65|not the same foil|--same-foil a.png third.png
65|not JSON|a.png --design text.json
65|text.json|text.json
74|missing.png|missing.png
74|nowhere|a.png -o /nowhere/x.json
TABLE

# Two bumps: done, and their limits are stated; of one bump hardly more rows are left than numbers would be fitted.
for bumps in 1 2; do
  cat >few.json <<SPEC
{"schema":"foilgauge/render/1","seed":3,"foils":[{"design":{"bump_count":$bumps},"overall_radius_mm":20.95,
 "radius_springback":{"mean":0.02,"sd":0.01}}],"scanner":{"dpi":2400,"blur_px":1.3,"noise":1.2}}
SPEC
  printf '{"schema":"foilgauge/design/1","bump_count":%d}' $bumps >few_design.json
  "$program" render few.json -o few.png || fail "render $bumps bumps"
  [ $bumps -eq 1 ] && expect 65 'edge rows are too few' "$program" loop few.png --design few_design.json -o few.out && continue
  expect 0 '' "$program" loop few.png --design few_design.json -o few.out
  [ "$(value few.out "r['verdict'], r['bumps']['count']")" = "('clean', $bumps)" ] || fail "$bumps bumps: verdict"
  value few.out "r['notes'][0]" | grep -q "$bumps measured: no effect over them can be told" ||
    fail "$bumps bumps: nothing is said of them"
  [ "$(value few.out "{x['verdict'] for x in r['rejected'] if x['level'] == 'bumps'}")" = "{'inconclusive'}" ] ||
    fail "$bumps bumps: effects are called absent"
done

for pair in scan_model:left scan_model:tied lot:one/lot measure:s1.out loop_scan:few.out; do
  file=${pair#*:}
  [ -e "$file" ] || file=$file.json
  (cd "$root" && python3 -c 'import jsonschema' 2>/dev/null || exit 0
  python3 tests/support/validate_schema.py reports/schema "${pair%%:*}.schema.json" "$work/$file") ||
    fail "$file does not validate"
done

exit $failed
