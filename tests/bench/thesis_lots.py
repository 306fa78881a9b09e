# SPDX-License-Identifier: GPL-3.0-or-later
"""thesis_lots.py FOLDER DPI: specs of the thesis's sinusoidal lot, 6 foils of 9 bumps (figure 5.22).

The normalised bump radius has its mean at 1.0096 and a relative standard deviation of 1.7 %, and lies in 0.95 to 1.068:
a normal distribution cut off there. The 54 radii are its quantiles at i / 53, the ends among them, shuffled; its standard
deviation is the one that gives these 54 numbers 1.7 %. The arc length is the design's. Beside the specs a manifest
and the design.
"""

import json
import pathlib
import random
import statistics
import sys

MEAN, RELATIVE_SD, LOWEST, HIGHEST = 1.0096, 0.017, 0.95, 1.068
FOILS, BUMPS = 6, 9
# A sinusoidal die: long fillets, no lip. The thesis prints neither its radius nor its angle.
DESIGN = {
    "schema": "foilgauge/design/1", "name": "sinusoidal", "form": "sinusoidal", "bump_radius_mm": 3.2, "bump_angle_deg": 60.0,
    "overall_radius_mm": 20.73, "thickness_mm": 0.1, "fillet_radius_mm": 1.1,
}


def quantiles(mean, sd):
    law = statistics.NormalDist(mean, sd)
    low, high = law.cdf(LOWEST), law.cdf(HIGHEST)
    count = FOILS * BUMPS
    inner = [law.inv_cdf(low + (high - low) * i / (count - 1)) for i in range(1, count - 1)]
    return [LOWEST, *inner, HIGHEST]


def radii():
    mean, sd = MEAN, RELATIVE_SD * MEAN
    for _ in range(100):  # until the numbers have the mean and the spread asked for
        values = quantiles(mean, sd)
        mean += MEAN - statistics.fmean(values)
        sd *= RELATIVE_SD * MEAN / statistics.stdev(values)
    random.Random(4).shuffle(values)
    return values


def main(folder, dpi):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    values, rng = radii(), random.Random(5)
    design = {key: value for key, value in DESIGN.items() if key not in ("schema", "name")}
    rows = ["scan,foil,die"]
    for foil in range(FOILS):
        spec = {
            "schema": "foilgauge/render/1",
            "seed": 200 + foil,
            "foils": [{
                "design": design,
                "overall_radius_mm": round(20.90 + rng.gauss(0, 0.03), 4),
                "radius_mm": [round(DESIGN["bump_radius_mm"] * x, 5) for x in values[foil * BUMPS:(foil + 1) * BUMPS]],
                "rotate_deg": round(-90 + rng.uniform(-25, 25), 3),
            }],
            "scanner": {"dpi": int(dpi), "bits": 8, "background": 30, "contrast": 175, "blur_px": 1.2, "noise": 1.5},
        }
        name = f"foil{foil + 1:02d}"
        (folder / f"{name}.json").write_text(json.dumps(spec, indent=1) + "\n", encoding="utf-8")
        rows.append(f"{name}.png,{name},sinusoidal")
    (folder / "manifest.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "design").mkdir(exist_ok=True)
    (folder / "design" / "sinusoidal.json").write_text(json.dumps(DESIGN, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
