#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Speed of a station: pages and start with thousands of scans in the database, the time from a scan's arrival to its
# verdict on the page, memory over thousands of requests and over a day's scans. Writes reports/station.md.
#   tests/bench/station_speed.sh [--scans 5000] [--requests 5000] [--day 1440] [-o FILE]
# Needs 1 GB in $TMPDIR (/tmp); the files that it makes there it removes.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES python3 python3-numpy
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/station_speed.py" "$@"
