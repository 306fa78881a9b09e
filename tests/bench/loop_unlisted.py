#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop on scans whose cause no row of its table names: renders without an effect, warped by any field of a scanner
or any deviation of a part, measured by the program; its claims, and R0 and R before and after.

    tests/bench/loop_unlisted.py build/foilgauge --seeds 1 2 --out reports

The warp knows nothing of the program: true place = nominal place + field, by cubic splines over the picture."""

import argparse
import csv
import json
import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from loop_cases import GEN2
from loop_foil import measurand_of
from scipy import ndimage
from skimage import io

MM = 25.4 / 4800
# Listed effects that are the cause itself, cut into pieces: a ripple that grows, a stair of rows, gaps of chips.
ALSO_RIGHT = {
    "ripple_growth": {"scan.carriage_ripple"},
    "stairs": {"scan.row_step"},
    "chip_gap": {"scan.column_step"},
    "slip": {"scan.row_step"},
}


def draw_foil(rng):
    scatter = rng.uniform(0.005, 0.02)
    return {
        "overall_radius_mm": 20.73 * (1 + rng.uniform(0.002, 0.02)),
        "radius_mm": [float(3.32 * (1.015 + scatter * rng.standard_normal())) for _ in range(9)],
        "rotate_deg": float(rng.uniform(-180, 180)),
        "mirror": bool(rng.integers(0, 2)),
    }


def draw_spec(rng, foil, turn_deg, rough):
    scanner = {"dpi": 4800, "blur_px": float(rng.uniform(1.0, 2.0)), "noise": 1.0}
    if rough:
        scanner["rough"] = {"edge_roughness_um": 1.2, "edge_common_um": 0.6, "correlation_um": float(rng.uniform(15, 60)),
                            "correlation_form": str(rng.choice(["gaussian", "exponential"]))}  # fmt: skip
    foil = {**foil, "rotate_deg": foil["rotate_deg"] + turn_deg}
    return {"schema": "foilgauge/render/1", "seed": int(rng.integers(1e9)), "foils": [foil], "scanner": scanner}


def saw(at):
    return at - np.floor(at) - 0.5


def scanner_fields(rng, width, height, a):
    """Kinds of fields, mm, of an amplitude `a` in mm: (x, y) to (dx, dy)."""
    cx, cy, sign = width / 2, height / 2, rng.choice([-1, 1])
    pitch, period, phase = rng.uniform(0.25, 0.4) * width, float(np.exp(rng.uniform(np.log(3), np.log(9)))), rng.uniform(0, 6.28)
    first = rng.uniform(0, pitch)
    waves, sizes, phases = rng.uniform(0.1, 0.35, (6, 2)), rng.standard_normal((2, 6)), rng.uniform(0, 6.28, 6)
    places, signs = np.sort(rng.uniform(0.1 * height, 0.9 * height, 3)), rng.choice([-1, 1], 3)
    turn = 2 * np.pi / (1.3 * height)

    def glass(x, y):
        dx = sum(s * np.sin(u * x + v * y + p) for s, (u, v), p in zip(sizes[0], waves, phases))
        dy = sum(s * np.cos(v * x - u * y + p) for s, (u, v), p in zip(sizes[1], waves, phases))
        return 0.7 * a * dx, 0.7 * a * dy

    def barrel(x, y):
        square = ((x - cx) / cx) ** 2 + ((y - cy) / cy) ** 2
        return 1.5 * a * sign * (x - cx) / cx * square, 1.5 * a * sign * (y - cy) / cx * square

    return {
        "chip_tilt": lambda x, y: (0 * x, 2 * a * sign * saw((x - first) / pitch)),
        "chip_gap": lambda x, y: (a * sign * np.floor((x - first) / pitch), 0 * y),
        "keystone": lambda x, y: (a * sign * (x - cx) * (y - cy) / (cx * cy), 0 * y),
        "yaw": lambda x, y: (a * np.sin(turn * y + phase), a * (x - cx) / cx * np.cos(turn * y + phase)),
        "ripple_growth": lambda x, y: (0 * x, a * sign * y / height * np.sin(2 * np.pi * y / period + phase)),
        "quintic": lambda x, y: (1.5 * a * sign * ((x - cx) / cx) ** 5, 0 * y),
        "barrel": barrel,
        "glass": glass,
        "stairs": lambda x, y: (0 * x, a * sum(s * (y > at) for s, at in zip(signs, places))),
        "slip": lambda x, y: (0 * x, 2 * a * sign * np.clip(3 * saw(y / (2.2 * period) + phase), -0.5, 0.5)),
        "drift": lambda x, y: (a * sign * (x - cx) / cx * np.tanh((y - cy) / (0.3 * height)), 0 * y),
    }


def part_deviations(rng, a):
    """Kinds of radial deviations, mm: (radius, direction about O in the part's frame) to mm outwards."""
    sign, n, phase = rng.choice([-1, 1]), int(rng.integers(3, 6)), rng.uniform(0, 6.28)
    period, bump = float(np.exp(rng.uniform(np.log(3), np.log(9)))), np.radians(40 / 3) * int(rng.integers(-3, 4))
    return {
        "lobes": lambda r, t: a * sign * np.cos(n * t - phase),
        "waves": lambda r, t: a * sign * np.sin(2 * np.pi * 20.9 * t / period + phase),
        "dent": lambda r, t: a * np.exp(-((np.angle(np.exp(1j * (t - bump))) * 21 / 0.5) ** 2)) * np.clip((20.85 - r) / 0.2, 0, 1),
    }


def warp(picture, displace):
    """Pixels near edges show what lies at their place plus `displace` of it, mm."""
    coarse = picture[::4, ::4].astype(np.float32)
    near = ndimage.maximum_filter(coarse, 5) - ndimage.minimum_filter(coarse, 5) > 12
    near = np.kron(ndimage.binary_dilation(near, iterations=4), np.ones((4, 4), bool))[: picture.shape[0], : picture.shape[1]]
    rows, columns = np.nonzero(near)
    dx, dy = displace((columns + 0.5) * MM, (rows + 0.5) * MM)
    out = picture.astype(np.float32)
    splines = ndimage.spline_filter(out, order=3, output=np.float32)
    at = [rows + dy / MM, columns + dx / MM]
    out[rows, columns] = ndimage.map_coordinates(splines, at, order=3, prefilter=False, mode="nearest")
    return np.clip(np.rint(out), 0, 255).astype(np.uint8)


KINDS = [*scanner_fields(np.random.default_rng(0), 40, 40, 1), *part_deviations(np.random.default_rng(0), 1)]


def make_scan(program, path, spec, kind, a, seed):
    with open(path + ".json", "w", encoding="utf-8") as out:
        json.dump(spec, out)
    subprocess.run([program, "render", path + ".json", "-o", path + ".png", "--truth", path + ".truth"], check=True)
    with open(path + ".truth", encoding="utf-8") as text:
        truth = json.load(text)
    ox, oy = (v * MM for v in truth["overall_centre_px"])
    rng = np.random.default_rng(seed)  # the same scanner, or part, for both scans of a pair
    fields, deviations = scanner_fields(rng, 38, 38, a), part_deviations(rng, a)
    turn = np.radians(spec["foils"][0]["rotate_deg"])

    def deviate(x, y):
        r = np.hypot(x - ox, y - oy)
        d = deviations[kind](r, np.arctan2(y - oy, x - ox) - turn)
        return -d * (x - ox) / r, -d * (y - oy) / r

    io.imsave(path + ".png", warp(io.imread(path + ".png"), fields.get(kind, deviate)), check_contrast=False)


def radii_of_part_um(foil, kind, a, seed):
    """R0 and R of the measurand: circles through the part as it is. The scanner's fields leave it as it was drawn."""

    def deviate_um(midline):
        deviations = part_deviations(after_fields(seed, a), a)
        if kind not in deviations:
            return np.zeros(len(midline.xy))
        return 1000 * deviations[kind](np.linalg.norm(midline.xy, axis=1), midline.mirror * midline.psi) * midline.radial_share()

    measurand = measurand_of({**foil, "first_land_mm": 1.8, "last_land_mm": 1.3}, GEN2, deviate_um)
    return 1000 * np.array([measurand.overall, *measurand.radius])


def after_fields(seed, a):
    """The random numbers of a cause, once its scanner's fields are drawn."""
    rng = np.random.default_rng(seed)
    scanner_fields(rng, 38, 38, a)
    return rng


def radii_um(foil):
    values = [foil["overall"], *foil["bumps"]]
    return np.array([[v["radius_mm"], v["u_radius_mm"]] for v in values], dtype=float).T * 1000


def run_case(program, seed, index):
    kind, rng = KINDS[index], np.random.default_rng([seed, index])
    rough, pair, um = (index + seed) % 2 == 1, (index + seed) % 3 == 0, [5, 10, 20][(7 * index + seed) % 3]
    foil, turns = draw_foil(rng), [0.0, float(rng.choice([45, 90]))] if pair else [0.0]
    with tempfile.TemporaryDirectory() as folder:
        paths = [os.path.join(folder, f"s{k}") for k in range(len(turns))]
        for path, turn in zip(paths, turns):
            make_scan(program, path, draw_spec(rng, foil, turn, rough), kind, um / 1000, [seed, index, 1])
        options = ["--same-foil"] if pair else []
        subprocess.run([program, "loop", "--dpi=4800", *options, *(p + ".png" for p in paths), "-o", folder + "/r"], capture_output=True, check=True)
        with open(folder + "/r", encoding="utf-8") as text:
            report = json.load(text)
    found = {c["id"] for c in report["claims"] if c["verdict"] == "found" and not c["id"].startswith("free.")}
    (before, _), (after, u) = (radii_um(report[side]["foils"][0]) for side in ("before", "after"))
    wanted = radii_of_part_um(foil, kind, um / 1000, [seed, index, 1])
    rms = [float(np.sqrt(np.mean((side - wanted)[1:] ** 2))) for side in (before, after)]
    wrong = found - ALSO_RIGHT.get(kind, set())
    return {"seed": seed, "kind": kind, "um": um, "edges": "rough" if rough else "ideal", "scans": len(turns),
            "verdict": report["verdict"], "found": " ".join(sorted(found)), "wrong": int(bool(wrong)),
            "R0 before": round(before[0] - wanted[0], 1), "R0 after": round(after[0] - wanted[0], 1), "u R0": round(u[0], 1),
            "R before": round(rms[0], 2), "R after": round(rms[1], 2), "u R": round(float(np.mean(u[1:])), 2),
            "R0 worse": int(worse(before[0] - wanted[0], after[0] - wanted[0], u[0])), "R worse": int(worse(rms[0], rms[1], np.mean(u[1:])))}  # fmt: skip


def worse(before, after, u):
    """Worse than before beyond noise."""
    return abs(after) > abs(before) + 2 * u


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--out", default="reports")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    jobs = [(seed, index) for seed in options.seeds for index in range(len(KINDS))]
    with ThreadPoolExecutor(2) as pool:
        rows = list(pool.map(lambda job: run_case(program, *job), jobs))
    with open(os.path.join(options.out, "loop_unlisted.csv"), "w", encoding="utf-8", newline="") as out:
        table = csv.DictWriter(out, rows[0])
        table.writeheader()
        table.writerows(rows)
    write_page(os.path.join(options.out, "loop_unlisted.md"), rows, options.seeds)


def write_page(path, rows, seeds):
    count, wrong = len(rows), sum(r["wrong"] for r in rows)
    lines = ["# Causes that no row names", "",
             f"`tests/bench/loop_unlisted.py build/foilgauge --seeds {' '.join(map(str, seeds))}`: {count} inputs of {len(KINDS)} kinds, renders without an effect",
             "that are warped by a field of the scanner or a deviation of the part (5, 10 and 20 µm; radii that scatter by 0.5 to 2 %).", "",
             f"A wrong listed effect is `found` in {wrong} of {count}. R0 is worse than before by more than 2 u in {sum(r['R0 worse'] for r in rows)},",
             f"R in {sum(r['R worse'] for r in rows)}. Errors in µm; R: rms over the bumps. Errors are against the measurand: circles through the part as it is.", "",
             "| kind | µm | edges | scans | verdict | found | R0 before, after ± u | R before, after, u |", "|---|---:|---|---:|---|---|---:|---:|"]  # fmt: skip
    for r in rows:
        lines.append(f"| {r['kind']} | {r['um']} | {r['edges']} | {r['scans']} | {r['verdict']} | {r['found'] or '–'} | {r['R0 before']} → {r['R0 after']} ± {r['u R0']} "
                     f"| {r['R before']} → {r['R after']}, {r['u R']} |")  # fmt: skip
    with open(path, "w", encoding="utf-8") as out:
        out.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
