#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds foilgauge on a fresh Debian bookworm and measures the sample scan.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. tests/packages.sh

if [ $# -gt 0 ]; then
  echo "usage: samples/run.sh (it takes no argument)" >&2
  exit 64
fi
scan=samples/gen2_foil.png
report=build/sample-report

install_missing $FOILGAUGE_PACKAGES
build_preset release build
mkdir -p "$report"

printf 'measuring %s ... ' "$scan"
code=0
build/foilgauge measure "$scan" -o "$report/gen2_foil.json" --overlay "$report/gen2_foil.png" \
  --html "$report/gen2_foil.html" --csv "$report/gen2_foil.csv" || code=$?
# Out of tolerance (1) and cannot tell (3) are answers about the foil; others are a failure to give one.
case $code in
0) echo "done, all measured, nothing out of tolerance" ;;
1) echo "done, out of tolerance" ;;
3) echo "done, cannot tell: a limit lies within the uncertainty of a value" ;;
*)
  echo "failed (exit code $code)"
  exit $code
  ;;
esac

echo "the report is in $report/:"
echo "  gen2_foil.html  the page to read: picture, table, residuals"
echo "  gen2_foil.png   the fitted circles over the scan"
echo "  gen2_foil.json  every value with its uncertainty"
echo "  gen2_foil.csv   one line per bump"
echo "measure your own: build/foilgauge measure SCAN.png"
