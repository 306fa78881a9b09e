#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Uncertainties where scans are hard: coarse resolution, and dust on the edges.

Renders foils with known truth from seeded specs, measures each, and counts which bumps lie within 2u,
which do not but are flagged, and which are neither. Writes reports/accuracy_hard.md.
"""

import argparse
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile

import numpy as np

import benchlib
from accuracy_specs import foil_spec, levels, log_uniform, spec_of

COARSE_DPI = (600, 700, 800, 1000, 1200)
# Flags that count as a warning of a value: its u may not hold.
BUMP_FLAGS = {"disturbed_edge", "gap", "touches_other", "poor_fit", "not_fitted", "crushed"}
FOIL_FLAGS = {"coarse_resolution"}
QUANTITIES = ("R", "h", "R0")


def coarse(rng, index):
    foil = foil_spec(rng, index)
    scanner = {
        "dpi": COARSE_DPI[index % len(COARSE_DPI)],
        "bits": 8,
        "blur_px": float(rng.uniform(0.7, 1.5)),
        "noise": log_uniform(rng, 0.5, 2.5),
    }
    scanner.update(levels(rng, light_on_dark=(index // 2) % 2 == 0))
    return spec_of(rng, foil, scanner)


def tidy(rng, index):
    foil = foil_spec(rng, index)
    scanner = {
        "dpi": 2400,
        "bits": 8,
        "blur_px": float(rng.uniform(0.8, 2.0)),
        "noise": log_uniform(rng, 0.5, 2.5),
    }
    scanner.update(levels(rng, light_on_dark=(index // 2) % 2 == 0))
    return spec_of(rng, foil, scanner)


def dusty(rng, index):
    """Dust and larger specks, lighter and darker than the surface under them."""
    spec = tidy(rng, index)
    sign = -1.0 if rng.uniform() < 0.5 else 1.0
    spec["scanner"]["dust"] = {
        "count": int(rng.integers(200, 1500)),
        "radius_px": float(rng.uniform(1.5, 5)),
        "contrast": sign * float(rng.uniform(30, 120)),
    }
    spec["scanner"]["specks"] = {
        "count": int(rng.integers(0, 30)),
        "radius_px": float(rng.uniform(5, 14)),
        "contrast": sign * float(rng.uniform(40, 150)),
    }
    return spec


SETS = {
    "coarse": ("600 to 1200 dpi", coarse, 60),
    "tidy": ("2400 dpi, clean", tidy, 60),
    "dusty": ("2400 dpi, dust and specks", dusty, 400),
}


def run(command):
    return subprocess.run(command, capture_output=True, text=True)


def render(spec, stem):
    with open(stem + ".spec.json", "w", encoding="utf-8") as file:
        json.dump(spec, file)
    done = run([benchlib.FOILGAUGE, "render", stem + ".spec.json", "-o", stem + ".png", "--truth", stem + ".truth.json"])
    if done.returncode:
        sys.exit(f"render: {done.stderr}")


def one(job):
    """[(set, index, dpi, bump or 0, quantity, error, u, flags)] of one foil, or what went wrong."""
    name, index, seed, folder, keep = job
    spec = SETS[name][1](np.random.default_rng([seed, index, len(name)]), index)
    stem = os.path.join(folder, f"{name}-{seed}-{index}")
    if not (keep and os.path.exists(stem + ".truth.json")):
        render(spec, stem)
    truth = benchlib.load_truth(stem + ".truth.json")
    done = run([benchlib.FOILGAUGE, "measure", stem + ".png"])
    dpi = spec["scanner"]["dpi"]
    for end in ("" if keep else ".png", "" if keep else ".truth.json", "" if keep else ".spec.json"):
        if end:
            os.remove(stem + end)
    if done.returncode not in (0, 1, 2, 3):
        return name, index, dpi, done.stderr.strip()[-200:], []
    foils = [f for f in json.loads(done.stdout)["foils"] if len(f["bumps"]) == len(truth["bumps"])]
    if len(foils) != 1:
        return name, index, dpi, "not every bump was found", []
    foil, rows = foils[0], []
    of_foil = [f for f in foil["flags"] if f in FOIL_FLAGS]
    wrong = benchlib.errors(foil, truth)
    if wrong is None:
        return name, index, dpi, "not every bump was measured", []
    pairs = benchlib.match(foil, truth)
    for k, (bump, _) in enumerate(pairs):
        flags = of_foil + [f for f in bump["flags"] if f in BUMP_FLAGS]
        rows.append((bump["number"], "R", wrong["R"][k], 1000 * bump["u_radius_mm"], flags))
        rows.append((bump["number"], "h", wrong["h"][k], 1000 * bump["u_height_mm"], flags))
    rows.append((0, "R0", wrong["R0"][0], 1000 * foil["overall"]["u_radius_mm"], of_foil))
    return name, index, dpi, "", rows


def figures(rows):
    error = np.array([r[2] for r in rows])
    u = np.array([r[3] for r in rows])
    flagged = np.array([bool(r[4]) for r in rows])
    t = np.abs(error / u)
    silent = (t > 4) & ~flagged
    return {
        "n": len(rows),
        "rms": benchlib.rms(error),
        "u": float(np.median(u)),
        "within": 100 * float(np.mean(t <= 2)),
        "good": 100 * float(np.mean((t <= 2) | flagged)),
        "flagged": 100 * float(np.mean(flagged)),
        "sound_flagged": 100 * float(np.mean(flagged[t <= 2])) if (t <= 2).any() else float("nan"),
        "silent": int(np.sum(silent)),
        "worst": float(np.max(np.where(flagged, 0, t))),
    }


HEADER = ["scans", "what", "n", "rms µm", "median u µm", "within 2u %", "within 2u or flagged %", "flagged %",
          "sound and flagged %", "silent beyond 4u", "worst silent, u"]


def figure_row(label, quantity, f):
    n = benchlib.number
    return [label, quantity, f["n"], n(f["rms"]), n(f["u"]), f"{f['within']:.1f}", f"{f['good']:.1f}",
            f"{f['flagged']:.1f}", f"{f['sound_flagged']:.1f}", f["silent"], f"{f['worst']:.1f}"]


def groups(results):
    for name, (title, _, _) in SETS.items():
        part = [r for r in results if r[0] == name]
        if part:
            yield title, part
        dpis = sorted({r[2] for r in part})
        for dpi in dpis if len(dpis) > 1 else []:
            yield f"{dpi} dpi", [r for r in part if r[2] == dpi]


def write(results, options):
    rows, failures = [], [r for r in results if r[3]]
    foils = ", ".join(f"{sum(r[0] == name for r in results)} {name}" for name in SETS)
    for title, part in groups(results):
        for quantity in QUANTITIES:
            of_it = [row for r in part for row in r[4] if row[1] == quantity]
            if of_it:
                rows.append(figure_row(title, quantity, figures(of_it)))
    with open(options.out, "w", encoding="utf-8") as out:
        out.write(
            "# Uncertainties of coarse and of dusty scans\n\n"
            f"`python3 tests/bench/accuracy_hard.py{arguments(options)}` wrote this page. Rendered Gen II foils, any rotation, "
            "both hands, light on dark and dark on light, 8 bit. Coarse: blur 0.7 to 1.5 px, noise 0.5 to 2.5. Dust: 200 to 1500 "
            "grains of 1.5 to 5 px and up to 30 specks of 5 to 14 px in each scan, brighter or darker by 30 to 150 counts. "
            "`Flagged` counts what says that a value may be wrong: " + ", ".join(f"`{f}`" for f in sorted(BUMP_FLAGS | FOIL_FLAGS))
            + f". Foils: {foils}.\n\n" + benchlib.table(HEADER, rows))
        out.write("\nNot measured: " + ("none.\n" if not failures else f"{len(failures)}.\n"))
        for name, index, _, why, _ in failures:
            out.write(f"- {name} {index}: {why}\n")


def arguments(options):
    """Options beyond the defaults, for the page."""
    given = [("--seed", options.seed, 1), ("--share", options.share, 1.0), ("--sets", options.sets, ",".join(SETS))]
    return "".join(f" {name} {value}" for name, value, default in given if value != default)


def wanted(options):
    """(set, how many foils) of --sets coarse,dusty:100."""
    for text in options.sets.split(","):
        name, _, count = text.partition(":")
        yield name, int(count) if count else max(1, round(SETS[name][2] * options.share))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--share", type=float, default=1.0, help="part of every set, for a quick look")
    parser.add_argument("--sets", default=",".join(SETS), help="which, and how many of each: coarse,dusty:100")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep", help="a folder where scans are kept for the next run")
    parser.add_argument("-o", "--out", default=os.path.join(benchlib.ROOT, "reports", "accuracy_hard.md"))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, multiprocessing.Pool(options.jobs) as pool:
        if options.keep:
            os.makedirs(options.keep, exist_ok=True)
        jobs = [(name, i, options.seed, options.keep or folder, bool(options.keep))
                for name, count in wanted(options)
                for i in range(count)]
        results = pool.map(one, jobs, chunksize=1)
    write(results, options)
    return results


if __name__ == "__main__":
    main()
