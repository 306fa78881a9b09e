# SPDX-License-Identifier: GPL-3.0-or-later
"""thesis_lot_report.py FOLDER OUT: two measured lots beside the thesis's printed figures, as lot.md and lot.csv."""

import csv
import json
import math
import pathlib
import sys

RADIUS_MM, ANGLE_DEG = 3.32, 63.15
LOTS = ("constant", "varied")

# Chapter 5, figures 5.8, 5.11 and 5.13 and their text.
THESIS = {
    "radius, mean": 1.05, "radius, mode": 1.02, "radius, min": 0.95, "radius, max": 1.30,
    "slope": -1.0,
    "clearance, mean": 50, "clearance, min": -50, "clearance, max": 150, "clearance, sd": 35,
    "stiffness, mean": 1.108, "stiffness, mode": 1.095, "stiffness, rsd": 12.4, "stiffness, min": 0.7, "stiffness, max": 1.6,
    "samples, min": 0.8, "samples, max": 1.4,  # "-20 to 40 %" of its samples; 0.7 to 1.6 are of 100,000 drawn
}


def mean(values):
    return sum(values) / len(values)


def sd(values):
    return math.sqrt(sum((x - mean(values)) ** 2 for x in values) / (len(values) - 1))


class Lot:
    """One of the lots: its report, and its truth."""

    def __init__(self, folder):
        self.report = json.loads((folder / "lot" / "lot.json").read_text(encoding="utf-8"))
        self.stiffness = self.report["stiffness"]
        self.models = {model["id"]: model for model in self.stiffness["models"]}
        bumps = [bump for path in sorted(folder.glob("foil*.truth"))
                 for bump in json.loads(path.read_text(encoding="utf-8"))["bumps"]]
        self.radii = [bump["radius_mm"] / RADIUS_MM for bump in bumps]
        self.arcs = [100 * (bump["radius_mm"] * bump["bump_angle_deg"] / (RADIUS_MM * ANGLE_DEG) - 1) for bump in bumps]
        self.gaps = self.relative([20.73 - bump["height_mm"] - 20 - 0.1 for bump in bumps])
        # Heights by eq 5.6 and 5.7 from the measured radii: the thesis's own way to its clearances.
        with open(folder / "lot" / "bumps.csv", newline="", encoding="utf-8") as file:
            self.model_gaps = self.relative([20.73 - float(row["height_model_mm"]) - 20 - 0.1 for row in csv.DictReader(file)])

    def relative(self, clearances_mm):
        nominal = self.report["nominal"]["clearance_mm"]
        return [100 * (value - nominal) / nominal for value in clearances_mm]


def spread_rows(words, spread, what):
    """Rows of one distribution of stiffness; `what` of its members."""
    names = {"mean": "mean", "mode": "mode", "relative_sd_pct": "rel. s, %", "min": "min", "max": "max"}
    keys = {member: f"stiffness, {member}" for member in names} | {"relative_sd_pct": "stiffness, rsd"}
    if words.endswith("bumps"):
        keys |= {member: f"samples, {member}" for member in ("min", "max")}
    return [(f"{words}, {names[member]}", keys[member], spread[member], None) for member in what]


