# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and the plot of loop_rough.py."""

import csv
import os

import numpy as np

from loop_rough_asked import asked, glance_lines, missed_figures_lines
from loop_rough_judged import (claims, corrected, floors, is_curve, is_right, mean_of, over_floor, p_values, told, worse,
                               wrong)
from loop_rough_plot import kolmogorov_smirnov, svg_of_p_values
from loop_scans_report import QUANTITIES, form_error_lines, is_scanner, markdown, number, share

NAMES = ["inputs", "failed", "claims %", "in class %", "exactly named %", "wrong, `found` %", "wrong, tied %",
         "unattributed %", "made worse %", "s", "most s"]  # fmt: skip


def naming_cells(rows, zero):
    seconds = [number(r, "seconds") for r in rows]
    return [
        len(rows), sum(r["verdict"] == "failed" for r in rows), share(rows, claims), share(rows, is_right),
        share(rows, lambda r: number(r, "named")), share(rows, lambda r: wrong(r, False)),
        share(rows, lambda r: wrong(r, True)), share(rows, lambda r: r["unattributed"]),
        share(rows, lambda r: worse(r, zero)), f"{np.median(seconds):.1f}", f"{max(seconds):.1f}",
    ]  # fmt: skip


def asked_cells():
    return ["**asked**", "", "", f"clean {asked('claims')}", f"{asked('class')}; curves {asked('curves')}",
            f"pairs {asked('exact')}", asked("wrong"), "", "", asked("worse"), "",
            f"{asked('one')}; pair {asked('pair')}"]  # fmt: skip


def by_tier(rows, tiers, seed=None):
    for name, tier in tiers.items():
        own = [r for r in rows if r["tier"] == name and seed in (None, r["seed"])]
        if own:
            yield name, tier.title, own


def naming_lines(rows, tiers):
    table = [asked_cells()]
    table += [[title, *naming_cells(own, floors(own))] for _, title, own in by_tier(rows, tiers)]
    return markdown(["tier", *NAMES], table)


def seed_lines(rows, tiers):
    table = []
    for seed in sorted({r["seed"] for r in rows}):
        for name, title, own in by_tier(rows, tiers, seed):
            table.append([seed, title, *naming_cells(own, floors([r for r in rows if r["tier"] == name]))])
    return markdown(["seed", "tier", *NAMES], table)


def effect_lines(rows):
    """In class, of how many, effect by effect."""
    kinds = sorted({r["wanted"] for r in rows if r["wanted"] and not is_curve(r)})
    tiers = ("single", "pair", "other-single", "other-pair")
    table = []
    for kind in kinds:
        cells = [kind]
        for tier in tiers:
            own = [r for r in rows if r["wanted"] == kind and r["tier"] == tier]
            cells.append(f"{sum(is_right(r) for r in own)} of {len(own)}" if own else "–")
        table.append(cells)
    return markdown(["effect", "one scan", "pair", "second renderer, one scan", "pair"], table)


# Standard errors between two effects that an oracle can tell apart: 1 in 700 by chance.
APART = 3.0


def apart_lines(rows, apart):
    """Turned pairs by whether the data tell their effect from every other one."""
    pairs = [r for r in rows if r["tier"].endswith("pair") and "thickness" not in r["wanted"]]
    known = {id(r): apart(r) for r in pairs}
    table, missed = [], []
    groups = ((f"at least {APART:g}", lambda a: a >= APART), ("less", lambda a: a < APART), ("all", lambda a: True))
    for title, test in groups:
        own = [r for r in pairs if test(known[id(r)][0])]
        oracle = f"{100 * np.mean([known[id(r)][2] for r in own]):.1f}" if own else "–"
        table.append([title, len(own), oracle, share(own, lambda r: number(r, "named")), share(own, told), share(own, is_right)])
        missed += [r for r in own if not number(r, "named") and title != "all"]
    said = [[r["tier"], r["seed"], r["index"], r["wanted"], r["claims"] or r["unattributed"] or r["verdict"],
             f"{known[id(r)][0]:.1f}", known[id(r)][1], f"{100 * known[id(r)][2]:.0f}"] for r in missed]  # fmt: skip
    return [*markdown(["standard errors to the nearest other effect", "pairs", "an oracle names %", "exactly named %", "and nothing tied %", "in class %"], table),
            "", "Pairs that were not exactly named:", "",
            *markdown(["tier", "seed", "case", "there", "said", "standard errors apart", "nearest", "an oracle names it, %"], said)]  # fmt: skip


def error_cells(rows, q):
    median = lambda side: np.median([number(r, f"{q}_{side}_um") for r in rows])
    return f"{median('before'):.3g} → {median('after'):.3g}, {median('floor'):.3g}"


