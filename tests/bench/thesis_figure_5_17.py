# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 5.17 of the thesis from end to end: writes reports/thesis/figure_5_17.md, .csv (the reference curve) and .html.

Fourteen foils of nine bumps are rendered with known truth: radius errors that fall from the lip on, with scatter
from bump to bump, at constant arc length. They are measured as a lot with a reference curve, which is the pattern
without the scatter, as a simulation would give it. The page's means and standard deviations per bump are set
beside those of the truth."""

import argparse
import json
import math
import os
import random
import shutil
import statistics
import subprocess
import tempfile

import benchlib as lib

FOILS, BUMPS = 14, 9
RADIUS_MM, ANGLE_DEG, OVERALL_MM = 3.32, 63.15, 20.73
# In percent: mean 5 as the thesis's normalised radius of 1.05, the fall over the foil and the scatter are made up.
FIRST, LAST, SCATTER = 6.5, 3.5, 1.0
OPENED_MM, OPENED_SD_MM = 20.93, 0.02


def pattern(bump):
    return FIRST + (LAST - FIRST) * (bump - 1) / (BUMPS - 1)


def theta_deg(radius, angle_deg, overall):
    """At the crossing: half the bump's angle, and half of the bump as seen from O."""
    half = math.radians(angle_deg) / 2
    return math.degrees(half + math.asin(radius * math.sin(half) / overall))


THETA_DEG = theta_deg(RADIUS_MM, ANGLE_DEG, OVERALL_MM)


def theta_error(radius_error_pct, overall):
    share = 1 + radius_error_pct / 100
    return 100 * (theta_deg(RADIUS_MM * share, ANGLE_DEG / share, overall) / THETA_DEG - 1)


def write_curve(path):
    with open(path, "w", encoding="utf-8") as file:
        file.write("bump,radius_error_pct,intersection_angle_error_pct\n")
        for bump in range(1, BUMPS + 1):
            file.write(f"{bump},{pattern(bump):.4f},{theta_error(pattern(bump), OPENED_MM):.4f}\n")


def render(folder, dpi):
    rng, truth = random.Random(17), []
    for foil in range(FOILS):
        radii = [RADIUS_MM * (1 + (pattern(b) + rng.gauss(0, SCATTER)) / 100) for b in range(1, BUMPS + 1)]
        spec = {"schema": "foilgauge/render/1", "seed": 500 + foil, "scanner": {"dpi": dpi},
                "foils": [{"overall_radius_mm": round(rng.gauss(OPENED_MM, OPENED_SD_MM), 5),
                           "radius_mm": [round(r, 6) for r in radii],
                           "rotate_deg": round(-90 + rng.uniform(-25, 25), 3)}]}
        base = os.path.join(folder, f"foil{foil + 1:02d}")
        with open(base + ".json", "w", encoding="utf-8") as file:
            json.dump(spec, file)
        subprocess.run([lib.FOILGAUGE, "render", base + ".json", "-o", base + ".png", "--truth", base + ".truth"],
                       check=True)
        truth.append(lib.load(base + ".truth")["bumps"])
    return truth


def true_errors(truth, bump):
    bumps = [foil[bump - 1] for foil in truth]
    return ([100 * (b["radius_mm"] / RADIUS_MM - 1) for b in bumps],
            [100 * (b["intersection_angle_deg"] / THETA_DEG - 1) for b in bumps])


def rows_of(lot, truth):
    names, rows, worst = ("radius_error_pct", "intersection_angle_error_pct"), [], [0.0, 0.0]
    for bump in range(1, BUMPS + 1):
        row = [bump]
        for k, true in enumerate(true_errors(truth, bump)):
            place = lot["quantities"][names[k]]["bumps"][bump - 1]
            curve = lot["reference_curve"]["points"][bump - 1][1 + k]
            row += [f"{statistics.mean(true):+.3f}", f"{place['mean']:+.3f}", f"{2 * statistics.stdev(true):.3f}",
                    f"{2 * place['sd']:.3f}", f"{curve:+.3f}"]
            worst[k] = max(worst[k], abs(place["mean"] - statistics.mean(true)))
        rows.append(row)
    return rows, worst


TEXT = """# Figure 5.17: errors of radius and intersection angle over the bumps

`tests/bench/thesis_figure_5_17.sh` writes this page, figure_5_17.csv (the reference curve) and figure_5_17.html (the
lot's page, section Springback). {version}; {foils} foils of {bumps} bumps rendered at {dpi} dpi with known truth.

What the thesis prints of it: {foils} measured classical foils of {bumps} bumps, bump 1 next to the lip, a mean normalised
bump radius of 1.05 (an error of +5 %), halves of the die +0.09 and +0.35 % off. **The values of figure 5.17 per bump,
simulated and measured, are not printed in its text**, so nothing here is compared with them. The lot is made up around
what is printed: radius errors that fall from {first:g} % at bump 1 to {last:g} % at bump {bumps} (mean +5 %), scatter 1 % from
bump to bump, constant arc length, foils opened to {opened} mm. The reference curve is the pattern without the scatter.

Errors in percent of the design, mean and two standard deviations over the foils:

{table}
The farthest that a measured mean lies from the true one is {worst_r:.4f} % of the radius and {worst_t:.4f} % of theta.
Mean over all bumps: radius {mean_r:+.3f} % (truth {true_r:+.3f} %; thesis +5 %), theta {mean_t:+.3f} % (truth {true_t:+.3f} %;
not printed in the thesis).
"""

HEADER = ["bump", "e_R true", "e_R measured", "2 s true", "2 s measured", "curve",
          "e_θ true", "e_θ measured", "2 s true", "2 s measured", "curve"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dpi", type=int, default=4800)
    parser.add_argument("-o", default=os.path.join(lib.ROOT, "reports", "thesis"))
    arguments = parser.parse_args()
    curve = os.path.join(arguments.o, "figure_5_17.csv")
    write_curve(curve)
    with tempfile.TemporaryDirectory() as folder:
        truth = render(folder, arguments.dpi)
        out = os.path.join(folder, "lot")
        subprocess.run([lib.FOILGAUGE, "lot", folder, "-o", out, "--name", "Thesis, figure 5.17",
                        "--reference-curve", curve, "--pages", "none"], check=True)
        shutil.copy(os.path.join(out, "index.html"), os.path.join(arguments.o, "figure_5_17.html"))
        lot = lib.load(os.path.join(out, "lot.json"))
    rows, worst = rows_of(lot, truth)
    every = [true_errors(truth, bump) for bump in range(1, BUMPS + 1)]
    true = [statistics.mean(e for bump in every for e in bump[k]) for k in (0, 1)]
    page = TEXT.format(version=lib.program_version(), foils=FOILS, bumps=BUMPS, dpi=arguments.dpi, first=FIRST, last=LAST,
                       opened=OPENED_MM, table=lib.table(HEADER, rows), worst_r=worst[0], worst_t=worst[1],
                       mean_r=lot["quantities"]["radius_error_pct"]["mean"], true_r=true[0],
                       mean_t=lot["quantities"]["intersection_angle_error_pct"]["mean"], true_t=true[1])
    with open(os.path.join(arguments.o, "figure_5_17.md"), "w", encoding="utf-8") as file:
        file.write(page)
    print(page)


if __name__ == "__main__":
    main()
