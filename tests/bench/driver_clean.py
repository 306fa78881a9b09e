# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain scans for driver.py: nothing may be flagged, and nothing be less accurate or slower than by another build."""

import multiprocessing
import os
import shutil
import subprocess
import tempfile
import time

import numpy as np

import benchlib as lib
import driver
import driver_kinds as kinds

TIMED, TURNS = 6, 9  # whole foils, and how often each is measured by either program
COUNTED = 3  # of them, whose instructions are counted


def clean_spec(index):
    """Both renderers, both resolutions, 8 and 16 bit, light on dark and dark on light; every fourth a plate of pins."""
    dpi, bits, is_light = kinds.DPI[index // 2 % 2], (8, 16)[index // 4 % 2], index // 8 % 2 == 0
    rng = np.random.default_rng([40, index])
    scanner = kinds.plain_scanner(rng, dpi, "moderate" if index % 3 else "ideal")
    scanner.update(bits=bits, background=float(rng.uniform(25, 45) if is_light else rng.uniform(200, 225)),
                   contrast=float(rng.uniform(150, 175) if is_light else -rng.uniform(140, 170)))  # fmt: skip
    draw = kinds.disc_spec(rng, scanner, False) if index // 16 % 4 == 3 else kinds.foil_spec(rng, scanner, kinds.THICK_MM, False)
    return {**draw, "seed": int(rng.integers(1, 2**31))}, kinds.RENDERERS[index % 2]


def flags_of(report):
    """Every flag of foils, bumps and discs, and every finding of the picture."""
    if report is None:
        return ["not_measured"]
    found = [f for part in report.get("foils", []) + report.get("discs", []) for f in part["flags"]]
    found += [f for foil in report.get("foils", []) for bump in foil.get("bumps") or [] for f in bump["flags"]]
    found += [f["finding"] for f in (report.get("picture") or {}).get("findings", [])]
    return sorted(set(found) - driver.NOT_FLAGS)


def work(job):
    """[(flags, {key: (error, u)}) of one scan by every program]."""
    index, options, programs = job
    spec, renderer = clean_spec(index)
    truth, result = kinds.truth_of(spec), []
    with tempfile.TemporaryDirectory() as folder:
        path = driver.picture(options["renderer"], options["cache"] or folder, spec, renderer)
        for program in programs:
            report, _ = driver.measure(program, folder, path, spec)
            found = driver.found_in(report, spec, truth)
            values = {k: (1000 * (v[0] - truth[k]), 1000 * v[1]) for k, v in found.items()
                      if v[0] is not None and v[1] is not None}  # fmt: skip
            result.append((flags_of(report), values))
    return index, result


def accuracy_row(name, title, scans, which):
    """Of the values that every program has."""
    pairs = [(scan[which][1][k]) for _, scan in scans for k in scan[0][1]
             if k[0] == name and all(k in one[1] for one in scan)]  # fmt: skip
    error, u = np.array(pairs).T
    within = np.mean(np.abs(error) <= 2 * u)
    return [name, title, len(error), lib.number(lib.rms(error)), lib.number(float(np.median(u))), f"{100 * within:.1f}",
            lib.number(float(np.max(np.abs(error / u))))]  # fmt: skip


def paired_row(name, scans):
    """Number of pairs, ratio of the rms errors, largest change of a value in u, median ratio of u."""
    pairs = [(one[0][1][k], one[1][1][k]) for _, one in scans for k in one[0][1] if k[0] == name and k in one[1][1]]
    new, old = np.array([p[0] for p in pairs]), np.array([p[1] for p in pairs])
    moved = np.abs(new[:, 0] - old[:, 0]) / old[:, 1]
    return [name, len(pairs), lib.number(lib.rms(new[:, 0]) / lib.rms(old[:, 0])), lib.number(float(np.max(moved)), 2),
            lib.number(float(np.median(new[:, 1] / old[:, 1])))]  # fmt: skip


def whole_foil(index):
    """A Gen II foil of nine bumps at 4800 dpi."""
    rng = np.random.default_rng([41, index])
    own = kinds.plain_scanner(rng, 4800, "ideal")
    foil = {"overall_radius_mm": 20.95, "radius_springback": {"mean": 0.02, "sd": 0.005}, "rotate_deg": -90 + 15 * index}
    scanner = {name: own[name] for name in kinds.SAME if name in own}
    return {"schema": "foilgauge/render/1", "seed": index, "foils": [foil], "scanner": scanner}


def seconds(program, path, folder):
    """Of the processor: another process on the machine changes it little."""
    start = os.times()
    subprocess.run([program, "measure", path, "-o", os.path.join(folder, "t.json"), "--threads", "1"], capture_output=True)
    end = os.times()
    return end.children_user + end.children_system - start.children_user - start.children_system


def wall_seconds(program, path, folder):
    start = time.perf_counter()
    subprocess.run([program, "measure", path, "-o", os.path.join(folder, "t.json")], capture_output=True)
    return time.perf_counter() - start


def instructions(program, path, folder):
    """Executed by one thread: nothing else on the machine changes them."""
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/calls", program, "measure", path, "-o",
               os.path.join(folder, "t.json"), "--threads", "1"]  # fmt: skip
    said = subprocess.run(command, capture_output=True, text=True).stderr
    return int(next(line for line in said.splitlines() if "refs" in line).split()[-1].replace(",", ""))


