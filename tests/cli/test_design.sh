#!/bin/bash
# `foilgauge design`: what it prints, what it refuses, and the committed clearance curve.
. tests/support/cli.sh
listened="stdout stderr"

expect 0 "0.564527 mm" "$program" design
expect 0 '"height_mm": 0.5645266892' "$program" design --json
expect 0 "--curve" "$program" design --help
expect 64 "" "$program" design --no-such-option
expect 64 "more than one DESIGN" "$program" design a b
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

# What is written loads again and gives the same.
"$program" design -o "$work/first.json" || fail "design -o"
sed -n '/^ "design": {/,/^ }/p' "$work/first.json" | sed '1s/.*/{/; $s/.*/}/' >"$work/again.json"
expect 0 "0.564527 mm" "$program" design "$work/again.json"

"$program" design --curve >"$work/curve.csv" || fail "design --curve"
[ "$(wc -l <"$work/curve.csv")" = 37 ] || fail "the curve has not 36 rows"
cmp "$work/curve.csv" "$root/reports/thesis/clearance_curve.csv" ||
  fail "reports/thesis/clearance_curve.csv is not what 'foilgauge design --curve' writes"

exit $failed
