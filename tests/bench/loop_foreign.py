#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop on scans of another rasteriser (loop_foreign_scans.py), with causes that its list does not name.

/usr/bin/python3 tests/bench/loop_foreign.py build/foilgauge [--cases 60] [--seed 1] [--threads 1] [--fresh]
    [--keep DIR] [--csv reports/loop_foreign.csv] [--out reports/loop_foreign.md]
--check measures clean ideal scans instead, and compares them with the rasteriser's own truth.
"""

import argparse
import json
import os
import shutil
import subprocess
import tempfile

import numpy as np

import loop_foreign_scans as scans
from kept_rows import append_row, forget_seeds, read_rows
from loop_run import run_timed

FACTORS = [1.5, 3.0, 10.0]
# Listed effects that name a cause rightly when they are found, fixed before the first run; every other name is wrong.
ALLOWED = {"flat_spots": {"part.dent"}}
# The arc length and the angle of bumps scatter about the declared springback, so this is true of every foil here.
ALLOWED_ALWAYS = {"part.stretch"}
COMBINATIONS = [(f, edge, count) for f in FACTORS for edge in ("ideal", "rough") for count in (1, 2)]
FIELDS = (
    "case seed cause side factor size_um capped edge scans turn_deg verdict found tied alias unattributed outcome "
    "R0_before R0_after u_R0_before R_before R_after u_R_before h_before h_after u_h_before "
    "worse_R0 worse_R worse_h twice_R0 twice_R twice_h inside_R0 inside_R inside_h values_R0 values_R values_h seconds"
).split()


def plan(seed, index):
    """Every tenth input is clean; the causes take turns, each through its combinations in an order of its own."""
    if index % 10 == 9:
        return "clean", "clean", 0.0, ("ideal", "rough")[index // 10 % 2], 1 + index // 20 % 2
    kinds = [*scans.SCANNER, *scans.PART]
    turn, kind = divmod(index - index // 10, len(kinds))
    order = np.random.default_rng([seed, 77, kind]).permutation(len(COMBINATIONS))
    factor, edge, count = COMBINATIONS[order[turn % len(COMBINATIONS)]]
    return kinds[kind], "scanner" if kinds[kind] in scans.SCANNER else "part", factor, edge, count


def draw_input(seed, index, folder):
    cause, side, factor, edge, count = plan(seed, index)
    rng = np.random.default_rng([seed, index])
    foil = scans.draw_foil(rng)
    line, model = scans.midline(foil), scans.edge_model(rng, edge)
    field = scans.SCANNER[cause](rng) if side == "scanner" else None
    move = scans.PART[cause](rng) if side == "part" else None
    mirror, first, turn = bool(rng.integers(0, 2)), rng.uniform(0, 2 * np.pi), rng.choice([45, 90]) + rng.uniform(-8, 8)
    turns = [first, first + np.radians(turn)][:count]
    poses = [scans.draw_pose(rng, line, t, mirror, 44.0 if count == 2 else 0.0) for t in turns]
    wanted = factor * 5 * scans.oracle_error(model, line, poses, field, move) if factor else 0.0
    size = min(wanted, scans.CAP_UM)
    points = line["points"] + (1e-3 * size * move(line) if move else 0.0)
    rough = [scans.roughness(rng, model, len(points)) for _ in range(2)]
    paths = []
    for number, pose in enumerate(poses):
        gray = scans.draw_scan(rng, model, line, points, rough, pose, field, 1e-3 * size)
        paths.append(os.path.join(folder, f"case_{index:03d}_{'ab'[number]}.png"))
        scans.write_scan(paths[-1], gray)
    row = {"case": index, "seed": seed, "cause": cause, "side": side, "factor": factor, "size_um": round(size, 3),
           "capped": int(wanted > size), "edge": edge, "scans": count, "turn_deg": round(turn) if count == 2 else ""}  # fmt: skip
    return row, paths, scans.measurand(line, points)


def run_loop(program, paths, threads, dpi=scans.DPI, more=()):
    out = os.path.join(os.path.dirname(paths[0]), "loop.json")
    pair = ["--same-foil"] if len(paths) > 1 else []
    code, seconds = run_timed([program, "loop", *pair, *paths, "--dpi", str(dpi), "--threads", str(threads), *more, "-o", out])
    if code:
        return None, f"exit code {code}", seconds
    with open(out, encoding="utf-8") as file:
        return json.load(file), "", seconds


def deviations(foils, truth):
    """Errors and standard uncertainties in um of R0, R and h over the foils of one side; None: a bump is missing."""
    overall, radius, height = truth
    errors, sizes = {"R0": [], "R": [], "h": []}, {"R0": [], "R": [], "h": []}
    for foil in foils:
        bumps = foil["bumps"]
        if len(bumps) != len(radius) or any(b["radius_mm"] is None for b in bumps):
            return None
        errors["R0"].append(foil["overall"]["radius_mm"] - overall)
        sizes["R0"].append(foil["overall"]["u_radius_mm"])
        for bump, r, h in zip(bumps, radius, height):
            for name, member, true in (("R", "radius_mm", r), ("h", "height_mm", h)):
                errors[name].append(bump[member] - true)
                sizes[name].append(bump["u_" + member])
    return {name: (1e3 * np.array(errors[name]), 1e3 * np.array(sizes[name])) for name in errors}


def outcome(allowed_names, claims, unattributed):
    """allowed_names: of the cause. wrong, right, unattributed, honest tie (one with an unnamed explanation in it), listed tie, or clean."""
    allowed = allowed_names | ALLOWED_ALWAYS
    found = [c["id"] for c in claims if c["verdict"] == "found"]
    tied = [c for c in claims if c["verdict"] == "tied" and c["id"] not in ALLOWED_ALWAYS]
    if any(name not in allowed for name in found):
        return "wrong"
    if any(name in allowed_names for name in found):
        return "right"
    if unattributed:
        return "unattributed"
    if tied:
        free = ("free.", "scan.x", "scan.y", "foil.s", "bump.phi", "bump.index", "edge.normal")
        open_tie = all(any(f in name for name in c["alias_class"] for f in free) for c in tied)
        return "honest tie" if open_tie else "listed tie"
    return "clean"


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def judge(row, report, truth, allowed=ALLOWED):
    """allowed: names by cause."""
    claims, curve = report["claims"], report["unattributed"]
    row["verdict"] = report["verdict"]
    for verdict in ("found", "tied"):
        row[verdict] = "; ".join(c["id"] for c in claims if c["verdict"] == verdict)
    row["alias"] = "; ".join(name for c in claims if c["verdict"] == "tied" for name in c["alias_class"])[:300]
    row["unattributed"] = f"{curve['coordinate']} {curve.get('moves', '')}" if curve else ""
    row["outcome"] = outcome(allowed.get(row["cause"], set()), claims, curve)
    before, after = (deviations(report[side]["foils"], truth) for side in ("before", "after"))
    if before is None or after is None:
        row["verdict"] += ", a bump is missing"
        return
    for name in ("R0", "R", "h"):
        (error, u), (left, u_left) = before[name], after[name]
        worse = rms(left) > rms(error) + 2 * rms(u)
        row[f"{name}_before"], row[f"{name}_after"] = f"{rms(error):.4f}", f"{rms(left):.4f}"
        row[f"u_{name}_before"] = f"{rms(u):.4f}"
        row[f"worse_{name}"] = int(worse)
        row[f"twice_{name}"] = int(worse and rms(left) > 2 * rms(error))
        row[f"inside_{name}"], row[f"values_{name}"] = int(np.sum(np.abs(left) <= 2 * u_left)), len(left)


def run_case(options, index):
    folder = tempfile.mkdtemp()
    try:
        row, paths, truth = draw_input(options.seed, index, folder)
        report, error, seconds = run_loop(options.program, paths, options.threads)
        row["seconds"] = f"{seconds:.2f}"
        if report:
            judge(row, report, truth)
        else:
            row["outcome"], row["verdict"] = "error", error
        bad = row["outcome"] in ("wrong", "error", "listed tie") or any(row.get(f"worse_{n}") for n in ("R0", "R", "h"))
        if options.keep and bad:
            os.makedirs(options.keep, exist_ok=True)
            for path in paths:
                shutil.copy(path, options.keep)
        return row
    finally:
        shutil.rmtree(folder)


# ---- the page


def is_worse(row, noise, times=1):
    """Beyond the noise of clean inputs with such edges: u_ of `before` holds what the loop could not explain as well."""
    for name in ("R0", "R", "h"):
        before, after = float(row[f"{name}_before"]), float(row[f"{name}_after"])
        if after > before + 2 * noise[row["edge"], name] and after > times * before:
            return True
    return False


def clean_noise(rows):
    """Medians over clean inputs of the standard uncertainties, by edge and quantity; without clean inputs 0."""
    noise = {}
    for edge in ("ideal", "rough"):
        for name in ("R0", "R", "h"):
            sizes = [float(r[f"u_{name}_before"]) for r in rows if (r["cause"], r["edge"]) == ("clean", edge) and r["outcome"] != "error"]
            noise[edge, name] = np.median(sizes) if sizes else 0.0
    return noise


def group_row(name, rows, noise):
    done = [r for r in rows if r["R0_before"]]
    count = {o: sum(r["outcome"] == o for r in rows) for o in
             ("wrong", "right", "unattributed", "honest tie", "listed tie", "clean", "error")}  # fmt: skip

    def inside(quantity):
        values = sum(int(r[f"values_{quantity}"]) for r in done)
        return f"{100 * sum(int(r[f'inside_{quantity}']) for r in done) / values:.0f}" if values else "-"

    def median(column):
        return f"{np.median([float(r[column]) for r in done]):.2f}" if done else "-"

    cells = [name, len(rows), *count.values(), sum(is_worse(r, noise) for r in done), sum(is_worse(r, noise, 2) for r in done)]
    cells += [f"{median(q + '_before')} → {median(q + '_after')}" for q in ("R0", "R", "h")]
    cells += [" / ".join(inside(q) for q in ("R0", "R", "h")), median("seconds")]
    return "| " + " | ".join(map(str, cells)) + " |"


HOW_JUDGED = (
    "The truth is the measurand: least-squares circles through the part with its form, without its roughness. Errors are"
    " medians of the inputs' rms.\nWorse: beyond the error before by more than 2 u of clean inputs. An honest tie holds an"
    " unnamed explanation. s: seconds of the processor,\nwhile other work ran beside.\n"
)
LABELS = {False: " × oracle", True: ""}
HEAD = (
    "| | inputs | wrong `found` | right | unattributed | honest tie | tie of listed ones | clean | errors | worse | "
    "more than twice | R0, um | R, um | h, um | inside 95 % R0 / R / h | s |\n|" + "---|" * 16
)


def write_page(path, rows, head, last=()):
    """head, last: lines before and after the tables."""
    unlisted = [r for r in rows if r["cause"] != "clean"]
    groups = [("all causes", unlisted), ("clean inputs", [r for r in rows if r["cause"] == "clean"])]
    labels = {"cause": "", "factor": LABELS[rows[0]["factor"].endswith("um")], "edge": " edges", "scans": " scan(s)", "side": ""}
    for column, label in labels.items():
        for value in sorted({r[column] for r in unlisted}, key=lambda v: (len(v) if column == "factor" else 0, v)):
            groups.append((f"{value}{label}", [r for r in unlisted if r[column] == value]))
    lines = [
        *head,
        HEAD,
        *[group_row(name, members, clean_noise(rows)) for name, members in groups],
        "\n## Wrong `found`\n",
        "| case | truth | size, um | edges | scans | found | R0, um | R, um | h, um |\n|" + "---|" * 9,
    ]
    for r in (r for r in rows if r["outcome"] == "wrong"):
        moved = [f"{r[q + '_before']} → {r[q + '_after']}" for q in ("R0", "R", "h")]
        cells = [r["case"], r["cause"], r["size_um"], r["edge"], r["scans"], r["found"], *moved]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join([*lines, *last]) + "\n")


def page_head(options, count):
    return [
        "# The loop on causes that nobody has named, drawn by another rasteriser\n",
        "Ten causes that the list of effects does not have, on foils of uneven pitch whose R scatters by 0.5 to 2 %, at"
        f" {scans.DPI} dpi. An oracle knows the\ncause's shape and the noise; a cause is 1.5, 3 or 10 times the oracle's"
        f" 5 standard errors, {scans.CAP_UM:g} um at most. Every tenth input is clean.\nThe second scan of a pair is"
        " turned by about 45 or 90 degrees. A bump with a flat spot may be called `part.dent`; every other name is wrong.\n"
        "An input whose cause met the cap (`capped` in the CSV) shows less than its factor says.\n" + HOW_JUDGED,
        f"    /usr/bin/python3 tests/bench/loop_foreign.py build/foilgauge --cases {count} --seed {options.seed}\n",
    ]


def check_rasteriser(options):
    """Clean ideal scans: what `measure` says against the rasteriser's truth, in standard uncertainties."""
    ratios = {"R0": [], "R": [], "h": []}
    for index in range(options.cases):
        rng = np.random.default_rng([options.seed, index, 5])
        line, model = scans.midline(scans.draw_foil(rng)), scans.edge_model(rng, "ideal")
        pose = scans.draw_pose(rng, line, rng.uniform(0, 2 * np.pi), bool(index % 2), 0.0)
        smooth = [np.zeros(len(line["points"]))] * 2
        with tempfile.TemporaryDirectory() as folder:
            picture, out = os.path.join(folder, "scan.png"), os.path.join(folder, "scan.json")
            scans.write_scan(picture, scans.draw_scan(rng, model, line, line["points"], smooth, pose, None, 0.0))
            subprocess.run([options.program, "measure", picture, "--dpi", str(scans.DPI), "-o", out], check=False)
            with open(out, encoding="utf-8") as file:
                found = deviations(json.load(file)["foils"][:1], scans.measurand(line, line["points"]))
        if found is None:
            print(f"scan {index}: a bump is missing")
            continue
        for name, (error, u) in found.items():
            ratios[name] += list(error / u)
    for name, values in ratios.items():
        print(f"{name}: {len(values)} values, rms of error / u {rms(values):.2f}, mean {np.mean(values):+.2f}, "
              f"within 2 u {100 * np.mean(np.abs(values) <= 2):.0f} %")  # fmt: skip


def rows_of(options):
    return [r for r in read_rows(options.csv) if int(r["seed"]) == options.seed]


def work_on_all(options, work, fields=FIELDS):
    """Inputs that the CSV holds are not run again; --fresh forgets those of this seed."""
    if options.fresh:
        forget_seeds(options.csv, [options.seed])
    done = {int(r["case"]) for r in rows_of(options)}
    for index in [i for i in range(options.cases) if i not in done]:
        row = work(index)
        append_row(options.csv, row, fields)
        told = [row.get(name) for name in ("cause", "size_um", "edge", "scans", "outcome", "found")]
        print(index, *told, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--csv", default="reports/loop_foreign.csv")
    parser.add_argument("--out", default="reports/loop_foreign.md")
    parser.add_argument("--keep", help="folder for the pictures of wrong and worse inputs")
    parser.add_argument("--fresh", action="store_true", help="forget the inputs of this seed that the CSV has")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if options.check:
        check_rasteriser(options)
        return
    work_on_all(options, lambda index: run_case(options, index))
    rows = rows_of(options)
    write_page(options.out, rows, page_head(options, len(rows)))


if __name__ == "__main__":
    main()