def error_lines(rows, tiers):
    table = [["**asked**", "", "", *["", asked("floor")] * 3]]
    for _, title, group in by_tier(rows, tiers):
        own = [r for r in group if is_scanner(r)]
        if not own:
            continue
        sure, cells = [r for r in own if told(r)], [title, len(own)]
        cells.append(sum(map(bool, map(told, own))))
        for q in QUANTITIES:
            ratio = over_floor(sure, q)
            cells += [error_cells(own, q), "–" if ratio is None else f"{ratio:.2f}"]
        table.append(cells)
    header = ["tier", "inputs", "told"]
    for q in QUANTITIES:
        header += [f"{q}: before → after, floor", f"{q} after / floor, told"]
    return markdown(header, table)


def profile_lines(rows, tiers):
    table = []
    for _, title, group in by_tier(rows, tiers):
        own = [r for r in group if r["wanted"]]
        if own:
            right, least = [r for r in own if is_right(r)], floors(group)["profile"]
            cells = [" → ".join(f"{np.median([number(r, f'profile_{side}_um') for r in some]):.3g}" for side in ("before", "after"))
                     if some else "–" for some in (own, right)]  # fmt: skip
            table.append([title, len(own), *cells, f"{least:.3g}" if least else "–"])
    return markdown(["tier", "inputs", "all: before → after", "in class: before → after", "floor"], table)


def interval_lines(rows, tiers):
    table = [["**asked**", "", *[asked("within")] * 3, "", *[asked("ranges")] * 3]]
    for _, title, group in by_tier(rows, tiers):
        own = [r for r in group if is_scanner(r) and corrected(r)]
        if not own:
            continue
        cells = [title, len(own)]
        for q in QUANTITIES:
            moved = [r for r in own if corrected(r, [q])]
            both = [mean_of(moved, f"{q}_within_{side}") for side in ("before", "after")]
            cells.append(f"{both[0]:.0f} → {both[1]:.0f} of {len(moved)}" if moved else "–")
        cells.append(sum(number(r, "R0_ranges") > 0 for r in own))
        for q in QUANTITIES:
            stated = sum(number(r, q + "_ranges") for r in own)
            held = sum(number(r, q + "_ranges_hold") for r in own)
            cells.append(f"{100 * held / stated:.0f} of {stated:.0f}" if stated else "–")
        table.append(cells)
    header = ["tier", "corrected inputs", *[f"{q} within U, %" for q in QUANTITIES], "with ranges"]
    return markdown(header + [f"ranges of {q} that hold, %" for q in QUANTITIES], table)


def p_lines(rows):
    table = []
    for title, second in (("this renderer", False), ("second renderer", True)):
        values = p_values([r for r in rows if r["tier"].startswith("other-") == second])
        if values:
            d, p = kolmogorov_smirnov(values)
            below = [f"{100 * np.mean(np.array(values) < level):.1f}" for level in (0.01, 0.05, 0.5)]
            table.append([title, len(values), f"{d:.3f}", f"{p:.2g}", *below, f"{values[0]:.1g}"])
    return markdown(["clean inputs", "n", "D", "p", "below 0.01, %", "below 0.05, %", "below 0.5, %", "least"], table)


def before_lines(folder, rows, tiers):
    """Inputs that loop_rough_before.csv holds as well: what a program said whose noise came from what many columns left."""
    path = os.path.join(folder, "loop_rough_before.csv")
    if not os.path.exists(path):
        return []
    with open(path, newline="", encoding="utf-8") as f:
        past = list(csv.DictReader(f))
    key = lambda r: (r["tier"], r["seed"], r["index"])
    both, table = {key(r) for r in past} & {key(r) for r in rows}, []
    for name, title, own in by_tier(past, tiers):
        least = floors(own)
        table.append([title, "then", *naming_cells(own, least)])
        now = [r for r in rows if r["tier"] == name and key(r) in both]
        if now:
            table.append([title, "now", *naming_cells(now, least)])
    chance = p_values(past)
    d, p = kolmogorov_smirnov(chance)
    text = ("loop_rough_before.csv: the program before noise was a covariance along the strip, on inputs of the second renderer. Its "
            f"p-values of {len(chance)} clean ones: Kolmogorov-Smirnov's D {d:.2f}, p {p:.1g}.")  # fmt: skip
    return ["", "## Then and now", "", text, "", *markdown(["tier", "", *NAMES], table)]


def missed_lines(rows, tiers):
    table = []
    for name, _, own in by_tier(rows, tiers):
        for r in own:
            if is_right(r):
                continue
            said = " + ".join(filter(None, [r["claims"], r["unattributed"] and "unattributed " + r["unattributed"]]))
            tie = f" ({r['class'].replace(' | ', '; ')})" if r["class"] else ""
            change = ", ".join(f"{r[q + '_before_um']} → {r[q + '_after_um']}" for q in QUANTITIES)
            table.append([name, r["seed"], r["index"], r["layout"], r["wanted"] or "nothing",
                          (said or r["verdict"]) + tie, change])  # fmt: skip
    return markdown(["tier", "seed", "case", "layout", "there", "said (tied)", "R, h, R0 error, µm"], table)


