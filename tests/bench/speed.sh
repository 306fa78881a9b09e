#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Time, memory and accuracy of foilgauge on all cores and on one, beside reading alone and two Python peers, in one run:
# writes reports/speed.md and .csv. Scans may be given (each with its *.truth.json beside it); without any, those of the
# shared data folder or, where it is not there, renders like them (speed_scans.py), and then also how the time grows with
# pixels, foils and noise, a bed of A4, and where the time goes: reports/speed_growth.md, .csv and .svg.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES $FOILGAUGE_BENCH_PACKAGES
(cd "$root" && build_preset release build)
/usr/bin/python3 "$root/tests/bench/speed.py" "$@"
[ $# -gt 0 ] || /usr/bin/python3 "$root/tests/bench/speed_growth.py"
