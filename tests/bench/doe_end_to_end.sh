#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Designed experiments end to end: plan, render, measure, analyse; how often the 95 % intervals hold
# the law. Writes reports/doe_end_to_end.md. --repetitions N for a shorter look.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/doe_end_to_end.py" "$@"
