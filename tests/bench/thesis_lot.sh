#!/bin/bash
# The thesis's lot from end to end: 14 foils of 9 bumps rendered with its distribution (thesis_lot.py), measured, and
# the figures set beside those that chapter 5 prints. Writes reports/thesis/lot.md, lot.csv and lot.html.
#   tests/bench/thesis_lot.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
program=$PWD/build/foilgauge
out=$PWD/reports/thesis
bench=$PWD/tests/bench
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

python3 "$bench/thesis_lot.py" . 4800
for spec in foil*.json; do
  "$program" render "$spec" -o "${spec%.json}.png" --truth "${spec%.json}.truth"
done
"$program" lot manifest.csv -o lot --name "Thesis, chapter 5" --group die || [[ $? == [13] ]]
cp lot/index.html "$out/lot.html"
python3 "$bench/thesis_lot_report.py" "$folder" "$out"
