#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A lot whose recipe names the dies that its foils were pressed in: springback against the die beside that against the
# design. Foils are rendered at 1.05 times the radius of dies that are 1 % and 3 % too large.
. tests/support/cli.sh
listened="stdout stderr"
cp "$root"/samples/die/con*.txt .
echo '{"schema": "foilgauge/design/1", "bump_count": 3}' >design.json
"$program" die con*.txt -o measured.json || fail "die"

# Reports of two dies: the sample's numbers scaled to what the foils are made of. B's traces do not show bump 1.
python3 - <<'END'
import json
for name, error in (("a", 0.01), ("b", 0.03)):
    report = json.load(open("measured.json"))
    die = report["die"]
    die["mean"]["radius_mm"] = 3.32 * (1 + error)
    for bump in die["bumps"]:
        bump["radius_mm"], bump["number"] = 3.32 * (1 + error), bump["number"] - (1 if name == "a" else 0)
    json.dump(report, open(f"{name}.json", "w"))
END
for foil in 1 2 3 4; do
  error=$([ $foil -le 2 ] && echo 0.0605 || echo 0.0815)
  printf '{"schema":"foilgauge/render/1","seed":%d,"foils":[{"design":{"bump_count":3},"overall_radius_mm":20.9,
"radius_springback":{"mean":%s,"sd":0},"rotate_deg":-90}],"scanner":{"dpi":1200,"blur_px":1.0,"noise":1}}' \
    $foil "$error" >spec.json
  "$renderer" render spec.json -o "foil$foil.png" || fail "render"
done
printf 'scan,die\nfoil1.png,A\nfoil2.png,A\nfoil3.png,B\nfoil4.png,B\n' >lot.csv
echo '{"schema":"foilgauge/recipe/1","design":"design.json","resamples":1000,"dies":{"A":"a.json","B":"b.json"}}' >recipe.json
expect 0 "4 foils" "$program" lot lot.csv -o lot --name "the lot" --recipe recipe.json
valid lot.schema.json lot/lot.json
for i in 0 1; do
  near "springback against die $i" "$(value lot/lot.json "r['dies']['each'][$i]['radius_error_to_die_mean_pct']")" 5 0.05
  near "foils of die $i" "$(value lot/lot.json "r['dies']['each'][$i]['radius_error_mean_pct'] - 2.1 * $i")" 6.05 0.05
done
[ "$(value lot/lot.json "[d['bumps_by_mean'] for d in r['dies']['each']]")" = "[0, 2]" ] || fail "bumps by the mean"
near "share of the difference" "$(value lot/lot.json 'r["dies"]["explained_difference_pct"]')" 95.2 2
near "share of the variance" "$(value lot/lot.json 'r["dies"]["explained_variance_pct"]')" 99 2
near "share of the mean" "$(value lot/lot.json 'r["dies"]["each"][1]["explained_by_die_pct"]')" 36.8 1
python3 - <<'END' || fail "bumps.csv"
import csv, sys
rows = list(csv.DictReader(open("lot/bumps.csv")))
for row in rows:
    ratio = float(row["radius_mm"]) / float(row["die_radius_mm"])
    off = float(row["radius_error_to_die_pct"]) - 100 * (ratio - 1)
    u = float(row["u_radius_error_to_die_pct"])
    if not (abs(off) < 1e-6 and float(row["u_radius_mm"]) * 100 / 3.5 < u < 0.5):
        sys.exit(str(row))
sys.exit(len(rows) != 12)
END
grep -q 'Dies: what of the deviation is theirs' lot/index.html || fail "the page has no dies"
grep -q "Held against the die's mean" lot/index.html || fail "the page does not say what the mean stands for"

# The lot's folder says all: it is reported anew, and in parts, without the dies' files.
mv a.json kept_a.json
cp -r lot again
expect 0 "" "$program" lot lot.csv -o again --name "the lot" --resume --recipe lot/recipe.json
same lot again
for part in 1 2; do
  expect 0 "" "$program" lot lot.csv -o "part$part" --recipe lot/recipe.json --name "the lot" --shard $part/2
done
expect 0 "" "$program" merge part1 part2 -o merged
same lot/lot.json merged/lot.json
mv kept_a.json a.json

# The same by options; without dies nothing is said of them.
expect 0 "" "$program" lot lot.csv -o options --design design.json --die A=a.json --die B=b.json
near "by options" "$(value options/lot.json 'r["dies"]["each"][0]["radius_error_to_die_mean_pct"]')" 5 0.05
expect 0 "" "$program" lot lot.csv -o without --design design.json
grep -q '"dies"' without/lot.json without/recipe.json && fail "dies of a lot without"
grep -q 'die_radius_mm' without/bumps.csv && fail "a column of dies of a lot without"

# Errors are reported before anything is measured.
expect 65 "there is no report; name it, or leave the cell empty" "$program" lot lot.csv -o bad --die A=a.json
expect 65 "has no column 'die'" "$program" lot foil1.png -o bad --die A=a.json
expect 65 "recipe.json: not a report of .foilgauge die" "$program" lot lot.csv -o bad --die A=recipe.json
expect 65 "con.*txt: line 1, column 1: this is not JSON" "$program" lot lot.csv -o bad --die A=concave_1.txt
expect 74 "no.json" "$program" lot lot.csv -o bad --die A=no.json
expect 65 "'A' is there twice" "$program" lot lot.csv -o bad --die A=a.json --die A=b.json
expect 64 "not NAME=FILE.json" "$program" lot lot.csv -o bad --die a.json
echo '{"schema":"foilgauge/design/1","datum":"inner"}' >inner.json
expect 65 "was measured for datum mid" "$program" lot lot.csv -o bad --design inner.json --die A=a.json --die B=b.json
[ -e bad ] && fail "a lot that is refused leaves a folder"

exit $failed
