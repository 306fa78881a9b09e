#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Growth of a measurement's time with pixels, foils and noise, a whole bed, and the share of each stage: see
speed.sh. Every size is read with libpng alone, measured on all cores and measured on one, in turn."""

import argparse
import csv
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

import benchlib

TOOLS = os.path.join(benchlib.ROOT, "build", "bench")
FOIL_PX = (7652, 2389)  # the sample's foil at 4800 dpi
A4_PX = (39685, 56125)
WIDE_PX = (20000, 14650)  # room for eight foils
WHAT = ("read", "all", "one")
WORDS = {"read": "libpng alone", "all": "foilgauge", "one": "foilgauge --threads 1"}
COLOURS = {"read": "#b8562b", "all": "#1f5fa8", "one": "#5a9a4a"}
PROFILED_RUNS = 12

# name of the series, what grows, [(value, width, height, foils, noise, rounds)]
SERIES = [
    ("pixels", "Mpx", [(round(FOIL_PX[0] * FOIL_PX[1] * k * k / 1e6), FOIL_PX[0] * k, FOIL_PX[1] * k, 1, 1, r)
                       for k, r in ((1, 9), (2, 7), (3, 5), (4, 3))]),
    ("foils", "foils", [(n, *WIDE_PX, n, 1, 2) for n in (1, 2, 4, 8)]),
    ("noise", "counts", [(n, *FOIL_PX, 1, n, 7) for n in (0, 0.5, 1, 2, 4, 8)]),
    ("bed", "foils", [(24, *A4_PX, 24, 1.5, 2)]),
]

# Stages and the symbols or libraries that belong to them: the first that fits.
STAGES = [
    ("inflate", r"libisal.*(inflate|decode_huffman|decode_next|make_inflate|huff)|libz\.so"),
    ("checksums of the PNG", r"crc32|adler"),
    ("SHA-256 of the file", r"nettle|sha256"),
    ("undoing the PNG's filters", r"unfilter|undo_|paeth|_average|_up\b|_sub\b|libpng"),
    ("reducing rows to tiles", r"fg_tiles_|reduce_strip|add_rows|mark_wanted|keep_tile|average_blocks|memmove|memcpy"),
    ("finding the foil", r"anchor|sheet|mark_hot|mark_near|find_low|fg_grid|fg_segment|fg_levels|cut_tile|forget_far"
                         r"|trace|cut_across|excess_over|walk|fg_island"),
    ("edges", r"solve_task|stack_task|fg_normal_add|step_at|pixel_band|fg_edges|collect_task|find_gamma|edge|shape|excess"
              r"|fg_reference|project|smooth"),
    ("loading the program", r"ld-linux"),
    ("kernel: pages, reading, writing", r"kernel"),
]


def render(folder, width, height, foils, noise):
    spec = {
        "schema": "foilgauge/render/1", "seed": 1, "width_px": width, "height_px": height,
        "foils": [{"repeat": foils, "rotate_deg": -90, "rotate_step_deg": 15 if foils == 24 else 0,
                   "overall_radius_mm": 20.95, "radius_springback": {"mean": 0.02, "sd": 0.007}}],
        "scanner": {"dpi": 4800, "bits": 8, "background": 30, "contrast": 175, "blur_px": 1.2, "noise": noise},
    }
    path, scan = os.path.join(folder, "spec.json"), os.path.join(folder, "scan.png")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(spec, file)
    subprocess.run([benchlib.FOILGAUGE, "render", path, "-o", scan], check=True)
    return scan


def run_once(command, folder):
    """Wall, CPU (s), peak (MiB)."""
    result = os.path.join(folder, "cost")
    subprocess.run([os.path.join(TOOLS, "run_timed"), result] + command, stdout=subprocess.DEVNULL,
                   stderr=subprocess.PIPE, check=True)
    with open(result, encoding="ascii") as file:
        wall, user, system, peak, code = file.read().split()
    if int(code) not in (0, 1):
        sys.exit(f"speed_growth.py: exit code {code}: {' '.join(command)}")
    return float(wall), float(user) + float(system), float(peak) / 1024


def commands(scan, folder):
    out = os.path.join(folder, "report.json")
    measure = [benchlib.FOILGAUGE, "measure", scan, "-o", out]
    return {"read": [os.path.join(TOOLS, "read_png"), scan], "all": measure, "one": measure + ["--threads", "1"]}


def time_scan(scan, foils, rounds, folder):
    """Costs of each, the first round left out (it warms the page cache); every foil must be there."""
    todo = commands(scan, folder)
    costs = {what: [] for what in WHAT}
    for k in range(rounds + 1):
        for what in WHAT[:: 1 if k % 2 else -1]:
            cost = run_once(todo[what], folder)
            if k:
                costs[what].append(cost)
    found = [f for f in benchlib.load(os.path.join(folder, "report.json"))["foils"] if f["bumps"]]
    if len(found) != foils:
        sys.exit(f"speed_growth.py: {len(found)} foils found of {foils}")
    return costs


def measure_size(name, size, folder):
    value, width, height, foils, noise, rounds = size
    scan = render(folder, width, height, foils, noise)
    costs = time_scan(scan, foils, rounds, folder)
    row = {"series": name, "value": value, "mpx": width * height / 1e6, "foils": foils, "noise": noise,
           "file_mb": os.path.getsize(scan) / 1e6, "rounds": rounds}
    for what in WHAT:
        row[f"{what}_s"] = statistics.median(c[0] for c in costs[what])
        row[f"{what}_cpu_s"] = statistics.median(c[1] for c in costs[what])
        row[f"{what}_mib"] = max(c[2] for c in costs[what])
    for what in ("all", "one"):
        ratios = sorted(c[0] / r[0] for c, r in zip(costs[what], costs["read"]))
        row[f"{what}_ratio"] = statistics.median(ratios)
        row[f"{what}_ratio_low"], row[f"{what}_ratio_high"] = ratios[0], ratios[-1]
    os.remove(scan)
    print({k: round(v, 3) if isinstance(v, float) else v for k, v in row.items()}, flush=True)
    return row


def stage_of(line):
    for name, pattern in STAGES:
        if re.search(pattern, line):
            return name
    return "circles, labels, the report and the rest"


def profile(scan, folder):
    """Share of CPU time of every stage on one core; None where perf is not to be had."""
    if not shutil.which("perf"):
        return None
    data = os.path.join(folder, "perf.data")
    loop = f"for i in $(seq {PROFILED_RUNS}); do {benchlib.FOILGAUGE} measure {scan} --threads 1 -o {folder}/p.json; done"
    record = subprocess.run(["perf", "record", "-F", "4999", "-o", data, "--", "bash", "-c", loop],
                            capture_output=True, check=False)
    if record.returncode:
        return None
    text = subprocess.run(["perf", "report", "-i", data, "--no-children", "--comm", "foilgauge", "--sort", "dso,symbol",
                           "--stdio", "-g", "none", "--percent-limit", "0"], capture_output=True, text=True, check=False).stdout
    shares = {}
    for line in text.splitlines():
        match = re.match(r"\s*([0-9.]+)%\s+(.*)", line)
        if match:
            name = stage_of(match.group(2))
            shares[name] = shares.get(name, 0) + float(match.group(1))
    total = sum(shares.values())
    return {name: value / total for name, value in shares.items()} if total else None


def copy_gb_per_second():
    """Memory throughput of one core: the best of several copies of 256 MB."""
    source = np.ones(1 << 25)
    target = np.empty_like(source)
    best = 1e9
    for _ in range(7):
        start = time.perf_counter()
        np.copyto(target, source)
        best = min(best, time.perf_counter() - start)
    return source.nbytes / best / 1e9


def nice_step(least):
    """The next larger of 1, 2, 2.5, 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(least))
    return next(m * power for m in (1, 2, 2.5, 5, 10) if m * power >= least)