def instructions_row(program, before, folder):
    counts = [[instructions(name, os.path.join(folder, f"{index}.png"), folder) for name in (before, program)]
              for index in range(COUNTED)]  # fmt: skip
    old, new = np.median(np.array(counts) / 1e6, axis=0)
    ratios = [c[1] / c[0] for c in counts]
    return ["instructions, one thread", f"{old:.0f} million", f"{new:.0f} million", f"{np.median(ratios):.3f}",
            f"{min(ratios):.3f} to {max(ratios):.3f}"]  # fmt: skip


def time_table(program, before, renderer):
    """Ratios are of neighbours in time, each program first in every second turn."""
    body = []
    with tempfile.TemporaryDirectory() as folder:
        for title, clock in (("processor, one thread", seconds), ("wall, all threads", wall_seconds)):
            ratios, times = [], []
            for index in range(TIMED):
                path = os.path.join(folder, f"{index}.png")
                if not os.path.exists(path):
                    spec = os.path.join(folder, "spec.json")
                    with open(spec, "w", encoding="utf-8") as file:
                        file.write(driver.json.dumps(whole_foil(index)))
                    subprocess.run([renderer, "render", spec, "-o", path], check=True)
                for turn in range(TURNS):
                    order = [program, before] if turn % 2 else [before, program]
                    taken = {name: sum(clock(name, path, folder) for _ in range(3)) / 3 for name in order}
                    ratios.append(taken[program] / taken[before])
                    times.append([1000 * taken[before], 1000 * taken[program]])
            low, middle, high = np.percentile(ratios, [25, 50, 75])
            times = np.median(times, axis=0)
            body.append([title, f"{times[0]:.0f} ms", f"{times[1]:.0f} ms", f"{middle:.3f}", f"{low:.3f} to {high:.3f}"])
        if shutil.which("valgrind"):
            body.append(instructions_row(program, before, folder))
    return lib.table(["of", "before", "now", "ratio, median", "quartiles, of instructions the range"], body)


TEXT = """{count} plain scans, of both renderers, at 2400 and 4800 dpi, of 8 and 16 bit, light on dark and dark on light, foils and
pins: **{flagged} have a flag**{which}.

{accuracy}"""

BEFORE = """
Beside another build ({version}) on the same scans: the errors' rms against its own, the farthest that a value moved in
units of its u, and u against its own.

{paired}
{timed}"""


def run(count, options, before, jobs):
    programs = [options["program"]] + ([before] if before else [])
    with multiprocessing.Pool(jobs) as pool:
        scans = sorted(pool.imap_unordered(work, [(index, options, programs) for index in range(count)]))
    flagged = [(index, one[0][0]) for index, one in scans if one[0][0]]
    names = ["R", "h", "alpha", "R0", "thickness", "clearance", "diameter"]
    names = [n for n in names if any(k[0] == n for _, one in scans for k in one[0][1])]
    titles = ["now", "before"][: len(programs)]
    accuracy = [accuracy_row(n, title, scans, k) for n in names for k, title in enumerate(titles)]
    head = ["quantity (µm; alpha: 0.001°)", "program", "values", "rms error", "median u", "within 2u %", "largest error over u"]
    text = TEXT.format(count=count, flagged=len(flagged), accuracy=lib.table(head, accuracy),
                       which=": " + "; ".join(f"{i} {' '.join(f)}" for i, f in flagged) if flagged else "")  # fmt: skip
    if before:
        version = subprocess.run([before, "--version"], capture_output=True, text=True).stdout.strip()
        paired = lib.table(["quantity", "values", "rms error ratio", "moved by up to u ×", "u ratio, median"],
                           [paired_row(n, scans) for n in names])  # fmt: skip
        text += BEFORE.format(version=version, paired=paired, timed=time_table(options["program"], before, options["renderer"]))
    return text
