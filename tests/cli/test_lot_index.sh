#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge lot --index`: lots whose differences are known (support/made_lots.py makes them out of one that was
# measured), dies, designs, dates; lots that cannot be read.
. tests/support/cli.sh
listened="stdout stderr"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
index() { "$program" lot --index i.html -o i.json --csv i.csv "$@"; }
# is EXPRESSION WORDS ...: what i.json says, all asked at once; it is kept for the schema.
kept=0
is() {
  cp i.json "kept$((kept += 1)).json"
  python3 - i.json "$@" <<'P' || fail "i.json of $*"
import json, sys
r = json.load(open(sys.argv[1]))
lots = {lot["folder"]: lot for lot in r["lots"]}
pairs = r["comparisons"]["pairs"]
for ask, answer in zip(sys.argv[2::2], sys.argv[3::2]):
    if str(eval(ask)) != answer:
        sys.exit(f"FAIL: {ask} is {eval(ask)}, not {answer}")
P
}

# One lot that was measured: its own date comes from its scan's file, or from the manifest.
mkdir scans
printf '{"schema":"foilgauge/render/1","foils":[{"design":{"bump_count":3},"rotate_deg":-90}],"scanner":{"dpi":1200}}' >spec.json
"$renderer" render spec.json -o scans/a.png || fail "render"
(cat scans/a.png && echo b) >scans/b.png # other bytes: another scan
touch -d '2025-03-04T12:00:00Z' scans/a.png
touch -d '2025-03-06T12:00:00Z' scans/b.png
echo '{"schema":"foilgauge/design/1","bump_count":3,"calibration": "not needed: the scan is rendered", "tolerances":{"height_mm":{"min":0.5,"max":0.6}}}' >design.json
"$program" lot scans -o model --design design.json --name 'Lot <b>&' 2>said || fail "lot: $(cat said)"
[ "$(value model/lot.json 'r["date"]')" = "{'first': '2025-03-04', 'last': '2025-03-06', 'from': 'scans'}" ] ||
  fail "the date of the scans: $(value model/lot.json 'r["date"]')"
touch scans/a.png
rm model/lot.json
"$program" lot model/manifest.csv -o model --design design.json --name 'Lot <b>&' --resume 2>said || fail "resume: $(cat said)"
[ "$(value model/lot.json 'r["date"]["first"]')" = 2025-03-04 ] || fail "a record lost its date"
dated() {
  printf 'scan,date\nscans/a.png,%s\nscans/b.png,%s\n' "$1" "$2" >m.csv
  rm -rf dated
  "$program" lot m.csv -o dated --design design.json 2>said || fail "lot: $(cat said)"
  [ "$(value dated/lot.json 'list(r["date"].values())')" = "$3" ] || fail "dates $1, $2: $(value dated/lot.json 'r["date"]')"
}
dated 20.11.2026 '' "['2026-11-20', '2026-11-20', 'manifest']"
dated '2026-11-20 13:45' 2026-11-19 "['2026-11-19', '2026-11-20T13:45', 'manifest']"
[ "$(value dated/lot.json 'r["date"]["from"]')" = manifest ] || fail "the manifest's dates are not taken"
dated 11/20/2026 2026-11-19 "['2025-03-06', '$(date -u +%F -r scans/a.png)', 'scans', 1]"

# The lots of the tests below: 12 foils of 3 bumps each, alike but for the options listed here.
cat >list <<'L'
a --seed 1 --date 2026-01-10
a2 --seed 4 --date 2026-01-10
b --seed 2 --date 2026-03-10 --radius 0.06
c --seed 3 --date 2026-02-10
other --seed 5 --date 2026-04-10 --design-radius 3.0
d1 --seed 6 --date 2026-05-10 --die A,B --die-radius 0.05
d2 --seed 7 --date 2026-05-11 --die A,B --die-radius 0.05 --radius 0.1
e1 --seed 8 --die A
e2 --seed 9 --die B
none --seed 1 --foils 0 --date 2026-01-01
far --seed 200 --date 2026-06-01 --radius 0.2
L
for i in $(seq 10 99); do echo "l$i --seed $i --date 2026-01-$((i % 28 + 1))"; done >>list
python3 "$root/tests/support/made_lots.py" model --list list || fail "made_lots"

# One lot alone; a name that would like to be markup.
expect 0 'One lot: there is nothing to compare' index model
is 'r["lots_read"]' 1 'r["comparisons"]["tested"]' 0
grep -q '<b>&' i.html && fail "a lot's name became markup"
grep -q 'href="model/index.html"' i.html || fail "no link"
[ "$(wc -l <i.csv)" -gt 8 ] || fail "i.csv: $(wc -l <i.csv) lines"

