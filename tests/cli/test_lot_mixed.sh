#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Lots that are not as they should be: a gauge study with scans missing, foils of another product among the lot's.
. tests/support/cli.sh
skip_when_slow
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }

cat >made.py <<'P'
import json, math, random, sys
sys.path.insert(0, sys.argv[1] + "/tests/support")
import formed_lots as made

template = made.Template(sys.argv[2], "template", {**made.DESIGN, "bump_count": 9}, renderer=sys.argv[3])
def foil(radii):
    return template.foil(20.73, made.DESIGN["pitch_deg"], [(radius, 63.15) for radius in radii])

def study(name, missing):
    """Eight foils by three operators, twice; each scan scatters by 2 um."""
    rng, foils, columns = random.Random(1), [], {"foil": [], "operator": []}
    bias = {who: rng.gauss(0, 0.003) for who in "ABC"}
    for part in range(8):
        radii = [3.3 * math.exp(rng.gauss(0, 0.01)) for _ in range(9)]
        for who in "ABC":
            for trial in range(2):
                seen = [radius + bias[who] + rng.gauss(0, 0.002) for radius in radii]
                if (part, who, trial) in missing:
                    continue
                foils.append(foil(seen))
                columns["foil"].append(f"P{part}")
                columns["operator"].append(who)
    template.write(name, foils, columns)
    studies = [s for s in json.load(open(name + "/lot.json"))["gauge_studies"] if s["quantity"] == "radius_mm"]
    return [studies[k]["repeatability"] for k in range(len(studies))]

whole, gaps = study("whole", ()), study("gaps", {(3, "B", 1), (5, "A", 0), (5, "A", 1)})
assert len(whole) == len(gaps) == 9, (len(whole), len(gaps))
for a, b in zip(whole, gaps):
    assert abs(a - b) < 0.2 * a, (whole, gaps)
assert not study("few", {(part, who, 0) for part in range(8) for who in "ABC" if part % 3}), "half of a study is one"

def lot(name, others, factor):
    rng, foils = random.Random(2), []
    for k in range(12):
        foils.append(foil([3.32 * (factor if k < others else 1) * math.exp(rng.gauss(0, 0.004)) for _ in range(9)]))
    template.write(name, foils)
    return "Foils far from the others" in open(name + "/index.html").read()

assert not lot("alike", 0, 1) and not lot("near", 2, 1.02)
assert lot("mixed", 2, 1.2) and lot("small", 1, 0.9)
P
python3 made.py "$root" "$program" "$renderer" || fail "the lots"

exit $failed
