# SPDX-License-Identifier: GPL-3.0-or-later
"""A tie with a second scan: the range that one scan leaves, and the range that remains with the foil turned by 90 degrees.

Usage: loop_ties.py PROGRAM [--cases N] [--seed S]; writes reports/loop_ties.csv and .md."""

import argparse
import csv
import os
import tempfile

import numpy as np

from loop_cases import draw_case
from loop_run import pair_bumps, pair_foils, run_loop

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
KINDS = ["scan.scale_y", "scan.shear", "part.ovality", "scan.optical_quadratic", "scan.carriage_quadratic"]
SIZES_UM = (0.5, 3.0)


def widths(case, report):
    """(the claims or the verdict, {quantity: (width of the range or of U in um, share that holds the truth)})."""
    foils = pair_foils(case, report["after"]["foils"])
    midline, _, foil = foils[0]
    overall = foil["overall"]
    rows = {"R0": [(overall, "radius", midline.measurand.overall)], "R": [], "h": []}
    for i, bump in pair_bumps(*foils[0]):
        rows["R"].append((bump, "radius", midline.measurand.radius[i]))
        rows["h"].append((bump, "height", midline.measurand.height[i]))
    result = {}
    for name, own in rows.items():
        span, held = [], []
        for circle, what, truth in own:
            value, u = circle[what + "_mm"], circle["u_" + what + "_mm"]
            low, high = circle.get(what + "_range_mm", (value - 2 * u, value + 2 * u))
            span.append(1000 * (high - low))
            held.append(low <= truth <= high)
        result[name] = (float(np.mean(span)), float(np.mean(held)))
    return " + ".join(f"{c['id']} ({c['verdict']})" for c in report["claims"]) or report["verdict"], result


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, default=12, help="ties")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", default=os.path.join(ROOT, "reports"))
    options = parser.parse_args()
    program, rows, tried = os.path.abspath(options.program), [], 0
    while len(rows) < options.cases and tried < 10 * options.cases:
        rng = np.random.default_rng([options.seed, 77, tried])
        kind = KINDS[tried % len(KINDS)]
        case = draw_case(rng, "90", tried, [kind], float(np.exp(rng.uniform(*np.log(SIZES_UM)))))
        tried += 1
        alone = {**case, "specs": case["specs"][:1], "same_foil": False}
        with tempfile.TemporaryDirectory() as folder:
            first, _, _ = run_loop(program, folder, alone)
        if not any(c["verdict"] == "tied" for c in first["claims"]):
            continue
        with tempfile.TemporaryDirectory() as folder:
            both, _, _ = run_loop(program, folder, case)
        one_said, one = widths(alone, first)
        two_said, two = widths(case, both)
        row = {"case": tried - 1, "there": kind, "one_scan": one_said, "two_scans": two_said}
        for q in ("R", "h", "R0"):
            row.update({f"{q}_one_um": f"{one[q][0]:.4g}", f"{q}_two_um": f"{two[q][0]:.4g}"})
            row.update({f"{q}_one_holds": f"{one[q][1]:.3f}", f"{q}_two_holds": f"{two[q][1]:.3f}"})
        rows.append(row)
    with open(os.path.join(options.out, "loop_ties.csv"), "w", newline="", encoding="utf-8") as f:
        writer = csv.DictWriter(f, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    lines = [
        "# What a second scan does to a tie", "",
        f"Made by `python3 tests/bench/loop_ties.py build/foilgauge --cases {options.cases} --seed {options.seed}`: {len(rows)} foils of which",
        f"one scan leaves a tie ({tried} tried, effects of {SIZES_UM[0]:g} to {SIZES_UM[1]:g} µm at the foil's ends). The report asks for a scan of the same",
        "foil turned by about 90°; here it is. Width: of the range over the tied explanations, else of ± U; holds: the truth",
        "lies in it.", "",
        "| dimension | one scan, median width, µm | two scans | median narrower by | one scan holds % | two scans hold % |",
        "|---|---|---|---|---|---|",
    ]  # fmt: skip
    for q in ("R", "h", "R0"):
        one, two = (np.array([float(r[f"{q}_{n}_um"]) for r in rows]) for n in ("one", "two"))
        holds = [100 * np.mean([float(r[f"{q}_{n}_holds"]) for r in rows]) for n in ("one", "two")]
        cells = [q, f"{np.median(one):.3g}", f"{np.median(two):.3g}", f"{np.median(one / two):.1f} ×"]
        lines.append("| " + " | ".join(cells + [f"{h:.0f}" for h in holds]) + " |")
    lines += ["", "| case | there | one scan said | two scans said | R0: width, µm |", "|---|---|---|---|---|"]
    for r in rows:
        lines.append(
            f"| {r['case']} | {r['there']} | {r['one_scan']} | {r['two_scans']} | {r['R0_one_um']} → {r['R0_two_um']} |"
        )
    with open(os.path.join(options.out, "loop_ties.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("wrote loop_ties.md and .csv")


if __name__ == "__main__":
    main()
