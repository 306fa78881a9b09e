#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The channels of colour scans against known truth: coverage of the 95 % intervals, place of the flag, p of a constant
profile, verdict of the loop's channel check and the ripple that it needs, and the time that all this takes.

Usage: colour_lines.py PROGRAM [--renders 30] [--seeds 3] [--before PROGRAM]; writes reports/colour_lines.md. --before: a
build without the colour lines, to compare times."""

import argparse
import concurrent.futures
import json
import math
import os
import random
import resource
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
OUT = os.path.join(ROOT, "reports", "colour_lines.md")
APART_PX = 0.1
PLATE = [([3, 3], 1.8), ([8, 3.3], 2), ([3, 8], 2), ([8, 8.4], 1.9), ([13, 5], 2)]


def run(*command, codes=(0,)):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(command)}: {done.stderr}")
    return done


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def draw(program, base, spec):
    with open(base + ".json", "w", encoding="utf-8") as out:
        json.dump({"schema": "foilgauge/render/1", **spec}, out)
    run(program, "render", base + ".json", "-o", base + ".png", "--truth", base + ".truth.json")
    return load(base + ".truth.json")


# ---- how far apart ----


def random_spec(number, seed):
    """A colour scan at random: resolution, rotation, polarity, noise, edges, distances. Every third one lies around where
    the flag begins."""
    r = random.Random(1000 * seed + number)
    dark = r.random() < 0.3
    share = 0.15 if number % 3 == 0 else 1
    distance = lambda most: [share * r.uniform(-most, most), 0, share * r.uniform(-most, most)]
    scanner = {
        "dpi": r.choice([1200, 2400, 2400, 4800]),
        "bits": r.choice([8, 16]),
        "background": 215 if dark else 30,
        "contrast": -170 if dark else 165,
        "noise": r.uniform(0.7, 3),
        "noise_correlation": r.choice([0, 0, 0.5]),
        "blur_px": r.uniform(0.9, 1.6),
        "colour_lines": {"gap_px": [8, 0, -8], "dx_px": distance(0.6), "dy_px": distance(0.6), "magnification_ppm": distance(60)},
    }
    if number % 2:
        scanner["rough"] = {"one_sided_blur_px": 0.6, "motion_blur_px": 0.5, "edge_roughness_um": 2, "edge_common_um": 1,
                            "halo": {"fraction": 0.1, "length_px": 15}}
    return {"seed": 1000 * seed + number, "scanner": scanner, "foils": [{"rotate_deg": r.uniform(-180, 180)}]}


def farthest(report, at, x0_mm, middle_px):
    """Distance from green where it is largest along the foil, which the magnification changes."""
    pixel_mm = 25.4 / report["inputs"][0]["dpi"][0]
    place = report["foils"][0]["place_mm"]
    ends = [1e-6 * at["magnification_ppm"] * (x - x0_mm) / pixel_mm for x in (place[0], place[0] + place[2])]
    return max(math.hypot(middle_px[0] + end, middle_px[1]) for end in ends)


def compare(report, truth):
    """(quantity, error / u, u) of both channels; the true distance, the flag; p of a constant profile."""
    lines, known = report["colour_lines"], truth["colour_lines"]
    pixel_mm = 25.4 / report["inputs"][0]["dpi"][0]
    rows, real = [], {"green": (0, 0)}
    for channel in ("red", "blue"):
        got, at = lines[channel], known[channel]
        dx = at["dx_px"] + 1e-6 * at["magnification_ppm"] * (lines["x0_mm"] - known["middle_x_mm"]) / pixel_mm
        real[channel] = (dx, at["dy_px"])
        for name, value, true, u in (("dx", got["dx_px"], dx, got["u_dx_px"]), ("dy", got["dy_px"], at["dy_px"], got["u_dy_px"]),
                                     ("magnification", got["magnification_ppm"], at["magnification_ppm"], got["u_magnification_ppm"]),
                                     ("skew", got["skew_ppm"], 0, got["u_skew_ppm"])):
            rows.append((name, (value - true) / u, u))
    far = max(math.dist(real["red"], real["blue"]), *(farthest(report, known[c], lines["x0_mm"], real[c]) for c in ("red", "blue")))
    return {"rows": rows, "far_px": far, "apart": lines["apart"], "p": [lines[c]["p_constant"] for c in ("red", "blue")]}


def one_distance(task):
    program, folder, number, seed = task
    base = os.path.join(folder, f"c{seed}_{number}")
    truth = draw(program, base, random_spec(number, seed))
    run(program, "measure", base + ".png", "--channel", "green", "-o", base + ".report.json")
    result = compare(load(base + ".report.json"), truth)
    os.remove(base + ".png")
    return number, result


def distance_table(results):
    lines = []
    for rough, words in ((0, "ideal"), (1, "rough")):
        table = {}
        for number, result in results:
            if number % 2 == rough:
                for name, z, u in result["rows"]:
                    table.setdefault(name, []).append((z, u))
        for name, unit in (("dx", "px"), ("dy", "px"), ("magnification", "ppm"), ("skew", "ppm")):
            values = table[name]
            held = 100 * sum(abs(z) <= 1.96 for z, _ in values) / len(values)
            spread = math.sqrt(sum(z * z for z, _ in values) / len(values))
            median = sorted(u for _, u in values)[len(values) // 2]
            lines.append(f"| {words} | {name}, {unit} | {len(values)} | {median:.2g} | {held:.1f} | {spread:.2f} |")
    return "\n".join(lines)


def flag_words(results):
    wrong = [r for _, r in results if r["apart"] != (r["far_px"] > APART_PX)]
    below = sum(r["far_px"] <= APART_PX for _, r in results)
    near = max((abs(r["far_px"] - APART_PX) for r in wrong), default=0)
    words = f"{below} scans lie below {APART_PX} px, {len(results) - below} above; the flag is wrong on {len(wrong)}"
    return words + (f", none farther than {near:.3f} px from the limit." if wrong else ".")


def constant_words(results):
    p = [value for _, r in results for value in r["p"]]
    share = lambda limit: 100 * sum(v < limit for v in p) / len(p)
    return f"{len(p)} courses that are constant: p < 0.05 in {share(0.05):.1f} %, p < 0.01 in {share(0.01):.1f} %."


# ---- an uneven carriage ----

UNEVEN_UM = (0.01, 0.02, 0.04, 0.08, 0.16)


def one_uneven(task):
    """p of a constant course where a ripple makes that much between neighbouring lines, 8 rows apart."""
    program, folder, rough, between_um, seed = task
    base = os.path.join(folder, f"u{rough}_{between_um}_{seed}")
    amplitude = between_um / (2 * math.sin(math.pi * 8 * 25.4 / 2400 / 2))
    scanner = {"dpi": 2400, "noise": 1.5, "colour_lines": {"gap_px": [8, 0, -8]}}
    if rough:
        scanner["rough"] = {"edge_roughness_um": 2, "edge_common_um": 2, "correlation_um": 60}
    ripple = {"id": "scan.carriage_ripple", "amplitude_um": amplitude, "period_mm": 2, "phase_deg": 61 * seed % 360}
    draw(program, base, {"seed": seed, "scanner": scanner, "effects": [ripple]})
    run(program, "measure", base + ".png", "--channel", "green", "-o", base + ".report.json")
    os.remove(base + ".png")
    lines = load(base + ".report.json")["colour_lines"]
    return task, [lines[c]["p_constant"] for c in ("red", "blue")]


def uneven_rows(results):
    rows = []
    for rough, words in ((0, "ideal"), (1, "rough")):
        cells = []
        for between in UNEVEN_UM:
            p = [v for task, values in results if task[2:4] == (rough, between) for v in values]
            cells.append(f"{100 * sum(v < 0.01 for v in p) / len(p):.0f}")
        rows.append(f"| {words} | {' | '.join(cells)} |")
    return "\n".join(rows)


# ---- the channel check ----


def ripple_spec(part, gap, amplitude, seed):
    r = random.Random(seed)
    spec = {"seed": seed, "scanner": {"dpi": 2400 if part == "foil" else 1200, "colour_lines": {"gap_px": [gap, 0, -gap]}},
            "effects": [{"id": "scan.carriage_ripple", "amplitude_um": amplitude, "period_mm": 2, "phase_deg": r.uniform(0, 360)}]}
    if part == "plate":
        spec.update(margin_px=60, discs=[{"centre_mm": at, "radius_mm": radius} for at, radius in PLATE])
    return spec


def one_witness(task):
    """Verdicts of the channel check on the ripple without and with the gap stated; None: the loop did not claim it."""
    program, folder, part, gap, amplitude, seed, stated = task
    base = os.path.join(folder, f"w{part}_{gap}_{amplitude}_{seed}")
    draw(program, base, ripple_spec(part, gap, amplitude, seed))
    said = []
    for options in ([], ["--colour-gap", str(stated)]):
        form = ["--form", "discs"] if part == "plate" else []
        run(program, "loop", base + ".png", "-o", base + ".loop.json", *form, *options)
        claims = [c for c in load(base + ".loop.json")["claims"] if c["id"] == "scan.carriage_ripple"]
        said.append(max(claims, key=lambda c: c["amplitude"])["witness"] if claims else None)
    os.remove(base + ".png")
    return task, said


def count_words(said):
    claimed = [w["verdict"] for w in said if w]
    return " ".join(f"{claimed.count(v)}" for v in ("for", "against", "cannot_tell")) + f" ({len(said) - len(claimed)})"


def witness_table(results, key):
    groups = {}
    for task, said in results:
        groups.setdefault(key(task), []).append(said)
    return [(k, [count_words([s[i] for s in groups[k]]) for i in (0, 1)], len(groups[k])) for k in sorted(groups)]


def witness_rows(results):
    rows = []
    for (part, gap, amplitude), words, count in witness_table(results, lambda t: (t[2], t[3], t[4])):
        pixel_um = 25400 / (2400 if part == "foil" else 1200)
        between = 2 * amplitude * abs(math.sin(math.pi * gap * pixel_um / 2000))
        rows.append(f"| {part} | {gap} | {amplitude:g} | {between:.2g} | {count} | {words[0]} | {words[1]} |")
    return "\n".join(rows)


# ---- ties ----

TIE_KINDS = {
    "carriage_start": {"id": "scan.carriage_start", "amplitude_um": 12, "length_mm": 4},
    "carriage_quadratic": {"id": "scan.carriage_quadratic", "amplitude_um": 60},
    "scale_y": {"id": "scan.scale_y", "value": 0.002},
    "ovality": {"id": "part.ovality", "amplitude_um": 15, "phase_deg": 20},
}
TIE_GAP = 16


def one_tie(task):
    """(The explanations are tied, the effect that the lines are said to speak for) without and with the gap stated."""
    program, folder, kind, seed = task
    base = os.path.join(folder, f"t{kind}_{seed}")
    rough = {"edge_roughness_um": 2, "edge_common_um": 2, "correlation_um": 60}
    scanner = {"dpi": 2400, "noise": 1.5, "rough": rough, "colour_lines": {"gap_px": [TIE_GAP, 0, -TIE_GAP]}}
    draw(program, base, {"seed": seed, "scanner": scanner, "effects": [TIE_KINDS[kind]]})
    said = []
    for options in ([], ["--colour-gap", str(TIE_GAP)]):
        run(program, "loop", base + ".png", "-o", base + ".loop.json", *options)
        report = load(base + ".loop.json")
        tied = any(c["verdict"] == "tied" for c in report["claims"])
        spoken = [w.split("): ")[1].split(", and not for")[0] for w in report["separating_measurement"] if "speak for" in w]
        said.append((tied, spoken[0] if spoken else None))
    os.remove(base + ".png")
    return task, said


def tie_rows(results):
    rows = []
    for kind, effect in TIE_KINDS.items():
        mine = [said for task, said in results if task[2] == kind]
        cells = []
        for i in (0, 1):
            named = [s[i][1] for s in mine if s[i][0] and s[i][1]]
            right = sum(effect["id"] in name for name in named)
            cells.append(f"{len(named)} | {right}")
        rows.append(f"| {effect['id']} | {len(mine)} | {sum(s[0][0] for s in mine)} | {cells[0]} | {cells[1]} |")
    return "\n".join(rows)


# ---- cost ----


def cost(program, folder, name, path, *options):
    best, memory = math.inf, 0
    for _ in range(3):
        child = subprocess.Popen([program, "measure", path, "-o", os.path.join(folder, "x.json"), *options],
                                 stderr=subprocess.DEVNULL)
        _, _, used = os.wait4(child.pid, 0)
        best = min(best, used.ru_utime + used.ru_stime)
        memory = max(memory, used.ru_maxrss / 1024)
    return f"| {name} | {best:.2f} | {memory:.0f} |"


def cost_rows(program, before, folder):
    base = os.path.join(folder, "cost")
    draw(program, base + "_gray", {"scanner": {}})
    draw(program, base + "_colour", {"scanner": {"colour_lines": {"dx_px": [0.2, 0, -0.2]}}})
    rows = [cost(program, folder, "gray", base + "_gray.png"),
            cost(program, folder, "RGB, channel named", base + "_colour.png", "--channel", "green"),
            cost(program, folder, "RGB, channel sought", base + "_colour.png")]
    if before:
        rows += [cost(before, folder, "gray, build before", base + "_gray.png"),
                 cost(before, folder, "RGB, channel named, build before", base + "_colour.png", "--channel", "green"),
                 cost(before, folder, "RGB, channel sought, build before", base + "_colour.png")]
    return "\n".join(rows)


TEXT = """# The colour lines of a scan

