#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scans a second of a lot, on one job and on two: see lot_speed.sh."""

import argparse
import csv
import hashlib
import json
import os
import random
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import zlib

import benchlib

TOOLS = os.path.join(benchlib.ROOT, "build", "bench")
RENDERS = 100  # different foils; every further scan is one of them with a note of its own in the file
PAIR_SCANS = 60  # of a lot that is measured again and again, turn and turn about
ROUNDS = 3
RECORDS = (1000, 10000, 100000)  # of lots that are reported from their records alone


def render(folder, count):
    """Different foils, two renders at a time."""
    with open(os.path.join(benchlib.ROOT, "samples", "render", "clean.json"), encoding="utf-8") as file:
        spec = json.load(file)
    for i in range(count):
        with open(f"{folder}/{i}.json", "w", encoding="utf-8") as file:
            json.dump({**spec, "seed": i + 1}, file)
    for i in range(0, count, 2):
        running = [subprocess.Popen([benchlib.FOILGAUGE, "render", f"{folder}/{k}.json", "-o", f"{folder}/{k}.png"])
                   for k in range(i, min(i + 2, count))]
        if any(process.wait() for process in running):
            sys.exit("lot_speed.py: a render failed")


def with_note(png, text):
    """The same picture in a file that differs: a tEXt chunk before its end."""
    body = b"tEXt" + b"Comment\0" + text.encode()
    return png[:-12] + struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body)) + png[-12:]


def make_scans(folder, count):
    renders = min(count, RENDERS)
    render(folder, renders)
    os.mkdir(f"{folder}/scans")
    for i in range(count):
        with open(f"{folder}/{i % renders}.png", "rb") as file:
            png = file.read()
        with open(f"{folder}/scans/foil{i:06d}.png", "wb") as file:
            file.write(with_note(png, f"scan {i}"))
    for i in range(renders):
        os.remove(f"{folder}/{i}.png")


