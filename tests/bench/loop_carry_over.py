# SPDX-License-Identifier: GPL-3.0-or-later
"""A scanner's errors, found on one thing, taken out of the scans of others.

Usage: loop_carry_over.py PROGRAM [--scanners N] [--seed S] [--threads N]; writes reports/loop_carry_over.csv and .md.

Every scanner has its own scale, shear, ripple and row step. Its model is found (`foilgauge loop --model-out`) on one foil,
on a foil that was turned by 90 degrees in between, on three foils, and on a plate of twelve pin gauges of known diameters;
then three other foils are measured on it with `foilgauge measure --model`."""

import argparse
import csv
import json
import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from loop_cases import GEN2, draw_foil, draw_scanner, extent_mm, log_uniform
from loop_run import MM_PER_PX, NOT_MEASURED_UM, errors_um, pair_bumps, pair_foils, render, write_design

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SIDE_MM = 46.0
SOURCES = {
    "foil": "one foil",
    "pair": "one foil, turned by 90°",
    "foils": "three foils",
    "plate": "a plate of 12 pin gauges",
}
QUANTITIES = ("R", "h", "R0")


def draw_effects(rng):
    sign = lambda: float(rng.choice([-1, 1]))
    return [
        {"id": "scan.scale_y", "value": sign() * log_uniform(rng, 8, 25) / 18000},
        {"id": "scan.shear", "value": sign() * log_uniform(rng, 8, 25) / 18000},
        {"id": "scan.carriage_ripple", "amplitude_um": log_uniform(rng, 3, 10),
         "period_mm": log_uniform(rng, 1.5, 5), "phase_deg": float(rng.uniform(-180, 180))},
        {"id": "scan.row_step", "amplitude_um": sign() * log_uniform(rng, 5, 30),
         "y_mm": float(SIDE_MM * rng.uniform(0.4, 0.6))},
    ]  # fmt: skip


def put(rng, foil):
    """About the middle of the glass, a little beside it."""
    x, y = extent_mm([foil])[0]
    foil["centre_mm"] = [
        float(SIDE_MM / 2 - (axis[0] + axis[1]) / 2 + rng.uniform(-0.7, 0.7)) for axis in (x, y)
    ]
    return foil


def spec_of(rng, scanner, effects, **content):
    pixels = int(SIDE_MM / MM_PER_PX)
    return {
        "schema": "foilgauge/render/1", "seed": int(rng.integers(1, 2**31)), "width_px": pixels,
        "height_px": pixels, "scanner": scanner, "effects": effects, **content,
    }  # fmt: skip


