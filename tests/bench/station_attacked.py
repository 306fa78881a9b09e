#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A station attacked by kills, slow connections, very many files, other machines through a proxy, hostile requests
and files. Runs the tests of it at their full size and writes the last section of reports/station.md.

    /usr/bin/python3 tests/bench/station_attacked.py [PROGRAM] [--kills 200] [-o FILE]
"""
import argparse
import os
import subprocess
import time

import benchlib

HEADING = "## What does not stop it\n"
TESTS = [
    ("killed while scans arrive, the disk full, memory short", "robust", "{kills}"),
    ("ended by signals, beside readers and slow clients", "ends", ""),
    ("500 slow connections from 50 addresses, and others", "slow", ""),
    ("100,500 files; the folder removed and made again twice", "crowd", ""),
    ("all addresses, other names, nginx with TLS before it", "reach", ""),
    ("names of any bytes, newlines, pipes, links, folders", "names", ""),
    ("hostile requests, files that change, databases replaced", "attacked", "20"),
]


def read_section(path):
    """The section as it stands in the page, for who writes the others; "" where there is none."""
    if not os.path.exists(path):
        return ""
    with open(path, encoding="utf-8") as file:
        section = file.read().partition(HEADING)
    return "\n" + section[1] + section[2] if section[1] else ""


def run(program, name, argument):
    script = f"tests/cli/test_station_{name}.sh"
    command = ["bash", script, program] + ([argument] if argument else [])
    began = time.monotonic()
    done = subprocess.run(command, cwd=benchlib.ROOT, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{script}: exit code {done.returncode}\n{done.stderr}")
    print(script, done.stdout, flush=True)
    return f"`{script} PROGRAM{' ' + argument if argument else ''}`", done.stdout.strip(), time.monotonic() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", nargs="?", default=os.path.join(benchlib.ROOT, "build", "foilgauge"))
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("-o", default=os.path.join(benchlib.ROOT, "reports", "station.md"))
    options = parser.parse_args()
    rows = []
    for what, name, argument in TESTS:
        command, found, seconds = run(os.path.abspath(options.program), name, argument.format(kills=options.kills))
        rows.append([what, command, found.replace("\n", "; "), f"{seconds:.0f}"])
    with open(options.o, encoding="utf-8") as file:
        before = file.read().split(HEADING)[0].rstrip("\n")
    section = [
        before + "\n",
        HEADING,
        f"`/usr/bin/python3 tests/bench/station_attacked.py` writes this section. {benchlib.program_version()} on "
        f"{benchlib.machine()}; load average {os.getloadavg()[0]:.1f}. Each test ends with an error where a scan is lost "
        "or comes twice, a page takes longer than 1 s, or the station ends.\n",
        benchlib.table(["what", "command", "found", "s"], rows),
    ]
    with open(options.o, "w", encoding="utf-8") as file:
        file.write("\n".join(section))


if __name__ == "__main__":
    main()
