#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Split plots with missing runs: the program beside lme4, nlme and pbkrtest of R.

    split_plots_r.py PROGRAM [COUNT] [--keep FOLDER]

Random split plots with runs missing; every number of `doe --whole-plot` against R's (Debian: r-cran-lme4,
r-cran-nlme, r-cran-pbkrtest). Exit 77 where R is missing. --keep writes the plans with R's answers (tests/data/split_plot)."""

import csv
import json
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MODELS = ["T*D", "T*(D+P)", "T + D + P", "T*D + group"]
TOLERANCE = {"estimate": 1e-5, "standard_error": 2e-4, "freedom": 2e-3, "plot_variance": 2e-3, "run_variance": 5e-4,
             "nlme_plot_sd": 2e-3, "term_f": 1e-3, "term_freedom": 5e-3, "term_p": 2e-3}


def plan(rng, plots, per_plot, missing, plot_sd):
    rows = []
    for load in range(plots):
        shift = rng.gauss(0, plot_sd)
        for run in range(per_plot):
            t, d, p = (-1, 1)[load % 2], (-1, 1)[run % 2], (-1, 1)[run // 2 % 2]
            word = "abc"[(load + run) % 3]
            y = 20 + 3 * t + 2 * d - p + t * d + shift + rng.gauss(0, 1)
            rows.append([t, d, p, word, f"L{load + 1}", f"{y:.5f}"])
    for _ in range(missing):
        rows.pop(rng.randrange(len(rows)))
    return rows


def write_plans(folder, count, seed):
    rng = random.Random(seed)
    plans = []
    for i in range(count):
        name = f"plan_{i + 1}.csv"
        rows = plan(rng, rng.choice([6, 8, 10]), 4, rng.randint(1, 8), rng.choice([0.0, 0.5, 1.0, 3.0]))
        with open(folder / name, "w", newline="") as out:
            csv.writer(out, lineterminator="\n").writerows([["T", "D", "P", "group", "load", "y"]] + rows)
        plans.append((name, MODELS[i % len(MODELS)]))
    (folder / "plans.txt").write_text("".join(f"{n}\t{m}\n" for n, m in plans))
    return plans


def r_name(name):
    return {"(constant)": "(Intercept)"}.get(name, name.replace("[", "").replace("]", ""))


def ours(program, folder, name, model):
    made = subprocess.run([program, "doe", str(folder / name), "--response", "y", "--model", model, "--whole-plot", "load",
                           "-o", "-"], capture_output=True, text=True)
    if made.returncode:
        sys.exit(f"{name}: {made.stderr}")
    report = json.loads(made.stdout)
    split = report["split_plot"]
    values = {("plot_variance", ""): split["whole_plot_variance"], ("run_variance", ""): split["run_variance"],
              ("nlme_plot_sd", ""): split["whole_plot_variance"] ** 0.5}
    for c in report["coefficients"]:
        for what in "estimate", "standard_error", "freedom":
            values[what, r_name(c["name"])] = c[what]
    for t in split["terms"]:
        values["term_f", t["term"]] = t["f"]
        values["term_freedom", t["term"]] = t["error_freedom"]
        values["term_p", t["term"]] = t["p_value"]
    return values


def main():
    words = sys.argv[1:]
    keep = Path(words.pop(words.index("--keep") + 1)) if "--keep" in words else None
    words = [w for w in words if w != "--keep"]
    program, count = words[0], int(words[1]) if len(words) > 1 else 100
    if not shutil.which("Rscript"):
        print("skipped: R is not installed", file=sys.stderr)
        sys.exit(77)
    with tempfile.TemporaryDirectory() as place:
        folder = keep or Path(place)
        folder.mkdir(parents=True, exist_ok=True)
        plans = write_plans(folder, count, 8)
        subprocess.run(["Rscript", "--vanilla", str(Path(__file__).with_suffix("").with_name("split_plots.R")), str(folder)],
                       check=True)
        sys.exit(compare(program, folder, plans))


def compare(program, folder, plans):
    reference, worst, failed, border = {}, {}, 0, 0
    for row in csv.DictReader(open(folder / "reference.csv")):
        reference.setdefault(row["plan"], []).append(row)
    for name, model in plans:
        values = ours(program, folder, name, model)
        variance = values["plot_variance", ""]
        border += variance == 0
        for row in reference.get(name, []):
            what, theirs, own = row["what"], float(row["value"]), values[row["what"], row["name"]]
            if what == "nlme_plot_sd" and variance < 1e-3 * values["run_variance", ""]:
                continue  # nlme leaves a trace of a variance of 0
            scale = max(abs(theirs), 1e-3 if what != "plot_variance" else values["run_variance", ""])
            error = abs(own - theirs) / scale
            worst[what] = max(worst.get(what, 0), error)
            if error > TOLERANCE[what]:
                failed += 1
                print(f"{name} ({model}): {what} {row['name']}: {own!r}, R {theirs!r}")
    print(f"{len(plans)} plans, {border} of them with a whole-plot variance of 0 (beside gls with a negative correlation); largest relative differences:")
    for what, error in sorted(worst.items()):
        print(f"  {what:16} {error:.1e}")
    return 1 if failed else 0


main()
