#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages, start, arrival to verdict and memory of a station: see station_speed.sh."""

import argparse
import glob
import json
import os
import re
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import time
import urllib.request
import zlib

import benchlib
import station_attacked
import station_hub
import station_many

RECIPE = os.path.join(benchlib.ROOT, "samples", "station", "recipe.json")
FILL = os.path.join(benchlib.ROOT, "tests", "bench", "station_fill.py")
SAMPLE = os.path.join(benchlib.ROOT, "samples", "gen2_foil.png")
# A foil that is quickly drawn and measured: what a day of them costs is asked of the memory, not of the clock.
SMALL = {"schema": "foilgauge/render/1", "foils": [{"rotate_deg": -90}], "scanner": {"dpi": 600, "blur_px": 0.8}}
PAGES = [
    ("Now", "/"), ("History", "/history"), ("History, a serial", "/history?serial=004711"), ("A foil", "/foil?id=4000"),
    ("Trends, newest 200", "/trends"), ("Trends, all", "/trends?newest=all"),
    ("Trends, all of a die", "/trends?newest=all&die=B"), ("Trends, one bump", "/trends?newest=all&bump=3"),
    ("Trends, zoomed", "/trends?newest=all&from=2000&to=2200"), ("Trends over lots", "/trends?by=lots&newest=all"),
    ("Scanner", "/scanner"), ("Lots", "/lots"),
]
ROUNDS = 15


class Station:
    """A running station and its address."""

    def __init__(self, folder, recipe=None):
        command = [benchlib.FOILGAUGE, "station", folder, "--port", "0"]
        if recipe:
            command += ["--recipe", recipe]
        self.started = time.monotonic()
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.address = self.process.stdout.readline().strip().rstrip("/")
        if not self.address:
            sys.exit("station_speed.py: the station did not start")
        self.get("/")
        self.start_s = time.monotonic() - self.started

    def get(self, path):
        with urllib.request.urlopen(self.address + path, timeout=30) as answer:
            return answer.read()

    def status(self, name):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as file:
            return int(re.search(rf"{name}:\s+(\d+)", file.read()).group(1)) / 1024

    def files(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def close(self):
        self.process.terminate()  # a shell may have had it ignore SIGINT
        self.process.wait(timeout=30)


def with_note(png, text):
    """The same picture in a file that differs: a tEXt chunk before its end."""
    body = b"tEXt" + b"Comment\0" + text.encode()
    return png[:-12] + struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body)) + png[-12:]


def time_pages(station):
    """Per page: median and longest time in ms, and size in kB."""
    rows = []
    for words, path in PAGES:
        times, size = [], 0
        for _ in range(ROUNDS):
            start = time.perf_counter()
            size = len(station.get(path))
            times.append(1e3 * (time.perf_counter() - start))
        rows.append([words, f"`{path}`", f"{statistics.median(times):.0f}", f"{max(times):.0f}", f"{size / 1e3:.0f}"])
    return rows


# Words of the page Now beside the name of a file that is received or measured.
UNDER_WAY = (b"<b>RECEIVING</b>", b"<b>MEASURING</b>")


def has_verdict(station, name):
    page = station.get("/")
    return name.encode() in page and not any(words in page for words in UNDER_WAY)


def arrivals(folder, count):
    """Seconds from the close of the file to the verdict on the page, of scans of 18 Mpx and more."""
    station, waits = Station(folder, RECIPE), []
    with open(SAMPLE, "rb") as file:
        png = file.read()
    for i in range(count):
        name = f"L900_A_arrival{i:03d}.png"
        with open(os.path.join(folder, name), "wb") as file:
            file.write(with_note(png, f"arrival {i}"))
        start = time.perf_counter()
        while not has_verdict(station, f"arrival{i:03d}"):
            if time.perf_counter() - start > 60:
                sys.exit("station_speed.py: a scan did not arrive")
            time.sleep(0.005)
        waits.append(time.perf_counter() - start)
        time.sleep(0.3)
    station.close()
    return waits


