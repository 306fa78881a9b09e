#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs fuzz targets for some seconds each (libFuzzer, AddressSanitizer, UndefinedBehaviorSanitizer), from the committed corpus and
# what earlier runs have found (build-fuzz/corpus/TARGET, the inputs that reach something new, 8 MiB of each target at most).
# Fails at the first input that breaks something, and keeps that input in build-fuzz/found/. build-fuzz/executions.csv has a row
# of each run; the sum over all of them is printed.
# Usage: tests/fuzz/run.sh [SECONDS [RUNS [TARGET...]]]; default 60 s, all targets; with RUNS (-1: no limit) it ends after so many.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"
seconds=${1:-60}
runs=${2:--1}

install_missing $FOILGAUGE_PACKAGES clang
cd "$root"
step "configuring fuzz in build-fuzz/" cmake -S . -B build-fuzz -G "Unix Makefiles" -C src/cmake/fuzz.cmake
targets=(png png_differential tiff design die load_test forming measure loop_scan loop_table station)
[ $# -le 2 ] || targets=("${@:3}")
step "building fuzz" cmake --build build-fuzz -j"$(nproc)" --target "${targets[@]/#/fuzz_}"
kept=$root/build-fuzz/found
runs_made=build-fuzz/executions.csv
mkdir -p "$kept"
[ -e $runs_made ] || echo "target,date,commit,seconds,executions,exit_code" >$runs_made

# keep_small TARGET: its corpus without inputs that reach nothing new; the smallest of them, up to 8 MiB.
keep_small() {
  local corpus=build-fuzz/corpus/$1 fewer=build-fuzz/corpus/$1.new
  rm -rf "$fewer" && mkdir "$fewer"
  "build-fuzz/fuzz/fuzz_$1" -merge=1 -rss_limit_mb=2048 -timeout=30 -artifact_prefix="$kept/$1-" "$fewer" "tests/fuzz/corpus/$1" \
    "$corpus" >/dev/null 2>&1 || return 0
  find "$fewer" -type f -printf '%s %p\n' | sort -n | awk '(sum += $1) > 8 * 1048576 { print $2 }' | xargs -r rm
  rm -rf "$corpus" && mv "$fewer" "$corpus"
}

for target in "${targets[@]}"; do
  log=$kept/$target.log
  mkdir -p "build-fuzz/corpus/$target"
  code=0
  "build-fuzz/fuzz/fuzz_$target" -max_total_time="$seconds" -runs="$runs" -rss_limit_mb=2048 \
    -timeout=30 -print_final_stats=1 -artifact_prefix="$kept/$target-" "build-fuzz/corpus/$target" "tests/fuzz/corpus/$target" \
    >"$log" 2>&1 || code=$?
  made=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  echo "$target,$(date +%F),$(git rev-parse --short=8 HEAD 2>/dev/null),$seconds,${made:-0},$code" >>$runs_made
  sum=$(awk -F, -v target="$target" '$1 == target { sum += $5 } END { print sum }' $runs_made)
  echo "fuzz_$target: ${made:-no} executions, exit code $code; $sum in all runs"
  if [ $code -ne 0 ]; then
    grep -E "ERROR|SUMMARY" "$log" || tail -5 "$log"
    echo "the input is in $kept" >&2
    exit 1
  fi
  keep_small "$target"
done
