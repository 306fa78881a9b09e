#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on a real scan of round holes: tests/bench/real_loop.sh SCAN.png [--dpi N] writes reports/real/loop.*
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/real_loop.py" "$@"
