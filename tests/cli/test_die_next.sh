#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge die --target` and `foilgauge lot --expected`: the next die from lots of a made-up process whose springback is
# known (support/formed_lots.py), the lot that comes of it, and refusals.
. tests/support/cli.sh
skip_when_slow
listened="stdout stderr"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
made() { python3 "$root/tests/support/formed_lots.py" "$program" "$@" --renderer "$renderer" --tolerance 3 >>said 2>&1 || fail "made $*: $(tail -3 said)"; }
next() { "$program" die --target target.json "$@"; }
echo '{"schema":"foilgauge/design/1","bump_count":9,"tolerances":{"radius_error_pct":{"min":-3,"max":3}}}' >target.json

# One lot of 12 foils from a die as designed: bumps open by 5 % (in logarithms), the last three by up to 1.5 % more.
made one --end 0.015 --columns coil
expect 0 'no report of its die' next --lot one -o next.json --html next.html --table next.txt --dxf next.dxf \
  --trace-concave concave.txt --trace-convex convex.txt --step-um 1
near "radius of bump 1" "$(value next.json 'r["die"]["bumps"][0]["radius_mm"]')" 3.1577 0.025
near "radius of bump 9" "$(value next.json 'r["die"]["bumps"][8]["radius_mm"]')" 3.1107 0.03
[ "$(value next.json 'all(abs(b["radius_mm"] * 1000 - round(b["radius_mm"] * 1000)) < 1e-6 for b in r["die"]["bumps"])')" = True ] ||
  fail "radii are not in steps of 1 um"
near "overall radius" "$(value next.json 'r["die"]["overall_radius_mm"]')" 20.524 0.05
near "arc length" "$(value next.json 'r["die"]["bumps"][4]["radius_mm"] * r["die"]["bumps"][4]["bump_angle_deg"]')" 209.66 0.7
near "expected radius" "$(value next.json 'r["expected"]["bumps"][4]["radius_mm"]["mean"]')" 3.32 0.004
[ "$(value next.json 'r["expected"]["bumps"][4]["radius_mm"]["u_mean"] > r["die"]["bumps"][4]["u_radius_mm"]')" = True ] ||
  fail "what lots differ by is not in the prediction"
grep -q 'Cut bump radii' next.txt && grep -q 'Cut bump radii' next.html || fail "no sentence of the die"

# The traces are those of the die: measured, they give its numbers.
"$program" die concave.txt convex.txt -o traced.json 2>/dev/null || fail "the traces are not read"
for i in 0 8; do
  near "traced radius $i" "$(value traced.json "r['die']['bumps'][$i]['radius_mm']")" \
    "$(value next.json "r['die']['bumps'][$i]['radius_mm']")" 2e-5
  near "traced angle $i" "$(value traced.json "r['die']['bumps'][$i]['bump_angle_deg']")" \
    "$(value next.json "r['die']['bumps'][$i]['bump_angle_deg']")" 2e-3
done
near "traced lands" "$(value traced.json "r['die']['overall']['radius_mm']")" \
  "$(value next.json "r['die']['overall_radius_mm']")" 2e-5

# The profile is whole: arcs of a layer join end to end, and the bumps are the die's.
python3 - <<'P' || fail "the DXF"
import json, math
tags = open("next.dxf").read().split("\n")
pairs = list(zip(tags[::2], tags[1::2]))
assert pairs[-1] == ("0", "EOF"), pairs[-1]
arcs, now = [], None
for code, text in pairs:
    if code == "0":
        now = {} if text == "ARC" else None
        arcs += [now] if now is not None else []
    elif now is not None:
        now[code] = text
die = json.load(open("next.json"))["die"]
for layer in ("DATUM", "CONCAVE", "CONVEX"):
    ends = []
    for arc in (a for a in arcs if a["8"] == layer):
        x, y, r, low, high = (float(arc[code]) for code in ("10", "20", "40", "50", "51"))
        ends.append(sorted((x + r * math.cos(math.radians(a)), y + r * math.sin(math.radians(a))) for a in (low, high)))
    assert len(ends) == 37, len(ends)
    gap = max(math.dist(a[1], b[0]) for a, b in zip(ends, ends[1:]))
    assert gap < 2e-6, (layer, gap)
