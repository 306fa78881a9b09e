#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The thesis's experiments analysed: writes reports/thesis/doe_*.json, .html and reports/thesis_doe.md.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
. tests/packages.sh

install_missing $FOILGAUGE_PACKAGES
build_preset release build

# doe NAME TABLE MODEL OPTION...
doe() {
  local name=$1 table=$2 model=$3
  shift 3
  build/foilgauge doe "samples/doe/$table.csv" --response springback_error_pct --model "$model" \
    -o "reports/thesis/doe_$name.json" --html "reports/thesis/doe_$name.html" "$@"
  echo "reports/thesis/doe_$name.html"
}

first='pressure_bar + temperature_C + duration_h'
second='temperature_C*duration_h + temperature_C^2 + duration_h^2'
levels="--code pressure_bar=300:400"
levels_two="--code temperature_C=500:600 --code duration_h=3:5"
doe table_5_2 springback_factorial "($first)^2" $levels $levels_two
doe table_5_3 springback_factorial 'temperature_C*duration_h' $levels_two
doe saturated springback_factorial "($first)^3" $levels $levels_two
doe table_5_5 springback_composite "$second" --code temperature_C=400:700 --code duration_h=1:7 \
  --constraint 'temperature_C <= 700' --at 'temperature_C=675, duration_h=4' --at 'temperature_C=675, duration_h=5' \
  --at 'temperature_C=650, duration_h=5'

build/tests/test_thesis --report reports
