#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Coverage of U with and without a calibration where pitch and temperature differ from their assumed values: writes
# reports/calibration.md. --foils 30 takes a quick look.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/calibration.py" "$@"
