#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coverage of U = 1.96 u where the scanner's pitch and the part's temperature differ from their assumed
values: writes reports/calibration.md.

Every scan is rendered with an error of the pitch (and, of the second tier, another one along y) that is
drawn from the uncertainty that the calibration states, and measured with that calibration, with one that
states temperature and expansion too, and without any.
"""

import argparse
import json
import multiprocessing
import os
import subprocess
import tempfile

import numpy as np

import benchlib

DPI = 1200
U_SCALE, U_AXIS = 2e-4, (2e-4, 4e-4)
T, U_T, EXPANSION, U_EXPANSION = 28.0, 2.0, 1.7e-5, 2e-6
BUMP = [("radius_mm", "R"), ("height_mm", "h"), ("bump_angle_deg", "alpha"), ("clearance_mm", "clearance")]
K95 = 1.96


def calibration(tier):
    if tier == "axes":
        return {"scale": {"x": {"u_rel": U_AXIS[0]}, "y": {"u_rel": U_AXIS[1]}}}
    return {
        "scale": {"U_rel": 2 * U_SCALE, "k": 2},
        "temperature": {"value_C": T, "u_K": U_T},
        "expansion": {"value_per_K": EXPANSION, "u_per_K": U_EXPANSION},
    }


def draw(tier, rng):
    """(factor of lengths along x, the same along y over that along x)"""
    if tier == "axes":
        x, y = 1 + U_AXIS[0] * rng.standard_normal(), 1 + U_AXIS[1] * rng.standard_normal()
        return x, y / x
    warmer = (EXPANSION + U_EXPANSION * rng.standard_normal()) * (T + U_T * rng.standard_normal() - 20)
    return (1 + U_SCALE * rng.standard_normal()) * (1 + warmer), 1


def run(task):
    tier, seed = task
    rng = np.random.default_rng([20, tier == "axes", seed])
    x, y_over_x = draw(tier, rng)
    spec = {
        "schema": "foilgauge/render/1",
        "seed": seed + 1,
        "foils": [{"rotate_deg": rng.uniform(0, 360), "radius_springback": {"mean": 0.02, "sd": 0.007}}],
        "scanner": {"dpi": DPI, "blur_px": 1.2, "noise": 2.0},
    }
    if y_over_x != 1:  # the carriage's way is longer: the scanned part is shorter in rows
        spec["effects"] = [{"id": "scan.scale_y", "value": 1 / y_over_x - 1}]
    with tempfile.TemporaryDirectory() as folder:
        path = lambda name: os.path.join(folder, name)
        json.dump(spec, open(path("spec.json"), "w"))
        subprocess.run([benchlib.FOILGAUGE, "render", path("spec.json"), "-o", path("scan.png"), "--truth", path("truth.json")], check=True)
        truth, found = benchlib.load_truth(path("truth.json")), {}
        for name, stated in (("none", None), ("stated", calibration(tier))):
            json.dump({"schema": "foilgauge/design/1", "calibration": stated}, open(path("d.json"), "w"))
            subprocess.run(
                [benchlib.FOILGAUGE, "measure", path("scan.png"), "--design", path("d.json"), "--dpi", repr(DPI / x), "--threads", "1", "-o", path("m.json")],
                stderr=subprocess.DEVNULL,
            )
            found[name] = json.load(open(path("m.json")))["foils"][0]
    return [record(found[name], truth) for name in ("none", "stated")]


def record(foil, truth):
    """quantity: [(error, u), ...]"""
    out = {"R0": [(foil["overall"]["radius_mm"] - truth["overall_radius_mm"], foil["overall"]["u_radius_mm"])]}
    design = truth["design"]
    for bump, true in zip(foil["bumps"], truth["bumps"]):
        room = design["sleeve_radius_mm"] - design["rotor_diameter_mm"] / 2 - truth["thickness_mm"]
        true = {**true, "clearance_mm": room - true["height_mm"]}
        for member, name in BUMP:
            out.setdefault(name, []).append((bump[member] - true[member], bump["u_" + member]))
    return out


def table(rows, names):
    lines = ["| what | n | none stated: rms error | rms u | covered, % | stated: rms error | rms u | covered, % |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name in names:
        cells = []
        for kind in (0, 1):
            pairs = np.array([p for r in rows for p in r[kind].get(name, [])])
            errors = pairs[:, 0]
            cells.append((np.sqrt(np.mean(errors**2)), np.sqrt(np.mean(pairs[:, 1] ** 2)), 100 * np.mean(np.abs(errors) <= K95 * pairs[:, 1]), len(pairs)))
        unit, factor = ("deg", 1) if name == "alpha" else ("µm", 1000)
        lines.append(
            f"| {name} ({unit}) | {cells[1][3]} | {factor * cells[0][0]:.3g} | {factor * cells[0][1]:.3g} | {cells[0][2]:.1f} "
            f"| {factor * cells[1][0]:.3g} | {factor * cells[1][1]:.3g} | {cells[1][2]:.1f} |"
        )
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--foils", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("-o", default=os.path.join(benchlib.ROOT, "reports", "calibration.md"))
    options = parser.parse_args()
    names = ["R0"] + [name for _, name in BUMP]
    version = subprocess.run([benchlib.FOILGAUGE, "--version"], capture_output=True, text=True).stdout.strip()
    parts = [
        "# What the statistics cannot know",
        f"Made by `tests/bench/calibration.sh` with {version}.\n\n"
        f"{options.foils} rendered foils in each tier, any rotation, {DPI} dpi. Every scan has its own error of the pitch, drawn\n"
        "from what the calibration states. Covered: how many of the intervals value ± 1.96 u hold the truth. All bumps of\n"
        f"a foil share the error, so it is the {options.foils} foils that the share's own error goes by: 95 % of {options.foils} is known to ± {100 * 2 * (0.95 * 0.05 / options.foils) ** 0.5:.1f} %.",
    ]
    with multiprocessing.Pool(options.jobs) as pool:
        for tier, title in (
            ("one", f"## One scale, and a warm part\n\nu of the scale {U_SCALE:g}; {T:g} °C ± {U_T:g} K, {EXPANSION:g} ± {U_EXPANSION:g} per K (standard uncertainties). Without a\ncalibration the part's {1e6 * EXPANSION * (T - 20):.0f} ppm are an error as well."),
            ("axes", f"## Each axis by itself\n\nu of the scale along x {U_AXIS[0]:g}, along y {U_AXIS[1]:g}: angles move as well."),
        ):
            rows = pool.map(run, [(tier, seed) for seed in range(options.foils)], chunksize=4)
            parts.append(title + "\n\n" + table(rows, names))
    with open(options.o, "w", encoding="utf-8") as file:
        file.write("\n\n".join(parts) + "\n")


if __name__ == "__main__":
    main()
