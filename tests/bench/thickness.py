# SPDX-License-Identifier: GPL-3.0-or-later
"""Error of the strip's measured thickness, and whether its uncertainty covers it: foils of accuracy_specs.py are
rendered, measured and held against the 0.1 mm that they were drawn with, as scanned, with a tone that is stated as
linear, and with a micrometer's value.

Usage: thickness.py PROGRAM [--count N]; writes reports/thickness.md."""

import argparse
import json
import os
import subprocess
import tempfile

import numpy as np

import accuracy_specs

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SEED, TRUE_MM, U_MICROMETER_MM = 99, 0.1, 0.0005


def render(program, folder, spec):
    paths = [os.path.join(folder, name) for name in ("spec.json", "scan.png")]
    with open(paths[0], "w", encoding="utf-8") as file:
        json.dump(spec, file)
    subprocess.run([program, "render", paths[0], "-o", paths[1]], check=True, capture_output=True)
    return paths[1]


def measure(program, folder, scan, *options):
    """Error and uncertainty of the thickness in force, um; whether a flag is up that touches it."""
    out = os.path.join(folder, "out.json")
    subprocess.run([program, "measure", scan, *options, "-o", out], capture_output=True)
    with open(out, encoding="utf-8") as file:
        foil = json.load(file)["foils"][0]
    contradicts = "thickness_contradicts" in foil["flags"]
    return 1000 * (foil["thickness_mm"] - TRUE_MM), 1000 * foil["u_thickness_mm"], contradicts


def of_foil(program, folder, tier, index):
    """The same foil as scanned, with a micrometer, and from a scanner without a tone curve, which is stated."""
    spec, _ = accuracy_specs.TIERS[tier].make(np.random.default_rng([SEED, index]), index)
    scan = render(program, folder, spec)
    read_mm = TRUE_MM + U_MICROMETER_MM * np.random.default_rng([SEED, index, 1]).standard_normal()
    found = [measure(program, folder, scan),
             measure(program, folder, scan, "--thickness-measured", f"{read_mm:.6f}:{U_MICROMETER_MM}")]
    spec["scanner"].pop("gamma", None)
    found.append(measure(program, folder, render(program, folder, spec), "--tone", "linear"))
    return found


def rows_of(program, folder, tier, title, count):
    found = np.array([of_foil(program, folder, tier, i) for i in range(count)], float)
    ways = ("as scanned", "with a micrometer (u 0.5 µm)", "tone linear, as stated")
    for way, (error, u, contradicts) in zip(ways, found.transpose(1, 2, 0)):
        yield (f"| {title} | {way} | {count} | {np.sqrt(np.mean(error**2)):.3g} | {np.median(u):.3g} | "
               f"{100 * np.mean(np.abs(error) <= 2 * u):.0f} | {np.max(np.abs(error / u)):.1f} | {int(contradicts.sum())} |")


TEXT = """# The strip's thickness

Foils with 0.1 mm thick strips, rendered at 4800 dpi as for reports/accuracy.md (seed {seed}); `python3 tests/bench/thickness.py
build/foilgauge` makes this page. Errors in µm, of the thickness in force.

| foils | what is known | scans | rms error | median u | within 2u, % | largest error over u | `thickness_contradicts` |
|---|---|---|---|---|---|---|---|
{rows}

Both edges lie where the light is half of what it is on either side, so a tone curve makes the strip wider or narrower on both
sides at once, the same all along it and in every foil. Edges alone do not tell it: u holds the range of tone curves that
scanners and their drivers have, 8 % of the contrast (`src/geometry/level_uncertainty.c`). These renders have a power of the light at the
most, which is found; so the errors of the first row are far smaller than u. What makes the tone known makes u small: the strip's thickness by a micrometer (`thickness_measured`),
or a tone that is linear and stated as such (`tone`). Radii and heights are of the midline and do not change with it.
A wall that shows beside one edge along the whole foil and is not recognised as one takes more: the strip then comes out thin
by more than its u where the tone is stated as linear.
"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=32)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [row for tier, title, count in (("clean", "clean", options.count // 2),
                                               ("rough", "rough, as real scans are", options.count))
                for row in rows_of(options.program, folder, tier, title, count)]
    with open(os.path.join(ROOT, "reports", "thickness.md"), "w", encoding="utf-8") as file:
        file.write(TEXT.format(seed=SEED, rows="\n".join(rows)))


if __name__ == "__main__":
    main()