def panel(out, left, top, rows, title, unit, x_key):
    width, height = 250, 180
    xs = [r[x_key] for r in rows]
    x_max = max(xs)
    step = nice_step(max(r[f"{what}_s"] for r in rows for what in WHAT) / 4)
    y_max = 4 * step
    out.append(f'<text x="{left}" y="{top - 30}" font-weight="bold">{title}</text>')
    out.append(f'<path d="M{left} {top}V{top + height}H{left + width}" fill="none" stroke="#444"/>')
    for k in range(5):
        y = top + height * (1 - k / 4)
        out.append(f'<text x="{left - 5}" y="{y + 4:.0f}" text-anchor="end">{step * k:g}</text>')
        out.append(f'<path d="M{left} {y:.0f}H{left + width}" stroke="#ddd"/>')
    for k, x in enumerate(xs):
        if len(xs) < 6 or k != 1:  # 0 and 0.5 of noise lie too close
            out.append(f'<text x="{left + width * x / x_max:.0f}" y="{top + height + 16}" text-anchor="middle">{x:g}</text>')
    out.append(f'<text x="{left + width / 2}" y="{top + height + 34}" text-anchor="middle">{unit}</text>')
    for what in WHAT:
        points = [(left + width * r[x_key] / x_max, top + height * (1 - r[f"{what}_s"] / y_max)) for r in rows]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        out.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[what]}" stroke-width="2"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{COLOURS[what]}"/>' for x, y in points]


def plot(rows):
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 960 320" font-family="sans-serif" font-size="12">',
           '<rect width="960" height="320" fill="#fff"/>']
    for k, (name, title, unit) in enumerate([("pixels", "one foil on a growing scan", "Mpx"),
                                             ("foils", "foils on 293 Mpx", "foils"),
                                             ("noise", "noise of one foil's scan (18 Mpx)", "sd of the noise, 8-bit counts")]):
        shown = [r for r in rows if r["series"] == name]
        if shown:
            panel(out, 50 + 315 * k, 60, shown, f"seconds: {title}", unit, "value")
    for k, what in enumerate(WHAT):
        out.append(f'<path d="M{280 + 150 * k} 306h20" stroke="{COLOURS[what]}" stroke-width="3"/>')
        out.append(f'<text x="{305 + 150 * k}" y="310">{WORDS[what]}</text>')
    out.append("</svg>")
    return "\n".join(out) + "\n"


