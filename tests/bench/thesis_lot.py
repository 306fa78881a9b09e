# SPDX-License-Identifier: GPL-3.0-or-later
"""thesis_lot.py FOLDER DPI [MEAN SD]: specs of 14 foils with 9 bumps each, as chapter 5 of the thesis found them.

The normalised bump radius has its mean at 1.05, its mode at 1.02 and lies in 0.95 to 1.30: a gamma
distribution shifted to 0.95 (mean - shift = k s = 0.10, mode - shift = (k - 1) s = 0.07, so s = 0.03, k = 10/3).
The 126 radii are its quantiles at i / 125, shuffled, so that the sample is the distribution with its ends.
The arc length is the design's, or differs from it by MEAN ± SD percent: a normal distribution's quantiles at
(i + 1/2) / 126, shuffled apart from the radii. Beside the specs a manifest.
"""

import json
import pathlib
import random
import statistics
import sys

SHIFT, SHAPE, SCALE = 0.95, 10 / 3, 0.03
LOWEST, HIGHEST = 0.95, 1.30
FOILS, BUMPS, RADIUS_MM, ANGLE_DEG = 14, 9, 3.32, 63.15
DRAWS = 200_000


def radii():
    rng = random.Random(1)
    draws = sorted(SHIFT + rng.gammavariate(SHAPE, SCALE) for _ in range(DRAWS))
    draws = [x for x in draws if LOWEST <= x <= HIGHEST]
    count = FOILS * BUMPS
    values = [draws[round(i / (count - 1) * (len(draws) - 1))] for i in range(count)]
    rng.shuffle(values)
    return values


def arc_lengths(mean_pct, sd_pct):
    """Over the design's."""
    count = FOILS * BUMPS
    if sd_pct == 0:
        return [1 + mean_pct / 100] * count
    law = statistics.NormalDist(mean_pct, sd_pct)
    values = [1 + law.inv_cdf((i + 0.5) / count) / 100 for i in range(count)]
    random.Random(3).shuffle(values)
    return values


def main(folder, dpi, mean_pct="0", sd_pct="0"):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    values = radii()
    lengths = arc_lengths(float(mean_pct), float(sd_pct))
    rng = random.Random(2)
    rows = ["scan,foil,die,bearing,pad"]
    for foil in range(FOILS):
        of_foil = slice(foil * BUMPS, (foil + 1) * BUMPS)
        spec = {
            "schema": "foilgauge/render/1",
            "seed": 100 + foil,
            "foils": [{
                "overall_radius_mm": round(20.90 + rng.gauss(0, 0.03), 4),
                "radius_mm": [round(RADIUS_MM * x, 5) for x in values[of_foil]],
                "bump_angle_deg": [round(ANGLE_DEG * l / x, 5) for x, l in zip(values[of_foil], lengths[of_foil])],
                "rotate_deg": round(-90 + rng.uniform(-25, 25), 3),
            }],
            "scanner": {"dpi": int(dpi), "bits": 8, "background": 30, "contrast": 175, "blur_px": 1.2, "noise": 1.5},
        }
        name = f"foil{foil + 1:02d}"
        (folder / f"{name}.json").write_text(json.dumps(spec, indent=1) + "\n", encoding="utf-8")
        rows.append(f"{name}.png,{name},{'A' if foil % 2 else 'B'},{foil // 3 + 1},{foil % 3 + 1}")
    (folder / "manifest.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
