# SPDX-License-Identifier: GPL-3.0-or-later
"""reports/loop_limits.md: the loop's time and memory on tables of many rows and columns, beside its estimate, and whether
the planted effects are found.

Usage: python3 tests/bench/loop_limits.py build/foilgauge [ROWSxCOLUMNS...]
"""

import json
import multiprocessing
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from loop_names import classes, member

SIZES = ("1000x3", "1000x10", "10000x3", "10000x10", "100000x3", "100000x10")
EFFECTS = (0, 1, 5)
HEAD = """# What the loop takes on a large table

`python3 tests/bench/loop_limits.py build/foilgauge`: columns of random numbers, one of words, and a response that is noise
beside the declared `1 + x0`, with nothing else in it, a step over the last column, or five effects: that step, a hump over
a column, levels of the words, a cycle over the rows and one wrong row, each far beyond the noise. Right: each effect is
claimed, stands in a claim's class or is the curve that is drawn, and nothing else is claimed. Processor seconds are those
of all cores together, with other work beside them, as the wall time has; memory is the largest resident. The estimate is
for the worst case, five effects and a curve, which cannot be known beforehand: with fewer it takes a third or a tenth.
`foilgauge loop --table` refuses what it puts above 10 minutes or 512 MiB (`--minutes`, `--memory`) before it starts. Up to
600 rows every candidate is scored in up to 1,999 draws of the null; from there on once, against a count of the looks, and
start values of shapes are compared over sums in steps of their column before the best is scored on all rows.

| rows | columns | effects | wall, s | processor, s | MiB | estimate, s | estimate, MiB | right |
|---:|---:|---:|---:|---:|---:|---:|---:|---|
"""


def planted(rows, columns):
    """What a claim may call each of the effects."""
    return [("table.threshold", f"x{columns - 1}"), ("unattributed", "x1"), ("table.factor", "w"), ("table.periodic", "row"),
            ("table.outlier", str(rows // 3 + 1))]


def make_table(path, rows, columns, count):
    import numpy as np  # in a process of its own: who starts the program lends it the size of its memory

    rng = np.random.default_rng([rows, columns, count])
    x, w = rng.random((rows, columns)), rng.integers(0, 4, rows)
    size, order = 20 / np.sqrt(rows), np.arange(rows) / rows
    effects = [2 * size * (x[:, -1] > 0.5),
               2 * size * np.exp(-(((x[:, 1] - 0.6) / 0.15) ** 2)),
               size * np.array([1.5, -1, 0.5, -1])[w],
               1.5 * size * np.sin(2 * np.pi * 9.3 * order),
               np.where(np.arange(rows) == rows // 3, 12.0, 0.0)]
    write_table(path, x, w, 1 + x[:, 0] + rng.normal(size=rows) + sum(effects[:count]))


def write_table(path, x, w, y):
    with open(path, "w", encoding="utf-8") as out:
        out.write("y," + ",".join(f"x{i}" for i in range(x.shape[1])) + ",w\n")
        for row, number in enumerate(y):
            out.write(f"{number:.6f}," + ",".join(f"{v:.6f}" for v in x[row]) + f",{'abcd'[w[row]]}\n")


def right(report, names):
    """Every effect found, and every claim one of them."""
    said = [{member(name) for name in members} for members in classes(report)]
    known = {(identity, frozenset([where])) for identity, where in names}
    return known <= set().union(*said) and all(claim & known for claim in said)


def run(command):
    """Exit code, message, wall and processor seconds, MiB."""
    with tempfile.TemporaryFile("w+") as errors:
        start = time.monotonic()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        return process.returncode, errors.read(), wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def measure(program, folder, size, count):
    rows, columns = (int(part) for part in size.split("x"))
    table, answer = pathlib.Path(folder) / "table.csv", pathlib.Path(folder) / "answer.json"
    making = multiprocessing.Process(target=make_table, args=(table, rows, columns, count))
    making.start()
    making.join()
    names = planted(rows, columns)[:count]
    command = [program, "loop", "--table", str(table), "--response", "y", "--model", "1 + x0", "-o", str(answer)]
    refusal = run(command + ["--minutes", "1e-9"])[1]
    minutes, memory = re.search(r"may take (\S+) minutes and (\S+) MiB", refusal).groups()
    code, message, wall, seconds, mebibytes = run(command)
    if code not in (0, 3, 65):  # 3: something is suspected, nothing is claimed
        sys.exit(message)
    taken, said = "refused | | ", ""
    if code in (0, 3):
        said = "yes" if right(json.loads(answer.read_text(encoding="utf-8")), names) else "no"
        taken = f"{wall:.3g} | {seconds:.3g} | {mebibytes:.0f}"
    return f"| {rows:,} | {columns} | {count} | {taken} | {60 * float(minutes):.3g} | {float(memory):.0f} | {said} |\n"


def main(program, *sizes):
    report = pathlib.Path(__file__).resolve().parents[2] / "reports" / "loop_limits.md"
    text = HEAD
    with tempfile.TemporaryDirectory() as folder:
        for size in sizes or SIZES:
            for count in EFFECTS:
                line = measure(program, folder, size, count)
                print(line, end="", flush=True)
                text += line
    report.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
