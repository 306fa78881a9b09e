#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge die`: the sample's traces give the die they were made of, in whatever way the text is written; its outputs;
# limits and exit codes. tests/bench/die_profiles.py made the sample, with samples/die/truth.json as its truth.
. tests/support/cli.sh
listened="stdout stderr"
sample=$root/samples/die

cp "$sample"/*.txt .
expect 0 "" "$program" die ./*.txt -o die.json
valid die.schema.json die.json

# Every radius within 3.5 u, each half's mean within 0.03 % of the thesis's +0.09 and +0.35 %, repeats within 1 um.
python3 - die.json "$sample/truth.json" <<'END' || fail "the die is not the truth"
import json, sys
report, truth = (json.load(open(name)) for name in sys.argv[1:])
wanted = {"concave": 0.09, "convex": 0.35}
bad = []
for half in report["halves"]:
    of = truth[half["half"]]
    for bump in half["bumps"]:
        number = str(bump["number"])
        for name in ("radius_mm", "centre_to_centre_mm", "bump_angle_deg"):
            off = bump[name] - of[name][number]
            if not abs(off) < 3.5 * bump["u_" + name]:
                bad.append((half["half"], number, name, off, bump["u_" + name]))
        if not (bump["repeats"] == 2 and bump["sd_radius_mm"] < 0.001 and 1e-5 < bump["u_radius_mm"] < 0.004):
            bad.append((half["half"], bump))
    if not abs(half["mean"]["radius_error_pct"] - wanted[half["half"]]) < 0.04:
        bad.append((half["half"], half["mean"]))
    if half["bumps_not_seen"] != "1, 9" or [b["number"] for b in half["bumps"]] != list(range(2, 9)):
        bad.append(half["bumps_not_seen"])
both = zip(report["die"]["bumps"], *(half["bumps"] for half in report["halves"]))
for die, a, b in both:
    if not abs(die["radius_mm"] - (a["radius_mm"] + b["radius_mm"]) / 2) < 1e-8 or die["halves"] != 2:
        bad.append(die)
print(*bad, sep="\n")
sys.exit(bool(bad))
END

# The same points, written otherwise, give the same die: micrometres, commas, columns in another order, from the right.
radius='[round(b["radius_mm"], 7) for b in r["halves"][0]["bumps"]]'
"$program" die concave_1.txt -o one.json || fail "one trace"
one=$(value one.json "$radius")
tr -d '\r' <concave_1.txt | grep '^[-0-9]' >bare.txt
tac bare.txt >from_right.txt
awk '{printf "%.3f;%.3f;\n", 1000 * $1, 1000 * $2}' bare.txt | tr . , >um.txt
awk '{print NR ", " $2 ", " $1}' bare.txt >columns.txt
(printf 'Profile\nZ [mm], N, X [mm]\n' && awk '{print $2 "," NR "," $1}' bare.txt) >named.txt
(printf '\xef\xbb\xbfUnit: \xc2\xb5m\r' && awk '{printf "%.3f\t%.3f\r", 1000 * $1, 1000 * $2}' bare.txt) >cr.txt
printf 'X\tZ\nmm\tmm\n' | cat - bare.txt >units_below.txt
common="--half concave --tip-um 2"
for written in "--unit mm bare.txt" "--unit mm from_right.txt" "--unit um um.txt" "--unit mm --columns 3,2 columns.txt" \
  named.txt cr.txt units_below.txt; do
  expect 0 "" "$program" die $common $written -o other.json
  [ "$(value other.json "$radius")" = "$one" ] || fail "$written: another die"
done
expect 0 "" "$program" die $common --unit mm --reversed --first-bump 1 bare.txt -o other.json
[ "$(value other.json "[b['number'] for b in r['halves'][0]['bumps']]")" = "[2, 3, 4, 5, 6, 7, 8]" ] || fail "reversed"
near "reversed" "$(value other.json 'r["halves"][0]["bumps"][0]["radius_mm"]')" \
  "$(value one.json 'r["halves"][0]["bumps"][-1]["radius_mm"]')" 1e-9

# A list says the same as options do.
mkdir -p set && cp bare.txt set/a.txt && cp convex_1.txt set/b.txt
printf 'profile,half,unit,tip_um\na.txt,concave,mm,2\nb.txt,convex,,\n' >set/list.csv
expect 0 "" "$program" die --list set/list.csv -o listed.json
[ "$(value listed.json "$radius")" = "$one" ] || fail "a list: another die"
printf 'profile,half\na.txt,hollow\n' >set/bad.csv
expect 65 "set/bad.csv: row 1: half must be concave or convex" "$program" die --list set/bad.csv
printf 'profile,side\na.txt,concave\n' >set/bad.csv
expect 65 "no column 'side' is read" "$program" die --list set/bad.csv

# The uncertainty of the tip's radius moves radii as a whole.
"$program" die --u-tip-um 1 concave_1.txt -o doubt.json || fail "--u-tip-um"
near "u of R" "$(value doubt.json '(r["halves"][0]["bumps"][0]["u_radius_mm"]**2 - 1e-6)**0.5')" \
  "$(value one.json 'r["halves"][0]["bumps"][0]["u_radius_mm"]')" 1e-8
near "u of h" "$(value doubt.json 'r["halves"][0]["bumps"][0]["u_height_mm"]')" \
  "$(value one.json 'r["halves"][0]["bumps"][0]["u_height_mm"]')" 1e-8
# A profile that is corrected already has the surface's radius, 2 um from the tip's centre line.
"$program" die --tip-um 0 concave_1.txt -o corrected.json || fail "--tip-um 0"
near "the tip" "$(value corrected.json 'r["halves"][0]["mean"]["radius_mm"]')" \
  "$(value one.json 'r["halves"][0]["mean"]["radius_mm"] - 0.002')" 1e-8

# A flank that the tip's cone made straight is no part of a bump: beyond 62 degrees the trace goes on as a line.
awk 'BEGIN { k = 1.88 } { x[NR] = $1; z[NR] = $2 }
  END { for (i = 2; i <= NR; i++) { low = z[i - 1] - k * (x[i] - x[i - 1]); if (z[i] < low) z[i] = low }
        for (i = NR - 1; i >= 1; i--) { low = z[i + 1] - k * (x[i + 1] - x[i]); if (z[i] < low) z[i] = low }
        for (i = 1; i <= NR; i++) printf "%.6f\t%.6f\n", x[i], z[i] }' bare.txt >flank.txt
"$program" die $common --unit mm flank.txt -o flank.json || fail "a trace with straight flanks"
python3 - flank.json one.json <<'END' || fail "straight flanks move radii"
import json, sys
cone, one = (json.load(open(n))["halves"][0]["bumps"] for n in sys.argv[1:])
radii = {b["number"]: b["radius_mm"] for b in one}
sys.exit(not (len(cone) >= 4 and all(abs(b["radius_mm"] - radii[b["number"]]) < 5 * b["u_radius_mm"] for b in cone)))
END

# The datum: the concave half touches the strip's inner side, the convex half its outer side.
design() {
  printf '{"schema":"foilgauge/design/1","bump_count":%s,"datum":"%s","tolerances":{%s}}' "$@"
}
design 9 inner "" >inner.json
"$program" die concave_1.txt convex_1.txt --design inner.json -o inner_die.json || fail "datum inner"
"$program" die concave_1.txt convex_1.txt -o mid_die.json || fail "datum mid"
for half in 0 1; do
  near "datum inner" "$(value inner_die.json "r['halves'][$half]['mean']['radius_mm']")" \
    "$(value mid_die.json "r['halves'][$half]['mean']['radius_mm'] + 0.05")" 1e-8
done

# Verdicts: bumps that no trace shows are not measured; a limit beyond the values, between them, within U.
design 9 mid '"radius_error_pct": {"max": 1}' >seen.json
expect 2 "not measured: 4 bumps that no trace shows whole" "$program" die con*.txt --design seen.json --table -
design 0 mid '"radius_error_pct": {"max": 1}' >wide.json
expect 0 "pass: every value is within" "$program" die con*.txt --design wide.json --table -
design 0 mid '"radius_error_pct": {"max": 0.25}' >narrow.json
expect 1 "fail: [0-9] values are beyond a limit by more than U" "$program" die con*.txt --design narrow.json --table -
design 0 mid '"radius_mm": {"max": 3.334}' >edge.json
expect 3 "with a limit within U" "$program" die convex_1.txt --design edge.json --table -
design 0 mid '"thickness_mm": {"max": 0.2}' >of_a_foil.json
expect 0 "no limit for a die" "$program" die convex_1.txt --design of_a_foil.json --table -

# The page: one file, errors by half with the limit, a drawing and residuals of each half, whatever a file is called.
cp convex_1.txt 'convex <b>&.txt'
expect 1 "" "$program" die concave_1.txt concave_2.txt 'convex <b>&.txt' --design narrow.json --html page.html
[ "$(grep -c '<svg' page.html)" = 6 ] || fail "the page has not its six plots"
grep -q 'class="limit"' page.html || fail "the page does not show the limit"
grep -q 'Out of tolerance' page.html || fail "the page does not show the verdict"
grep -q 'convex &lt;b&gt;&amp;.txt' page.html || fail "a file's name is not made harmless"
grep -qiE '<script|src=|href=|<b>&' page.html && fail "the page holds more than a page"
python3 -c "import sys, html.parser; html.parser.HTMLParser().feed(open(sys.argv[1]).read())" page.html || fail "no HTML"

expect 0 "named by its bumps" "$program" die --help
expect 64 "no PROFILE" "$program" die
expect 64 "--tip-um counts for the profiles that follow" "$program" die concave_1.txt --tip-um 2 -o after.json
[ -e after.json ] && fail "an option that counts for no profile was passed over"
expect 64 "--unit: 'inch'" "$program" die --unit inch bare.txt
expect 64 "--half: 'hollow'" "$program" die --half hollow bare.txt
expect 64 "" "$program" die concave_1.txt -o concave_1.txt
expect 74 "no_such.txt" "$program" die no_such.txt

# Dust on bump 5: said apart from bumps 1 and 9, which no trace shows whole; in one trace of two the other has it.
awk '$1 ~ /^[0-9.]+$/ && $1 > 16 && $1 < 18 { $2 += 0.02 * rand() } { print $1 "\t" $2 }' concave_1.txt >dusty.txt
grep -v '^[0-9.-]' concave_1.txt >dusty_1.txt
grep '^[0-9.]' dusty.txt >>dusty_1.txt
{ grep -v '^[0-9.-]' concave_2.txt
  awk '/^[0-9.]/ { if ($1 > 16 && $1 < 18) $2 += 0.02 * rand(); print $1 "\t" $2 }' concave_2.txt; } >dusty_2.txt
listened=stderr
expect 0 'concave half: lost to dust or a lost contact: bump 5: traced' "$program" die dusty_1.txt dusty_2.txt convex_[12].txt -o dust.json
grep -q 'concave half: bumps 1, 9: no trace shows them whole' stderr || fail "places that were not traced: $(cat stderr)"
valid die.schema.json dust.json
[ "$(value dust.json '[(h["bumps_not_seen"], h["bumps_lost"]) for h in r["halves"]], [t["bumps_lost"] for t in r["traces"]]')" = \
  "([('1, 5, 9', '5'), ('1, 9', '')], [[5], [5], [], []])" ] || fail "lost bumps of the report"
expect 0 'dusty_1.txt: bump 5 is lost to dust' "$program" die dusty_1.txt concave_2.txt -o dust.json
grep -q 'lost to dust or a lost contact: bump 5' stderr && fail "a bump that another trace has is lost"
expect 0 '' "$program" die --reversed dusty_1.txt -o dust.json
[ "$(value dust.json 'r["traces"][0]["bumps_lost"]')" = '[5]' ] || fail "reversed: $(value dust.json 'r["traces"][0]["bumps_lost"]')"
listened=stdout
echo '{"schema":"foilgauge/design/1","tolerances":{"radius_mm":{"min":3,"max":4}}}' >wide.json
expect 2 'not measured: 2 bumps that no trace shows whole; .*; lost to dust or a lost contact: concave bump 5$' \
  "$program" die dusty_1.txt dusty_2.txt --design wide.json --table -
grep -q 'traced, but lost to dust or a lost contact: bump 5$' stdout || fail "the table: $(grep -i bump stdout | head -3)"

exit $failed
