# SPDX-License-Identifier: GPL-3.0-or-later
"""Coverage of `foilgauge stiffness` on the records of other_bearing.py, whose truth is known.

Usage: other_bearing_coverage.py build/foilgauge [--records N] [--kinds NAME...] [--seed S] [--csv FILE]

  /usr/bin/python3 tests/bench/other_bearing_coverage.py build/foilgauge

A cell says, in percent: values within U = 2 u of the truth, of those that are given; withheld; given with a flag that
casts doubt on them; beyond 2 U without such a flag (the silent failures). `-` stands where the report has no such
member. Of a direction without a gap a clearance cannot be right; nor can an axis where all directions are alike: a value
given there without a flag is a silent failure.

Stiffness and loss factor are judged twice: `there` against the true slope where the report says that it has found it
(at the force of its course beside stiffness_at_mm), `largest` against the largest over the whole test.

Break-away tests are judged where the program has --break-away.

The gains of the N records of a kind are spread evenly over their distribution (a Latin square), so that N need not be
large for their share. Members are looked up by their names; null, absent and refused records count as withheld."""

import argparse
import csv
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from statistics import NormalDist

import numpy as np

from other_bearing import make_break_away, make_record
from other_bearing_kinds import KINDS, PULL_KINDS, draw_spec, generator_of

# Flags that tell of a test and cast no doubt on a value. Every other flag, also one that is new, does.
INFORMATIVE = {"stiffness_at_end", "one_cycle", "line_not_checked", "weights_differ"}

# label, of a direction or the bearing, member of the truth, names in the report
QUANTITIES = [
    ("clearance", "direction", "clearance_mm", ["clearance_mm"]),
    ("gap", "direction", "gap_mm", ["gap_mm"]),
    ("stiffness there", "direction", "stiffness_there_n_mm", ["stiffness_n_mm"]),
    ("largest", "direction", "stiffness_n_mm", ["stiffness_n_mm"]),
    ("secant", "direction", "stiffness_secant_n_mm", ["stiffness_secant_n_mm"]),
    ("loss there", "direction", "loss_factor_there", ["loss_factor"]),
    ("loss, largest", "direction", "loss_factor", ["loss_factor"]),
    ("loss, secant", "direction", "loss_factor_secant", ["loss_factor_secant"]),
    ("loss of the foil", "direction", "loss_factor_foil", ["loss_factor_foil", "foil_loss_factor"]),
    ("axis", "bearing", "smallest_axis_deg", ["smallest_at_deg", "smallest_axis_deg"]),
    ("preload", "bearing", "preload_n", ["preload_n"]),
]
PULL_QUANTITIES = [
    ("coefficient", "friction_coefficient", ["friction_coefficient"]),
    ("no weight", "friction_no_weight_n", ["friction_no_weight_n"]),
    ("preload N", "preload_n", ["preload_n"]),
    ("preload kPa", "preload_kpa", ["preload_kpa"]),
]


@dataclass
class Tally:
    """Counts of one quantity of one kind."""

    present: bool = False
    values: int = 0
    withheld: int = 0
    given: int = 0
    flagged: int = 0
    comparable: int = 0
    within: int = 0
    silent: int = 0
    errors: list = field(default_factory=list)
    relative: list = field(default_factory=list)

    def add(self, value, u, truth, flagged, period=None):
        self.values += 1
        if value is None or u is None:
            self.withheld += 1
            return
        self.given += 1
        self.flagged += flagged
        if truth is None:
            self.silent += not flagged
            return
        error = value - truth
        if period:
            error = (error + period / 2) % period - period / 2
        self.comparable += 1
        self.within += abs(error) <= 2 * u
        self.silent += abs(error) > 4 * u and not flagged
        self.errors.append(error / (2 * u) if u else float("inf"))
        self.relative.append(100 * error / truth if truth else float("nan"))

    def cell(self):
        if not self.present or not self.values:
            return "-"
        within = f"{100 * self.within / self.comparable:.0f}" if self.comparable else "."
        rest = (f"{100 * n / self.values:.0f}" for n in (self.withheld, self.flagged, self.silent))
        return " / ".join([within, *rest])


