#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scans a second of a lot on one job and on two, and the memory of each: writes reports/lot_speed.md and .csv. 1,000
# scans by default, of 100 different foils; every further file is one of them with a note of its own, so that each is
# read, summed and measured for itself. Then reports of 1,000 to 100,000 records. Needs 6 GB in $TMPDIR (/tmp); the files
# that it makes there it removes.
#   tests/bench/lot_speed.sh [SCANS] [--records MOST] [--before PROGRAM [--before-name WORDS]]
# --before: another build of the program, turn and turn about with this one.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/lot_speed.py" "$@"