def table_rows(rows):
    for r in rows:
        yield ([f"{r['mpx']:.0f}", r["foils"], f"{r['noise']:g}", f"{r['file_mb']:.1f}"]
               + [f"{r[f'{what}_s']:.3f}" for what in WHAT]
               + [f"{r[f'{what}_ratio']:.2f} ({r[f'{what}_ratio_low']:.2f}–{r[f'{what}_ratio_high']:.2f})"
                  for what in ("all", "one")]
               + [f"{r['all_cpu_s'] / r['all_s']:.2f}", f"{r['read_mib']:.0f}, {r['all_mib']:.0f}, {r['one_mib']:.0f}"])


HEADER = ["Mpx", "foils", "noise", "file, MB", "libpng alone, s", "foilgauge, s", "--threads 1, s", "× reading, all cores",
          "× reading, one core", "cores at work", "peak MiB: read, all, one"]
TITLES = {"pixels": "One foil on a growing scan", "foils": "Foils on a scan of 293 Mpx",
          "noise": "Noise: what does not compress", "bed": "A bed of A4 at 4800 dpi"}


def slope_words(rows):
    """Seconds for each further million of pixels and each further foil, by straight lines."""
    pixels = [r for r in rows if r["series"] == "pixels"]
    foils = [r for r in rows if r["series"] == "foils"]
    words = []
    for what in WHAT if pixels and foils else ():
        per_mpx = np.polyfit([r["mpx"] for r in pixels], [r[f"{what}_s"] for r in pixels], 1)[0] * 1e3
        per_foil = np.polyfit([r["foils"] for r in foils], [r[f"{what}_s"] for r in foils], 1)[0] * 1e3
        words.append(f"- {WORDS[what]}: {per_mpx:.2f} ms for each further million of pixels, "
                     f"{per_foil:.0f} ms for each further foil\n")
    return "".join(words)


def write_markdown(path, rows, shares, copy):
    with open(path, "w", encoding="utf-8") as out:
        out.write("# How the time grows, and where it goes\n\n"
                  f"Made by `tests/bench/speed.sh` with {benchlib.program_version()} on {benchlib.machine()}. Scans are rendered\n"
                  "(4800 dpi, 8 bit, foils of nine bumps); each is read with libpng alone, measured on all cores and measured on\n"
                  "one, in alternating order, after one round that warms the page cache. Seconds are medians of wall time, start-up\n"
                  "and JSON report included; ratios are formed pair by pair: median (lowest–highest).\n\n"
                  "![seconds over pixels, foils and noise](speed_growth.svg)\n\n" + slope_words(rows))
        for name, title in TITLES.items():
            shown = [r for r in rows if r["series"] == name]
            if shown:
                out.write(f"\n## {title}\n\n" + benchlib.table(HEADER, table_rows(shown)))
        write_limit(out, rows, shares, copy)


def write_limit(out, rows, shares, copy):
    one = max(rows, key=lambda r: r["mpx"] / r["foils"])
    out.write("\n## Where the limit is\n\n")
    if not shares:
        out.write("No profile: `perf` is missing here, or may not look.\n")
        return
    names = sorted(next(iter(shares.values())), key=lambda n: -next(iter(shares.values()))[n])
    out.write(f"CPU time on one core by stage, {PROFILED_RUNS} runs each under `perf record`.\n\n")
    out.write(benchlib.table(["stage", *shares], [[n] + [f"{100 * s.get(n, 0):.1f} %" for s in shares.values()] for n in names]))
    out.write(f"\nMemory is not the limit: one core copies {copy:.1f} GB in a second here, and measures "
              f"{one['mpx'] / one['one_s'] / 1e3:.2f} Gpx of one byte.\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--out", default=os.path.join(benchlib.ROOT, "reports"))
    parser.add_argument("--only", nargs="*", default=[name for name, _, _ in SERIES], help="of these series only")
    parser.add_argument("--rounds", type=int, default=99, help="at most, to try it")
    options = parser.parse_args()
    rows, shares = [], {}
    with tempfile.TemporaryDirectory() as folder:
        for name, _, sizes in SERIES:
            if name in options.only:
                rows += [measure_size(name, (*size[:-1], min(size[-1], options.rounds)), folder) for size in sizes]
        for noise in (1, 4):
            shares[f"18 Mpx, noise {noise}"] = profile(render(folder, *FOIL_PX, 1, noise), folder)
        shares["73 Mpx, noise 1"] = profile(render(folder, 2 * FOIL_PX[0], 2 * FOIL_PX[1], 1, 1), folder)
    shares = {name: share for name, share in shares.items() if share}
    copy = copy_gb_per_second()
    with open(os.path.join(options.out, "speed_growth.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)
    with open(os.path.join(options.out, "speed_growth.svg"), "w", encoding="utf-8") as file:
        file.write(plot(rows))
    write_markdown(os.path.join(options.out, "speed_growth.md"), rows, shares, copy)
    print(shares, f"{copy:.1f} GB/s")


if __name__ == "__main__":
    main()
