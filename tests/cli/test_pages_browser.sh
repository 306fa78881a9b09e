#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Every page in a real browser, on the screen and printed. Only with FOILGAUGE_TEST_LONG, and where there is one: see
# tests/browser/pages_browser.py.
# Usage: test_pages_browser.sh PROGRAM
set -euo pipefail
[ -n "${FOILGAUGE_TEST_LONG-}" ] || { echo "skipped: only with FOILGAUGE_TEST_LONG"; exit 77; }
[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || { echo "skipped: left to the other tree"; exit 77; }
[ -x /usr/bin/python3 ] || { echo "skipped: python3 is not on this machine"; exit 77; }
exec /usr/bin/python3 tests/browser/pages_browser.py "$1" --renderer "${FOILGAUGE_RENDERER:-$1}"
