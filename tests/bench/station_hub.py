#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An hour of ten stations with a scan a second at one hub: 36,000 parts, as fast as the hub takes them, posted as stations post them (each
station its own connection, one part after the other), while the hub is killed now and then; then the hub's own time for a
page. In SQLite and, where it is installed, in PostgreSQL. Writes a section of reports/station.md.

    tests/bench/station_hub.py [--stations 10] [--parts 3600] [--kills 3] [-o FILE]"""

import argparse
import glob
import http.client
import json
import os
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time

import benchlib

HEADING = "## Ten stations at a hub\n"


def read_section(path, heading=HEADING):
    """The section as it stands in the page, for who writes the others; "" where there is none."""
    if not os.path.exists(path):
        return ""
    with open(path, encoding="utf-8") as file:
        section = file.read().partition(heading)
    text = section[2].partition("\n## ")[0]
    return "\n" + section[1] + text.rstrip("\n") + "\n" if section[1] else ""


def free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


def a_part(folder):
    """A part as a station passes it on."""
    watched = f"{folder}/watched"
    os.mkdir(watched)
    shutil.copy(os.path.join(benchlib.ROOT, "samples", "gen2_foil.png"), f"{watched}/F1.png")
    with open(os.path.join(benchlib.ROOT, "samples", "station", "recipe.json"), encoding="utf-8") as file:
        recipe = json.load(file)
    recipe["station"] = {"pass_on": [{"to": f"{folder}/parts"}]}
    if isinstance(recipe["design"], str):
        recipe["design"] = os.path.join(benchlib.ROOT, "samples", "station", recipe["design"])
    os.mkdir(f"{folder}/parts")
    with open(f"{folder}/recipe.json", "w", encoding="utf-8") as file:
        json.dump(recipe, file)
    subprocess.run([benchlib.FOILGAUGE, "station", watched, "--recipe", f"{folder}/recipe.json", "--once"], check=False,
                   stderr=subprocess.DEVNULL)
    with open(glob.glob(f"{folder}/parts/*.json")[0], encoding="utf-8") as file:
        return json.load(file)


class Hub:
    """A hub that can be killed and started again."""

    def __init__(self, database):
        self.command = [benchlib.FOILGAUGE, "hub", "--database", database, "--port", str(free_port())]
        self.port = int(self.command[-1])
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if not self.process.stdout.readline():
            sys.exit("station_hub.py: the hub did not start: " + self.process.stderr.read())

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def get(self, path):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        connection.request("GET", path)
        body = connection.getresponse().read()
        connection.close()
        return body


def run_station(hub, part, number, count, waits, again):
    """Posts parts in order, each until it is taken."""
    connection = None
    body = dict(part, source=f"{number:032x}", station=f"hall {number}")
    for event in range(1, count + 1):
        body.update(event=event, foil=event, serial=f"{number}-{event:05d}")
        text, start = json.dumps(body), time.perf_counter()
        while True:
            try:
                if not connection:
                    connection = http.client.HTTPConnection("127.0.0.1", hub.port, timeout=60)
                connection.request("POST", "/api/parts", text, {"Content-Type": "application/json"})
                answer = connection.getresponse()
                answer.read()
                if answer.status == 200:
                    break
            except (OSError, http.client.HTTPException):
                pass
            connection, again[number] = None, again[number] + 1
            time.sleep(0.05)
        waits[number].append(time.perf_counter() - start)


def measure(database, part, options):
    hub = Hub(database)
    waits, again = [[] for _ in range(options.stations)], [0] * options.stations
    threads = [threading.Thread(target=run_station, args=(hub, part, n, options.parts, waits, again)) for n in range(options.stations)]
    start = time.monotonic()
    for thread in threads:
        thread.start()
    for kill in range(options.kills):
        wanted = options.stations * options.parts * (kill + 1) // (options.kills + 1)
        while sum(map(len, waits)) < wanted:
            time.sleep(0.01)
        hub.kill()
        time.sleep(0.2)
        hub.start()
    for thread in threads:
        thread.join()
    seconds = time.monotonic() - start
    times = []
    for _ in range(15):
        begin = time.perf_counter()
        hub.get("/")
        times.append(1e3 * (time.perf_counter() - begin))
    stations = json.loads(hub.get("/api/parts"))["stations"]
    counted = hub.get("/api/parts.csv").count(b"\n") - 1
    hub.kill()
    total = options.stations * options.parts
    if counted != total or len(stations) != options.stations:
        sys.exit(f"station_hub.py: {counted} parts of {total}, {len(stations)} stations")
    all_waits = sorted(w for station in waits for w in station)
    return [f"{total}", f"{sum(again)}", f"{counted}", f"{seconds:.0f}", f"{total / seconds:.0f}", f"{1e3 * statistics.median(all_waits):.1f}",
            f"{1e3 * all_waits[int(0.999 * len(all_waits))]:.0f}", f"{statistics.median(times):.0f}", f"{max(times):.0f}"]


def as_postgres(command):
    if os.getuid() == 0:
        command = ["setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups"] + command
    return subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def measure_postgresql(folder, part, options):
    programs = sorted(glob.glob("/usr/lib/postgresql/*/bin"))
    if not programs:
        return None
    os.chmod(folder, 0o755)
    os.mkdir(f"{folder}/pg")
    if os.getuid() == 0:
        shutil.chown(f"{folder}/pg", "postgres")
    port = free_port()
    as_postgres([f"{programs[-1]}/initdb", "-D", f"{folder}/pg", "-A", "trust", "-U", "postgres"])
    as_postgres([f"{programs[-1]}/pg_ctl", "-D", f"{folder}/pg", "-w", "-o", f"-p {port} -k {folder}/pg", "start"])
    try:
        return measure(f"postgresql://postgres@127.0.0.1:{port}/postgres", part, options)
    finally:
        as_postgres([f"{programs[-1]}/pg_ctl", "-D", f"{folder}/pg", "-m", "fast", "stop"])


def replace_section(path, heading, section):
    """Puts the section where it was, else before the last one."""
    before = ""
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            before = file.read()
    old = read_section(path, heading)
    head, attacked, rest = (before.replace(old, "") if old else before).partition("\n## What does not stop it\n")
    with open(path, "w", encoding="utf-8") as out:
        out.write(head.rstrip("\n") + "\n\n" + "\n".join(section).rstrip("\n") + "\n" + attacked + rest)


def write(path, options, rows):
    names = ["database", "parts", "sent again", "kept", "s", "parts/s", "median, ms", "999 of 1000, ms", "page, ms", "longest, ms"]
    section = [
        HEADING,
        f"`tests/bench/station_hub.py` writes this section. {benchlib.program_version()} on {benchlib.machine()}; load average "
        f"{os.getloadavg()[0]:.1f}. {options.parts / 60:.0f} minutes of {options.stations} stations with a scan a second, in less time: each posts {options.parts} parts as "
        f"fast as the hub takes them, one after the other; the hub is killed {options.kills} times meanwhile. They need {options.stations} parts/s. "
        "Afterwards its page, 15 times.\n",
        benchlib.table(names, rows),
    ]
    replace_section(path, HEADING, section)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stations", type=int, default=10)
    parser.add_argument("--parts", type=int, default=3600)
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("-o", default=os.path.join(benchlib.ROOT, "reports", "station.md"))
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        part = a_part(folder)
        rows.append(["SQLite"] + measure(f"{folder}/hub.sqlite", part, options))
        print(rows, flush=True)
        other = measure_postgresql(folder, part, options)
        if other:
            rows.append(["PostgreSQL"] + other)
    write(options.o, options, rows)


if __name__ == "__main__":
    main()
