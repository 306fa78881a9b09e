#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Regression against R's lm and anova on random designs: agreement to 1e-9 of every number.
# Needs R (Debian: r-base-core) and a release build. Usage: differential_r.sh [COUNT] [REPORT.csv]
set -euo pipefail
cd "$(dirname "$0")/../.."
count=${1:-300}
report=${2:-}
command -v Rscript >/dev/null || { echo "skipped: R is not installed" >&2; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cc -std=c17 -O2 -D_GNU_SOURCE -I include tests/bench/regression_dump.c build/libfoilgauge.a \
  -lcsv -lgsl -lgslcblas -lm -o "$work/dump"
Rscript --vanilla tests/bench/differential.R "$count" "$work" "$report"
