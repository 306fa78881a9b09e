# SPDX-License-Identifier: GPL-3.0-or-later
"""made_lots.py MODEL FOLDER [options], made_lots.py MODEL --list FILE: lots of known values in the form of a lot that was
measured; made_lots.py --check INDEX: the comparisons of an index against the means and spreads it states of its lots.

Radius, height and overall radius are drawn anew, 12 foils of 3 bumps: a foil's own level and its bumps' scatter.
"""

import argparse
import csv
import json
import math
import pathlib
import random
import statistics
import sys

RADIUS_MM, RADIUS_FOIL_SD, RADIUS_BUMP_SD = 3.486, 0.02, 0.03  # 5 % of springback
HEIGHT_MM, HEIGHT_FOIL_SD, HEIGHT_BUMP_SD = 0.55, 0.003, 0.004
OVERALL_MM, OVERALL_SD = 20.9, 0.03


def options(words):
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--date")
    parser.add_argument("--radius", type=float, default=0)
    parser.add_argument("--die", default="")
    parser.add_argument("--die-radius", type=float, default=0)
    parser.add_argument("--design-radius", type=float, default=3.32)
    parser.add_argument("--foils", type=int, default=12)
    return parser.parse_args(words)


def describe(values):
    known = len(values) > 0
    return {
        "count": len(values), "mean": statistics.fmean(values) if known else None,
        "sd": statistics.stdev(values) if len(values) > 1 else None, "median": statistics.median(values) if known else None,
        "mode": None, "min": min(values, default=None), "max": max(values, default=None), "bandwidth": None,
    }


def write(folder, name, like, rows):
    with open(like / name, newline="", encoding="utf-8") as file:
        fields = next(csv.reader(file))
    extra = [key for key in ("die",) if key not in fields]
    with open(folder / name, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fields[:1] + extra + fields[1:], restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def make(model, o):
    folder, rng = pathlib.Path(o.folder), random.Random(o.seed)
    folder.mkdir(exist_ok=True)
    lot = json.loads((model / "lot.json").read_text(encoding="utf-8"))
    dies, foils, bumps = o.die.split(","), [], []
    scale = o.design_radius / 3.32
    for i in range(o.foils):
        die = dies[i % len(dies)]
        shift = o.radius + (o.die_radius if i % len(dies) else 0) + rng.gauss(0, RADIUS_FOIL_SD)
        height = HEIGHT_MM + rng.gauss(0, HEIGHT_FOIL_SD)
        key = {"scan": f"{o.folder}-{i}.png", "die": die, "foil_number": 1}
        foils.append(key | {"verdict": "pass", "overall.radius_mm": repr(rng.gauss(OVERALL_MM, OVERALL_SD))})
        for k in range(3):
            radius = scale * (RADIUS_MM + shift + rng.gauss(0, RADIUS_BUMP_SD))
            bumps.append(key | {"bump": k + 1, "radius_mm": repr(radius),
                                "radius_error_pct": repr(100 * (radius / o.design_radius - 1)),
                                "height_mm": repr(rng.gauss(height, HEIGHT_BUMP_SD))})
    write(folder, "foils.csv", model, foils)
    write(folder, "bumps.csv", model, bumps)
    values = lambda rows, name: describe([float(row[name]) for row in rows])
    lot["name"] = o.folder
    lot["date"] = {"first": o.date, "last": o.date, "from": "manifest" if o.date else None}
    lot["design"]["bump_radius_mm"] = o.design_radius
    lot["inputs"] = [{"path": foil["scan"], "sha256": f"{o.seed:032x}{i:032x}", "error": None} for i, foil in enumerate(foils)]
    lot["counts"] |= {"foils": len(foils), "scans": len(foils), "pass": len(foils), "no_tolerance": 0}
    lot["quantities"] = {name: values(bumps, name) for name in ("radius_mm", "height_mm", "radius_error_pct")}
    lot["quantities"]["overall.radius_mm"] = values(foils, "overall.radius_mm")
    (folder / "lot.json").write_text(json.dumps(lot, indent=1), encoding="utf-8")


def t_two_sided(t, nu, steps=2000):
    """P(|T| > t) by Simpson's rule over the angle whose tangent is t / sqrt(nu)."""
    norm = math.exp(math.lgamma((nu + 1) / 2) - math.lgamma(nu / 2)) / math.sqrt(math.pi)
    end, start = math.pi / 2, math.atan(t / math.sqrt(nu))
    step = (end - start) / steps
    total = sum((1 if i in (0, steps) else 4 if i % 2 else 2) * max(0.0, math.cos(start + i * step)) ** (nu - 1)
                for i in range(steps + 1))
    return 2 * norm * total * step / 3


def check(path):
    index = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    lots = {lot["folder"]: lot["quantities"] for lot in index["lots"]}
    pairs, worst = index["comparisons"]["pairs"], 0.0
    close = lambda a, b, share: abs(a - b) <= share * max(abs(a), abs(b), 1e-12)
    for folder, quantities in lots.items():  # every foil has as many bumps: the mean of their means is the mean of all
        for name, q in quantities.items():
            assert close(q["foil_mean"], q["mean"], 1e-6), (folder, name, q)
    for rank, pair in enumerate(pairs):
        a, b = (lots[pair[side]][pair["quantity"]] for side in ("larger", "smaller"))
        va, vb = a["foil_sd"] ** 2 / a["foils"], b["foil_sd"] ** 2 / b["foils"]
        freedom = (va + vb) ** 2 / (va ** 2 / (a["foils"] - 1) + vb ** 2 / (b["foils"] - 1))
        difference = a["foil_mean"] - b["foil_mean"]
        p = t_two_sided(abs(difference) / math.sqrt(va + vb), freedom)
        worst = max(worst, min(1.0, (len(pairs) - rank) * p))
        assert difference >= 0 and close(difference, pair["difference"], 1e-5), pair
        assert close(freedom, pair["freedom"], 1e-5) and close(p, pair["p"], 1e-5) and close(worst, pair["p_holm"], 1e-5), (p, pair)


if __name__ == "__main__":
    if sys.argv[1] == "--check":
        check(sys.argv[2])
    elif sys.argv[2] == "--list":
        for line in pathlib.Path(sys.argv[3]).read_text().splitlines():
            make(pathlib.Path(sys.argv[1]), options(line.split()))
    else:
        make(pathlib.Path(sys.argv[1]), options(sys.argv[2:]))