TEXT = """Made by `python3 tests/bench/loop_rough.py build/foilgauge{options}`: {count} inputs of the seeds {seeds}, a row each in
loop_rough.csv with the effects that were put in. Scatter of 0 to 0.4 px, correlated over 2 to 15 px of the edge (Gaussian or
exponential), blur 1.4 to 2.4 px; in half of them one-sided blur, in a third each a halo, a side wall, JPEG. The second renderer
(other_scanner.py) shares nothing with the program's: scatter of 0.15 to 0.35 px over 5 to 11 px, exponential or Matern, a sensor that
lags along the carriage's way, halo, grain, tone, clipped white, JPEG. Effects are 1.5 times the size that an oracle, which knows their
form and the noise's covariance, sees at 5 standard errors (unlisted curves, seams and bumps: by what all smooth listed effects together leave of them; a taper of
the thickness: 10 µm).

In class: what is there was named, or is one of the explanations that the report says it cannot tell apart. Wrong: something
is claimed, and what is there is not among the explanations. Told: exactly named, and nothing is tied with it. Floor: the same foils
and scatter without the effect, measured. Errors of R, h and R0 are against the measurand: least-squares circles through the part as it
is. Worse: an error is larger after than before, by more than 2 % and a tenth of the tier's median floor;
beyond its noise: and larger than 1.2 times its floor. The midline: circles and what is said to deviate from them. Right place of curves: `unattributed` over the right coordinate, or over one that it is told to be as good as,\nor the curve told as one of the explanations of a tie; seams also as their row.
Seconds are {seconds}."""

QUIET = "the clock's, or the processor's where those are less: other inputs are rendered and judged beside"
BUSY = "the clock's while other work ran beside, so that they are not judged (`--busy`)"


def write(folder, rows, tiers, apart, busy=False):
    seeds = sorted({r["seed"] for r in rows})
    whole = all(sum(r["tier"] == n and r["seed"] == s for r in rows) >= t.count for n, t in tiers.items() for s in seeds)
    options = " --all" if "13" in seeds else ""
    text = TEXT.format(options=options, count=len(rows), seeds=", ".join(seeds), seconds=BUSY if busy else QUIET)
    lines = ["# The loop on scans with rough edges", "", text, ""]
    if not whole:
        lines += ["**A part of the benchmark: not every tier of every seed is whole.**", ""]
    lines += ["## What was asked, and what holds", "", *glance_lines(rows, busy), "", *missed_figures_lines(rows, tiers, busy)]
    lines += ["", "## Named", "", *naming_lines(rows, tiers), "", "Effect by effect, in class:", "", *effect_lines(rows)]
    lines += ["", "Turned pairs, by how far an oracle, which knows every form and the noise's covariance, can hold the effect from the nearest",
              "other listed one of any size, place, middle, length or period (loop_oracle.py), and by how often Bayes' rule over all of these names",
              "it. That is the most that anybody can name:", "", *apart_lines(rows, apart)]  # fmt: skip
    lines += ["", "## Errors against truth, effects of the scanner", "", "Medians, µm.", "", *error_lines(rows, tiers)]
    lines += ["", "Distance of the true midline from what is reported, all effects; medians, µm.", "", *profile_lines(rows, tiers)]
    lines += ["", "## Intervals", "", "Inputs with an effect of the scanner where the dimension was corrected: values within U = 2 u of the",
              "truth, before → after, of how many inputs; and how many of the ranges that a tie gives hold the truth.", "", *interval_lines(rows, tiers)]  # fmt: skip
    lines += ["", "Form errors of lands and bumps, peak to valley, against those of the part as it is:", "", *form_error_lines(rows)]
    lines += ["", "## p-values where nothing is there", "", "That no effect is needed (`p_value` of the report); uniform is right. "
              "Kolmogorov-Smirnov against uniform.", "", *p_lines(rows), "", "![sorted p-values](loop_rough.svg)"]  # fmt: skip
    lines += ["", "## Seed by seed", "", *seed_lines(rows, tiers)]
    lines += before_lines(folder, rows, tiers)
    lines += ["", "## Every input that is not right", "", *missed_lines(rows, tiers)]
    with open(os.path.join(folder, "loop_rough.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    own = [(title, p_values([r for r in rows if r["tier"].startswith("other-") == second]))
           for title, second in (("this renderer", False), ("second renderer", True))]  # fmt: skip
    with open(os.path.join(folder, "loop_rough.svg"), "w", encoding="utf-8") as f:
        f.write(svg_of_p_values(own))
    print("wrote loop_rough.md and .svg")
