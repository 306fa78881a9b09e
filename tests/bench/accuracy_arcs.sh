#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Accuracy of `measure` on plain strips with known truth: writes reports/accuracy_arcs.md.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/accuracy_arcs.py" "$@"
