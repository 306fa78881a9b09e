# SPDX-License-Identifier: GPL-3.0-or-later
"""loop_strata.py PROGRAM [--lots N] [--relabelled N] [--out FOLDER]

Tables like a lot's: bumps in foils in dies, coils and days, with operator and oven place. One of them is planted, at
five standard errors of the difference between its levels' means (foils are the rows that count); or the foils' labels
are drawn anew, and no claim is right. Writes loop_strata.md.
"""

import argparse
import csv
import json
import os
import random
import subprocess
import tempfile

FOILS, BUMPS = 24, 8
LEVELS = {"die": 3, "coil": 4, "day": 4, "operator": 2, "oven_place": 6}
FOIL_SD, ROW_SD, ERRORS = 1.0, 0.7, 5.0


def labels(draw):
    """Nested in time: coils and days follow each other; dies, operators and places are mixed."""
    rows = []
    for f in range(FOILS):
        rows.append({"coil": f * LEVELS["coil"] // FOILS, "day": (f * 5 // 4) % FOILS * LEVELS["day"] // FOILS})
    for name in ("die", "operator", "oven_place"):
        mixed = [f % LEVELS[name] for f in range(FOILS)]
        draw.shuffle(mixed)
        for row, level in zip(rows, mixed):
            row[name] = level
    return rows


def planted_levels(name, draw):
    """Levels with an sd that stands ERRORS standard errors from nothing."""
    count = LEVELS[name]
    values = [draw.gauss(0, 1) for _ in range(count)]
    mean = sum(values) / count
    size = (sum((v - mean) ** 2 for v in values)) ** 0.5
    error = ((FOIL_SD ** 2 + ROW_SD ** 2 / BUMPS) / (FOILS / count)) ** 0.5
    reach = ERRORS * error * max(1, (count - 1) ** 0.5)
    return [(v - mean) / size * reach for v in values]


def write_lot(path, planted, seed):
    draw = random.Random(f"{planted} {seed}")
    foils = labels(draw)
    effect = planted_levels(planted, draw) if planted else None
    with open(path, "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["foil", "bump", *LEVELS, "radius_mm"])
        for f, foil in enumerate(foils):
            level = draw.gauss(0, FOIL_SD) + (effect[foil[planted]] if planted else 0)
            for bump in range(1, BUMPS + 1):
                radius = 3 + 0.01 * (level + draw.gauss(0, ROW_SD))
                out.writerow([f"F{f + 1:03}", bump, *(f"{n[0].upper()}{foil[n] + 1}" for n in LEVELS), f"{radius:.6f}"])


def names(claim):
    return [claim["name"], *(a["name"] for a in claim["alias_class"])]


def ask(program, planted, seed):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "lot.csv")
        write_lot(path, planted, seed)
        command = [program, "loop", "--table", path, "--response", "radius_mm", "--model", "1", "--group", "foil", "-o", "-"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    report = json.loads(done.stdout)
    return report["verdict"], [names(c) for c in report["claims"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--lots", type=int, default=20)
    parser.add_argument("--relabelled", type=int, default=100)
    parser.add_argument("--out", default="reports")
    args = parser.parse_args()
    lines = ["# Strata of a lot in the loop on tables", "",
             f"{FOILS} foils of {BUMPS} bumps (sd between foils {FOIL_SD}, within {ROW_SD}); one stratum planted at {ERRORS:g}"
             " standard errors.", "", f"    python3 tests/bench/loop_strata.py build/foilgauge --lots {args.lots} --relabelled {args.relabelled}",
             "", "| planted | lots | named | in class | another claim |", "|---|---|---|---|---|"]
    for planted in LEVELS:
        named = in_class = other = 0
        for seed in range(args.lots):
            _, claims = ask(args.program, planted, seed)
            right = [c for c in claims if any(f"({planted})" in n for n in c)]
            named += any(f"({planted})" in c[0] for c in right)
            in_class += bool(right)
            other += len(right) < len(claims)
        lines.append(f"| {planted} | {args.lots} | {named} | {in_class} | {other} |")
    wrong = sum(bool(ask(args.program, None, seed)[1]) for seed in range(args.relabelled))
    lines += ["", f"Labels drawn anew: {wrong} of {args.relabelled} lots with a claim.", ""]
    with open(os.path.join(args.out, "loop_strata.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
