#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory of a lot over the number of its scans, while it measures and when it reports.

/usr/bin/python3 tests/bench/lot_memory.py build/foilgauge [--scans 10000] > reports/lot_memory.md"""

import argparse
import json
import os
import subprocess
import tempfile
import time

import benchlib
import lot_speed

DPI = 1200
RENDERS = 50


def draw_scans(program, folder):
    """Small pictures: the sample's foil at another resolution."""
    with open(os.path.join(benchlib.ROOT, "samples", "render", "clean.json"), encoding="utf-8") as file:
        spec = json.load(file)
    spec["scanner"] = {**spec.get("scanner", {}), "dpi": DPI}
    spec.pop("width_px", None)
    spec.pop("height_px", None)
    pictures = []
    for i in range(RENDERS):
        path = f"{folder}/{i}"
        with open(path + ".json", "w", encoding="utf-8") as file:
            json.dump({**spec, "seed": i + 1}, file)
        subprocess.run([program, "render", path + ".json", "-o", path + ".png"], check=True)
        with open(path + ".png", "rb") as file:
            pictures.append(file.read())
    return pictures


def memory_mib(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS")) / 1024


def count_records(path):
    if not os.path.exists(path):
        return 0
    with open(path, "rb") as file:
        return max(0, sum(block.count(b"\n") for block in iter(lambda: file.read(1 << 20), b"")) - 1)


def run_lot(program, folder, count):
    """(seconds, largest memory in the first and the second half of the scans, and from the last one on, MiB)."""
    out, largest, start = f"{folder}/lot{count}", {"first": 0.0, "second": 0.0, "report": 0.0}, time.monotonic()
    with subprocess.Popen([program, "lot", f"{folder}/list.txt", "-o", out, "--jobs", "2", "--pages", "none"],
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as lot:  # fmt: skip
        while lot.poll() is None:
            done = count_records(f"{out}/results.jsonl")
            part = "first" if 2 * done < count else "second" if done < count else "report"
            try:
                largest[part] = max(largest[part], memory_mib(lot.pid))
            except (OSError, StopIteration):
                break
            time.sleep(0.02 if count < 1000 else 0.2)
        code = lot.wait()
    if code > 3 or count_records(f"{out}/results.jsonl") != count:
        raise SystemExit(f"lot_memory.py: exit code {code}")
    return time.monotonic() - start, largest


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--scans", type=int, default=10000, help="largest number of scans")
    options = parser.parse_args()
    counts = [n for n in (100, 1000, 10000) if n <= options.scans]
    with tempfile.TemporaryDirectory() as folder:
        pictures = draw_scans(options.program, folder)
        paths = [f"{folder}/foil{i:06d}.png" for i in range(counts[-1])]
        for i, path in enumerate(paths):
            with open(path, "wb") as file:
                file.write(lot_speed.with_note(pictures[i % RENDERS], f"scan {i}"))
        rows = []
        for count in counts:
            with open(f"{folder}/list.txt", "w", encoding="utf-8") as file:
                file.write("\n".join(paths[:count]) + "\n")
            rows.append((count, *run_lot(options.program, folder, count)))
    print(f"# Memory of a lot\n\nLots of small scans: {RENDERS} rendered foils at {DPI} dpi ({len(pictures[0]) / 1024:.0f} KiB each), every file with a note of"
          " its own; two jobs, no pages\nof single scans. Largest resident memory while the first half of the scans is measured, the second, and while the lot is"
          " reported, which\nholds all records. Other work may have run beside: lot_speed.md has the speed.\n\n    /usr/bin/python3 tests/bench/lot_memory.py build/foilgauge\n")  # fmt: skip
    print("| scans | seconds | scans a second | first half, MiB | second half, MiB | reporting, MiB |\n|---|---|---|---|---|---|")
    for count, seconds, largest in rows:
        print(f"| {count} | {seconds:.1f} | {count / seconds:.0f} | " + " | ".join(f"{largest[p]:.0f}" for p in largest) + " |")


if __name__ == "__main__":
    main()