radii = [float(a["40"]) for a in arcs if a["8"] == "DATUM"][2::4]
assert all(abs(r - b["radius_mm"]) < 1e-6 for r, b in zip(radii, die["bumps"])), radii
P
cat >read_dxf.py <<'P'
try:
    import ezdxf
except ImportError:
    print("none")
else:
    drawing = ezdxf.readfile("next.dxf")
    layers = sorted({arc.dxf.layer for arc in drawing.modelspace().query("ARC")})
    print(len(drawing.modelspace().query("ARC")), *layers, len(drawing.audit().errors))
P
read=$(/usr/bin/python3 read_dxf.py)
[ "$read" = none ] || [ "$read" = "111 CONCAVE CONVEX DATUM 0" ] || fail "ezdxf reads: $read"

# The lot of that die is held against it; the law goes on with it, and the loop finds the missing term.
made two --end 0.015 --columns coil --die next.json --seed 7 --expected next.json
grep -q 'the prediction holds' said || fail "the prediction does not hold: $(cat said)"
valid expected.schema.json two/expected.json
near "error before" "$(value two/expected.json 'r["error_before_pct"]')" 5.9 0.5
near "error after" "$(value two/expected.json 'r["error_after_pct"]')" 0.2 0.3
[ "$(value two/expected.json 'r["values"], len(r["iterations"]), r["loop"]["verdict"], "bump" in r["loop"]["name"]')" = "(29, 2, 'explained', True)" ] ||
  fail "the loop over both lots: $(value two/expected.json 'r["loop"]')"
[ "$(value two/expected.json 'r["law"]["radius"]["u_springback_pct"] < r["law_before"]["radius"]["u_springback_pct"] / 1.4')" = True ] ||
  fail "a second lot teaches nothing"
grep -q 'Was the prediction right' two/expected.html || fail "no page"

# The index of lots has the history.
expect 0 '' "$program" lot --index lots.html -o lots.json one two
[ "$(value lots.json '[lot["prediction"] and lot["prediction"]["values"] for lot in r["lots"]]')" = "[None, 29]" ] || fail "the index has no history"
grep -q 'whether their predictions were right' lots.html || fail "the page over lots has no history"
valid lot_index.schema.json lots.json

# The posterior of both by one report after the other is that from both at once.
expect 0 '' next --prior two/expected.json -o by_prior.json
expect 0 '' next --prior next.json --lot two -o by_lot.json
expect 0 '' next --lot one --lot two --die next.json -o wrong_die.json # next.json for both: another law
python3 - <<'P' || fail "sequential and joint laws differ"
import json
a, b, c = (json.load(open(name + ".json")) for name in ("by_prior", "by_lot", "wrong_die"))
assert a["die"] == b["die"] and a["law"]["radius"] == b["law"]["radius"]
assert c["law"]["radius"] != a["law"]["radius"]
P
# A lot that its die was not made for: off, and said so.
made off --springback 0.09 --die next.json --seed 3 --expected next.json
grep -q 'the prediction was wrong\|questionable' said || fail "a process that moved by 4 % is not noticed: $(tail -4 said)"
[ "$(value off/expected.json 'r["inside"] < r["values"]')" = True ] || fail "all values of a moved process are inside"

# One foil; other numbers of bumps; one radius for all.
made single --foils 1
expect 0 'more is not proven by the scatter of 1 foil of single' next --lot single -o single.json
[ "$(value single.json 'r["die"]["bumps"][0]["u_radius_mm"]')" \> "$(value next.json 'r["die"]["bumps"][0]["u_radius_mm"]')" ] ||
  fail "one foil is as sure as twelve"
