# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop on rendered scans whose truth is known: the effects that it names, and the error that it removes.

Usage: loop_scans.py PROGRAM [--cases N] [--tier NAME]... [--seed S] [--threads N] [--fresh] [--report-only]
       loop_scans.py PROGRAM --curve [--trials N] [--threads N] [--fresh]

Writes reports/loop_scans.csv and .md, or with --curve reports/loop_scans_curve.csv, .svg and .md. Cases that the CSV
holds are not run again (--fresh: all are), so that a run can be broken off and taken up."""

import argparse
import os
import tempfile
from dataclasses import dataclass

import numpy as np

import loop_scans_report
from loop_cases import CURVES, PART_EFFECTS, SCANNER_EFFECTS, draw_case
from loop_run import Results, judge, run_loop

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
ALL = SCANNER_EFFECTS + PART_EFFECTS


@dataclass
class Tier:
    title: str
    layouts: list  # taken in turn
    count: int
    effects: int  # listed ones; -1: one free-form curve
    kinds: list


TIERS = {
    "clean": Tier("nothing there", ["single", "90", "single", "45", "single", "foils"], 60, 0, []),
    "single": Tier("one scan, one effect", ["single"], 66, 1, ALL),
    "single-two": Tier("one scan, two effects", ["single"], 33, 2, ALL),
    "single-curve": Tier("one scan, an unlisted curve", ["single"], 28, -1, CURVES),
    "pair-90": Tier("turned by 90°, one effect", ["90"], 44, 1, ALL),
    "pair-45": Tier("turned by 45°, one effect", ["45"], 44, 1, ALL),
    "pair-two": Tier("turned by 90° or 45°, two effects", ["90", "45"], 44, 2, ALL),
    "pair-curve": Tier("turned by 90°, an unlisted curve", ["90"], 42, -1, CURVES),
    "foils": Tier("three foils, one effect of the scanner", ["foils"], 28, 1, SCANNER_EFFECTS),
}
CURVE_KINDS = [
    ("scan.scale_y", "single"),
    ("scan.scale_y", "90"),
    ("scan.carriage_ripple", "single"),
    ("part.ovality", "90"),
]
CURVE_SIZES = [0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6, 1.2, 3.0]


def kinds_of(rng, tier, index):
    """The first effect goes through the list, so that every one comes equally often."""
    if tier.effects == 0:
        return []
    first = tier.kinds[index % len(tier.kinds)]
    if tier.effects < 2:
        return [first]
    rest = [k for k in tier.kinds if k != first]
    return [first, str(rng.choice(rest))]


def make_case(name, index, seed):
    tier = TIERS[name]
    rng = np.random.default_rng([seed, list(TIERS).index(name), index])
    layout = tier.layouts[index % len(tier.layouts)]
    return layout, draw_case(rng, layout, index, kinds_of(rng, tier, index))


def run_scans(program, options):
    seed = options.seed

    def work(key):
        layout, case = make_case(key["tier"], key["index"], seed)
        with tempfile.TemporaryDirectory() as folder:
            return {"layout": layout, **judge(case, *run_loop(program, folder, case))}

    jobs = []
    for name in options.tier or TIERS:
        count = TIERS[name].count if options.cases is None else min(options.cases, TIERS[name].count)
        jobs += [{"tier": name, "index": k} for k in range(count)]
    results = Results(os.path.join(options.out, "loop_scans.csv"), options.fresh, [seed], "form_within")
    if not options.report_only:
        results.run(jobs, work, options.threads)
    loop_scans_report.write_scans(options.out, results.rows, TIERS, options)


def run_curve(program, options):
    def work(key):
        kind, layout = key["effect"], key["layout"]
        numbers = [options.seed, 1000 + CURVE_KINDS.index((kind, layout)), key["trial"]]
        # The same foil and scanner at every size: only the size differs along the curve.
        case = draw_case(np.random.default_rng(numbers), layout, key["trial"], [kind], key["size_um"])
        with tempfile.TemporaryDirectory() as folder:
            report, code, seconds = run_loop(program, folder, case)
        row = judge(case, report, code, seconds)
        keep = ("verdict", "claims", "class", "unattributed", "named", "in_class", "exit", "seconds")
        return {k: row[k] for k in keep}

    jobs = [
        {"effect": kind, "layout": layout, "size_um": size, "trial": k}
        for k in range(options.trials)
        for kind, layout in CURVE_KINDS
        for size in CURVE_SIZES
    ]
    results = Results(os.path.join(options.out, "loop_scans_curve.csv"), options.fresh, [options.seed], "size_um")
    if not options.report_only:
        results.run(jobs, work, options.threads)
    loop_scans_report.write_curve(options.out, results.rows, CURVE_KINDS, CURVE_SIZES)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, help="at most so many of every tier")
    parser.add_argument("--tier", action="append", choices=TIERS)
    parser.add_argument("--curve", action="store_true", help="how small an effect is found")
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--fresh", action="store_true", help="forget the rows of this seed that the CSV has")
    parser.add_argument("--report-only", action="store_true")
    parser.add_argument("--out", default=os.path.join(ROOT, "reports"))
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    (run_curve if options.curve else run_scans)(os.path.abspath(options.program), options)


if __name__ == "__main__":
    main()
