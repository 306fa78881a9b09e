"""thesis_lot.py FOLDER [DPI]: specs of 14 foils with 9 bumps each, as chapter 5 of the thesis found them.

The normalised bump radius has its mean at 1.05, its mode at 1.02 and lies in 0.95 to 1.30: a gamma
distribution shifted to 0.95 (mean - shift = k s = 0.10, mode - shift = (k - 1) s = 0.07, so s = 0.03, k = 10/3).
The 126 radii are its quantiles at i / 125, shuffled, so that the sample is the distribution with its ends.
The arc length is the design's: the renderer's default. Beside the specs a manifest and a design with tolerances.
"""

import json
import pathlib
import random
import sys

SHIFT, SHAPE, SCALE = 0.95, 10 / 3, 0.03
LOWEST, HIGHEST = 0.95, 1.30
FOILS, BUMPS, RADIUS_MM = 14, 9, 3.32
DRAWS = 200_000


def radii():
    rng = random.Random(1)
    draws = sorted(SHIFT + rng.gammavariate(SHAPE, SCALE) for _ in range(DRAWS))
    draws = [x for x in draws if LOWEST <= x <= HIGHEST]
    count = FOILS * BUMPS
    values = [draws[round(i / (count - 1) * (len(draws) - 1))] for i in range(count)]
    rng.shuffle(values)
    return values


def main(folder, dpi="2400"):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    values = radii()
    rng = random.Random(2)
    rows = ["scan,foil,die,bearing,pad"]
    for foil in range(FOILS):
        spec = {
            "schema": "foilgauge/render/1",
            "seed": 100 + foil,
            "foils": [{
                "overall_radius_mm": round(20.90 + rng.gauss(0, 0.03), 4),
                "radius_mm": [round(RADIUS_MM * x, 5) for x in values[foil * BUMPS:(foil + 1) * BUMPS]],
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
