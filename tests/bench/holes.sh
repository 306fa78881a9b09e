#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The round features of a real scan: tests/bench/holes.sh SCAN.png [--dpi N] writes reports/real/holes.*
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/holes.py" "$@"