def rows_of(lot):
    """(words, key of the thesis's figure or None, measured, as rendered)."""
    radius = lot.report["quantities"]["radius_mm"]
    clearance = lot.report["clearance_relative_to_design_pct"]
    line = lot.report["correlation"]
    rows = [
        ("normalised bump radius, mean", "radius, mean", radius["mean"] / RADIUS_MM, mean(lot.radii)),
        ("normalised bump radius, mode", "radius, mode", radius["mode"] / RADIUS_MM, None),
        ("normalised bump radius, min", "radius, min", radius["min"] / RADIUS_MM, min(lot.radii)),
        ("normalised bump radius, max", "radius, max", radius["max"] / RADIUS_MM, max(lot.radii)),
        ("arc length against design, mean, %", None, line["arc_length_mean_pct"], mean(lot.arcs)),
        ("arc length against design, s, %", None, line["arc_length_sd_pct"], sd(lot.arcs)),
        ("slope of angle over radius error", "slope", line["slope"], None),
        ("slope of their logarithms", "slope", line["log_slope"], None),
        ("clearance against design, mean, %", "clearance, mean", clearance["mean"], mean(lot.gaps)),
        ("clearance against design, s, %", "clearance, sd", clearance["sd"], sd(lot.gaps)),
        ("clearance against design, min, %", "clearance, min", clearance["min"], min(lot.gaps)),
        ("clearance against design, max, %", "clearance, max", clearance["max"], max(lot.gaps)),
        ("the same by the springback model, mean, %", "clearance, mean", mean(lot.model_gaps), None),
        ("the same by the springback model, s, %", "clearance, sd", sd(lot.model_gaps), None),
        ("the same by the springback model, min, %", "clearance, min", min(lot.model_gaps), None),
        ("the same by the springback model, max, %", "clearance, max", max(lot.model_gaps), None),
    ]
    everything = ("mean", "mode", "relative_sd_pct", "min", "max")
    rows += spread_rows("stiffness, arch, bumps", lot.stiffness["normalised"], everything)
    rows += spread_rows("stiffness, arch, drawn", lot.stiffness["normalised_resampled"], everything)
    for model, title in (("heshmat", "Heshmat"), ("link_spring", "link-spring")):
        rows += spread_rows(f"stiffness, {title}, bumps", lot.models[model]["normalised"], ("mean", "relative_sd_pct"))
    rows += spread_rows("sideways stiffness of the feet, bumps", lot.stiffness["normalised_foot"], everything)
    return rows


def budget_rows(lots):
    """Contribution of each cause to the stiffness' relative s, percent, of every lot."""
    signed = lambda variance: math.copysign(math.sqrt(abs(variance)), variance)
    lines = []
    for words, member in (("radius, at constant arc length", "radius_at_arc_length"), ("arc length R alpha", "arc_length"),
                          ("these two together", "radius_with_arc_length"), ("thickness", "thickness")):
        cells = []
        for lot in lots:
            cause = lot.stiffness["budget"][member]
            cells += [cause.get("relative_sd_pct"), cause.get("sensitivity"), signed(cause["variance_pct2"])]
        lines.append((words, cells))
    for words, member in (("radius", "radius_at_arc_length"), ("arc length", "arc_length"), ("thickness", "thickness")):
        lines.append((f"share of {words}, % of the variance",
                      [cell for lot in lots for cell in (None, None, lot.stiffness["budget"][member]["share_pct"])]))
    lines.append(("share not explained, % of the variance",
                  [cell for lot in lots for cell in (None, None, lot.stiffness["budget"]["rest_share_pct"])]))
    for words, member in (("observed", "observed_relative_sd_pct"), ("of it measurement", "measurement_relative_sd_pct")):
        lines.append((words, [cell for lot in lots for cell in (None, None, lot.stiffness["budget"][member])]))
    return lines


def show(value, digits=4):
    return "" if value is None else f"{value:.{digits}g}"


def sensitivity_rows(lot):
    lines = []
    for model in lot.stiffness["models"]:
        slope = model["design"]["sensitivity"]
        both = slope["radius"] + slope["angle"]
        lines.append(f"| {model['id'].replace('_', '-')} | {model['design']['stiffness_n_mm2']:.4g} | {slope['radius']:+.2f} | "
                     f"{slope['angle']:+.2f} | {slope['radius_at_arc_length']:+.2f} | {both:+.2f} | {slope['thickness']:+.2f} |")
    return "\n".join(lines)


