#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The thesis's figure 5.22 from end to end: its classical and its sinusoidal lot rendered (thesis_lot.py, thesis_lots.py),
# measured, and put over each other. Writes reports/thesis/lots.md, lots.svg, lots.html, lots.json and
# lot_sinusoidal.html; the classical lot has its page by thesis_lot.sh.
#   tests/bench/thesis_lots.sh [DPI]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
program=$PWD/build/foilgauge
out=$PWD/reports/thesis
bench=$PWD/tests/bench
dpi=${1:-4800}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# make_lot NAME TITLE DATE OPTION...
make_lot() {
  cd "$1"
  printf '%s\n' foil*.json | sed 's/\.json$//' |
    xargs -P "$(nproc)" -I{} "$program" render {}.json -o {}.png --truth {}.truth
  touch -d "$3" -- *.png
  "$program" lot manifest.csv -o "../$1-lot" --name "$2" --pages none "${@:4}" || [[ $? == [13] ]]
  rm -- *.png
  cd ..
}

python3 "$bench/thesis_lot.py" classical "$dpi"
python3 "$bench/thesis_lots.py" sinusoidal "$dpi"
make_lot classical "Classical" 2015-06-01T12:00:00Z
make_lot sinusoidal "Sinusoidal" 2016-06-01T12:00:00Z --design design/sinusoidal.json
"$program" lot --index lots.html -o lots.json classical-lot sinusoidal-lot
cp lots.json "$out"
cp sinusoidal-lot/index.html "$out/lot_sinusoidal.html"
sed 's|"classical-lot/index.html"|"lot.html"|; s|"sinusoidal-lot/index.html"|"lot_sinusoidal.html"|' lots.html >"$out/lots.html"
python3 "$bench/thesis_lots_report.py" "$folder" "$out" "$dpi"
