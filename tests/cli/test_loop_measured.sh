#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tables that somebody measured, through `foilgauge loop`: their known findings are claimed or in a claim's class, and
# nothing is claimed of those that hold nothing (tests/data/measured/expected.json; its "not_yet" lists missed findings).
if ! command -v python3 >/dev/null; then
  echo "skipped: no python3"
  exit 77
fi
. tests/support/cli.sh
long_only

only=()
[ -n "${FOILGAUGE_TEST_BRIEF:-}" ] && only=(--only load_cell --only impact_energy --only lattice_a)
python3 "$root/tests/bench/loop_measured.py" "$program" --check "${only[@]}" >differences || fail "$(cat differences)"

# The judge itself: an answer that is not the known one is called wrong.
cat >wrong.py <<'EOF2'
import sys
sys.path.insert(0, sys.argv[1])
from loop_measured import judge
case = {"findings": [{"what": "load", "accepted": ["table.quadratic(load)"]}], "allowed": []}
claim = lambda name, more: {"id": name.split("(")[0], "name": name, "parameters": {}, "alias_class": [{"name": m} for m in more]}
report = lambda claims, after: {"verdict": "explained" if claims else "clean", "claims": claims, "unattributed": None,
                                "before": {"rms": 1.0}, "after": {"rms": after}}
said = [judge(report(c, after), case) for c, after in (
    ([claim("table.quadratic(load)", [])], 0.5), ([claim("table.linear(other)", ["table.quadratic(load)"])], 0.5), ([], 1.0),
    ([claim("table.linear(other)", [])], 0.5), ([claim("table.quadratic(load)", [])], 1.0))]
assert said[0] == said[1] == [], said
assert said[2] == ["misses load"], said
assert said[3] == ["misses load", "claims table.linear(other)"], said
assert said[4] == ["explained without an error that falls"], said
EOF2
python3 wrong.py "$root/tests/bench" || fail "the judge of loop_measured.py"
exit $failed
