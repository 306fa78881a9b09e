#!/bin/bash
# reports/loop_tables.md and .csv: the loop on generated tables with known truth. Half an hour on two
# cores. Needs python3-numpy.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
/usr/bin/python3 "$root/tests/bench/loop_tables.py" "$root/build/foilgauge" -o "$root/reports" "$@"
