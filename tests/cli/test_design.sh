#!/bin/bash
# `foilgauge design`: what it prints, what it refuses, and the committed clearance curve.
set -u
program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
  echo "FAIL: $*"
  failures=$((failures + 1))
}

# expect CODE WORDS ARGUMENT...: exit code, and words on standard output or error.
expect() {
  local code=$1 words=$2
  shift 2
  "$program" "$@" >"$folder/out" 2>"$folder/err"
  local got=$?
  [ "$got" = "$code" ] || fail "$*: exit $got, not $code"
  grep -qF -- "$words" "$folder/out" "$folder/err" || fail "$*: does not say '$words'"
}

expect 0 "0.564527 mm" design
expect 0 '"height_mm": 0.5645266892' design --json
expect 0 "--curve" design --help
expect 64 "" design --no-such-option
expect 64 "more than one DESIGN" design a b
expect 64 "drop --json" design --json --curve
expect 74 "no/such.json" design no/such.json
expect 74 "no/such/out.json" design -o no/such/out.json

echo '{"schema": "foilgauge/design/1", "pitch_deg": -3}' >"$folder/bad.json"
expect 65 "$folder/bad.json: pitch_deg is -3" design "$folder/bad.json" -o "$folder/never.json"
[ -s "$folder/out" ] && fail "a refused design prints on standard output"
[ -e "$folder/never.json" ] && fail "a refused design leaves an output file"

echo '{"schema": "foilgauge/design/1", "form": "discs", "diameters_mm": [4]}' >"$folder/discs.json"
expect 0 "4.000000 mm" design "$folder/discs.json"
expect 65 "there is no curve" design --curve "$folder/discs.json"

# What is written loads again and gives the same.
"$program" design -o "$folder/first.json" || fail "design -o"
sed -n '/^ "design": {/,/^ }/p' "$folder/first.json" | sed '1s/.*/{/; $s/.*/}/' >"$folder/again.json"
expect 0 "0.564527 mm" design "$folder/again.json"

"$program" design --curve >"$folder/curve.csv" || fail "design --curve"
[ "$(wc -l <"$folder/curve.csv")" = 37 ] || fail "the curve has not 36 rows"
cmp "$folder/curve.csv" "$root/reports/thesis/clearance_curve.csv" ||
  fail "reports/thesis/clearance_curve.csv is not what 'foilgauge design --curve' writes"

[ "$failures" = 0 ]
