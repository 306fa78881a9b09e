# SPDX-License-Identifier: GPL-3.0-or-later
"""loop_levels.py PROGRAM [--tables N] [--clean N] [--nested N] [--out FOLDER]

Random levels in the loop on tables: tables of casks with unequal numbers of samples, out of order, of which each cask
has one heat, which is declared. The findings beside lme of R's nlme (loop_levels.R; needs Rscript), the coverage of
the slope's interval, and claims where the casks are alike; the same of casks in batches, each with a variance, also with
the casks declared as groups. Writes loop_levels.md.
"""

import argparse
import csv
import json
import os
import random
import subprocess
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
CASKS, SLOPE = 14, 0.3
T_975 = 2.179  # of Student's t with 12 dof: casks less a constant and a slope


def write_table(path, level_sd, seed):
    draw = random.Random(f"{level_sd} {seed}")
    heat = [draw.uniform(0, 10) for _ in range(CASKS)]
    level = [draw.gauss(0, level_sd) for _ in range(CASKS)]
    rows = [c for c in range(CASKS) for _ in range(draw.randint(2, 7))]
    draw.shuffle(rows)
    humidity = [round(draw.uniform(20, 60), 1) for _ in rows]
    with open(path, "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["cask", "supplier", "heat", "humidity", "y"])
        for c, h in zip(rows, humidity):
            y = 5 + SLOPE * heat[c] + level[c] + draw.gauss(0, 1)
            out.writerow([f"C{c + 1:02}", f"S{c % 3 + 1}", repr(heat[c]), h, repr(y)])


def ask(program, path, group=False):
    command = [program, "loop", "--table", path, "--response", "y", "--model", "1 + heat", "-o", "-"]
    command += ["--group", "cask"] if group else []
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout)


def found_of(report):
    """The claim, sd of the levels, the slope and its u; None where it is not claimed."""
    for claim in report["claims"]:
        if claim["name"] == "table.random_levels(cask)":
            slope = next(p for p in report["declared_parameters"] if p["name"] == "heat")
            alone = len(report["claims"]) == 1 and not report["unattributed"]
            return claim["parameters"]["level_sd"], claim["amplitude_interval_95"], slope["value"], slope["u_value"], alone
    return None


def by_lme(folder):
    subprocess.run(["Rscript", os.path.join(HERE, "loop_levels.R"), folder], check=True)
    with open(os.path.join(folder, "lme.txt"), encoding="utf-8") as file:
        return {line.split()[0]: [float(v) for v in line.split()[1:]] for line in file}


def of_size(program, level_sd, tables):
    found, apart_sd, apart_u, slopes, levels, by_rows = 0, [], [], 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(tables):
            write_table(os.path.join(folder, f"{seed:04}.csv"), level_sd, seed)
        lme = by_lme(folder)
        for name in sorted(lme):
            path = os.path.join(folder, name)
            one = found_of(ask(program, path))
            if not one:
                continue
            sd, interval, slope, u, alone = one
            found += 1
            slopes += abs(slope - SLOPE) <= T_975 * u
            levels += interval[0] <= level_sd <= interval[1]
            if alone:  # another effect beside it is another model
                apart_sd.append(abs(sd / lme[name][0] - 1))
                apart_u.append(abs(u / lme[name][3] - 1))
    worst = lambda values: f"{100 * max(values):.2f} %" if values else "–"
    return [f"{level_sd:g}", tables, found, worst(apart_sd), worst(apart_u), f"{slopes}/{found}", f"{levels}/{found}"]


def clean(program, tables):
    claimed = suspected = 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(tables):
            path = os.path.join(folder, "clean.csv")
            write_table(path, 0, seed)
            report = ask(program, path)
            claimed += any("random_levels" in c["name"] for c in report["claims"])
            suspected += any("random_levels" in s["name"] for s in report["suspects"])
    return claimed, suspected


# ---- casks in batches ----

BATCHES = 12
T_NESTED = 2.228  # with 10 dof: batches less a constant and a slope


def write_nested(path, batch_sd, cask_sd, seed):
    """Two to four samples of three to five casks of each batch; a batch has one heat."""
    draw, rows = random.Random(f"{batch_sd} {cask_sd} {seed}"), []
    for b in range(BATCHES):
        heat, of_batch = draw.uniform(0, 10), draw.gauss(0, batch_sd)
        for c in range(draw.randint(3, 5)):
            of_cask = draw.gauss(0, cask_sd)
            for _ in range(draw.randint(2, 4)):
                y = 5 + SLOPE * heat + of_batch + of_cask + draw.gauss(0, 1)
                rows.append([f"B{b + 1:02}", f"B{b + 1:02}C{c + 1}", repr(heat), round(draw.uniform(20, 60), 1), repr(y)])
    draw.shuffle(rows)
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["batch", "cask", "heat", "humidity", "y"], *rows])