def memory_of_requests(folder, count):
    """Resident MiB along `count` requests over all pages, and open files at both ends."""
    station, samples = Station(folder, RECIPE), []
    paths = [path for _, path in PAGES] + ["/style.css", "/nothing"]
    for i in range(count + 1):
        if i % max(count // 5, 1) == 0:
            samples.append((i, station.status("VmRSS"), station.files()))
        try:
            station.get(paths[i % len(paths)])
        except urllib.error.HTTPError:
            pass
    station.close()
    return samples


def a_day(scans):
    """A day's scans, one a minute, as fast as they are measured; resident MiB along the way."""
    samples = []
    with tempfile.TemporaryDirectory() as folder:
        watched = os.path.join(folder, "watched")
        os.mkdir(watched)
        with open(f"{folder}/small.json", "w", encoding="utf-8") as file:
            json.dump(SMALL, file)
        subprocess.run([benchlib.FOILGAUGE, "render", f"{folder}/small.json", "-o", f"{folder}/small.png"], check=True)
        with open(f"{folder}/small.png", "rb") as file:
            png = file.read()
        station, start = Station(watched), time.monotonic()
        for i in range(scans):
            with open(f"{watched}/{i:05d}.png", "wb") as file:
                file.write(with_note(png, f"minute {i}"))
            if i % 20 == 19 or i + 1 == scans:
                wait_for(station, f"{i:05d}")
            if i % max(scans // 8, 1) == 0 or i + 1 == scans:
                samples.append((i + 1, station.status("VmRSS"), station.files(), database_mib(watched), journal_mib(watched)))
        seconds = time.monotonic() - start
        station.close()
        megapixels = struct.unpack(">II", png[16:24])
    return samples, seconds, megapixels[0] * megapixels[1] / 1e6


def wait_for(station, serial):
    start = time.monotonic()
    while not has_verdict(station, serial):
        if time.monotonic() - start > 120:
            sys.exit(f"station_speed.py: scan {serial} did not arrive")
        time.sleep(0.02)


def database_mib(folder):
    return os.path.getsize(f"{folder}/foilgauge.sqlite") / 2**20


def journal_mib(folder):
    return sum(os.path.getsize(path) for path in glob.glob(f"{folder}/foilgauge.sqlite-wal")) / 2**20


def fill(folder, scans):
    start = time.monotonic()
    subprocess.run([sys.executable, FILL, folder, "--scans", str(scans), "--recipe", RECIPE], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.monotonic() - start


def write(path, options, filled, starts, pages, waits, requests, day):
    samples, seconds, megapixels = day
    load = os.getloadavg()[0]
    ms = sorted(1e3 * w for w in waits)
    lines = [
        "# What a station takes\n",
        f"`tests/bench/station_speed.sh` writes this page. {benchlib.program_version()} on {benchlib.machine()}; load average "
        f"{load:.1f} when it was written: above 1 others were at work and times are longer than they need be.\n",
        "## From arrival to verdict\n",
        f"Scans of 20 Mpx (4800 dpi, 8 bit), {len(ms)} of them, each from the close of its file to its verdict on the page "
        f"Now, which is asked for every 5 ms: median {statistics.median(ms):.0f} ms, longest {ms[-1]:.0f} ms.\n",
        f"## With {options.scans} scans in the database\n",
        f"Made by `tests/bench/station_fill.py` in {filled:.0f} s: one scan is measured, the others are its rows with other values. Start, "
        f"until the first page is there: median {1e3 * statistics.median(starts):.0f} ms, longest {1e3 * max(starts):.0f} ms of {len(starts)}. "
        f"Each page {ROUNDS} times:\n",
        benchlib.table(["page", "path", "median, ms", "longest, ms", "size, kB"], pages),
        f"## Memory over {options.requests} requests\n",
        "All pages of the table in turn, the style and a page that is not there.\n",
        benchlib.table(["requests", "resident, MiB", "open files"], [[i, f"{m:.1f}", f] for i, m, f in requests]),
        f"## A day: {options.day} scans, one a minute, in {seconds:.0f} s\n",
        f"Foils of {megapixels:.1f} Mpx (600 dpi), each file different, written as fast as they are measured.\n",
        benchlib.table(["scans", "resident, MiB", "open files", "database, MiB", "journal, MiB"],
                       [[i, f"{m:.1f}", f, f"{d:.1f}", f"{j:.1f}"] for i, m, f, d, j in samples]),
    ]
    others = station_hub.read_section(path, station_many.HEADING) + station_hub.read_section(path) + station_attacked.read_section(path)
    with open(path, "w", encoding="utf-8") as out:
        out.write("\n".join(lines) + others)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scans", type=int, default=5000)
    parser.add_argument("--requests", type=int, default=5000)
    parser.add_argument("--day", type=int, default=1440)
    parser.add_argument("--arrivals", type=int, default=10)
    parser.add_argument("-o", default=os.path.join(benchlib.ROOT, "reports", "station.md"))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        watched = os.path.join(folder, "station")
        filled = fill(watched, options.scans)
        starts = []
        for _ in range(5):
            station = Station(watched, RECIPE)
            starts.append(station.start_s)
            station.close()
        station = Station(watched, RECIPE)
        pages = time_pages(station)
        station.close()
        print(pages, starts, flush=True)
        requests = memory_of_requests(watched, options.requests)
        print(requests, flush=True)
        waits = arrivals(watched, options.arrivals)
        print(waits, flush=True)
        shutil.rmtree(watched)
    day = a_day(options.day)
    write(options.o, options, filled, starts, pages, waits, requests, day)


if __name__ == "__main__":
    main()
