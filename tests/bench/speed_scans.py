#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""speed_scans.py PROGRAM FOLDER: renders scans like those whose truth is in tests/data/truth, of the same size, turn, contrast, blur
and noise, with their truth beside them; the last two by a rough scanner, the last one with a side wall. Of the scanner effects of two of
them nothing is rendered: they cost no time."""

import glob
import json
import os
import subprocess
import sys

import benchlib

TRUTHS = os.path.join(benchlib.ROOT, "tests", "data", "truth", "p*.truth.json")
ROUGH = {
    "gamma": 1.2, "noise_correlation": 0.6, "dust": {"count": 60, "radius_px": 4, "contrast": 60},
    "shading": {"x": 0.03, "y": -0.02, "quadratic": -0.04},
    "rough": {"one_sided_blur_px": 1.8, "edge_roughness_um": 1.4, "edge_common_um": 0.7, "correlation_um": 50,
              "halo": {"fraction": 0.15, "length_px": 15}},
}  # fmt: skip
WALL = {"amplitude": 0.35, "direction_deg": 90, "length_px": 8, "gap_px": 2}
DESIGN = ("bump_radius_mm", "bump_angle_deg", "bump_count", "overall_radius_mm", "fillet_radius_mm", "thickness_mm")


def spec_of(name, truth):
    scan = truth["scan"]
    scanner = {"dpi": 4800, "bits": 16 if "16bit" in name else 8, "background": 30 if scan["contrast"] > 0 else 205,
               "contrast": scan["contrast"], "blur_px": scan["blur_px"], "noise": scan["noise"]}  # fmt: skip
    if "rough" in name or "side_wall" in name:
        scanner.update(ROUGH)
    if "side_wall" in name:
        scanner["rough"] = {**ROUGH["rough"], "side_wall": WALL}
    design = {key: truth["design"][key] for key in DESIGN if key in truth["design"]}
    foil = {"design": design, "overall_radius_mm": truth["overall_radius_mm"], "rotate_deg": scan["rotate_deg"],
            "radius_mm": [bump["radius_mm"] for bump in truth["bumps"]]}  # fmt: skip
    return {"schema": "foilgauge/render/1", "seed": 3, "foils": [foil], "scanner": scanner}


def render_all(program, folder):
    """Paths of the scans; those that are there already stay."""
    os.makedirs(folder, exist_ok=True)
    scans = []
    for path in sorted(glob.glob(TRUTHS)):
        name = os.path.basename(path)[: -len(".truth.json")]
        base = os.path.join(folder, name)
        scans.append(base + ".png")
        if os.path.exists(base + ".png"):
            continue
        with open(base + ".json", "w", encoding="utf-8") as out:
            json.dump(spec_of(name, benchlib.load(path)), out)
        subprocess.run([program, "render", base + ".json", "-o", base + ".png", "-t", base + ".truth.json"], check=True)
    return scans


if __name__ == "__main__":
    render_all(*sys.argv[1:3])
