# SPDX-License-Identifier: GPL-3.0-or-later
"""compensation_report.py ROWS.csv THESIS.json OUT.md: the page of die compensation from what compensation.py and
compensation_thesis.py have written."""

import csv
import json
import pathlib
import statistics
import sys

BUMPS = 9


def number(row, key):
    return float(row[key]) if row.get(key) else None


def of(rows, rule, turn):
    return [row for row in rows if row["rule"] == rule and int(row["round"]) == turn]


def rms(values):
    return statistics.fmean(value * value for value in values) ** 0.5


def error_table(rows):
    lines = ["| round | rule | mean radius error, rms over the processes, % | largest, % | error of single bumps, rms, % | foils within ± 2 %, % |",
             "|---|---|---|---|---|---|"]
    for turn in range(4):
        for rule in ("program", "naive", "oracle") if turn else ("program",):
            some = of(rows, rule, turn)
            mean = [number(row, "mean_pct") for row in some]
            lines.append(f"| {turn} | {rule if turn else 'die as designed'} | {rms(mean):.3f} | {max(map(abs, mean)):.2f} | "
                         f"{rms([number(row, 'rms_pct') for row in some]):.3f} | "
                         f"{100 * statistics.fmean(number(row, 'within') for row in some):.1f} |")
    return lines


def coverage_table(rows):
    lines = ["| round | R of a bump | R of the three bumps at the end with the undeclared effect | alpha | h | R0 | p below 0.01 | shares of foils in tolerance |",
             "|---|---|---|---|---|---|---|---|"]
    for turn in range(1, 4):
        some = of(rows, "program", turn)
        touched = [row for row in some if number(row, "end") > 0]
        share = lambda key, count, chosen=some: f"{100 * sum(number(row, key) for row in chosen) / (count * len(chosen)):.1f} %"
        wrong = sum(number(row, "p_value") < 0.01 for row in some)
        lines.append(f"| {turn} | {share('radius_inside', BUMPS)} | {share('end_inside', 3, touched)} | {share('angle_inside', BUMPS)} | "
                     f"{share('height_inside', BUMPS)} | {share('overall_inside', 1)} | {wrong} of {len(some)} | {share('share_inside', 1)} |")
    return lines


def found_table(rows):
    lines = ["| after the lot of round | processes with the effect | found on the bumps' numbers | suspected | nothing said | processes without | claims there |",
             "|---|---|---|---|---|---|---|"]
    for turn in range(1, 4):
        some = of(rows, "program", turn)
        touched, clean = ([row for row in some if (number(row, "end") > 0) == has] for has in (True, False))
        found = sum("bump" in row["claim"] for row in touched)
        suspected = sum(row["verdict"] == "suspected" for row in touched)
        claims = sum(bool(row["claim"]) for row in clean)
        lines.append(f"| {turn} | {len(touched)} | {found} | {suspected} | {len(touched) - found - suspected} | {len(clean)} | {claims} |")
    return lines


def thesis_table(thesis):
    lines = ["| lot | foils | die to be cut: bump radii, mm (mean) | overall radius, mm | mean radius error before, % | after, % | R0 error before, % | after, % | "
             "values inside | foils within ± 10 % before, % | predicted, % (95 % of lots) | after, % |", "|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for lot in thesis["lots"]:
        before = statistics.fmean(lot["mean_error_pct"][:-1])
        low, mean, high = lot["die_radius_mm"]
        a, b = lot["share_of_lots"]
        lines.append(f"| {lot['name']} | {lot['foils']} | {low:.3f} to {high:.3f} ({mean:.4f}) | {lot['die_overall_mm']:.3f} | {before:+.2f} | "
                     f"{lot['mean_error_pct'][-1]:+.3f} | {lot['overall_error_pct'][0]:+.2f} | {lot['overall_error_pct'][1]:+.3f} | "
                     f"{lot['inside']} of {lot['values']} | {100 * lot['passed'][0]:.0f} | {100 * lot['share_predicted']:.0f} "
                     f"({100 * a:.0f} to {100 * b:.0f}) | {100 * lot['passed'][1]:.0f} |")
    return lines


def main(rows_path, thesis_path, out):
    with open(rows_path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    thesis = json.loads(pathlib.Path(thesis_path).read_text(encoding="utf-8"))
    processes = len({row["process"] for row in rows})
    shares = [lot["step_share"] for lot in thesis["lots"]]
    pathlib.Path(out).write_text("\n".join([
        "# The next die, three times over", "",
        f"{processes} made-up processes: bumps open by 2 to 8 % at constant arc length, with a dependence on the die's own radius (exponent 0 to twice the",
        "springback), dies that differ (0.1 to 0.4 %), coils that drift (0 to 0.3 % a lot), foils (0.2 to 0.5 %) and bumps (0.4 to 1.2 %) that scatter, a measuring",
        "noise of 0.05 %; lots of 6 to 14 foils of 9 bumps. Every second process has an effect that no law has a term for: springback grows by 0.8 to 2.5 % over the last",
        "three or four bumps at one end of the die. Round 0 is a die as designed. The program finds each next die (`foilgauge die --target`) and holds each lot",
        "against its prediction (`foilgauge lot --expected`); lots are the records that `foilgauge lot` keeps. `naive` scales each size of the die by the error of its",
        "mean; `oracle` knows the law, the undeclared effect and the last coil, but neither the next coil's step nor the next die's own deviation. All have the",
        "same foils' deviations.", "",
        f"`/usr/bin/python3 tests/bench/compensation.py build/foilgauge --processes {processes} --csv rows.csv` makes the rows ([compensation.csv](compensation.csv)),",
        "`compensation_thesis.py build/foilgauge thesis.json` the thesis's lots, `compensation_report.py rows.csv thesis.json reports/compensation.md` this page.", "",
        "## Error and foils in tolerance", "", *error_table(rows), "",
        "A foil is within with all of its nine bumps.", "",
        "## Were the predictions right?", "",
        "Share of the measured means inside the predicted 95 % intervals for the mean of as many foils; lots of a prediction called wrong (p below 0.01); shares of",
        "foils in tolerance inside the predicted 95 % of lots.", "", *coverage_table(rows), "",
        "Round 1 predicts from one lot: how lots differ and how springback depends on the die's radius is the prior's. It is wider than these processes need.", "",
        "## The effect that no law has a term for", "",
        "The loop over the springback of all lots, against the law without terms for single bumps. The die follows single bumps from round 1 on, found or not.", "",
        *found_table(rows), "",
        "## The thesis's lots as rendered", "",
        f"The thesis has one lot of each kind, pressed in a die within 0.35 % of the design. Rendered at {thesis['dpi']} dpi and measured, they ask for the dies below. What comes",
        "of these is a model: every bump loses the curvature that a bump of the first lot lost, dealt anew, at constant arc length; the overall radius opens by the",
        "same ratios. The program is told nothing of that. The second lots are rendered and measured as well.", "", *thesis_table(thesis), "",
        f"The radii of both lots are dealt at random over the bumps, so single bumps deviate by chance alone: of those deviations the dies take {100 * shares[0]:.0f} and "
        f"{100 * shares[1]:.0f} %.", ""]), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
