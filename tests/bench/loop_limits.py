"""reports/loop_limits.md: what the loop takes on tables of many rows and columns, beside its estimate.

Usage: python3 tests/bench/loop_limits.py build/foilgauge [ROWSxCOLUMNS...]
"""

import math
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

SIZES = ("100x3", "100x10", "500x3", "500x10", "600x10", "1000x10", "10000x3", "10000x10", "100000x3", "100000x10",
         "1000000x3")
HEAD = """# What the loop takes on a large table

`python3 tests/bench/loop_limits.py build/foilgauge`: random columns and a response that is noise beside the declared
`1 + x0`, or that holds a trend, a wave, a step, a decay and a cycle. Seconds are those of the processor, one core, with
other work beside it; memory is the largest resident. The estimate is for the worst case (five effects, each refined);
`foilgauge loop --table` refuses what it puts above 10 minutes or 512 MiB (`--minutes`, `--memory`) before it starts. Up to
600 rows every candidate is scored in up to 1,999 draws of the null; from there on once, against a count of the looks.

| rows | columns | what is in it | seconds | MiB | estimate, s | estimate, MiB |
|---:|---:|---|---:|---:|---:|---:|
"""


def response(row, rows, x, found):
    y = random.gauss(0, 1) + x[0]
    if found:
        y += 0.5 * x[1] + 0.5 * math.sin(20 * x[2]) + 0.3 * (x[-1] > 0.5) + 0.3 * math.exp(-5 * row / rows)
        y += 0.4 * math.sin(60 * row / rows)
    return y


def write_table(path, rows, columns, found):
    random.seed(1)
    with open(path, "w", encoding="utf-8") as out:
        out.write("y," + ",".join(f"x{i}" for i in range(columns)) + "\n")
        for row in range(rows):
            x = [random.random() for _ in range(columns)]
            out.write(f"{response(row, rows, x, found):.5f}," + ",".join(f"{v:.5f}" for v in x) + "\n")


def run(command):
    """Exit code, message, processor seconds, MiB."""
    with tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        return process.returncode, errors.read(), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def measure(program, folder, size, found):
    rows, columns = (int(part) for part in size.split("x"))
    path = pathlib.Path(folder) / "table.csv"
    write_table(path, rows, columns, found)
    command = [program, "loop", "--table", str(path), "--response", "y", "--model", "1 + x0", "-o", "/dev/null"]
    refusal = run(command + ["--minutes", "1e-9"])[1]
    minutes, memory = re.search(r"may take (\S+) minutes and (\S+) MiB", refusal).groups()
    code, message, seconds, mebibytes = run(command)
    if code not in (0, 65):
        sys.exit(message)
    taken = f"{seconds:.3g} | {mebibytes:.0f}" if code == 0 else "refused | "
    what = "effects" if found else "noise"
    return f"| {rows:,} | {columns} | {what} | {taken} | {60 * float(minutes):.3g} | {float(memory):.0f} |\n"


def main(program, *sizes):
    report = pathlib.Path(__file__).resolve().parents[2] / "reports" / "loop_limits.md"
    text = HEAD
    with tempfile.TemporaryDirectory() as folder:
        for size in sizes or SIZES:
            for found in (False, True):
                line = measure(program, folder, size, found)
                print(line, end="", flush=True)
                text += line
    report.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
