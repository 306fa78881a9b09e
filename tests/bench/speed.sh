#!/bin/bash
# Time, memory and accuracy of foilgauge beside reading alone and two Python peers, in one run:
# writes reports/speed.md and reports/speed.csv. Scans may be given (each with its *.truth.json
# beside it); without any, those of the shared data folder or of samples/.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/packages.sh"

install_missing $FOILGAUGE_PACKAGES $FOILGAUGE_BENCH_PACKAGES
(cd "$root" && build_preset release build)
exec /usr/bin/python3 "$root/tests/bench/speed.py" "$@"
