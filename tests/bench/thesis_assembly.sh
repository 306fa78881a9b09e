#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Bearings drawn from the thesis's lot (thesis_lot.py), measured, against the truth of the same draws. Writes
# reports/thesis/assembly.md.   tests/bench/thesis_assembly.sh [DPI]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
root=$PWD
program=${FOILGAUGE:-$PWD/build/foilgauge}
dpi=${1:-2400}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

python3 "$root/tests/bench/thesis_lot.py" . "$dpi"
for spec in foil*.json; do
  "$program" render "$spec" -o "${spec%.json}.png" --truth "${spec%.json}.truth"
done
recipe() { # NAME DESIGN
  printf '{"schema":"foilgauge/recipe/1","name":"%s","design":{"schema":"foilgauge/design/1",%s}}' "$1" "$2" >"$1.json"
}
round='"calibration":"not needed: rendered","tolerances":{"circularity_mm":{"max":0.11}}'
recipe thesis "$round"
recipe tight "\"rotor_diameter_mm\":40.11,$round"
cut -d, -f1-3 manifest.csv >foils.csv
head -n 11 foils.csv >few.csv
"$program" lot foils.csv -o thesis --recipe thesis.json || [[ $? == [123] ]]
"$program" lot foils.csv -o tight --recipe tight.json || [[ $? == [123] ]]
"$program" lot few.csv -o ten --recipe thesis.json || [[ $? == [123] ]]
/usr/bin/python3 "$root/tests/bench/thesis_assembly.py" "$folder" "$root/reports/thesis/assembly.md" "$dpi"