def strata_of(report):
    """sd of the claimed levels by column; the slope and its u; whether nothing else was claimed."""
    sd = {c["coordinates"][0]: c["parameters"]["level_sd"] for c in report["claims"] if c["id"] == "table.random_levels"}
    slope = next(p for p in report["declared_parameters"] if p["name"] == "heat")
    return sd, slope["value"], slope["u_value"], len(report["claims"]) == len(sd) and not report["unattributed"]


def nested(program, batch_sd, cask_sd, tables, group):
    wanted = {"batch"} if group else {"batch", "cask"}
    both = batches = casks = slopes = 0
    apart_sd, apart_u = [], []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(tables):
            write_nested(os.path.join(folder, f"{seed:04}.csv"), batch_sd, cask_sd, seed)
        lme = by_lme(folder)
        for name in sorted(lme):
            sd, slope, u, alone = strata_of(ask(program, os.path.join(folder, name), group))
            batches, casks = batches + ("batch" in sd), casks + ("cask" in sd)
            if set(sd) != wanted:
                continue
            both += 1
            slopes += abs(slope - SLOPE) <= T_NESTED * u
            if alone:
                theirs = dict(zip(("batch", "cask"), lme[name]))
                apart_sd += [abs(sd[c] / theirs[c] - 1) for c in sd]
                apart_u.append(abs(u / lme[name][4] - 1))
    worst = lambda values: f"{100 * max(values):.2f} %" if values else "–"
    return [f"{batch_sd:g}", f"{cask_sd:g}", "`--group cask`" if group else "–", tables, batches, "declared" if group else casks,
            worst(apart_sd), worst(apart_u), f"{slopes}/{both}"]


def nested_lines(program, tables):
    lines = ["## Casks in batches", "",
             f"{BATCHES} batches of 3 to 5 casks of 2 to 4 samples, sd 1 within a cask; each batch has one heat, whose slope is declared. "
             "Beside it lme with `random = ~ 1 | batch / cask`, where both variances are claimed (the casks: or declared) and nothing else.", "",
             "| sd between batches | sd between casks | option | tables | batch found | cask found | sd beside lme's, at most apart "
             "| u of the slope beside lme's, at most apart | slope in its 95 % interval |", "|---|---|---|---|---|---|---|---|---|"]
    for batch_sd, cask_sd in ((2, 1), (1.5, 0), (0, 1.5), (0, 0)):
        lines.append("| " + " | ".join(map(str, nested(program, batch_sd, cask_sd, tables, False))) + " |")
    for batch_sd in (2, 0):
        lines.append("| " + " | ".join(map(str, nested(program, batch_sd, 1, tables, True))) + " |")
    return lines + [""]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--tables", type=int, default=40)
    parser.add_argument("--clean", type=int, default=100)
    parser.add_argument("--nested", type=int, default=16, help="tables of casks in batches, of each size")
    parser.add_argument("--out", default="reports")
    args = parser.parse_args()
    lines = ["# Random levels in the loop on tables", "",
             f"{CASKS} casks of 2 to 7 samples out of order, sd 1 within a cask; each cask has one heat, whose slope is declared. Beside it "
             "lme of R's nlme with the same model. Differences in tables where nothing else was found; coverage in all where the casks were.",
             "", f"    python3 tests/bench/loop_levels.py build/foilgauge --tables {args.tables} --clean {args.clean} --nested {args.nested}", "",
             "| sd between casks | tables | found | sd beside lme's, at most apart | u of the slope beside lme's, at most apart "
             "| slope in its 95 % interval | sd in its 95 % interval |", "|---|---|---|---|---|---|---|"]
    for level_sd in (0.7, 1.5, 4.0):
        lines.append("| " + " | ".join(map(str, of_size(args.program, level_sd, args.tables))) + " |")
    claimed, suspected = clean(args.program, args.clean)
    lines += ["", f"Casks that are alike: {claimed} of {args.clean} claimed, {suspected} suspected.", ""]
    lines += nested_lines(args.program, args.nested)
    with open(os.path.join(args.out, "loop_levels.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
