#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The ± of a difference between the highest and the lowest of several levels, against a balanced table's own algebra: of
# slopes with their covariance; of means with an interval that allows for the data's choice of both levels.
. tests/support/cli.sh
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }

python3 - "$program" <<'P' || fail "the intervals of extremes"
import json, math, random, re, subprocess, sys
rng = random.Random(2)

def loop(name, head, rows, model):
    with open(name, "w") as out:
        out.write(head + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    said = subprocess.run([sys.argv[1], "loop", name, "--response", "y", "--model", model], capture_output=True, text=True)
    return json.loads(said.stdout)["claims"][0]

def near(name, value, expected):
    print(name, value, expected)
    assert abs(value - expected) < 0.02 * expected, name

# Three slopes over T = 0 to 11: se of a difference is s sqrt(2 / Sxx), Student's t of 30 degrees of freedom 2.042.
rows = [(t, coil, slope * t + rng.gauss(0, 1)) for coil, slope in (("A", 0), ("B", 0.2), ("C", 0.9)) for t in range(12)]
rng.shuffle(rows)
rest, sxx, slopes = 0, sum((t - 5.5) ** 2 for t in range(12)), {}
for coil in "ABC":
    own = [(t, y) for t, c, y in rows if c == coil]
    mean = sum(y for t, y in own) / 12
    slopes[coil] = sum((t - 5.5) * (y - mean) for t, y in own) / sxx
    rest += sum((y - mean - slopes[coil] * (t - 5.5)) ** 2 for t, y in own)
claim = loop("slopes.csv", "T,coil,y", rows, "1 + T + coil")
assert claim["name"] == "table.interaction(T, coil)", claim["name"]
said = re.search(r"is ([0-9.]+) ± ([0-9.]+) higher for coil (\w) than for coil (\w)", claim["sentence"])
near("difference of slopes", float(said[1]), 11 * (slopes[said[3]] - slopes[said[4]]))
near("its U", float(said[2]), 2.0423 * 11 * math.sqrt(rest / 30 * 2 / sxx))

# Seven levels of six rows, one of which stands out: Student's t at 2.5 % / 6, of 35 degrees of freedom, is 2.7966.
rows = [(level, (3 if level == "D" else 0) + rng.gauss(0, 1)) for level in "ABCDEFG" for i in range(6)]
rng.shuffle(rows)
rest = 0
for level in "ABCDEFG":
    own = [y for l, y in rows if l == level]
    rest += sum((y - sum(own) / 6) ** 2 for y in own)
claim = loop("levels.csv", "coil,y", rows, "1")
assert claim["name"] == "table.factor(coil)", claim["name"]
said = re.search(r"reads ([0-9.]+) ± ([0-9.]+) higher", claim["sentence"])
near("U of the extremes", float(said[2]), 2.7966 * math.sqrt(rest / 35 * 2 / 6))
P

exit $failed
