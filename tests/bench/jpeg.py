#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors that JPEG adds, and whether the uncertainties cover them: writes reports/jpeg.md.

Foils and plates of discs are rendered with known truth from seeded specs (accuracy_specs.py,
accuracy_discs.py), saved as JPEG by libjpeg at several qualities, as gray and as colour with halved
chroma, and measured twice: the JPEG itself (--allow-lossy, which widens u), and its very pixels in a
file that does not tell where they came from (u as it would be without widening)."""

import argparse
import json
import math
import multiprocessing
import os
import pickle
import subprocess
import tempfile

import numpy as np

import accuracy
import accuracy_discs
import benchlib as lib
from accuracy_specs import TIERS

TO_JPEG = os.path.join(os.path.dirname(lib.FOILGAUGE), "tests", "to_jpeg")
KINDS = [(quality, "gray") for quality in (75, 80, 85, 90, 95, 98)] + [(quality, "420") for quality in (75, 90)]
FOIL_QUANTITIES = (("R", "R"), ("h", "h"), ("alpha", "α"), ("theta", "θ"), ("R0", "R0"), ("t", "t"))
DISC_QUANTITIES = (("R", "R"), ("x", "centre x"), ("y", "centre y"))


def run(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True)


def measure(path, words):
    done = run(lib.FOILGAUGE, "measure", "--threads", "1", path, *words)
    return json.loads(done.stdout) if done.returncode in (0, 1, 2, 3) else None


# --- foils ----------------------------------------------------------------------------------


def foil_spec(tier, rng, index):
    """A spec of the accuracy tables; `coarse` is one at 2400 dpi."""
    spec, _ = TIERS["clean" if tier == "coarse" else tier].make(rng, index)
    if tier == "coarse":
        spec["scanner"]["dpi"] = 2400
        spec["scanner"]["blur_px"] = float(rng.uniform(0.7, 1.6))
    return spec


def foil_values(report, truth):
    """{quantity: (errors, u)} of the one foil; None when it was not measured."""
    foils = report["foils"] if report else []
    wrong = lib.errors(foils[0], truth) if len(foils) == 1 else None
    if wrong is None:
        return None
    u = accuracy.uncertainties(foils[0], truth)
    values = {name: (wrong[name], u[name]) for name in wrong}
    thick = (foils[0]["thickness_mm"] - truth["design"]["thickness_mm"]) * 1e3
    values["t"] = (np.array([thick]), np.array([foils[0]["u_thickness_mm"] * 1e3]))
    return values


# --- discs ----------------------------------------------------------------------------------


def disc_spec(rng, index):
    _, low, high, count = accuracy_discs.SIZES[index % len(accuracy_discs.SIZES)]
    return accuracy_discs.plate(rng, low, high, count, index, False)


def disc_values(report, spec, truth):
    if not report:
        return None
    rows = accuracy_discs.errors_of(spec, truth["discs"], report["discs"])
    rows = np.array([row for row in rows if row])
    if not rows.size:
        return None
    columns = {"R": (0, 1), "x": (3, 4), "y": (5, 6)}
    return {name: (rows[:, a], rows[:, b]) for name, (a, b) in columns.items()}


# --- one render -----------------------------------------------------------------------------


def work(job):
    """[(quality, kind, values before widening, values after)] of one render."""
    tier, seed, index = job
    rng = np.random.default_rng([seed, index])
    discs = tier == "discs"
    spec = disc_spec(rng, index) if discs else foil_spec(tier, rng, index)
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)
        with open(at("spec.json"), "w", encoding="utf-8") as file:
            json.dump(spec, file)
        run(lib.FOILGAUGE, "render", at("spec.json"), "-o", at("scan.png"), "--truth", at("truth.json"))
        if discs:
            truth, words = lib.load(at("truth.json")), ["--form", "discs"]
            values = lambda report: disc_values(report, spec, truth)
        else:
            truth = lib.load_truth(at("truth.json"))
            lib.write_design(truth, at("design.json"))
            words = ["--design", at("design.json")]
            values = lambda report: foil_values(report, truth)
        clean = values(measure(at("scan.png"), words))
        rows = [(0, "PNG", clean, clean)]
        dpi = spec["scanner"].get("dpi", 4800)
        for quality, kind in KINDS:
            run(TO_JPEG, at("scan.png"), at("scan.jpg"), quality, kind)
            run(TO_JPEG, at("scan.jpg"), at("scan.pgm"), 0)
            before = values(measure(at("scan.pgm"), words + ["--dpi", dpi]))
            after = values(measure(at("scan.jpg"), words + ["--allow-lossy"]))
            rows.append((quality, kind, before, after))
    return spec["scanner"], rows


# --- the page -------------------------------------------------------------------------------


def pooled(results, quality, kind, quantity, which):
    parts = [row[2 + which][quantity] for _, rows in results for row in rows
             if row[:2] == (quality, kind) and row[2] and row[3]]
    return (np.concatenate([p[k] for p in parts]) for k in (0, 1)) if parts else (np.array([]),) * 2


def covered(error, u):
    return 100 * float(np.mean(np.abs(error) <= 1.96 * u)) if error.size else math.nan


def row_of(results, quality, kind, quantity, title):
    error, u = pooled(results, quality, kind, quantity, 0)
    after_error, after_u = pooled(results, quality, kind, quantity, 1)
    n = lib.number
    return [f"{quality} {kind}" if quality else "PNG", title, error.size, n(lib.rms(error)), n(lib.rms(u)),
            accuracy.per_cent(covered(error, u), 1), n(lib.rms(after_u)),
            accuracy.per_cent(covered(after_error, after_u), 1)]


HEADER = ["quality", "what", "n", "rms error", "u before", "in 95 % before", "u after", "in 95 % after"]


def table_of(results, quantities):
    rows = [row_of(results, quality, kind, name, title)
            for name, title in quantities for quality, kind in [(0, "PNG")] + KINDS]
    return lib.table(HEADER, rows)


def lost(results):
    bad = [(row[0], row[1]) for _, rows in results for row in rows if not row[3]]
    return f"{len(bad)} of {sum(len(rows) for _, rows in results)} measurements failed.\n\n"


TEXT = """# JPEG: accuracy and coverage

