"""thesis_lot_report.py FOLDER OUT: a measured lot beside the thesis's printed figures, as lot.md and lot.csv."""

import csv
import json
import math
import pathlib
import sys

RADIUS_MM, ANGLE_DEG = 3.32, 63.15

# Chapter 5, figures 5.8, 5.11 and 5.13 and their text.
THESIS = {
    "radius, mean": 1.05, "radius, mode": 1.02, "radius, min": 0.95, "radius, max": 1.30,
    "slope": -1.0,
    "clearance, mean": 50, "clearance, min": -50, "clearance, max": 150, "clearance, sd": 35,
    "stiffness, mean": 1.108, "stiffness, mode": 1.095, "stiffness, rsd": 12.4, "stiffness, min": 0.7, "stiffness, max": 1.6,
}


def truth_of(folder):
    """Normalised radius and local clearance (eq 5.8) of every bump as it was rendered."""
    radii, clearances = [], []
    for path in sorted(pathlib.Path(folder).glob("foil*.truth")):
        for bump in json.loads(path.read_text(encoding="utf-8"))["bumps"]:
            radii.append(bump["radius_mm"] / RADIUS_MM)
            clearances.append(20.73 - bump["height_mm"] - 20 - 0.1)
    return radii, clearances


def model_clearances(folder):
    """What eq 5.6 and 5.7 make of the measured radii: the thesis's own way to its clearances."""
    with open(pathlib.Path(folder) / "lot" / "bumps.csv", newline="", encoding="utf-8") as file:
        return [20.73 - float(row["height_model_mm"]) - 20 - 0.1 for row in csv.DictReader(file)]


def rows_of(lot, folder):
    radius = lot["quantities"]["radius_mm"]
    clearance = lot["clearance_relative_to_design_pct"]
    free, foot = lot["stiffness"]["normalised_resampled"], lot["stiffness"]["normalised_foot"]
    truth, gaps = truth_of(folder)
    nominal = lot["nominal"]["clearance_mm"]
    gaps = [100 * (c - nominal) / nominal for c in gaps]
    model = [100 * (c - nominal) / nominal for c in model_clearances(folder)]
    mean = lambda v: sum(v) / len(v)
    sd = lambda v: math.sqrt(sum((x - mean(v)) ** 2 for x in v) / (len(v) - 1))
    law = [r * r for r in truth]
    return [
        ("normalised bump radius, mean", "radius, mean", radius["mean"] / RADIUS_MM, mean(truth)),
        ("normalised bump radius, mode", "radius, mode", radius["mode"] / RADIUS_MM, None),
        ("normalised bump radius, min", "radius, min", radius["min"] / RADIUS_MM, min(truth)),
        ("normalised bump radius, max", "radius, max", radius["max"] / RADIUS_MM, max(truth)),
        ("slope of angle over radius error", "slope", lot["correlation"]["slope"], None),
        ("slope of their logarithms", "slope", lot["correlation"]["log_slope"], -1.0),
        ("clearance against design, mean, %", "clearance, mean", clearance["mean"], mean(gaps)),
        ("clearance against design, s, %", "clearance, sd", clearance["sd"], sd(gaps)),
        ("clearance against design, min, %", "clearance, min", clearance["min"], min(gaps)),
        ("clearance against design, max, %", "clearance, max", clearance["max"], max(gaps)),
        ("the same by the springback model, mean, %", "clearance, mean", mean(model), None),
        ("the same by the springback model, s, %", "clearance, sd", sd(model), None),
        ("the same by the springback model, min, %", "clearance, min", min(model), None),
        ("the same by the springback model, max, %", "clearance, max", max(model), None),
        ("vertical stiffness, resampled, mean", "stiffness, mean", free["mean"], None),
        ("vertical stiffness, resampled, mode", "stiffness, mode", free["mode"], None),
        ("vertical stiffness, resampled, rel. s, %", "stiffness, rsd", free["relative_sd_pct"], None),
        ("sideways stiffness of the feet, mean", "stiffness, mean", foot["mean"], mean(law)),
        ("sideways stiffness of the feet, mode", "stiffness, mode", foot["mode"], None),
        ("sideways stiffness of the feet, rel. s, %", "stiffness, rsd", foot["relative_sd_pct"], 100 * sd(law) / mean(law)),
        ("sideways stiffness of the feet, min", "stiffness, min", foot["min"], min(law)),
        ("sideways stiffness of the feet, max", "stiffness, max", foot["max"], max(law)),
    ]


