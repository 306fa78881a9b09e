#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the pages of reports/, each by its command in reports/README.md; --help says how.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. tests/packages.sh

case "${1-}" in
  --help | -h)
    cat <<'U'
usage: tests/reports.sh [--again] [NAME...] | --list | --check | --help

  NAME     makes the pages with NAME in theirs; without one, all of them: that takes many hours
  --again  also those that stand in reports/made.csv with the present commit; without it, a run that was interrupted goes on
  --list   writes the columns `made`, `figure` and `goal` of reports/README.md anew, and makes nothing
  --check  ends with 1 where a page's sources have changed much since it was made, and its row does not say so; and where its
           figure is not found (reports/figures.csv says where it stands in the page), or is another than in its row

Times are measured alone, other pages are made two at a time. What a command says goes to build/reports/.
U
    exit 0
    ;;
  --list | --check) ;;
  *)
    install_missing $FOILGAUGE_PACKAGES $FOILGAUGE_BENCH_PACKAGES $FOILGAUGE_R_PACKAGES $FOILGAUGE_BROWSER_PACKAGES
    build_preset release build
    # The numbers of Debian's python3, whatever stands before it in PATH.
    PATH=/usr/bin:$PATH
    ;;
esac
exec python3 tests/bench/reports.py "$@"
