# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered experiments with a known law: run sheet from `doe plan`, one scan per run, `doe --scans`.

Every repetition draws its own law. The benchmark counts 95 % intervals that hold the true coefficient,
the true response at the best setting, and one more run there.
"""

import argparse
import csv
import json
import math
import multiprocessing
import os
import pathlib
import random
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("FOILGAUGE", ROOT / "build" / "foilgauge"))
OVERALL_MM = 20.73
RUN_SD = 0.15  # of the process, in % of springback
LOAD_SD = 0.3  # between oven loads
FACTORS = {"pressure_bar": (300, 400), "temperature_C": (500, 600), "duration_h": (3, 5)}

FIRST = "(pressure_bar + temperature_C + duration_h)^2"
SECOND = "(temperature_C + duration_h)^2 + temperature_C^2 + duration_h^2"
OVERALL = "overall.springback_error_pct"
EXPERIMENTS = {
    "factorial with centre runs": dict(
        plan=["--replicates", "2", "--centre", "3"], factors=list(FACTORS), model=FIRST,
        response=OVERALL),
    "composite": dict(
        plan=["--kind", "composite", "--centre", "5"], factors=["temperature_C", "duration_h"],
        model=SECOND, response=OVERALL),
    "composite, bump radius": dict(
        plan=["--kind", "composite", "--centre", "5"], factors=["temperature_C", "duration_h"],
        model=SECOND, response="radius_error_pct"),
    "oven loads as whole plots": dict(
        plan=["--replicates", "3", "--hard", "temperature_C"], factors=list(FACTORS),
        model=FIRST, response=OVERALL, loads=True, analyse=["--whole-plot", "whole_plot"]),
    "oven loads, not told of": dict(
        plan=["--replicates", "3", "--hard", "temperature_C"], factors=list(FACTORS),
        model=FIRST, response=OVERALL, loads=True),
}


def term_value(term, coded):
    value = 1.0
    for part in term.split(":"):
        name, _, power = part.partition("^")
        value *= coded[name] ** int(power or 1)
    return value


def law_value(law, coded):
    return law["(constant)"] + sum(
        c * term_value(term, coded) for term, c in law.items() if term != "(constant)")


def draw_law(rng, experiment):
    """A magnitude of springback of some 6 %, so that no run comes near 0."""
    factors = experiment["factors"]
    law = {"(constant)": rng.uniform(5, 7)}
    for name in factors:
        law[name] = rng.uniform(-0.8, 0.8)
    for i, a in enumerate(factors):
        for b in factors[i + 1:]:
            law[f"{a}:{b}"] = rng.uniform(-0.3, 0.3)
    if experiment["model"] == SECOND:
        for name in factors:
            law[f"{name}^2"] = rng.uniform(-0.4, 0.4)
    return law


def coded_of(row, factors):
    levels = {name: FACTORS[name] for name in factors}
    return {n: (2 * float(row[n]) - low - high) / (high - low) for n, (low, high) in levels.items()}


def spec(rng, magnitude, response):
    foil = {"design": {"bump_count": 4}, "rotate_deg": rng.uniform(0, 360)}
    if response == OVERALL:
        foil["overall_radius_mm"] = OVERALL_MM * (1 + magnitude / 100)
        foil["radius_springback"] = {"mean": 0.02, "sd": 0.005}
    else:
        foil["radius_springback"] = {"mean": magnitude / 100, "sd": 0}
    return {"schema": "foilgauge/render/1", "seed": rng.randrange(2**31), "foils": [foil],
            "scanner": {"dpi": 2400, "bits": 8, "background": 30, "contrast": 175, "blur_px": 1.0,
                        "noise": 1.5}}


def run(*arguments):
    done = subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{arguments}: exit {done.returncode}: {done.stderr}")
    return done.stdout


def make_scans(folder, sheet, experiment, law, rng):
    """One scan per run; returns the true responses."""
    rows = list(csv.DictReader(sheet.open(encoding="utf-8")))
    loads, truth = {}, []
    for i, row in enumerate(rows):
        value = law_value(law, coded_of(row, experiment["factors"])) + rng.gauss(0, RUN_SD)
        if experiment.get("loads"):
            value += loads.setdefault(row["whole_plot"], rng.gauss(0, LOAD_SD))
        truth.append(value)
        row["scan"] = f"run{i}.png"
        (folder / "spec.json").write_text(json.dumps(spec(rng, value, experiment["response"])))
        run("render", folder / "spec.json", "-o", folder / row["scan"])
    with sheet.open("w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    return truth


def repeat(task):
    """Counts of one repetition: what, held."""
    name, seed = task
    experiment, rng = EXPERIMENTS[name], random.Random(f"{name}/{seed}")
    law = draw_law(rng, experiment)
    counts = []
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        sheet, design, report = folder / "runs.csv", folder / "design.json", folder / "doe.json"
        design.write_text('{"schema": "foilgauge/design/1", "bump_count": 4}')
        ranges = {n: FACTORS[n] for n in experiment["factors"]}
        given = [f"{n}={low}:{high}" for n, (low, high) in ranges.items()]
        run("doe", "plan", "-o", sheet, "--seed", seed, *experiment["plan"],
            *[a for g in given for a in ("--factor", g)])
        truth = make_scans(folder, sheet, experiment, law, rng)
        run("doe", sheet, "--scans", "scan", "--response", experiment["response"], "--design",
            design, "--model", experiment["model"], *[a for g in given for a in ("--code", g)],
            "--threads", "1", "-o", report, *experiment.get("analyse", []))
        result = json.loads(report.read_text())
    for c in result["coefficients"]:
        low, high = c["interval"]
        kind = "temperature_C" if c["name"] in ("temperature_C", "(constant)") else "other"
        held = low <= law[c["name"]] <= high
        counts.append((f"coefficients: {kind}" if experiment.get("loads") else "coefficients", held))
    for scan, value in zip(result["inputs"][1:], truth):
        error = abs(scan["value"]) - value
        counts.append(("measurement", abs(error) <= 2 * scan["u"]))
    best = result["surface"]["optimum"]
    setting = dict.fromkeys(experiment["factors"], 0)  # any will do where none is said: the middle
    mean = law_value(law, setting | dict(zip(result["surface"]["axes"], best["coded"])))
    counts.append(("response at the best setting", best["interval"][0] <= mean <= best["interval"][1]))
    one = mean + rng.gauss(0, RUN_SD) + (rng.gauss(0, LOAD_SD) if experiment.get("loads") else 0)
    low, high = best["confirmation_run_interval"]
    counts.append(("confirmation run", low <= one <= high))
    return name, counts


HEADING = """# Designed experiments, end to end

