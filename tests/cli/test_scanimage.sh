#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The scanner's own path: SANE's test backend through scanimage into the program, as PNG, TIFF and PNM,
# gray and colour, 1, 8 and 16 bit, by file and by pipe. Its pictures hold no foils, only bars and squares:
# the program must read all of each, and see the same in every format.
set -euo pipefail
program=$1
command -v scanimage >/dev/null || { echo "skipped: sane-utils is not installed"; exit 77; }
work=$(mktemp -d)
trap '[ "$BASHPID" != $$ ] || rm -rf "$work"' EXIT

fail() {
  echo "test_scanimage: $*" >&2
  exit 1
}

# scanimage of SANE 1.2 hangs in one of some thousand scans: it cancels the backend's reading thread while that holds a
# lock of the C library (malloc's, the loader's). A scan takes 0.1 s; after ten seconds it has hung, and SIGTERM,
# which asks it to cancel once more, would not end it.
scan() { # PICTURE MODE DEPTH FORMAT
  timeout -s KILL 10 scanimage -d test --test-picture "$1" --mode "$2" --depth "$3" --resolution 300 -x 60 -y 40 \
    --format "$4" 2>"$work/scanimage"
}
# attempt COMMAND...: runs it up to five times, until it succeeds.
attempt() {
  local try
  for try in 1 2 3 4 5; do
    "$@" && return 0
    echo "attempt $try failed: $*: $(tr '\n' ' ' <"$work/scanimage")" >&2
  done
  fail "five attempts failed: $*"
}
scan Grid Gray 8 pnm >"$work/probe" || scan Grid Gray 8 pnm >"$work/probe" ||
  { echo "skipped: scanimage has no test backend"; exit 77; }
scan_to_file() { scan "$@" >"$work/scan.$4"; }

measured=0
# Fails unless measure could read the picture: that it holds no foil is right (exit code 65). Keeps a checksum of the
# report without the inputs, or of the message without the file's name, in $work/results.
check_result() { # EXIT_CODE HOW
  sed -n '/"light_on_dark"/,$p' "$work/report" >"$work/seen"
  sed -E 's|^foilgauge: [^:]*: ||' "$work/said" >>"$work/seen"
  if [ "$1" -eq 65 ] && ! grep -q '^no foil in the picture' "$work/seen" || [ "$1" -gt 65 ]; then
    fail "measure $2: exit code $1: $(cat "$work/said")"
  fi
  measured=$((measured + 1))
  sha256sum <"$work/seen" >>"$work/results"
}
measure() { # FILE [OPTION...]
  local code=0
  "$program" measure "$@" >"$work/report" 2>"$work/said" || code=$?
  check_result $code "$*"
}
measure_pipe() { # FILE
  local code=0
  cat "$1" | "$program" measure --dpi 300 - >"$work/report" 2>"$work/said" || code=$?
  check_result $code "- (pipe of $1)"
}
# Fails, to be attempted again, when scanimage hangs.
scan_into_program() {
  local code=0
  rm -f "$work/hung"
  { scan "$@" || touch "$work/hung"; } | "$program" measure --dpi 300 - >"$work/report" 2>"$work/said" || code=$?
  echo $code >"$work/code"
  [ ! -e "$work/hung" ]
}
same_in_every_format() { # PICTURE_AND_KIND
  [ "$(sort -u "$work/results" | wc -l)" -eq 1 ] || fail "$1: the formats' results differ"
}

for picture in Grid "Color pattern" "Solid white"; do
  for kind in "Gray 1" "Gray 8" "Gray 16" "Color 8" "Color 16"; do
    read -r mode depth <<<"$kind"
    rm -f "$work/results"
    for format in png tiff pnm; do
      attempt scan_to_file "$picture" "$mode" "$depth" $format
      measure "$work/scan.$format" --dpi 300
      measure_pipe "$work/scan.$format"
    done
    same_in_every_format "$picture, $kind"
  done
done

# As README pipes it: scanimage writes while the program reads.
rm -f "$work/results"
for format in png tiff pnm; do
  attempt scan_into_program "Color pattern" Color 8 $format
  check_result "$(cat "$work/code")" "- (scanimage's pipe, $format)"
done
same_in_every_format "scanimage's pipe"

# Resolution: scanimage writes it in formats that have one.
measure "$work/scan.png"
measure "$work/scan.tiff"
echo "$measured pictures measured"