TEXT = """# The thesis's lot

14 foils × 9 bumps, rendered at 4800 dpi with the distribution of radii of the thesis's figure 5.11 (a shifted gamma distribution:
mean 1.05, mode 1.02, 0.95 to 1.30), measured and reported end to end, twice: with the arc length as designed
([lot.html](lot.html)), and with arc lengths of {arc_mean:+.1f} ± {arc_sd:.1f} % against the design's that have nothing to do with the radii
([lot_arc_length.html](lot_arc_length.html)). `tests/bench/thesis_lot.sh` makes this page, lot.csv and both pages of the lots.

| figure | thesis | arc length as designed | as rendered | arc length {arc_mean:+.1f} ± {arc_sd:.1f} % | as rendered |
|---|---|---|---|---|---|
{rows}

`drawn`: 100,000 bumps drawn from the densities of radius and arc length, as the thesis resamples its own.

## What agrees, and what does not

**Radius** comes back: its distribution is an input, so this says that the chain is right. The **mode** of a kernel density lies
somewhat above that of the distribution, because the kernel smooths a skewed peak.

**Slope**: the errors in percent give a slope flatter than -1 even where the arc length is constant exactly, because
1 / (1 + e) is curved; in logarithms it is -1. The thesis's -1 is the straight line of small errors. Arc lengths that vary by themselves
leave the slope of the logarithms at {log_slope:.2f} (95 % interval {log_low:.2f} to {log_high:.2f}), so a slope of -1 is no proof of a constant arc length.

**Clearance**: same spread (the thesis gives s as 70 % of its mean, so 35). Measured, it follows from the height h = R0 - (X - R) of the
free foil, which opened to 20.90 ± 0.03 mm here; the thesis computes it from the bump radius alone (eq 5.6 and 5.7), which gives a mean of {model_mean:.0f} %
where it prints 50; the radii of its figure 5.13 are not printed. The shorter arcs of the second lot make lower bumps: {gap_mean:.0f} ± {gap_sd:.0f} %, more than the thesis prints, which
says nothing about its arc lengths where its clearances come from the radius alone.

## Stiffness

The thesis finds the mean at 1.108 of the design's and a relative standard deviation of 12.4 %, and prints a sensitivity of 5 % per percent.

Bending of a slender arc gives K = D / R³ g(alpha), whatever the feet do: R enters in no other way. For the crown of bumps like these g goes
nearly with alpha⁻³, so where R alpha stays, K stays. The three models differ in stiffness by up to {apart:.0f} % and agree in that:

| model | N/mm² as designed | radius alone | angle alone | radius at constant arc length | radius and angle | thickness |
|---|---|---|---|---|---|---|
{sensitivities}

(percent of stiffness per percent.) So **constant arc length alone cannot give the thesis's spread**: over its radii it makes
{rsd_constant:.1f} % (arch), {rsd_constant_heshmat:.1f} % (Heshmat), {rsd_constant_link:.1f} % (link-spring), and a mean below 1. 12.4 % over these radii would take
alpha to the power of {power_needed:.1f}. Something else varied, or the thesis's stiffness is another. What would give its figures:

- **Arc lengths of {arc_mean:+.1f} ± {arc_sd:.1f} %**, with the arch as it is: mean {mean_varied:.3f}, relative standard deviation {rsd_varied:.1f} % over the bumps and
  {rsd_drawn:.1f} % drawn (thesis: 1.108, 12.4 %). These two numbers were chosen to meet two of the thesis's: that they exist is what this lot
  shows, not that they are the thesis's. Not chosen were the mode, {mode_drawn:.3f} drawn (thesis: 1.095), and the ranges: {least_varied:.2f} to {most_varied:.2f} over the bumps
  (thesis: its samples 0.8 to 1.4), {least_drawn:.2f} to {most_drawn:.2f} drawn (0.7 to 1.6).
- **Strips whose thickness varies by {thickness_sd:.1f} %**, and are {thickness_mean:.1f} % thicker than designed: K goes with t³. Its printed results name no measured thickness.
- **Another stiffness.** That of the feet sideways, 1 / f_HH, goes with R⁻³ alpha⁻⁵, so with R² at constant arc length: mean {foot_mean:.3f}, relative standard
  deviation {foot_rsd:.1f} %, with no free number. It comes near both as well, and its mode of {foot_mode:.3f} does not. Nothing in its printed results says that it means this one.

Which of them the thesis's lot was, its printed results do not tell: they hold neither the model nor arc lengths or thicknesses. Its 5 % per percent
is none of the slopes above taken alone; radius and angle together come nearest.

## Where the spread of each lot comes from

Relative s of the cause, percent of stiffness per percent of it at the lot's mean bump, and the relative s of stiffness that gives (arch; below zero: it takes away).

| cause | as designed: s, % | slope | gives, % | {arc_mean:+.1f} ± {arc_sd:.1f} %: s, % | slope | gives, % |
|---|---|---|---|---|---|---|
{budget}

What the slopes leave is curvature: radii reach 30 % above the design's. Measurement is nothing beside the parts on these clean scans.
"""