Planned by `foilgauge doe plan`, one scan rendered per run (2400 dpi, a foil of four bumps, any
rotation) with the springback of a known law plus the process's own scatter (standard deviation
{run_sd} %; {load_sd} % more between oven loads where there are some), measured and analysed by
`foilgauge doe --scans`. The law is another one in each of {repetitions} repetitions. The table says
how often the 95 % intervals (of a measurement: ±2 u) held the truth. ± is the standard error of
the share, as if all intervals were independent.

    tests/bench/doe_end_to_end.sh

The last experiment shows why restricted randomisation must be told: the same oven loads analysed as
if all runs were in random order (temperature is what changes between loads).

| experiment | intervals of | held | of | share |
|---|---|---|---|---|
"""
NAMES = {"coefficients: temperature_C": "coefficients: constant, temperature",
         "coefficients: other": "coefficients: all others", "measurement": "measured responses"}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--repetitions", type=int, default=80)
    parser.add_argument("--output", default=str(ROOT / "reports" / "doe_end_to_end.md"))
    arguments = parser.parse_args()
    tasks = [(name, seed) for name in EXPERIMENTS for seed in range(1, arguments.repetitions + 1)]
    totals = {}
    with multiprocessing.Pool(2) as pool:
        for name, counts in pool.imap(repeat, tasks):
            for what, held in counts:
                entry = totals.setdefault((name, what), [0, 0])
                entry[0] += held
                entry[1] += 1
    text = HEADING.format(run_sd=RUN_SD, load_sd=LOAD_SD, repetitions=arguments.repetitions)
    for (name, what), (held, count) in totals.items():
        share = held / count
        error = math.sqrt(share * (1 - share) / count)
        text += (f"| {name} | {NAMES.get(what, what)} | {held} | {count} | "
                 f"{100 * share:.1f} ± {100 * error:.1f} % |\n")
    pathlib.Path(arguments.output).write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