def draw_plate(rng):
    """Twelve pins of 4 to 8 mm in four columns, every second lower by half a step: a row step crosses
    pins wherever it is. The design tells their diameters."""
    diameters = [float(d) for d in rng.permutation(np.round(np.linspace(4, 8, 12), 4))]
    discs = []
    for k, diameter in enumerate(diameters):
        x, y = 6.5 + 11 * (k % 4), 6.5 + 13 * (k // 4) + 6.5 * (k % 2)
        centre = [float(v + rng.uniform(-0.5, 0.5)) for v in (x, y)]
        discs.append({"centre_mm": centre, "radius_mm": diameter / 2})
    return discs, {"name": "pin gauges", "form": "discs", "diameters_mm": diameters}


def sources(rng, scanner, effects):
    """{name: (specs, design, options)} of what a model is found on."""
    draw = lambda: put(rng, draw_foil(rng, GEN2))
    one = draw()
    turned = put(rng, {**one, "rotate_deg": one["rotate_deg"] + 90})
    discs, plate = draw_plate(rng)
    specs = lambda foils: [spec_of(rng, scanner, effects, foils=[f]) for f in foils]
    return {
        "foil": (specs([one]), GEN2, []),
        "pair": (specs([one, turned]), GEN2, ["--same-foil"]),
        "foils": (specs([draw() for _ in range(3)]), GEN2, []),
        "plate": ([spec_of(rng, scanner, effects, foils=[], discs=discs)], plate, []),
    }


def find_model(program, folder, name, specs, design, options):
    """(path of the model or None, what the loop said)."""
    own = os.path.join(folder, name)
    os.makedirs(own)
    paths = render(program, own, specs)
    model, report = os.path.join(own, "model.json"), os.path.join(own, "loop.json")
    command = [program, "loop", *paths, "--design", write_design(own, design), *options]
    done = subprocess.run([*command, "-o", report, "--model-out", model], capture_output=True, text=True)
    if done.returncode not in (0, 1, 2, 3) or not os.path.exists(report):
        return None, "failed: " + (done.stderr.strip().split("\n")[-1] or str(done.returncode))[-80:]
    with open(report, encoding="utf-8") as f:
        answer = json.load(f)
    said = [c["id"] for c in answer["claims"]]
    if answer["unattributed"]:
        said.append("unattributed over " + answer["unattributed"]["coordinate"])
    return (model if os.path.exists(model) else None), " + ".join(sorted(said)) or answer["verdict"]


def measure(program, folder, case, path, model):
    """(errors, share of R and h within U = 2 u)."""
    out = os.path.join(folder, "measure.json")
    command = [program, "measure", path, "--design", write_design(folder, case["design"]), "-o", out]
    done = subprocess.run(command + (["--model", model] if model else []), stderr=subprocess.DEVNULL)
    if done.returncode not in (0, 1, 2, 3):
        return dict.fromkeys(QUANTITIES, NOT_MEASURED_UM), float("nan")
    with open(out, encoding="utf-8") as f:
        pairs = pair_foils(case, json.load(f)["foils"])
    held = []
    for midline, centre, foil in pairs or []:
        for i, bump in pair_bumps(midline, centre, foil):
            held.append(abs(bump["radius_mm"] - midline.measurand.radius[i]) <= 2 * bump["u_radius_mm"])
            held.append(abs(bump["height_mm"] - midline.measurand.height[i]) <= 2 * bump["u_height_mm"])
    return errors_um(pairs), float(np.mean(held)) if held else float("nan")


def run_scanner(program, seed, index):
    rng = np.random.default_rng([seed, index])
    scanner, effects = draw_scanner(rng, index), draw_effects(rng)
    made = sources(rng, scanner, effects)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        models = {name: find_model(program, folder, name, *source) for name, source in made.items()}
        for k in range(3):
            foil = put(rng, draw_foil(rng, GEN2))
            case = {"design": GEN2, "specs": [spec_of(rng, scanner, effects, foils=[foil])]}
            path = render(program, folder, case["specs"])[0]
            before, held = measure(program, folder, case, path, None)
            for name, (model, said) in models.items():
                row = {"scanner": index, "source": name, "foil": k, "said": said}
                after, held_after = before, held
                if model:
                    after, held_after = measure(program, folder, case, path, model)
                for q in QUANTITIES:
                    row[q + "_before_um"] = float(f"{before[q]:.5g}")
                    row[q + "_after_um"] = float(f"{after[q]:.5g}")
                row.update(within_before=round(held, 3), within_after=round(held_after, 3))
                row["effects"] = json.dumps(effects, separators=(",", ":"))
                rows.append(row)
    return rows


def summary(rows, name):
    own = [r for r in rows if r["source"] == name]
    cells = [SOURCES[name]]
    for q in QUANTITIES:
        before, after = (np.array([r[f"{q}_{side}_um"] for r in own]) for side in ("before", "after"))
        ratio = before / np.maximum(after, 1e-4)
        cells += [f"{np.median(before):.3g} → {np.median(after):.3g}", f"{np.median(ratio):.1f}"]
        cells.append(f"{100 * np.mean(ratio >= 10):.0f}")
    within = [100 * np.nanmean([r[side] for r in own]) for side in ("within_before", "within_after")]
    return cells + [f"{within[0]:.0f} → {within[1]:.0f}"]


def write_report(rows, options):
    with open(os.path.join(options.out, "loop_carry_over.csv"), "w", newline="", encoding="utf-8") as f:
        writer = csv.DictWriter(f, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    header = ["model found on"]
    for q in QUANTITIES:
        header += [f"error of {q}, µm (median)", "median ×", "≥ 10 × %"]
    header.append("R and h within U, %")
    lines = [
        "# A scanner's model, carried over to other foils", "",
        f"Made by `python3 tests/bench/loop_carry_over.py build/foilgauge --scanners {options.scanners} --seed "
        f"{options.seed}`.", "",
        f"{options.scanners} rendered scanners, each with a scale error and a shear of 8 to 25 µm at 18 mm, a ripple of the",
        "carriage of 3 to 10 µm and 1.5 to 5 mm, and a row step of 5 to 30 µm. On each a model is found on four things, and",
        "three other foils are measured with it. Errors are against the truth of the render, rms over the bumps of a foil.",
        "Pins are known by their diameters, not by their places.", "",
        "| " + " | ".join(header) + " |", "|" + "---|" * len(header),
    ]  # fmt: skip
    lines += ["| " + " | ".join(summary(rows, name)) + " |" for name in SOURCES]
    lines += ["", "What the loop said (there: scale_y, shear, carriage_ripple, row_step):", ""]
    lines += ["| scanner | model found on | said |", "|---|---|---|"]
    for r in rows:
        if r["foil"] == 0:
            lines.append(f"| {r['scanner']} | {SOURCES[r['source']]} | {r['said']} |")
    with open(os.path.join(options.out, "loop_carry_over.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("wrote loop_carry_over.md and .csv")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--scanners", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", default=os.path.join(ROOT, "reports"))
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    work = lambda k: run_scanner(os.path.abspath(options.program), options.seed, k)
    with ThreadPoolExecutor(options.threads) as pool:
        rows = [row for part in pool.map(work, range(options.scanners)) for row in part]
    write_report(rows, options)


if __name__ == "__main__":
    main()
