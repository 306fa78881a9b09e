#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Accuracy of foilgauge on foils with known truth: writes reports/accuracy.md, accuracy.csv and
# accuracy_shared.md. --share 0.1 takes a tenth of every tier for a quick look.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/accuracy.py" "$@"