# Three lots, one of them with 0.06 mm more radius: found, by that much, and nothing else.
expect 0 'Bump radius: larger in lot 3 \(b\) than in lot' index c b a
is '[lot["name"] for lot in r["lots"]]' "['a', 'c', 'b']" \
  'sorted({(p["quantity"], p["larger"], p["smaller"]) for p in pairs if p["differs"]})' \
  "[('radius_mm', 'b', 'a'), ('radius_mm', 'b', 'c')]" \
  'all(abs(p["difference"] - 0.06) < 3 * p["u_difference"] < 0.05 for p in pairs if p["differs"])' True \
  '[q["same_as"] for q in r["quantities"] if q["name"] == "radius_error_pct"]' "['radius_mm']" \
  'r["comparisons"]["tested"]' 9
python3 "$root/tests/support/made_lots.py" --check i.json || fail "the comparisons are not what their lots say"

# Twice the same; two of one date stay in order of their names; a lot beside its copy is no evidence.
expect 0 'a/\.: the same folder as a, counts once' index a2 a a/.
is '[lot["name"] for lot in r["lots"]]' "['a', 'a2']"
cp -r b copy
expect 0 'share 12 scans' index b copy
is 'r["comparisons"]["tested"]' 0

# Designs that differ share an axis only relative to their nominal values.
expect 0 'of 2 different designs' index a other
is '[q["scale"] for q in r["quantities"] if q["name"] in ("radius_mm", "radius_error_pct")]' "['over_design', 'as_is']" \
  '[p["differs"] for p in pairs if p["quantity"] == "radius_mm"]' '[False]' \
  'abs(lots["other"]["quantities"]["radius_mm"]["mean"] - 1.05) < 0.01' True

# Dies: within lots that have both; and where a die is a lot.
expect 0 'Bump radius: larger of die B than of die A' index d1 d2
is '[(c["basis"], c["lots"], c["larger"]) for c in r["die_comparisons"] if c["differs"]]' "[('within_lots', 2, 'B')]" \
  'abs(r["die_comparisons"][0]["difference"] - 0.05) < 0.015' True
expect 0 '1 pair of dies cannot be told from their lots' index e1 e2
is '{(c["basis"], c["p"]) for c in r["die_comparisons"]}' "{('not_separable', None)}"

# Nine lots, one of them out of the run of the others; ninety-one.
expect 0 'Bump radius, out of the run of the other lots: lot 9 \(far\)' index l1[0-7] far
is '[name for name, lot in lots.items() if lot["quantities"]["radius_mm"]["unexpected"]]' "['far']" \
  'sum(lot["quantities"]["height_mm"]["unexpected"] for lot in r["lots"])' 0
expect 0 '91 lots' index l?? far
is '[name for name, lot in lots.items() if lot["quantities"]["radius_mm"]["unexpected"]]' "['far']" 'len(pairs)' 2000
rm "kept$kept.json" # thousands of pairs alike take the schema long
[ "$(wc -c <i.html)" -lt 700000 ] || fail "a page of 91 lots has $(wc -c <i.html) bytes"

# Nothing measured in a lot; tables that are gone, or of another run: the lot stays, without tests.
expect 0 'No two lots can be compared' index none a
is 'lots["none"]["quantities"]["radius_mm"]["mean"]' None
cp -r b torn; rm torn/bumps.csv
expect 0 'torn/bumps.csv.*no density and no test' index torn a
is '[bool(lot["foils_unknown"]) for lot in r["lots"]]' "[False, True]"
cp a/bumps.csv torn/bumps.csv
expect 0 'other values of radius_mm than lot.json' index torn a

# Unreadable lots are named with a remedy, and the others are shown.
bad() {
  expect 2 "$2" index a "$1" b
  grep -q '"lots_not_read": 1' i.json || fail "$1: i.json does not say so"
  grep -q 'Not on this page: 1' i.html || fail "$1: the page does not say so"
  expect 65 "$2" "$program" lot --index no.html "$1"
  [ -e no.html ] && fail "$1: a page of nothing"
}
mkdir empty begun newer damaged wrong
bad nowhere 'nowhere'
bad empty 'not the folder of a lot.*foilgauge lot SCANS -o empty'
cp model/results.jsonl model/manifest.csv begun
bad begun 'not finished.*--resume'
sed 's|foilgauge/lot/1|foilgauge/lot/2|' a/lot.json >newer/lot.json
bad newer 'newer/lot.json: of another version, foilgauge/lot/2'
head -c 3000 a/lot.json >damaged/lot.json
bad damaged 'damaged/lot.json: not JSON: damaged or cut off'
cp i.json wrong/lot.json
bad wrong "not the report of a lot \(its schema is 'foilgauge/lot_index/1'\)"
"$program" lot model/manifest.csv -o shard --design design.json --shard 1/2 2>/dev/null
bad shard 'one of 2 shards.*foilgauge merge'
bad a/lot.json 'not a folder'
for file in lot.json foils.csv bumps.csv index.html; do
  expect 64 'would overwrite' "$program" lot --index a/$file a b
  expect 64 'would overwrite' "$program" lot --index i.html -o a/$file a b
