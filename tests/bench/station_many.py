#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages, start and size of a station with a hundred thousand scans in its database: time on the clock, and of a processor, as a
busy machine makes the first longer. Writes a section of reports/station.md.

    tests/bench/station_many.py [--scans 100000] [--folder FOLDER] [-o FILE]

FOLDER keeps the database (2 GB) for another run; without it a temporary one is made."""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time

import benchlib
import station_hub

HEADING = "## With very many scans\n"
ROUNDS = 9


def processor_ms(process):
    """Time of a processor that the threads of a process have had, ms."""
    total = 0
    for thread in os.listdir(f"/proc/{process.pid}/task"):
        try:
            with open(f"/proc/{process.pid}/task/{thread}/schedstat", encoding="ascii") as file:
                total += int(file.read().split()[0])
        except OSError:
            pass
    return total / 1e6


def time_pages(station, pages):
    rows = []
    for words, path in pages:
        station.get(path)
        times, before = [], processor_ms(station.process)
        for _ in range(ROUNDS):
            start = time.perf_counter()
            size = len(station.get(path))
            times.append(1e3 * (time.perf_counter() - start))
        spent = (processor_ms(station.process) - before) / ROUNDS
        rows.append([words, f"`{path}`", f"{statistics.median(times):.0f}", f"{max(times):.0f}", f"{spent:.0f}", f"{size / 1e3:.0f}"])
    return rows


def measure(folder, scans):
    import station_speed  # which asks for this section when it writes the page
    if not os.path.exists(f"{folder}/foilgauge.sqlite"):
        subprocess.run([sys.executable, station_speed.FILL, folder, "--scans", str(scans), "--recipe", station_speed.RECIPE], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    size = os.path.getsize(f"{folder}/foilgauge.sqlite")
    station = station_speed.Station(folder, station_speed.RECIPE)
    rows = time_pages(station, station_speed.PAGES)
    station.close()
    return size, station.start_s, rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scans", type=int, default=100000)
    parser.add_argument("--folder")
    parser.add_argument("-o", default=os.path.join(benchlib.ROOT, "reports", "station.md"))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        size, start_s, rows = measure(options.folder or f"{temporary}/station", options.scans)
    section = [
        HEADING,
        f"`tests/bench/station_many.py` writes this section. {benchlib.program_version()} on {benchlib.machine()}; load average "
        f"{os.getloadavg()[0]:.1f}. {options.scans} scans, made by `tests/bench/station_fill.py`: {size / options.scans / 1e3:.1f} kB for each foil, besides "
        f"the pictures of the newest 40, some 150 kB each. Start, until the first page is there: {1e3 * start_s:.0f} ms. Each page {ROUNDS} times; the last "
        "but one column is the time of a processor.\n",
        benchlib.table(["page", "path", "median, ms", "longest, ms", "processor, ms", "size, kB"], rows),
    ]
    station_hub.replace_section(options.o, HEADING, section)


if __name__ == "__main__":
    main()
