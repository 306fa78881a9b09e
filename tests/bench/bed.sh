#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Whole beds: time and memory against reading alone, over bed size and number of foils; the foils of a
# bed against the same foils one by one. Writes reports/bed.md, bed.csv and bed.svg.
# Needs 4 GB in $TMPDIR (/tmp); the files that it makes there it removes.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/bed.py" "$@"
