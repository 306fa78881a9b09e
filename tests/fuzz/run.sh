#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs every fuzz target for some seconds (libFuzzer, AddressSanitizer, UndefinedBehaviorSanitizer), from the
# committed corpus. Fails at the first input that breaks something, and keeps that input.
# Usage: tests/fuzz/run.sh [SECONDS [RUNS]]; default 60 s; with RUNS it ends after so many executions.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"
seconds=${1:-60}
runs=${2:--1}

install_missing $FOILGAUGE_PACKAGES clang
cd "$root"
step "configuring fuzz in build-fuzz/" cmake -S . -B build-fuzz -G "Unix Makefiles" -C src/cmake/fuzz.cmake
step "building fuzz" cmake --build build-fuzz -j"$(nproc)" --target fuzz_png fuzz_png_differential fuzz_tiff \
  fuzz_design fuzz_die fuzz_load_test fuzz_forming fuzz_measure fuzz_loop_scan fuzz_loop_table fuzz_station
kept=$root/build-fuzz/found
mkdir -p "$kept"
for target in png png_differential tiff design die load_test forming measure loop_scan loop_table station; do
  grown=$(mktemp -d)
  log=$kept/$target.log
  code=0
  "build-fuzz/fuzz/fuzz_$target" -max_total_time="$seconds" -runs="$runs" -rss_limit_mb=2048 \
    -timeout=30 -print_final_stats=1 -artifact_prefix="$kept/$target-" "$grown" "tests/fuzz/corpus/$target" \
    >"$log" 2>&1 || code=$?
  rm -rf "$grown"
  echo "fuzz_$target: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") executions, exit code $code"
  if [ $code -ne 0 ]; then
    grep -E "ERROR|SUMMARY" "$log" || tail -5 "$log"
    echo "the input is in $kept" >&2
    exit 1
  fi
done
