#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The thesis's lot from end to end, twice: 14 foils of 9 bumps rendered with its distribution of radii (thesis_lot.py),
# once with the arc length as designed, once with -3.8 ± 4.3 % of it; measured, and the figures set beside those that
# chapter 5 prints. Writes reports/thesis/lot.md, lot.csv, lot.html, lot_arc_length.html and design.html.
#   tests/bench/thesis_lot.sh [DPI]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
program=$PWD/build/foilgauge
out=$PWD/reports/thesis
bench=$PWD/tests/bench
dpi=${1:-4800}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# make_lot FOLDER TITLE [MEAN SD]
make_lot() {
  local title=$2
  python3 "$bench/thesis_lot.py" "$1" "$dpi" "${@:3}"
  cd "$1"
  printf '%s\n' foil*.json | sed 's/\.json$//' |
    xargs -P "$(nproc)" -I{} "$program" render {}.json -o {}.png --truth {}.truth
  "$program" lot manifest.csv -o lot --name "$title" --group die --pages none --jobs "$(nproc)" || [[ $? == [13] ]]
  rm -- *.png
  cd ..
}

make_lot constant "Thesis, chapter 5: arc length as designed"
make_lot varied "Thesis, chapter 5: arc length -3.8 ± 4.3 %" -3.8 4.3
cp constant/lot/index.html "$out/lot.html"
cp varied/lot/index.html "$out/lot_arc_length.html"
"$program" design --html "$out/design.html" >/dev/null
python3 "$bench/thesis_lot_report.py" "$folder" "$out"
