#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""reports/loop_speed.md: how long the loop takes, beside the goals: on an ideal scan, on a rough one, on two scans of one foil, on a long
table and on a wide one. All inputs are drawn here, with seeds.

Usage: tests/bench/loop_speed.py [--rounds N] [-o FOLDER]
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

import benchlib
import numpy as np

SEED = 1
BUMPS, BUMP_RADIUS_MM, SPRINGBACK, SPRINGBACK_SD = 9, 3.32, 0.02, 0.007
TURN_DEG = 92
NOISE = 0.2  # of a table's response


def sample(name):
    return benchlib.load(os.path.join(benchlib.ROOT, "samples", "render", f"{name}.json"))


def draw_scan(folder, name, spec):
    """A rendered scan; returns its path."""
    scan, text = os.path.join(folder, f"{name}.png"), os.path.join(folder, f"{name}.json")
    with open(text, "w", encoding="utf-8") as file:
        json.dump(spec, file)
    subprocess.run([benchlib.FOILGAUGE, "render", text, "-o", scan], check=True)
    return scan


def single(folder, name):
    return ["loop", draw_scan(folder, name, {**sample(name), "seed": SEED})]


def pair(folder):
    """Two scans of one rough foil, turned in between, with a ripple of the carriage."""
    rng, spec = np.random.default_rng(SEED), sample("rough")
    foil = {**spec["foils"][0], "radius_mm": list(BUMP_RADIUS_MM * (1 + SPRINGBACK + SPRINGBACK_SD * rng.standard_normal(BUMPS)))}
    del foil["radius_springback"]
    scans = []
    for k in range(2):
        foil_here = {**foil, "rotate_deg": foil["rotate_deg"] + TURN_DEG * k}
        scans.append(draw_scan(folder, f"pair_{k}", {**spec, "seed": SEED + k, "foils": [foil_here], "effects": sample("ripple")["effects"]}))
    return ["loop", "--same-foil", *scans]


def table(folder, rows, columns):
    """Columns of random numbers; the response follows the first, as declared, and the third and a drift, which are not."""
    rng = np.random.default_rng([SEED, rows, columns])
    x = rng.standard_normal((rows, columns))
    y = 10 + 0.5 * x[:, 0] + 0.6 * x[:, 2] + 0.6 * np.arange(rows) / rows + NOISE * rng.standard_normal(rows)
    path = os.path.join(folder, f"table_{rows}x{columns}.csv")
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(f"c{k + 1}" for k in range(columns)) + ",y\n")
        for row, response in zip(x, y):
            file.write(",".join(f"{value:.6g}" for value in row) + f",{response:.6g}\n")
    return ["loop", "--table", path, "--response", "y", "--model", "c1"]


# Words, the command's arguments from a folder, goal in s.
CASES = [
    ("ideal scan", lambda folder: single(folder, "clean"), 1.5),
    ("rough scan", lambda folder: single(folder, "rough"), 1.5),
    ("two rough scans of one foil", pair, 4.0),
    ("table of 388 rows, 4 columns", lambda folder: table(folder, 388, 4), 3.0),
    ("table of 40 rows, 53 columns", lambda folder: table(folder, 40, 53), 8.5),
]


def run(arguments, folder):
    """Wall and processor seconds, MiB, and the verdict."""
    report = os.path.join(folder, "report.json")
    start = time.monotonic()
    with subprocess.Popen([benchlib.FOILGAUGE, *arguments, "-o", report], stderr=subprocess.DEVNULL) as process:
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 3):  # 3: something is suspected
        sys.exit(f"loop_speed.py: exit code {process.returncode} of {' '.join(arguments)}")
    return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, benchlib.load(report)["verdict"]


def measure(words, arguments, goal, rounds, folder):
    """A row of the page; the first run, which fills caches, does not count."""
    runs = [run(arguments, folder) for _ in range(rounds + 1)][1:]
    walls, seconds, mebibytes, verdicts = zip(*runs)
    row = [words, f"{statistics.median(walls):.2f}", f"{max(walls):.2f}", f"≤ {goal:g}", f"{statistics.median(seconds):.2f}",
           f"{max(mebibytes):.0f}", verdicts[0]]
    print(" | ".join(row), flush=True)
    return row


def write_page(path, rows, rounds, load):
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"""# Speed of the loop

Made by `tests/bench/loop_speed.py` with {benchlib.program_version()} on {benchlib.machine()}. {load}

Each loop runs once unseen and {rounds} times more. Wall time holds everything, from the file to the report (JSON); processor seconds are
those of all threads together. The scans are renders of `samples/render/` (nine bumps, 4800 dpi), the two of one foil turned by
{TURN_DEG}° in between and with the ripple of `ripple.json`. In the tables two columns and the order move the response; the model declares one of the columns.

""")
        file.write(benchlib.table(["input", "median, s", "longest, s", "goal, s", "processor, s", "peak memory, MiB", "verdict"], rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("-o", "--out", default=os.path.join(benchlib.ROOT, "reports"))
    options = parser.parse_args()
    rows, load = [], benchlib.MachineLoad()
    with tempfile.TemporaryDirectory() as folder:
        for words, prepare, goal in CASES:
            rows.append(measure(words, prepare(folder), goal, options.rounds, folder))
    write_page(os.path.join(options.out, "loop_speed.md"), rows, options.rounds, load.said())


if __name__ == "__main__":
    main()