def member(report, names):
    """Name under which a report has a quantity; None where it has none."""
    return next((n for n in names if n in report), None)


def uncertainty(report, name, options):
    """u of a member; of a value that is given without one, the instruments' share of a stiffness."""
    if f"u_{name}" in report or report[name] is None:
        return report.get(f"u_{name}")
    return report[name] * options.get("u_stiffness_pct", 0) / 100


def found_there(report, truth, record):
    """True slope at the force where the report has its stiffness, and the loss factor with it."""
    at = report.get("stiffness_at_mm")
    rows = [(r, side) for side in ("course_push", "course_pull") for r in report.get(side) or [] if None not in r[:2]]
    if at is None or not rows:
        return {"stiffness_there_n_mm": truth["stiffness_n_mm"], "loss_factor_there": truth["loss_factor"]}
    row, side = min(rows, key=lambda r: abs(r[0][0] - at))
    force = (row[1] - record["spec"]["instruments"]["offset_n"]) / record["gain_force"]
    course = sorted(truth[side], key=lambda r: r[1])
    slope = float(np.interp(force, [r[1] for r in course], [r[2] for r in course]))
    return {"stiffness_there_n_mm": slope, "loss_factor_there": truth["loss_factor"] * truth["stiffness_n_mm"] / slope}


def doubts(report):
    return bool(set(report.get("flags", [])) - INFORMATIVE) or report.get("verdict") == "not_measured"


def run(program, path, *options):
    """The report of a record, or {} where it is refused, and the exit code."""
    command = [program, "stiffness", path, *options, "-o", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        return json.loads(done.stdout), done.returncode
    except json.JSONDecodeError:
        return {}, done.returncode


def of_azimuth(report, azimuth_deg):
    rows = [r for r in report.get("azimuths", []) if r.get("azimuth_deg") is not None]
    return next((r for r in rows if abs(r["azimuth_deg"] - azimuth_deg) < 0.01), {})


def tally_record(report, truth, tallies, flags):
    """Adds one record's report to the counts."""
    directions = [(of_azimuth(report, t["azimuth_deg"]), t) for t in truth["directions"]]
    directions = [(found, t | found_there(found, t, truth)) for found, t in directions]
    bearing = [((report.get("bearings") or [{}])[0], truth)]
    for found, _ in directions + bearing:
        flags.update(found.get("flags", []))
    for level, rows in (("direction", directions), ("bearing", bearing)):
        quantities = [(label, true, names) for label, where, true, names in QUANTITIES if where == level]
        for found, true in rows:
            tally_quantities(quantities, found, true, tallies, report)


def tally_quantities(quantities, found, truth, tallies, report):
    """Adds the quantities of one part of a report to the counts."""
    for label, of_truth, names in quantities:
        name = member(found, names)
        tallies[label].present |= name is not None
        value = found.get(name) if name else None
        u = uncertainty(found, name, report.get("options", {})) if name else None
        tallies[label].add(value, u, truth[of_truth], doubts(found), 180 if label == "axis" else None)


def spread(rng, n):
    """n normal deviates at evenly spaced probabilities from a random one on, in random order: no bias at any n."""
    start = rng.uniform(1e-6, 1)
    return [NormalDist().inv_cdf((k + start) / n) for k in rng.permutation(n)]


def drawn_gains(kind, records, seed):
    """Two gains of every record, in their u; each gain alone is spread evenly."""
    rng = generator_of(kind, seed + 1_000_000)
    return list(zip(spread(rng, records), spread(rng, records), strict=True))


def judge_kind(program, kind, records, seed):
    """Counts of every quantity, of flags and of exit codes over the records of one kind."""
    tallies, flags, codes = {q[0]: Tally() for q in QUANTITIES}, Counter(), Counter()
    gains = drawn_gains(kind, records, seed)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, f"{kind}.csv")
        for i in range(records):
            text, truth = make_record(draw_spec(kind, seed + i), seed + i, deviates=gains[i])
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            report, code = run(program, path)
            codes[code] += 1
            tally_record(report, truth, tallies, flags)
    return tallies, flags, codes


