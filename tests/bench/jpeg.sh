#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Errors that JPEG adds, and whether the uncertainties cover them: writes reports/jpeg.md. --seed N, --renders N.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/jpeg.py" "$@"
