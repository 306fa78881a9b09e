#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds foilgauge and tests it; --help says what each option adds or leaves out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. tests/packages.sh

usage() {
  cat <<'U'
usage: tests/run.sh [--quick | --long | --help]

  (nothing)  builds foilgauge twice, for release in build/ and with sanitizers and warnings as errors in build-sanitize/,
             and runs every test in both: some fifteen minutes on two cores
  --quick    builds for release alone and runs the tests that are labelled `quick`: less than a minute after the build.
             Every room's unit tests and a script for each command are among them
  --long     as without an option, and before that the benchmarks of accuracy, speed and beds, the rendered experiments,
             the thesis's experiments, the comparison with R, the station and every page in a browser and the loop on
             measured tables, which rewrite the tables in reports/; a minute of fuzzing for each target; a failure of
             every single allocation; every JSON document of the tests against its schema

After a build, `ctest --test-dir build -R NAME` runs the tests with NAME in theirs, and `ctest --test-dir build -L LABEL`
those of a room, a command or a kind: station, loop, lot, render, unit, cli, fuzz (`ctest --test-dir build --print-labels`).
U
}

tier=whole
case "$#${1-}" in
  0) ;;
  1--quick) tier=quick ;;
  1--long) tier=long ;;
  1--help | 1-h)
    usage
    exit 0
    ;;
  *)
    usage >&2
    exit 64
    ;;
esac

# One more test at once than there are cores: the station's tests wait more than they work.
jobs=$(($(nproc) + 1))
install_missing $FOILGAUGE_PACKAGES
# A version manager's python3 is a script that takes a tenth of a second, and the tests call Python a thousand times.
PATH=$(dirname "$(python3 -c 'import sys; print(sys.executable)' 2>/dev/null || command -v sh)"):$PATH
build_preset release build
if [ $tier = quick ]; then
  exec ctest --test-dir build -L quick --output-on-failure -j$jobs
fi
build_preset sanitize build-sanitize

if [ $tier = long ]; then
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
  install_missing $FOILGAUGE_R_PACKAGES $FOILGAUGE_BROWSER_PACKAGES $FOILGAUGE_SCHEMA_PACKAGES $FOILGAUGE_SHOP_PACKAGES
  tests/bench/json_documents.sh
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
  ctest --test-dir "$tree" --output-on-failure -j$jobs || code=$?
done
exit $code