def judge_pulls(program, kind, records, seed):
    """Counts over break-away tests of one kind, each given with a load test of a bearing that agrees with it."""
    tallies, flags, codes = {q[0]: Tally() for q in PULL_QUANTITIES}, Counter(), Counter()
    gains = drawn_gains(kind, records, seed)
    with tempfile.TemporaryDirectory() as folder:
        load, path = os.path.join(folder, "load.csv"), os.path.join(folder, f"{kind}.csv")
        for i in range(records):
            text, truth = make_break_away(draw_spec(kind, seed + i), seed + i, gains[i])
            spec = draw_spec("interference" if truth["preload_n"] else "clean", seed + i) | {"azimuths": 1}
            for name, content in ((path, text), (load, make_record(spec, seed + i)[0])):
                with open(name, "w", encoding="utf-8") as file:
                    file.write(content)
            rig = ["--rig-torque", str(truth["spec"]["rig_torque_n_mm"])] if truth["spec"]["rig_torque_given"] else []
            report, code = run(program, load, "--break-away", path, *rig)
            codes[code] += 1
            bearing = (report.get("bearings") or [{}])[0]
            found = bearing | {k: v for k, v in (bearing.get("break_away") or {}).items() if k != "verdict"}
            flags.update(found.get("flags", []))
            tally_quantities(PULL_QUANTITIES, found, truth, tallies, report)
    return tallies, flags, codes


def has_break_away(program):
    done = subprocess.run([program, "stiffness", "--help"], capture_output=True, text=True, check=False)
    return "--break-away" in done.stdout


def write_head(labels):
    print("\n| " + " | ".join(["kind", *labels, "flags, in %", "exit codes"]) + " |")
    print("|---" * (len(labels) + 3) + "|")


def write_row(kind, tallies, flags, codes):
    directions = max(next(iter(tallies.values())).values, 1)
    named = [(name, n) for name, n in flags.most_common() if name not in INFORMATIVE]
    words = ", ".join(f"{name} {100 * n / directions:.0f}" for name, n in named)
    exits = ", ".join(f"{code}: {n}" for code, n in sorted(codes.items()))
    print("| " + " | ".join([kind, *(t.cell() for t in tallies.values()), words, exits]) + " |", flush=True)


def csv_rows(kind, tallies):
    for label, t in tallies.items():
        known = [e for e in t.relative if e == e]
        yield [kind, label, t.values, t.withheld, t.flagged, t.comparable, t.within, t.silent,
               f"{statistics.median(known):.3f}" if known else "",
               f"{statistics.median(abs(e) for e in t.errors):.3f}" if t.errors else ""]  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--records", type=int, default=30, help="of every kind")
    parser.add_argument("--kinds", nargs="+", choices=[*KINDS, *PULL_KINDS], default=[*KINDS, *PULL_KINDS])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--csv", help="counts, median error in percent and in U, a row per kind and quantity")
    args = parser.parse_args()
    print(f"{args.records} records of every kind, seed {args.seed}; in %: within U / withheld / flagged / silent")
    rows, chosen = [], [k for k in args.kinds if k in KINDS or has_break_away(args.program)]
    for judge, table, quantities in ((judge_kind, KINDS, QUANTITIES), (judge_pulls, PULL_KINDS, PULL_QUANTITIES)):
        kinds = [k for k in chosen if k in table]
        if kinds:
            write_head([q[0] for q in quantities])
        for kind in kinds:
            result = judge(args.program, kind, args.records, args.seed)
            write_row(kind, *result)
            rows += csv_rows(kind, result[0])
    if args.csv:
        with open(args.csv, "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([["kind", "quantity", "values", "withheld", "flagged", "comparable", "within",
                                         "silent", "median_error_pct", "median_error_in_U"], *rows])  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
