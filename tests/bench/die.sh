#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The thesis's die from traces with known truth: writes reports/thesis/die.md and die.html (the sample's page).
#   tests/bench/die.sh [SEEDS]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
/usr/bin/python3 tests/bench/die.py "$PWD/build/foilgauge" "$folder" reports/thesis/die.md "${1:-16}"
(cd samples/die && ../../build/foilgauge die con*.txt --html ../../reports/thesis/die.html)