Rendered colour scans whose lines are a known distance apart; `python3 tests/bench/colour_lines.py build/foilgauge` makes this
page ({seeds} seeds, {renders} scans each).

## How far apart

Foils at 1200 to 4800 dpi, any rotation, both polarities, 8 and 16 bit, noise of 0.7 to 3 counts (a third of it correlated), blur
of 0.9 to 1.6 px; half of them with rough edges, one-sided and motion blur and a halo. The channels lie up to 0.85 px apart; every
third scan lies around where the flag begins.

| edges | quantity | values | median u | in the 95 % interval, % | rms error over u |
|---|---|---|---|---|---|
{distances}

{flag}

{constant} The test is the better of two (eight windows along y, and all), and their scatter holds the correlation of
neighbours, so p comes out large rather than small.

An uneven carriage: a ripple of 2 mm period that makes so much (um, amplitude) between two lines, 8 rows apart, in a foil at 2400
dpi with noise of 1.5 counts; share of the courses, %, with p < 0.01 ({unevens} each). Scatter of the edges is the same in all
channels, and hides nothing.

| edges | {uneven_um} |
|---|{uneven_rule}|
{uneven}

## What the loop's witness says

A ripple of 2 mm period in all lines, seen by red and blue `gap` rows ahead of and behind green: what it makes between two
neighbouring lines is 2 a sin(pi gap / p). The counts are the verdicts `for`, `against`, `cannot_tell` beside the loop's claim, in
brackets the scans on which the loop claims no ripple.

