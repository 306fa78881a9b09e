"""How well the strip's thickness is measured, and whether its uncertainty says so: foils of accuracy_specs.py are
rendered, measured and held against the 0.1 mm that they were drawn with.

Usage: thickness.py PROGRAM [--count N]; writes reports/thickness.md."""

import argparse
import json
import math
import os
import subprocess
import tempfile

import numpy as np

import accuracy_specs

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SEED, TRUE_MM = 99, 0.1


def measure(program, folder, tier, index):
    """Error and uncertainty of the thickness, um, and the relative error of gamma."""
    spec, record = accuracy_specs.TIERS[tier].make(np.random.default_rng([SEED, index]), index)
    paths = {name: os.path.join(folder, name) for name in ("spec.json", "scan.png", "out.json")}
    with open(paths["spec.json"], "w", encoding="utf-8") as file:
        json.dump(spec, file)
    subprocess.run([program, "render", paths["spec.json"], "-o", paths["scan.png"]], check=True, capture_output=True)
    subprocess.run([program, "measure", paths["scan.png"], "-o", paths["out.json"]], capture_output=True)
    with open(paths["out.json"], encoding="utf-8") as file:
        foil = json.load(file)["foils"][0]
    tone = math.log(foil["strip"]["gamma"] / record["gamma"])
    return 1000 * (foil["thickness_mm"] - TRUE_MM), 1000 * foil["u_thickness_mm"], tone


def row_of(program, folder, tier, title, count):
    found = np.array([measure(program, folder, tier, i) for i in range(count)])
    error, u, tone = found.T
    rms = lambda v: float(np.sqrt(np.mean(v**2)))
    within = 100 * np.mean(np.abs(error) <= 2 * u)
    return (f"| {title} | {count} | {rms(error):.3g} | {np.median(u):.3g} | {within:.0f} | {np.max(np.abs(error / u)):.1f} | "
            f"{100 * rms(tone):.2g} |")


TEXT = """# The strip's thickness

Foils with 0.1 mm thick strips, rendered at 4800 dpi as for reports/accuracy.md (seed {seed}); `python3 tests/bench/thickness.py
build/foilgauge` makes this page. Errors in µm; `gamma`: relative rms error of the tone curve's exponent that was found.

| foils | scans | rms error | median u | within 2u, % | largest error over u | gamma, % |
|---|---|---|---|---|---|---|
{rows}

Both edges lie where the light is half of what it is on either side, so an error of the tone curve makes the strip wider or
narrower on both sides at once, the same all along it: u holds what the profiles leave in doubt of gamma, and where halo, wall or
clipping shape the edges (flags `rough_edge`, `side_band`, `clipped`) a relative doubt of 0.23, the error that rough scans show.
Radii and heights are of the midline and do not change with it. A wall that shows beside one edge along the whole foil and is
not recognised as one (no `side_band`) takes more: the strip can come out 10 % thin, far outside its u.
"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=32)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [row_of(options.program, folder, tier, title, count) for tier, title, count in
                (("clean", "clean", options.count // 2), ("rough", "rough, as real scans are", options.count))]
    with open(os.path.join(ROOT, "reports", "thickness.md"), "w", encoding="utf-8") as file:
        file.write(TEXT.format(seed=SEED, rows="\n".join(rows)))


if __name__ == "__main__":
    main()