def measure_lot(program, paths, jobs, folder):
    """Wall (s), CPU (s), peak (MiB); the lot's results are left."""
    out, result, listed = f"{folder}/lot", f"{folder}/cost", f"{folder}/list.txt"
    shutil.rmtree(out, ignore_errors=True)
    with open(listed, "w", encoding="utf-8") as file:
        file.write("\n".join(paths) + "\n")
    pages = ["--pages", "none"] if program == benchlib.FOILGAUGE else []  # the program before may draw none
    subprocess.run([os.path.join(TOOLS, "run_timed"), result, program, "lot", listed, "-o", out, "--jobs", str(jobs)] + pages,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    with open(result, encoding="ascii") as file:
        wall, user, system, peak, code = file.read().split()
    with open(f"{out}/results.jsonl", encoding="utf-8") as file:
        records = sum(1 for _ in file) - 1
    if int(code) > 3 or records != len(paths):
        sys.exit(f"lot_speed.py: exit code {code}, {records} records of {len(paths)}")
    return float(wall), float(user) + float(system), float(peak) / 1024


def sealed(line):
    """A line of results.jsonl with its checksum in place of the closing brace."""
    body = line[:-1]
    return f'{body}, "checksum": "{hashlib.sha256(body.encode()).hexdigest()[:16]}"}}\n'


def scattered(values, factor):
    return "[" + ", ".join("null" if v is None else f"{v * factor:.10g}" if isinstance(v, float) else str(v) for v in values) + "]"


def write_record(file, record, number, rng):
    """The record of a foil as another foil's: a level of its own, and bumps that scatter about it."""
    foil, level = record["foils"][0], 1 + 1e-3 * rng.gauss(0, 1)
    bumps = ", ".join('{"number": %d, "flags": [], "values": %s}' % (b["number"], scattered(b["values"], level * (1 + 2e-3 * rng.gauss(0, 1))))
                      for b in foil["bumps"])
    file.write(sealed('{"scan": "scans/foil%06d.png", "sha256": "%064x", "date": "2026-11-27", "measured_with": "%s", "error": null, '
                      '"foils": [{"number": 1, "flags": [], "error": null, "values": %s, "bumps": [%s]}]}'
                      % (number, number + 1, record["measured_with"], scattered(foil["values"], level), bumps)))


def make_records(measured, folder, count):
    """A lot as it lies after its last scan, whose scans are gone: of the measured lot's records."""
    os.mkdir(folder)
    rng = random.Random(1)
    with open(f"{measured}/results.jsonl", encoding="utf-8") as file:
        head, *records = (json.loads(line) for line in file)
    with open(f"{folder}/manifest.csv", "w", encoding="utf-8") as file:
        file.write("scan,foil,coil,date\n")
        file.writelines(f"scans/foil{i:06d}.png,F{i},C{i // 500},2026-{1 + i * 12 // count:02d}-{1 + i % 28:02d}\n" for i in range(count))
    shutil.copy(f"{measured}/recipe.json", folder)
    for name in ("manifest", "recipe"):
        with open(f"{folder}/{name}.{'csv' if name == 'manifest' else 'json'}", "rb") as file:
            head[f"{name}_sha256"] = hashlib.sha256(file.read()).hexdigest()
    head["items"] = count
    del head["checksum"]
    with open(f"{folder}/results.jsonl", "w", encoding="utf-8") as file:
        file.write(sealed(json.dumps(head)))
        for i in range(count):
            write_record(file, records[i % len(records)], i, rng)


def report_records(measured, folder, count, jobs):
    """Wall (s), CPU (s), peak (MiB) of the report of that many records."""
    lot, result = f"{folder}/records", f"{folder}/cost"
    shutil.rmtree(lot, ignore_errors=True)
    make_records(measured, lot, count)
    subprocess.run([os.path.join(TOOLS, "run_timed"), result, benchlib.FOILGAUGE, "lot", f"{lot}/manifest.csv", "--recipe", f"{lot}/recipe.json",
                    "-o", lot, "--resume", "--jobs", str(jobs), "--pages", "none"],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    with open(result, encoding="ascii") as file:
        wall, user, system, peak, code = file.read().split()
    with open(f"{lot}/foils.csv", encoding="utf-8") as file:
        lines = sum(1 for _ in file) - 1
    shutil.rmtree(lot)
    if int(code) > 3 or lines != count:
        sys.exit(f"lot_speed.py: exit code {code}, {lines} foils of {count} records")
    return float(wall), float(user) + float(system), float(peak) / 1024


def pair_ratio(a, b):
    """Ratio of the times a to b, round by round: median, lowest, highest."""
    ratios = sorted(x[0] / y[0] for x, y in zip(a, b))
    return f"{statistics.median(ratios):.2f} × ({ratios[0]:.2f}–{ratios[-1]:.2f})"


def measure_pairs(programs, paths, folder):
    """Every program on one job and on two, in turn; (name, jobs) -> costs."""
    todo = [(name, jobs) for name in programs for jobs in (1, 2)]
    costs = {key: [] for key in todo}
    for k in range(ROUNDS):
        for name, jobs in todo[:: 1 if k % 2 else -1]:
            costs[name, jobs].append(measure_lot(programs[name], paths, jobs, folder))
            print(name, jobs, costs[name, jobs][-1], flush=True)
    return costs


def write_markdown(path, whole, pairs, records, scans, before):
    in_turn = min(scans, PAIR_SCANS)

    def row(words, count, cost):
        return [words, count, f"{cost[0]:.1f}", f"{count / cost[0]:.2f}", f"{cost[1] / count * 1e3:.0f}", f"{cost[2]:.0f}"]

    def middle(costs):
        return tuple(statistics.median(c[i] for c in costs) if i < 2 else max(c[2] for c in costs) for i in range(3))

    lines = [
        "# Speed of a lot\n",
        f"Made by `tests/bench/lot_speed.sh` with {benchlib.program_version()} on {benchlib.machine()}.",
        f"The lot is {scans} files of {min(scans, RENDERS)} rendered foils (nine bumps, 4800 dpi, 18 Mpx each); a file that shows a foil",
        "again has a note of its own, so that no two files or sums are the same. Wall time holds everything: reading,",
        "SHA-256, measuring, keeping every record, statistics and the lot's page, but no pages of single scans (`--pages none`).",
        "They lie in the page cache.\n",
        f"- two jobs against one, {scans} scans: {whole[1][0] / whole[2][0]:.2f} × the scans a second",
        f"- two jobs against one, {in_turn} scans, {ROUNDS} rounds in turn: {pair_ratio(pairs['now', 1], pairs['now', 2])}",
    ]
    if before:
        lines += [f"- against {before} (the same compiler and settings), {ROUNDS} rounds in turn: on one job "
                  f"{pair_ratio(pairs['before', 1], pairs['now', 1])}, on two "
                  f"{pair_ratio(pairs['before', 2], pairs['now', 2])}"]
    table = [row(f"lot --jobs {jobs}", scans, whole[jobs]) for jobs in (1, 2)]
    table += [row(f"lot --jobs {jobs}" + ("" if name == "now" else f", {before}"), in_turn, middle(costs))
              for (name, jobs), costs in pairs.items()]
    lines += ["", benchlib.table(["how", "scans", "seconds", "scans a second", "CPU ms a scan", "peak memory, MiB"], table)]
    lines += ["\n## Reports from records\n",
              "A lot that was measured before, whose scans are gone: its records are read, and everything that `lot` writes is made of them",
              "(JSON, tables, page, QIF, Q-DAS). The records are those of the lot above, scattered, of nine bumps each.\n",
              benchlib.table(["records", "jobs", "seconds", "CPU seconds", "peak memory, MiB", "KiB a record"],
                             [[count, jobs, f"{wall:.1f}", f"{cpu:.1f}", f"{peak:.0f}", f"{peak * 1024 / count:.1f}"]
                              for (count, jobs), (wall, cpu, peak) in records.items()])]
    with open(path, "w", encoding="utf-8") as out:
        out.write("\n".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scans", nargs="?", type=int, default=1000)
    parser.add_argument("--records", type=int, default=RECORDS[-1], help="largest number of records that are reported")
    parser.add_argument("--before", help="another build of the program, to compare with")
    parser.add_argument("--before-name", default="the program before")
    parser.add_argument("-o", "--out", default=os.path.join(benchlib.ROOT, "reports"))
    options = parser.parse_args()
    programs = {"now": benchlib.FOILGAUGE}
    if options.before:
        programs["before"] = options.before
    with tempfile.TemporaryDirectory() as folder:
        make_scans(folder, options.scans)
        paths = sorted(f"{folder}/scans/{name}" for name in os.listdir(f"{folder}/scans"))
        pairs = measure_pairs(programs, paths[:PAIR_SCANS], folder)
        measured = f"{folder}/measured"
        measure_lot(programs["now"], paths[:PAIR_SCANS], 2, folder)
        os.rename(f"{folder}/lot", measured)
        records = {}
        for count, jobs in ((count, jobs) for count in RECORDS if count <= options.records for jobs in (1, 2)):
            records[count, jobs] = report_records(measured, folder, count, jobs)
            print("records", count, jobs, records[count, jobs], flush=True)
        whole = {}
        for jobs in (1, 2):
            whole[jobs] = measure_lot(programs["now"], paths, jobs, folder)
            print("whole", jobs, whole[jobs], flush=True)
    rows = [("now", jobs, len(paths), 0, *whole[jobs]) for jobs in (1, 2)]
    rows += [(name, jobs, len(paths[:PAIR_SCANS]), k + 1, *cost) for (name, jobs), costs in pairs.items() for k, cost in enumerate(costs)]
    rows += [("records", jobs, count, 0, *cost) for (count, jobs), cost in records.items()]
    with open(os.path.join(options.out, "lot_speed.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["program", "jobs", "scans", "round", "wall_s", "cpu_s", "peak_mib"])
        writer.writerows([[f"{v:.6g}" if isinstance(v, float) else v for v in row] for row in rows])
    write_markdown(os.path.join(options.out, "lot_speed.md"), whole, pairs, records, len(paths), options.before and options.before_name)


if __name__ == "__main__":
    main()