`tests/bench/jpeg.sh{words}` writes this page. {version}.

{intro}
"""

INTRO = """JPEG rounds the frequencies of every block of 8 × 8 pixels to steps, which its quantization tables
name; `jpeg_quality` in the reports is the quality of the Independent JPEG Group whose table is nearest
at the frequencies of edges. What that does to an edge differs from place to place, and is seen in the
residuals, as every scatter is: u of circles, angles and heights follows from them without further ado.
What the residuals cannot see is what all edges of a scan do together (src/measure/loss.c):

- a shift across the edge, outwards or inwards, of {edge} px² × step / (contrast × blur), step being the root
  mean square of the table's entries at frequencies u + v up to 6, contrast and step in gray values, blur in
  pixels (the sharper the edge, the more of it is rounded): in u of the thickness, of a disc's radius, of
  circles of an inner or outer datum, of the length of a plain strip;
- where an edge runs with the rows or columns, blocks in a row are rounded alike: the variance that the
  residuals tell is raised by {arc} (arcs of a strip) and {turn} (discs) per gray value of step.

These three numbers were set on renders of other seeds.

Every render is measured as PNG, and as JPEG at each quality: gray, and (420) as tinted colour with
chroma halved both ways. "Before" is the JPEG's own pixels, saved without loss and measured as any
scan; "after" is the JPEG itself with `--allow-lossy`, which widens u. Errors and u are in µm (angles
in degrees); "in 95 %" is the share of intervals value ± 1.96 u that hold the truth. Values of one scan
share its circle and its edges, so that n counts more than it tells: a share of n values is known to no
better than that of as many scans where errors go together (R0 and t: one value a scan)."""


def constant(name):
    """A number of src/measure/loss.c, so that the page states the one in force."""
    with open(os.path.join(lib.ROOT, "src", "measure", "loss.c"), encoding="utf-8") as file:
        return next(line.split()[2] for line in file if line.startswith(f"#define {name} "))

TIER_TEXT = {
    "clean": "Foils, 4800 dpi: any rotation, both hands and polarities, blur 0.7 to 3 px, noise 0.3 to 3",
    "coarse": "Foils, 2400 dpi: the same, blur 0.7 to 1.6 px",
    "rough": "Foils, 4800 dpi, rough edges, halo, shading, some with JPEG blocks already",
    "discs": "Discs, radius 0.5 to 8 mm, 4800 dpi, blur 0.7 to 3 px, noise 1 to 4",
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=19)
    parser.add_argument("--renders", type=int, default=6, help="per tier")
    parser.add_argument("--tiers", default="clean,discs,coarse")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--dump", help="every value, as a pickle")
    parser.add_argument("-o", default=os.path.join(lib.ROOT, "reports", "jpeg.md"))
    options = parser.parse_args()
    everything = {}
    with multiprocessing.Pool(options.jobs) as pool:
        for tier in options.tiers.split(","):
            jobs = [(tier, options.seed + len(everything), k) for k in range(options.renders)]
            everything[tier] = pool.map(work, jobs, chunksize=1)
            print(f"{tier}: done", flush=True)
            if options.dump:
                with open(options.dump, "wb") as file:
                    pickle.dump(everything, file)
    words = "".join(f" --{name} {getattr(options, name)}" for name in ("seed", "renders")
                    if getattr(options, name) != parser.get_default(name))
    with open(options.o, "w", encoding="utf-8") as out:
        out.write(TEXT.format(words=words, version=lib.program_version(), intro=INTRO.format(
            edge=constant("EDGE_PX2_PER_STEP"), arc=constant("ARC_VARIANCE_PER_STEP"),
            turn=constant("TURN_VARIANCE_PER_STEP"))))
        for tier, results in everything.items():
            out.write(f"\n## {TIER_TEXT[tier]}\n\n{len(results)} renders. " + lost(results))
            out.write(table_of(results, DISC_QUANTITIES if tier == "discs" else FOIL_QUANTITIES))


if __name__ == "__main__":
    main()
