# SPDX-License-Identifier: GPL-3.0-or-later
"""A test of p-values for uniformity: Kolmogorov-Smirnov's test, and a plot."""

import math

import numpy as np

COLOURS = ["#1b6ca8", "#c1432e"]
SIDE, LEFT, TOP, GAP = 300, 60, 24, 80
DECADES = 8  # of the second panel; smaller values lie on its edge


def kolmogorov_smirnov(values):
    """(D, p), p by Stephens's approximation of Kolmogorov's distribution."""
    p, n = np.sort(values), len(values)
    rank = np.arange(1, n + 1) / n
    d = float(max(np.max(rank - p), np.max(p - rank + 1 / n)))
    size = (math.sqrt(n) + 0.12 + 0.11 / math.sqrt(n)) * d
    if size < 0.2:
        return d, 1.0
    return d, min(1.0, 2 * sum((-1) ** (k - 1) * math.exp(-2 * (k * size) ** 2) for k in range(1, 101)))


def frame(left, title, ticks, place):
    parts = [f'<rect x="{left}" y="{TOP}" width="{SIDE}" height="{SIDE}" fill="none" stroke="#888"/>',
             f'<path d="M{left} {TOP + SIDE}l{SIDE} {-SIDE}" stroke="#bbb"/>',
             f'<text x="{left + SIDE / 2}" y="{TOP + SIDE + 36}" text-anchor="middle">{title}</text>']  # fmt: skip
    for value, word in ticks:
        at = SIDE * place(value)
        parts.append(f'<text x="{left + at:.0f}" y="{TOP + SIDE + 16}" text-anchor="middle">{word}</text>')
        parts.append(f'<text x="{left - 6}" y="{TOP + SIDE - at + 4:.0f}" text-anchor="end">{word}</text>')
    return parts


def dots(left, values, place, colour):
    expected = (np.arange(len(values)) + 0.5) / len(values)
    return [f'<circle cx="{left + SIDE * place(e):.1f}" cy="{TOP + SIDE - SIDE * place(v):.1f}" r="2" fill="{colour}"/>'
            for e, v in zip(expected, values)]  # fmt: skip


def band(left, n, colour):
    """The band in which 95 of 100 uniform samples stay."""
    reach = 1.358 / math.sqrt(n)
    lines = []
    for a, b in (((0, reach), (1 - reach, 1)), ((reach, 0), (1, 1 - reach))):
        (x0, y0), (x1, y1) = ((left + SIDE * x, TOP + SIDE - SIDE * y) for x, y in (a, b))
        lines.append(f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" stroke="{colour}" stroke-dasharray="3 3" opacity="0.6"/>')
    return lines


def svg_of_p_values(series):
    """series: (title, sorted p-values)."""
    right = LEFT + SIDE + GAP
    in_log = lambda p: min(1.0, -math.log10(max(p, 1e-300)) / DECADES)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {right + SIDE + 24} {TOP + SIDE + 90}" '
             'font-family="sans-serif" font-size="12">', '<rect width="100%" height="100%" fill="white"/>']  # fmt: skip
    parts += frame(LEFT, "uniform; upwards: p of clean inputs, sorted", [(v, f"{v:g}") for v in (0, 0.5, 1)], float)
    powers = [(10.0**-k, f"1e-{k}" if k else "1") for k in range(0, DECADES + 1, 2)]
    parts += frame(right, "the same, small p outwards", powers, in_log)
    for k, (title, values) in enumerate(series):
        if not values:
            continue
        parts += band(LEFT, len(values), COLOURS[k]) + dots(LEFT, values, float, COLOURS[k])
        parts += dots(right, values, in_log, COLOURS[k])
        at = TOP + SIDE + 56 + 16 * k
        words = f"{title}: {len(values)} inputs (dashed: 95 of 100 uniform samples stay within)"
        parts.append(f'<circle cx="{LEFT}" cy="{at - 4}" r="4" fill="{COLOURS[k]}"/><text x="{LEFT + 12}" y="{at}">{words}</text>')
    return "\n".join(parts + ["</svg>"]) + "\n"