def main(folder, out):
    folder, out = pathlib.Path(folder), pathlib.Path(out)
    constant, varied = lots = [Lot(folder / name) for name in LOTS]
    tables = [rows_of(lot) for lot in lots]
    table = "\n".join(
        f"| {words} | {show(THESIS.get(key))} | {show(a)} | {show(truth_a)} | {show(b)} | {show(truth_b)} |"
        for (words, key, a, truth_a), (_, _, b, truth_b) in zip(*tables))
    budget = "\n".join(f"| {words} | " + " | ".join(show(cell, 3) for cell in cells) + " |" for words, cells in budget_rows(lots))
    rsd = lambda lot, model: lot.models[model]["normalised"]["relative_sd_pct"]
    by_arch = [model["design"]["over_arch"] for model in constant.models.values()]
    drawn, bumps, foot = varied.stiffness["normalised_resampled"], varied.stiffness["normalised"], constant.stiffness["normalised_foot"]
    power = constant.models["arch"]["design"]["sensitivity"]["thickness"]
    (out / "lot.md").write_text(TEXT.format(
        rows=table, budget=budget, sensitivities=sensitivity_rows(constant),
        arc_mean=mean(varied.arcs), arc_sd=sd(varied.arcs),
        log_slope=varied.report["correlation"]["log_slope"], log_low=varied.report["correlation"]["log_slope_low"],
        log_high=varied.report["correlation"]["log_slope_high"],
        model_mean=mean(constant.model_gaps), gap_mean=mean(varied.gaps), gap_sd=sd(varied.gaps),
        apart=100 * (1 - min(by_arch) / max(by_arch)),
        rsd_constant=rsd(constant, "arch"), rsd_constant_heshmat=rsd(constant, "heshmat"), rsd_constant_link=rsd(constant, "link_spring"),
        mean_varied=bumps["mean"], rsd_varied=bumps["relative_sd_pct"], least_varied=bumps["min"], most_varied=bumps["max"],
        rsd_drawn=drawn["relative_sd_pct"], least_drawn=drawn["min"], most_drawn=drawn["max"], mode_drawn=drawn["mode"],
        power_needed=-3 - THESIS["stiffness, rsd"] / constant.stiffness["budget"]["radius_at_arc_length"]["relative_sd_pct"],
        thickness_sd=THESIS["stiffness, rsd"] / power,
        thickness_mean=100 * ((THESIS["stiffness, mean"] / constant.stiffness["normalised"]["mean"]) ** (1 / power) - 1),
        foot_mean=foot["mean"], foot_rsd=foot["relative_sd_pct"], foot_mode=foot["mode"]), encoding="utf-8")
    lines = ["figure,thesis,measured,rendered,measured_arc_length,rendered_arc_length"]
    lines += [f'"{words}",{show(THESIS.get(key))},{show(a)},{show(truth_a)},{show(b)},{show(truth_b)}'
              for (words, key, a, truth_a), (_, _, b, truth_b) in zip(*tables)]
    (out / "lot.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
