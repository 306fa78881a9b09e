#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From a plate of gauges to foils: tests/bench/loop_plate.sh [--scanners N] [--seed N] writes reports/loop_plate.*
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/loop_plate.py" "$@"
