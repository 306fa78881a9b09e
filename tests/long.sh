# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by tests/run.sh, after packages.sh: the parts of the long tier, each to be run alone, and how they are run.

# A line at the margin names a part and its subject; the lines under it are its commands. An exit code of 77 says
# `skipped`. Pages of reports/ are made by tests/bench/reports.py, which leaves out those that are of this commit already.
long_parts() {
  cat <<'P'
accuracy: bumps against known truth, of two renderers
  python3 tests/bench/reports.py accuracy.md accuracy_shared.md
speed: one scan beside reading alone and two peers; scans a second of a lot
  python3 tests/bench/reports.py speed.md speed_growth.md lot_speed.md
beds: whole A4 beds, time and memory
  python3 tests/bench/reports.py bed.md
lots: the thesis's lots, groups of a lot, shards by Slurm
  python3 tests/bench/reports.py thesis/lot.md thesis/lots.md lot_groups.md
  tests/bench/slurm_lot.sh
rendered-experiments: designed experiments from plan to scan to answer
  python3 tests/bench/reports.py doe_end_to_end.md
statistics: split plots, regressions and mixed models beside R's, the thesis's experiments
  python3 tests/bench/reports.py split_plots.md thesis_doe.md differential_r.csv
  python3 tests/bench/split_plots_r.py build/foilgauge 150
tables: the loop on measured tables
  python3 tests/bench/reports.py loop_measured.md loop_r_tables.md
documents: every JSON document of the tests against its schema
  tests/bench/json_documents.sh
fuzz: two minutes for each fuzz target
  tests/fuzz/run.sh 120
failures: every single allocation and every KiB written failing once, in a measurement, a render, a design
  bash tests/cli/test_failures.sh build/foilgauge 1
station: a station killed 200 times, 800 allocations and every write failing
  bash tests/cli/test_station_robust.sh build/foilgauge 200 800
packages: the packages for Debian, installed on a Debian of nothing else
  ctest --test-dir build -R test_package --output-on-failure
tests: every test of the release build, with what it shows only in the long tier
  ctest --test-dir build -E test_package --output-on-failure -j3
sanitized: every test of the build with sanitizers
  ctest --test-dir build-sanitize --output-on-failure -j3
P
}

# long_names: the parts' names, in their order.
long_names() { long_parts | sed -n 's/^\([a-z-]*\): .*/\1/p'; }

# long_commands PART: its commands, a line each.
long_commands() { long_parts | awk -v part="$1" '/^[a-z-]+: / { inside = $1 == part ":" } /^  / && inside { sub(/^ +/, ""); print }'; }

# run_long PART...: one after the other, two hours each at most; goes on after one that fails, and says at last which did. A
# command has a process group of its own, by which it is ended when the run is.
run_long() {
  local part command began code running= failed=()
  export FOILGAUGE_TEST_LONG=1 FOILGAUGE_RENDERER=$PWD/build/foilgauge
  mkdir -p build/long
  trap '[ -z "$running" ] || kill "$running" 2>/dev/null; exit 130' INT TERM HUP
  for part in "$@"; do
    began=$SECONDS code=0
    echo "part $part: $(date +%H:%M), what it says is in build/long/$part.log"
    while read -r command; do
      timeout 120m bash -c "$command" </dev/null >>"build/long/$part.log.new" 2>&1 &
      running=$!
      wait $running || code=$?
      running=
      [ $code = 0 ] || [ $code = 77 ] || break
      [ $code = 0 ] || echo "skipped: $command"
      code=0
    done < <(long_commands "$part")
    mv "build/long/$part.log.new" "build/long/$part.log"
    [ $code = 0 ] || failed+=("$part")
    echo "part $part: $([ $code = 0 ] && echo passed || echo "FAILED (exit code $code of: $command)") in $(((SECONDS - began + 59) / 60)) min"
  done
  trap - INT TERM HUP
  [ ${#failed[@]} = 0 ] || { echo "parts that failed: ${failed[*]}"; return 1; }
}