| part | gap, rows | a, um | between lines, um | scans | gap not stated | gap stated |
|---|---|---|---|---|---|---|
{witness}

With gap 0 no line sees the carriage at another moment: there nothing may speak `for` (any such is wrong), and with a stated gap of
8 rows the lines speak `against`. Elsewhere `against` is wrong.

Foils with rough edges at 2400 dpi and one smooth effect, lines {tie_gap} rows apart: where the loop leaves a tie, how often the lines are
said to speak for the carriage, and how often an explanation that is named with it holds the effect that was drawn (the loop's class need
not hold it as an explanation of its own). A scale makes nothing between the lines, and a part's effect neither: of them nothing may be
said.

| drawn | scans | tied | said, gap not stated | holds it | said, gap stated | holds it |
|---|---|---|---|---|---|---|
{ties}

## What it costs

A foil at 4800 dpi (18 Mpx), processor time of user and system, the best of three, on all threads; MiB at the most.

| scan | s | MiB |
|---|---|---|
{cost}
"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--renders", type=int, default=30)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--witnesses", type=int, default=6)
    parser.add_argument("--ties", type=int, default=4)
    parser.add_argument("--before")
    parser.add_argument("--out", default=OUT)
    a = parser.parse_args()
    program = os.path.realpath(a.program)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        distances = list(pool.map(one_distance, [(program, folder, n, s) for s in range(1, a.seeds + 1) for n in range(a.renders)]))
        uneven = list(pool.map(one_uneven, [(program, folder, rough, between, seed) for rough in (0, 1) for between in UNEVEN_UM
                                            for seed in range(1, a.witnesses + 1)]))
        tasks = [(program, folder, "plate", gap, amplitude, seed, gap or 8) for gap in (0, 4, 8, 16)
                 for amplitude in ((6,) if gap == 0 else (0.5, 1, 2, 6)) for seed in range(1, a.witnesses * (3 if gap == 0 else 1) + 1)]
        tasks += [(program, folder, "foil", gap, amplitude, seed, gap or 8) for gap, amplitude in ((0, 3), (8, 0.3), (8, 1), (8, 3))
                  for seed in range(1, a.witnesses // 2 + 1)]
        witnesses = list(pool.map(one_witness, tasks))
        ties = list(pool.map(one_tie, [(program, folder, kind, seed) for kind in TIE_KINDS for seed in range(1, a.ties + 1)]))
        costs = cost_rows(program, a.before and os.path.realpath(a.before), folder)
    page = TEXT.format(uneven=uneven_rows(uneven), unevens=2 * a.witnesses, uneven_um=" | ".join(f"{v:g}" for v in UNEVEN_UM),
                       uneven_rule="|".join("---" for _ in UNEVEN_UM), seeds=a.seeds, renders=a.renders, distances=distance_table(distances), flag=flag_words(distances),
                       constant=constant_words(distances), witness=witness_rows(witnesses), ties=tie_rows(ties), tie_gap=TIE_GAP, cost=costs)
    with open(a.out, "w", encoding="utf-8") as out:
        out.write(page)


if __name__ == "__main__":
    main()
