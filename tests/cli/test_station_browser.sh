#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The inspection station in a real browser: a day. Only with FOILGAUGE_TEST_LONG, and where
# there is one: see tests/browser/station_browser.py.
# Usage: test_station_browser.sh PROGRAM
set -euo pipefail
[ -n "${FOILGAUGE_TEST_LONG-}" ] || { echo "skipped: only with FOILGAUGE_TEST_LONG"; exit 77; }
[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || { echo "skipped: left to the other tree"; exit 77; }
[ -x /usr/bin/python3 ] || { echo "skipped: python3 is not on this machine"; exit 77; }
exec /usr/bin/python3 -B tests/browser/station_browser.py "$1" --renderer "${FOILGAUGE_RENDERER:-$1}"
