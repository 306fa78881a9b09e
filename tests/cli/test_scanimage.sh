#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The scanner's own path: SANE's test backend through scanimage into the program, as PNG, TIFF and PNM,
# gray and colour, 1, 8 and 16 bit, by pipe and by file. Its pictures hold no foils, only bars and squares:
# the program must read all of each, and see the same in every format.
set -euo pipefail
program=$1
command -v scanimage >/dev/null || { echo "skipped: sane-utils is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
scan() {
  scanimage -d test --test-picture "$1" --mode "$2" --depth "$3" --resolution 300 -x 60 -y 40 --format "$4" 2>/dev/null
}
scan Grid Gray 8 pnm >"$work/probe" || { echo "skipped: scanimage has no test backend"; exit 77; }

tried=0
# What the program sees: its report without the inputs, or its words without the file's name. That there is
# no foil is fine; that a file cannot be read is not.
ask() {
  local code=0
  "$program" measure "$@" >"$work/report" 2>"$work/said" || code=$?
  sed -n '/"light_on_dark"/,$p' "$work/report" >"$work/seen"
  sed -E 's|^foilgauge: [^:]*: ||' "$work/said" >>"$work/seen"
  if [ $code -eq 65 ] && ! grep -q '^no foil in the picture' "$work/seen" || [ $code -gt 65 ]; then
    echo "test_scanimage: measure $*: exit code $code: $(cat "$work/said")" >&2
    exit 1
  fi
  tried=$((tried + 1))
  sha256sum <"$work/seen" >>"$work/words"
}

for picture in Grid "Color pattern" "Solid white"; do
  for kind in "Gray 1" "Gray 8" "Gray 16" "Color 8" "Color 16"; do
    read -r mode depth <<<"$kind"
    rm -f "$work/words"
    for format in png tiff pnm; do
      scan "$picture" "$mode" "$depth" $format >"$work/scan.$format"
      ask --dpi 300 "$work/scan.$format"
      ask --dpi 300 - < <(scan "$picture" "$mode" "$depth" $format)
    done
    if [ "$(sort -u "$work/words" | wc -l)" -ne 1 ]; then
      echo "test_scanimage: $picture, $kind: formats differ" >&2
      exit 1
    fi
  done
done
# Where the format has a resolution, scanimage writes it.
ask "$work/scan.png"
ask "$work/scan.tiff"
echo "$tried scans"
