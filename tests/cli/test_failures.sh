#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Memory that runs out at any allocation, a disk that is full at any write: an error each time, no
# crash, and nothing under a final name but whole files.
# Usage: test_failures.sh PROGRAM [STRIDE]; with a stride of 1 every allocation fails once.
set -euo pipefail
program=$1
stride=${2:-71}
shim=$(dirname "$program")/tests/libfailing_malloc.so
work=$(mktemp -d)
trap '[ "$BASHPID" != $$ ] || rm -rf "$work"' EXIT

fail() {
  echo "test_failures: $*" >&2
  exit 1
}

# Exit code 0 and every file whole, or another code, words, and no file at all.
check() {
  local code=$1 what=$2 left
  left=$(find "$work/out" -type f | wc -l)
  case $code in
    0) cmp -s "$work/out/report.json" "$work/report.json" || fail "$what: exit code 0 and another report" ;;
    71 | 74)
      [ "$left" -eq 0 ] || fail "$what: exit code $code leaves $(ls -A "$work/out")"
      grep -q '^foilgauge: .' "$work/said" || fail "$what: exit code $code without words"
      ;;
    *) fail "$what: exit code $code: $(cat "$work/said")" ;;
  esac
  rm -rf "$work/out"
  mkdir "$work/out"
}

mkdir "$work/out"
cat >"$work/spec.json" <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 3, "foils": [{"rotate_deg": -90}], "scanner": {"dpi": 1200}}
SPEC
"$program" render "$work/spec.json" -o "$work/scan.png"
"$program" measure "$work/scan.png" -o "$work/report.json"

# Disk full: a limit on the size of files, at every KiB of the report.
size=$((($(stat -c %s "$work/report.json") + 1023) / 1024))
for ((kib = 0; kib < size; kib++)); do
  code=0
  (ulimit -f "$kib" && exec "$program" measure "$work/scan.png" -o "$work/out/report.json" \
    --csv "$work/out/bumps.csv" 2>&1 >/dev/null) | cat >"$work/said" || code=$?
  [ $code -eq 74 ] && grep -q 'cannot be written: File too large' "$work/said" ||
    fail "disk full at $kib KiB: exit code $code: $(cat "$work/said")"
  check $code "disk full at $kib KiB"
done
code=0
"$program" measure "$work/scan.png" >/dev/full 2>"$work/said" || code=$?
[ $code -eq 74 ] || fail "/dev/full: exit code $code"
echo "disk full: $((size + 1)) places"

# A sanitizer has its own malloc: the shim cannot stand before it.
if ldd "$program" | grep libasan >/dev/null || [ ! -e "$shim" ]; then
  echo "allocations: not in this build"
  exit 0
fi
# Address space that runs out: wherever it does, an error with words, and no signal.
mkdir "$work/scans"
for seed in 1 2 3; do
  sed "s/: 3,/: $seed,/; s/{\"rotate/{\"design\": {\"bump_count\": 3}, \"rotate/" "$work/spec.json" >"$work/small.json"
  "$program" render "$work/small.json" -o "$work/scans/$seed.png"
done
limited() { (ulimit -v "$1" && shift && exec timeout 20 "$@"); }
below=16000 least=1000000
while ((least - below > 500)); do
  kib=$(((below + least) / 2))
  limited $kib "$program" version >/dev/null 2>&1 && least=$kib || below=$kib
done
for ((kib = least - 2000; kib < least + 16000; kib += 600)); do
  code=0
  rm -rf "$work/lot"
  limited $kib "$program" lot "$work/scans" -o "$work/lot" >/dev/null 2>"$work/said" || code=$?
  case $code in
    0) continue ;;
    2 | 71 | 74 | 127) [ -s "$work/said" ] || fail "lot in $kib KiB: exit code $code without words" ;;
    *) fail "lot in $kib KiB: exit code $code: $(cat "$work/said")" ;;
  esac
done
echo "address space: $kib KiB and less"

# run_failing N [ON]: the Nth allocation of the command fails; with ON all after it too.
run_failing() {
  code=0
  (
    export LD_PRELOAD=$shim FOILGAUGE_FAIL_AT=$1
    [ $# -eq 1 ] || export FOILGAUGE_FAIL_ON=1
    exec "${command[@]}"
  ) >/dev/null 2>"$work/said" || code=$?
}

# fail_allocations NAME CHECK STRIDE COMMAND...: each STRIDEth allocation of it, alone and with all after it.
fail_allocations() {
  local name=$1 check=$2 stride=$3 at total tried=0
  shift 3
  command=("$@")
  run_failing 0
  total=$(sed -n 's/^allocations: //p' "$work/said")
  $check $code "$name: no failure"
  for ((at = 1; at <= total; at += at < 30 ? 1 : stride)); do
    run_failing "$at"
    $check $code "$name: allocation $at of $total"
    run_failing "$at" on
    $check $code "$name: allocation $at of $total and all after it"
    tried=$((tried + 2))
  done
  echo "allocations: $name: $tried failures over $total"
}

# Memory that runs out is said with its own code, never as a fault of the file that was being read.
out_of_memory_or_whole() {
  case $1 in
    0) return ;;
    71) grep -q '^foilgauge: .' "$work/said" || fail "$2: exit code 71 without words" ;;
    *) fail "$2: exit code $1: $(cat "$work/said")" ;;
  esac
  ! grep -qi 'not JSON' "$work/said" || fail "$2: $(cat "$work/said")"
}
whole_truth() {
  out_of_memory_or_whole "$@"
  [ "$1" -eq 0 ] && { cmp -s "$work/out/truth.json" "$work/truth.json" || fail "$2: exit code 0 and another truth"; }
  rm -rf "$work/out"
  mkdir "$work/out"
}

fail_allocations measure check "$stride" "$program" measure "$work/scan.png" --threads 1 -o "$work/out/report.json"

sed 's/"foils"/"width_px": 60, "height_px": 40, "foils"/; s/"scanner": {/&"colour_lines": {}, /' "$work/spec.json" >"$work/cut.json"
"$program" render "$work/cut.json" -o "$work/cut.png" --truth "$work/truth.json" ||
  fail "a render of a corner"
fail_allocations "render --truth" whole_truth $((stride < 5 ? 1 : stride / 5)) \
  "$program" render "$work/cut.json" -o "$work/out/cut.png" --truth "$work/out/truth.json"

"$program" design >/dev/null || fail "design"
cat >"$work/design.json" <<'DESIGN'
{"schema": "foilgauge/design/1", "name": "a", "bump_count": 9, "calibration": "not needed: the scan is rendered", "tolerances": {"radius_mm": {"min": 3.2, "max": 3.4}}}
DESIGN
fail_allocations design out_of_memory_or_whole 1 "$program" design "$work/design.json"
