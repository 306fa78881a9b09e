# SPDX-License-Identifier: GPL-3.0-or-later
"""Requirements on the loop on rough scans: which figures hold, and which are missed by how much."""

import math

import numpy as np

from loop_rough_judged import (claims, corrected, floors, is_curve, is_right, mean_of, over_floor, own_row, p_values,
                               percent, ranges_held, told, worse, worse_than_noise, wrong)
from loop_rough_plot import kolmogorov_smirnov
from loop_scans_report import QUANTITIES, is_scanner, markdown, number

# Required figures, and whether less or more of each is good.
ASKED = {
    "claims": ("≤", 1.0), "class": ("≥", 95.0), "wrong": ("≤", 1.0), "exact": ("≥", 95.0), "curves": ("≥", 90.0),
    "worse": ("≤", 2.0), "floor": ("≤", 1.2), "within": ("between", (93.0, 97.0)), "ranges": ("≥", 95.0),
    "p": ("≥", 0.01), "one": ("≤", 3.0), "pair": ("≤", 8.0),
}  # fmt: skip
OF_INPUTS = {"claims", "class", "wrong", "exact", "curves", "worse"}  # shares of inputs
OF_VALUES = {"within", "ranges"}  # of the values of inputs, which go together
UNITS = {"floor": "", "p": "", "one": "s ", "pair": "s "}


def measures(rows, busy):
    """{what: (key in ASKED, value, of how many)} of one renderer's rows; busy: seconds are not judged."""
    of = lambda *kinds: [r for r in rows if r["tier"].replace("other-", "") in kinds]
    clean, named, pairs, curves = of("clean"), of("single", "pair"), of("pair"), of("curve", "odd")
    fixed = [r for r in rows if r["wanted"] and is_scanner(r) and corrected(r)]
    sure = [r for r in fixed if told(r) and not is_curve(r)]
    zero = floors(rows) if rows else {}
    chance = p_values(rows)
    seconds = lambda own: float(np.percentile([number(r, "seconds") for r in own], 95)) if own and not busy else None
    result = {
        "clean inputs with a claim, %": ("claims", percent(clean, claims), len(clean)),
        "p-values of clean inputs uniform: Kolmogorov-Smirnov's p": (
            "p", kolmogorov_smirnov(chance)[1] if chance else None, len(chance)),
        "one effect: in class, %": ("class", percent(named, is_right), len(named)),
        "one effect: a wrong cause, called `found`, %": ("wrong", percent(named, lambda r: wrong(r, False)), len(named)),
        "turned pairs: exactly named, %": ("exact", percent(pairs, lambda r: number(r, "named")), len(pairs)),
        "unlisted curves, seams, single bumps: `unattributed` or their own row, %": ("curves", percent(curves, own_row), len(curves)),
        "the same in the right place, %": ("curves", percent(curves, is_right), len(curves)),
        "made worse, %": ("worse", percent(rows, lambda r: worse(r, zero)), len(rows)),
        "made worse beyond its noise, %": ("worse", percent(rows, lambda r: worse_than_noise(r, zero)), len(rows)),
    }  # fmt: skip
    for q in QUANTITIES:
        result[f"{q} after / floor (medians), where the data tell"] = ("floor", over_floor(sure, q), len(sure))
    for q in QUANTITIES:
        moved = [r for r in fixed if corrected(r, [q])]
        inside = mean_of(moved, q + "_within_after")
        result[f"intervals of {q} after a correction that hold, %"] = ("within", inside, len(moved))
    tied = [r for r in rows if any(number(r, q + "_ranges") for q in QUANTITIES)]
    result["ranges of ties that hold the truth, %"] = ("ranges", ranges_held(tied), len(tied))
    lone = [r for r in rows if r["layout"] == "single"]
    turned = [r for r in rows if r["layout"] in ("90", "45")]
    result["one scan, s (95 % are below)"] = ("one", seconds(lone), len(lone))
    result["a pair, s (95 % are below)"] = ("pair", seconds(turned), len(turned))
    return result


def asked(key):
    sign, limit = ASKED[key]
    return f"{limit[0]:g} to {limit[1]:g}" if sign == "between" else f"{sign} {limit:g}"


def limits(key):
    sign, limit = ASKED[key]
    return {"≤": (-np.inf, limit), "≥": (limit, np.inf), "between": limit}[sign]


def reached(key, value):
    low, high = limits(key)
    return low <= value <= high


def verdict_of(key, value):
    if value is None:
        return "–"
    return "yes" if reached(key, value) else "**no**"


def short_by(key, value, count):
    """Distance of a missed figure from its requirement, in words."""
    low, high = limits(key)
    missed = low - value if value < low else value - high
    side = "below" if value < low else "above"
    if key in OF_INPUTS:
        allowed = math.floor(high * count / 100) if side == "above" else math.ceil(low * count / 100)
        inputs = abs(round(value * count / 100) - allowed)
        return f"{missed:.2g} % {side}: {inputs} input{'s' if inputs > 1 else ''}"
    return f"{missed:.2g} {UNITS.get(key, '% ')}{side}".strip()


def chance_of_share(value, count):
    """Wilson's interval of a share of so many inputs, in %: where the figure of all such inputs is, 95 times in 100."""
    p, z2 = value / 100, 1.96**2
    middle, half = p + z2 / (2 * count), math.sqrt(z2 * (p * (1 - p) + z2 / (4 * count)) / count)
    return [100 * float(np.clip((middle + s * half) / (1 + z2 / count), 0, 1)) for s in (-1, 1)]


def glance_lines(rows, busy):
    other = lambda r: r["tier"].startswith("other-")
    own, second = (measures([r for r in rows if other(r) == which], busy) for which in (False, True))
    table = []
    for what, (key, value, count) in own.items():
        cells = [what, asked(key)]
        for v, n in ((value, count), second[what][1:]):
            cells += ["–" if v is None else f"{v:.3g} (of {n})", verdict_of(key, v)]
        table.append(cells)
    return markdown(["what", "asked", "this renderer", "holds", "second renderer", "holds"], table)


def figures_by_tier(rows, tiers, busy):
    """(title, what, key, value, of how many) of every figure that is asked of a tier."""
    for name, tier in tiers.items():
        for what, (key, value, count) in measures([r for r in rows if r["tier"] == name], busy).items():
            if value is not None:
                yield tier.title, what, key, value, count


def missed_figures_lines(rows, tiers, busy):
    figures = list(figures_by_tier(rows, tiers, busy))
    missed, table = [f for f in figures if not reached(f[2], f[3])], []
    for title, what, key, value, count in missed:
        likely = "{:.1f} to {:.1f}".format(*chance_of_share(value, count)) if key in OF_INPUTS | OF_VALUES else ""
        table.append([title, what, asked(key), f"{value:.3g} (of {count})", likely, short_by(key, value, count)])
    text = f"Held tier by tier, {len(figures) - len(missed)} of {len(figures)} figures are reached. These are not:"
    header = ["tier", "what", "asked", "is", "what so many inputs leave open, %", "missed by"]
    return [text, "", *markdown(header, table)]