TEXT = """# The thesis's lot

14 foils × 9 bumps, rendered at 4800 dpi with the distribution of the thesis's figure 5.11 (a shifted gamma distribution:
mean 1.05, mode 1.02, 0.95 to 1.30; arc length as designed), measured and reported end to end. `tests/bench/thesis_lot.sh`
makes this page, lot.csv and the page of the lot, [lot.html](lot.html).

| figure | thesis | measured here | as rendered |
|---|---|---|---|
{rows}

`as rendered` of the feet's stiffness is R², the law below.

## What agrees, and what does not

**Radius** comes back: its distribution is an input, so this says that the chain is right. The **mode** of a kernel density lies
somewhat above that of the distribution, because the kernel smooths a skewed peak.

**Slope**: the errors in percent give a slope flatter than -1 even where the arc length is constant exactly, because
1 / (1 + e) is curved; in logarithms it is -1. The thesis's -1 is the straight line of small errors.

**Clearance**: same range and spread (the thesis gives s as 70 % of its mean, so 35). Measured, it follows from the height h = R0 - (X - R) of the free foil, which opened to 20.90 ± 0.03 mm here;
the thesis computes it from the bump radius alone (eq 5.6 and 5.7). Both are below its mean of 50 %; the radii of its figure 5.13 are not printed.

**Stiffness**: the thesis finds the mean at 1.108 and a relative standard deviation of 12.4 %. Our arch (Castigliano, both feet
sliding with friction 0.1) hardly changes with springback: at constant arc length bending scales with (R phi)³, which stays, and
what is left is {sensitivity:+.2f} % per percent of radius. The thesis's figures are those of a law that grows with R² at constant arc length,
that is R⁻³ alpha⁻⁵: R² over the same radii has its mean at {law_mean:.3f} and a relative standard deviation of {law_rsd:.1f} %, and the exponent 5 is the
sensitivity of 5 % per percent that it prints. In the arch this is the stiffness of the feet sideways, 1 / f_HH ~ R⁻³ alpha⁻⁵, which the
program reports beside the vertical one: mean {foot_mean:.3f}, mode {foot_mode:.3f}, relative standard deviation {foot_rsd:.1f} %. That the thesis's model
is this one is our inference from its figures; it prints no formula that would settle it. Its mode of 1.095, close to its mean, also says that
its stiffness is less skewed than R² of its radii, so its angles did not follow the arc length exactly.
"""


def main(folder, out):
    out = pathlib.Path(out)
    lot = json.loads((pathlib.Path(folder) / "lot" / "lot.json").read_text(encoding="utf-8"))
    rows = rows_of(lot, folder)
    show = lambda v: "" if v is None else f"{v:.4g}"
    truth, _ = truth_of(folder)
    law = [r * r for r in truth]
    law_mean = sum(law) / len(law)
    law_rsd = 100 * math.sqrt(sum((x - law_mean) ** 2 for x in law) / (len(law) - 1)) / law_mean
    foot = lot["stiffness"]["normalised_foot"]
    table = "\n".join(f"| {words} | {THESIS[key]:g} | {show(ours)} | {show(true)} |" for words, key, ours, true in rows)
    (out / "lot.md").write_text(TEXT.format(
        rows=table, sensitivity=lot["stiffness"]["sensitivity"]["radius_at_arc_length"], law_mean=law_mean, law_rsd=law_rsd,
        foot_mean=foot["mean"], foot_mode=foot["mode"], foot_rsd=foot["relative_sd_pct"]), encoding="utf-8")
    lines = ["figure,thesis,measured,rendered"]
    lines += [f'"{words}",{THESIS[key]:g},{show(ours)},{show(true)}' for words, key, ours, true in rows]
    (out / "lot.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
