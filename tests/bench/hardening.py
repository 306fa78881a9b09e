#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of canaries, checked lengths and full RELRO: the program with and without them on the same work in turn, processor
time of each pair as a ratio. Builds the program without them in build-unhardened/; writes reports/hardening.md."""

import argparse
import os
import resource
import statistics
import subprocess
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PLAIN = os.path.join(ROOT, "build-unhardened", "foilgauge")
HARDENED = os.path.join(ROOT, "build", "foilgauge")


def build():
    for folder, option in (("build", "ON"), ("build-unhardened", "OFF")):
        subprocess.run(
            ["cmake", "-S", ROOT, "-B", os.path.join(ROOT, folder), "-G", "Unix Makefiles", f"-DFOILGAUGE_HARDENING={option}"]
            + ["-C", os.path.join(ROOT, "src/cmake/release.cmake")],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        subprocess.run(
            ["cmake", "--build", os.path.join(ROOT, folder), "-j2", "--target", "foilgauge"], check=True, stdout=subprocess.DEVNULL
        )


def cpu_s(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def compare(arguments, pairs):
    """Median and quartiles of hardened over plain, and the plain median in seconds."""
    ratios, plain_s = [], []
    for i in range(pairs + 1):
        order = (HARDENED, PLAIN) if i % 2 else (PLAIN, HARDENED)
        spent = {program: cpu_s([program] + arguments) for program in order}
        if i:  # the first pair warms the caches
            ratios.append(spent[HARDENED] / spent[PLAIN])
            plain_s.append(spent[PLAIN])
    quartiles = statistics.quantiles(ratios, n=4)
    return statistics.median(ratios), quartiles[0], quartiles[2], statistics.median(plain_s)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=40)
    pairs = parser.parse_args().pairs
    build()
    with tempfile.TemporaryDirectory() as folder:
        bed = os.path.join(folder, "ripple.png")
        subprocess.run([PLAIN, "render", os.path.join(ROOT, "samples/render/ripple.json"), "-o", bed], check=True)
        work = {
            "measure, one foil at 4800 dpi": ["measure", os.path.join(ROOT, "samples/gen2_foil.png"), "-o", os.path.join(folder, "a.json")],
            "loop on a scan": ["loop", bed, "-o", os.path.join(folder, "b.json")],
            "die, four traces": ["die"]
            + [os.path.join(ROOT, "samples/die", name) for name in ("concave_1.txt", "concave_2.txt", "convex_1.txt", "convex_2.txt")]
            + ["-o", os.path.join(folder, "c.json")],
        }
        rows = [(name, *compare(arguments, pairs if "loop" not in name else max(5, pairs // 8))) for name, arguments in work.items()]
    with open(os.path.join(ROOT, "reports/hardening.md"), "w", encoding="utf-8") as out:
        out.write("# What hardening costs\n\n`python3 tests/bench/hardening.py`: processor time of the release build with canaries, checked\n")
        out.write("lengths (FORTIFY) and full RELRO over that of the same without them, pair by pair in turn.\n\n")
        out.write("| work | ratio, median | quartiles | without, s |\n|---|---|---|---|\n")
        for name, median, low, high, plain in rows:
            out.write(f"| {name} | {median:.3f} | {low:.3f} to {high:.3f} | {plain:.3f} |\n")


if __name__ == "__main__":
    main()
