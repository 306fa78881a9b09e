#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The beam model of forming beside the thesis, and a loop with it as the declared model: writes reports/thesis/form*.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/thesis_form.py" "$@"