made seven --bumps 7 --template seven_template
expect 0 'has 7 bumps, the target 9' next --lot seven -o nine.json
[ "$(value nine.json 'r["die"]["bumps"][8]["u_radius_mm"] > r["die"]["bumps"][3]["u_radius_mm"]')" = True ] || fail "a bump never seen is as sure as one seen"
expect 0 '' next --lot one --common --foils 100 -o common.json
[ "$(value common.json 'r["expected"]["foils"]')" = 100 ] || fail "--foils"
[ "$(value common.json 'len({b["radius_mm"] for b in r["die"]["bumps"]})')" = 1 ] || fail "--common: several radii"

# Die and heat treatment together: an experiment that tells springback well moves the setting, one that does not keeps it.
python3 - <<'P'
import random
rng = random.Random(1)
for name, sd in (("good", 0.02), ("poor", 3.0)):
    with open(f"{name}.csv", "w") as out:
        out.write("temperature_C,duration_h,springback_error_pct\n")
        for t in (500, 550, 600, 650, 700):
            for d in (3, 5, 3, 5):
                out.write(f"{t},{d},{-(8 - 0.02 * (t - 500) - 0.2 * (d - 3)) + rng.gauss(0, sd):.4f}\n")
P
for name in good poor; do
  expect 0 '' next --lot one --doe $name.csv --setting 'temperature_C=550, duration_h=5' -o $name.json --html $name.html --table $name.txt
  grep -q 'heat treatment' $name.txt && grep -q 'Die and heat treatment together' $name.html || fail "$name: no trade"
done
near "springback at the warmest" "$(value good.json '[s for s in r["settings"] if s["setting"] == "temperature_C=700, duration_h=5"][0]["share"]')" 0.548 0.02
[ "$(value good.json '[s["setting"] for s in r["settings"] if s["chosen"]][0] != r["settings"][0]["setting"]')" = True ] || fail "a good experiment is not used"
[ "$(value poor.json 'r["settings"][0]["chosen"], r["settings"][0]["share"]')" = "(True, 1)" ] || fail "a poor experiment moves the setting"
expect 64 'needs the --setting' next --lot one --doe good.csv
expect 64 "'duration_h' has no value" next --lot one --doe good.csv --setting 'temperature_C=550'

# A plain strip has a mandrel.
for i in 1 2 3; do
  printf '{"schema":"foilgauge/render/1","seed":%d,"foils":[{"design":{"form":"arc","overall_radius_mm":20.73,"subtended_angle_deg":110,
"thickness_mm":0.1},"overall_radius_mm":21.%d4,"rotate_deg":-90}],"scanner":{"dpi":600}}' $i $i >strip.json
  "$renderer" render strip.json -o strip$i.png || fail "render"
done
sed 's/"flatbed"/"not needed: rendered"/' "$root/samples/top_foil_design.json" >strip_design.json
"$program" lot strip?.png -o strips --design strip_design.json --pages none >said 2>&1 || [ $? -le 3 ] || fail "strips: $(cat said)"
expect 0 'Cut the mandrel' "$program" die --target strip_design.json --lot strips -o mandrel.json --html mandrel.html --dxf mandrel.dxf --table -
near "mandrel" "$(value mandrel.json 'r["die"]["overall_radius_mm"]')" "$(python3 -c 'print(20.73 ** 2 / 21.24)')" 0.03
[ "$(value mandrel.json 'r["die"]["bumps"]')" = "[]" ] || fail "a mandrel with bumps"
valid next_die.schema.json next.json good.json mandrel.json

# One foil of three is scanned eight times: the lot's means are of three foils, as in the lot of one scan each.
python3 - "$root" "$program" "$renderer" <<'P' || fail "lots of repeated scans"
import random, sys
sys.path.insert(0, sys.argv[1] + "/tests/support")
from formed_lots import DESIGN, Template
template = Template(sys.argv[2], "template", {**DESIGN, "bump_count": 9, "tolerances": {"radius_error_pct": {"min": -3, "max": 3}}},
                    renderer=sys.argv[3])
foils = [template.foil(20.73 + 0.02 * k, 40 / 3, [(3.3 * (1 + 0.01 * k), 62 + k)] * 9) for k in range(3)]
for name, of in (("once", [0, 1, 2]), ("often", [0, 1] + [2] * 8)):
    template.write(name, [foils[k] for k in of], {"foil": [f"f{k}" for k in of]}, options=("--expected", "next.json"))
