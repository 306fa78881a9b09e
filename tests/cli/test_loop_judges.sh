#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The judge and the tables of tests/bench/loop_power.py: what counts as found, and effects as large as they are said to be.
if ! /usr/bin/python3 -c 'import numpy, scipy' 2>/dev/null; then
  echo "skipped: no numpy and scipy"
  exit 77
fi
. tests/support/cli.sh

cat >judge.py <<'EOF2'
import sys
sys.path.insert(0, sys.argv[1])
import loop_power as power
import loop_power_tables as tables
Truth = tables.Truth

def claim(name, also=(), **parameters):
    return {"id": name.split("(")[0], "name": name, "parameters": parameters, "alias_class": [{"name": n} for n in also], "p_value": 0.001}

def report(*claims, curve=None):
    return {"verdict": "explained", "claims": list(claims), "unattributed": curve, "rejected": [], "error_ratio": {}}

def said(truth, *claims, curve=None):
    j = power.judge(report(*claims, curve=curve), truth)
    return j["found"], j["exact"], j["wrong"]

drift = Truth([("table.order_drift", ["run"]), ("table.linear", ["run"])])
assert said(drift, claim("table.order_drift(run)")) == (1, 1, 0)
assert said(drift, claim("table.factor(coil)", ["table.linear(run)"])) == (1, 0, 0)
assert said(drift, claim("table.order_drift(foil)")) == (0, 0, 1)
assert said(drift, claim("table.factor(coil)", ["table.linear(run) + table.outlier(3)"])) == (0, 0, 1)
assert said(drift) == (0, 0, 0)
pair = Truth([("table.interaction", ["a", "b"])])
assert said(pair, claim("table.interaction(b, a)")) == (1, 1, 0)
two = Truth([], rows=[4, 8])
assert said(two, claim("table.outlier(5)", row=5.0), claim("table.outlier(9)", row=9.0)) == (1, 1, 0)
assert said(two, claim("table.outlier(5)", row=5.0)) == (0, 0, 0)
assert said(two, claim("table.outlier(6)", row=6.0)) == (0, 0, 1)
assert said(two, claim("table.exchanged_runs(5, 9)", row=5.0, second_row=9.0)) == (1, 1, 0)
curve = Truth([], anywhere="humidity_pct")
assert said(curve, curve={"coordinate": "humidity_pct", "p_value": 0.001}) == (1, 1, 0)
assert said(curve, curve={"coordinate": "run", "p_value": 0.001})[0] == 0
false = lambda kind, *claims: power.judge_clean(report(*claims), kind)["found"]
assert false("white") == 0 and false("white", claim("table.spread(coil)")) == 1
assert false("unequal_spread", claim("table.spread(coil)")) == 0 and false("unequal_spread", claim("table.factor(coil)")) == 1
assert false("correlated", claim("table.order_drift(run)", ["table.serial_correlation(run)"])) == 0
assert false("correlated", claim("table.order_drift(run)")) == 1

for design in tables.DESIGNS:
    off = []
    for kind in tables.KINDS:
        for index in range(4):
            made = tables.effect_table(design, kind, 6, 5, index)
            if made and kind not in tables.SCATTERS + ["masked_outliers"]:
                off.append(tables.oracle_z(made[1], made[0], made[2]) - 6)
    assert len(off) == 60 and abs(sum(off) / len(off)) < 0.5, (design, sum(off) / len(off))
EOF2
/usr/bin/python3 judge.py "$root/tests/bench" 2>words || fail "$(tail -n 3 words)"
exit $failed
