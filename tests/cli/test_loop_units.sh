#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Nothing that `foilgauge loop` says of a measured table depends on the origin or the unit of the response or of a column,
# nor on a column that is given twice (tests/data/measured/expected.json lists tables of which it still does).
if ! command -v python3 >/dev/null; then
  echo "skipped: no python3"
  exit 77
fi
. tests/support/cli.sh

only=(--only lattice_a --only check_standard)
[ -n "${FOILGAUGE_TEST_BRIEF:-}" ] || only+=(--only impact_energy)
[ -z "${FOILGAUGE_TEST_LONG:-}" ] || only+=(--only load_cell --only filter_transmittance)
python3 "$root/tests/bench/loop_measured.py" "$program" --units "${only[@]}" >differences || fail "$(cat differences)"
exit $failed
