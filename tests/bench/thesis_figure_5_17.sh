#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A rendered lot with known truth and a reference curve, as in figure 5.17: writes reports/thesis/figure_5_17.*.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/thesis_figure_5_17.py" "$@"