# Bump 5 is missing in the second of three scans: its mean is that of the two scans that show it.
scans = [template.foil(20.77, 40 / 3, [(3.3 + 0.06 * k, 64 - k)] * 9) for k in range(3)]
scans[1]["bumps"] = [bump for bump in scans[1]["bumps"] if bump["number"] != 5]
for name, of in (("gap", [0, 1, 2]), ("both", [0, 2])):
    template.write(name, foils[:2] + [scans[k] for k in of], {"foil": ["f0", "f1"] + ["f2"] * len(of)}, options=("--expected", "next.json"))
P
for of in radius_mm bump_angle_deg height_mm; do
  near "a scan without the bump: $of" "$(value gap/expected.json "r[\"bumps\"][4][\"$of\"][\"measured\"]")" "$(value both/expected.json "r[\"bumps\"][4][\"$of\"][\"measured\"]")" 1e-9
done
for of in 'bumps"][4]["radius_mm' 'bumps"][4]["bump_angle_deg' 'bumps"][4]["height_mm' 'overall_radius_mm'; do
  near "repeated scans: $of" "$(value often/expected.json "r[\"$of\"][\"measured\"]")" "$(value once/expected.json "r[\"$of\"][\"measured\"]")" 1e-9
done

# Refused: no lot, no lot's folder, another strip, datum or kind, limits of the shop.
expect 64 'name one with --lot' "$program" die --target target.json
expect 64 'put --lot first' "$program" die --target target.json --die next.json --lot one
expect 74 'nowhere' next --lot nowhere
echo '{"schema":"foilgauge/design/1","bump_radius_mm":3.32,"bump_angle_deg":63.15,"overall_radius_mm":20.73,"thickness_mm":0.12}' >thick.json
expect 65 'its strip has 0.1 mm, the target.s 0.12' "$program" die --target thick.json --lot one
python3 -c "
import json
r = json.load(open('next.json')); r['target']['thickness_mm'] = 0.2; json.dump(r, open('thick_die.json', 'w'))
r['target']['thickness_mm'], r['target']['datum'] = 0.1, 'outer'; json.dump(r, open('outer_die.json', 'w'))"
expect 65 'thick_die.json: the die is of a strip of 0.2 mm' next --lot one --die thick_die.json
expect 65 'datum is outer, the target.s is mid' next --lot one --die outer_die.json
echo '{"schema":"foilgauge/design/1","datum":"inner"}' >inner.json
expect 65 'measured for datum mid, the target has inner' "$program" die --target inner.json --lot one
expect 65 'its foils are of form classical, the target.s of form arc' "$program" die --target "$root/samples/top_foil_design.json" --lot one
expect 65 'is bent by no die' "$program" die --target "$root/samples/cantilever_design.json" --lot one
expect 65 'beyond 2 %.*--max-move-pct' next --lot one --max-move-pct 2
expect 65 'below the smallest radius that can be cut' next --lot one --min-radius-mm 3.2
expect 65 'neither a report of' next --prior target.json
expect 65 'neither a report of .foilgauge die -o' next --lot one --die target.json
expect 65 'no report of .foilgauge die --target' "$program" lot one.csv -o two --resume --recipe template/recipe.json --expected traced.json
expect 64 'of a whole lot' "$program" lot one.csv -o two --shard 1/2 --expected next.json
python3 -c "
import json
r = json.load(open('next.json')); r['law']['sets'] = []; json.dump(r, open('empty.json', 'w'))
r['law']['sets'] = 7; json.dump(r, open('number.json', 'w'))"
expect 65 'the same scans as lot one, which counts already' next --lot one --lot one
expect 65 'the same scans as lot two' next --prior two/expected.json --lot two
cp -r one again
expect 65 'rests on this lot, which cannot test it' "$program" lot one.csv -o again --resume --recipe template/recipe.json --expected next.json
expect 65 'law.sets is missing or empty' next --prior empty.json
expect 65 'sets.*must be an array' next --prior number.json
exit $failed
