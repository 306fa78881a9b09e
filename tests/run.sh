#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds foilgauge twice (release; sanitizers with warnings as errors) and runs every test in both.
# --long adds the accuracy, speed and bed benchmarks, the rendered experiments, the thesis's
# experiments, the comparison with R, the station and every page in a browser and the loop on measured tables, which rewrite the tables in reports/; a minute of fuzzing for
# each target, and a failure of every single allocation.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. tests/packages.sh

long=no
case "${1-}" in
  "") ;;
  --long) long=yes ;;
  *)
    echo "usage: tests/run.sh [--long]" >&2
    exit 64
    ;;
esac

install_missing $FOILGAUGE_PACKAGES
build_preset release build
build_preset sanitize build-sanitize

if [ $long = yes ]; then
  export FOILGAUGE_TEST_LONG=1 # tests that have more to show where time is no matter
  tests/bench/accuracy.sh
  tests/bench/speed.sh
  tests/bench/thesis_lot.sh
  tests/bench/thesis_lots.sh
  tests/bench/lot_speed.sh
  build/bench/lot_groups >reports/lot_groups.md
  tests/bench/slurm_lot.sh || [ $? = 77 ]
  tests/bench/doe_end_to_end.sh
  build/bench/split_plots >reports/split_plots.md
  python3 tests/bench/split_plots_r.py build/foilgauge 150 || [ $? = 77 ]
  tests/bench/thesis.sh
  install_missing $FOILGAUGE_R_PACKAGES $FOILGAUGE_BROWSER_PACKAGES
  tests/bench/differential_r.sh 300 reports/differential_r.csv
  python3 tests/bench/loop_measured.py build/foilgauge
  python3 tests/bench/loop_r_tables.py build/foilgauge
  tests/bench/bed.sh
  tests/fuzz/run.sh 60
  step "failing every allocation once" bash tests/cli/test_failures.sh build/foilgauge 1
  step "a station killed 200 times, 800 allocations and every write failing" bash tests/cli/test_station_robust.sh build/foilgauge 200 800
fi

# The sanitized tree looks at scans that the release tree draws; drawing has tests of its own in both.
export FOILGAUGE_RENDERER=$PWD/build/foilgauge
# Both trees are tested even when the first fails; ctest's own summary is the last thing said.
code=0
for tree in build build-sanitize; do
  echo "testing $tree/"
  # One more than there are cores: the station's tests wait more than they work.
  ctest --test-dir "$tree" --output-on-failure -j"$(($(nproc) + 1))" || code=$?
done
exit $code