done
expect 64 'belongs to --index' "$program" lot scans -o x --csv x.csv
expect 74 'cannot be' "$program" lot --index y.html -o y.json --csv nowhere/y.csv a b
[ -e y.html ] || [ -e y.json ] && fail "outputs beside one that cannot be written"
python3 - a/lot.json <<'P'
import json, sys
lot = json.load(open(sys.argv[1]))
lot["name"] = "a\x1b[31m"
json.dump(lot, open(sys.argv[1], "w"))
P
expect 0 'Lots? .*a.x1B.31m|a.x1B.31m' index b a
grep -q $'\x1b' i.html i.json stderr && fail "a control character of a lot's name"

# Two lots of one process, nine foils each, every foil scanned four times: a foil counts once, or its scans, which scatter
# less than foils do, would make two lots of it and signals of its chart. In the lots with "names" the column says so.
python3 - "$root/tests/support" "$program" "$renderer" <<'P' || fail "lots of repeated scans"
import math, pathlib, random, sys
sys.path.insert(0, sys.argv[1])
import formed_lots as made
template = made.Template(sys.argv[2], "template", {**made.DESIGN, "bump_count": 9}, renderer=sys.argv[3])
rng = random.Random(4)
for lot in ("first", "second"):
    foils, names = [], []
    for foil in range(9):
        own, overall = rng.gauss(0, 0.006), 20.93 * math.exp(rng.gauss(0, 0.0015))
        radii = [3.32 * math.exp(0.05 + own + rng.gauss(0, 0.006)) for _ in range(9)]
        for scan in range(4):
            foils.append(template.foil(overall, 40 / 3, [(r * math.exp(rng.gauss(0, 1e-4)), 3.32 * 63.15 / r) for r in radii]))
            names.append(f"foil {foil + 1}")
    template.write(lot + "_named", foils, {"foil": names})
    template.write(lot + "_apart", foils)
# One stated thickness for all foils: the last bit of a mean over 23 or 41 of them is no difference.
template = made.Template(sys.argv[2], "stated", {**made.DESIGN, "bump_count": 3, "thickness_mm": 0.1003}, renderer=sys.argv[3])
process = made.Process(random.Random(1), lot_sd=0)
for count in (3, 10, 14, 23, 30, 41):
    template.write(f"stated{count}", [template.foil(*foil) for foil in process.lot(made.die_of_design(made.DESIGN, 3), count)])
pathlib.Path("die_design.json").write_text('{"schema":"foilgauge/design/1","bump_count":9}')
P
expect 0 'No two lots differ' index first_named second_named
is '{(p["larger"], p["smaller"]) for p in pairs if p["differs"]}' 'set()' '[q["foils"] for q in r["lots"][0]["quantities"].values()][0]' 9 \
  'r["lots"][0]["radius_over_design"]["count"]' 81 'r["lots"][0]["foils_unknown"]' None
expect 0 '' index first_apart second_apart
is '[q["foils"] for q in r["lots"][0]["quantities"].values()][0]' 36
[ "$(value first_named/lot.json '[r["counts"][k] for k in ("foils", "foils_scanned_again")]')" = '[36, 27]' ] || fail "scans of a foil are not counted"
[ "$(value first_named/lot.json '[r["quantities"]["radius_mm"][k] for k in ("count", "stable")]')" = '[81, True]' ] || fail "a chart of scans"
[ "$(value first_apart/lot.json '[r["quantities"]["radius_mm"][k] for k in ("count", "stable")]')" = '[324, False]' ] || fail "a chart of scans that no column joins"
grep -q 'Different foils' first_named/index.html && ! grep -q 'Different foils' first_apart/index.html || fail "the page's number of foils"
expect 0 'No two lots differ' index stated3 stated10 stated14 stated23 stated30 stated41
is '[p["quantity"] for p in pairs if p["quantity"] == "thickness_mm"]' '[]' '[s for s in r["summary"] if "hickness" in s]' '[]'
expect 0 '' "$program" die --target die_design.json --lot first_named -o next.json
[ "$(value next.json 'r["expected"]["foils"]')" = 9 ] || fail "the next die counts scans for foils"
valid lot.schema.json first_named/lot.json
valid lot_index.schema.json kept*.json i.json
valid lot.schema.json model/lot.json dated/lot.json
exit $failed
