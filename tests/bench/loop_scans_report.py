# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and the plot of loop_scans.py."""

import os

import numpy as np

QUANTITIES = ("R", "h", "R0")
SCANNER_CURVES = ("free.scan.x", "free.scan.y", "free.edge.normal")


def number(row, name):
    return float(row[name])


def share(rows, test):
    return f"{100 * np.mean([bool(test(r)) for r in rows]):.1f}" if rows else "–"


def is_scanner(row):
    """Nothing but the scanner is wrong: there is an error to take out of dimensions."""
    ids = row["wanted"].split(" + ") if row["wanted"] else []
    return bool(ids) and all(i.startswith("scan.") or i in SCANNER_CURVES for i in ids)


def ratio(row, quantity):
    return number(row, quantity + "_before_um") / max(number(row, quantity + "_after_um"), 1e-4)


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return lines + ["| " + " | ".join(str(c) for c in r) + " |" for r in rows]


def naming_row(title, rows):
    return [
        title,
        len(rows),
        share(rows, lambda r: r["verdict"] != "clean"),
        share(rows, lambda r: number(r, "named")),
        share(rows, lambda r: number(r, "in_class")),
        share(rows, lambda r: r["unattributed"]),
        share(rows, lambda r: number(r, "right_coordinate")) if "free." in rows[0]["wanted"] else "",
        f"{np.median([number(r, 'seconds') for r in rows]):.1f}",
        f"{max(number(r, 'seconds') for r in rows):.1f}",
    ]


def floors(rows):
    """Error of a clean input that 95 % stay below."""
    clean = [r for r in rows if r["tier"] == "clean" and r["verdict"] != "failed"]
    names = [*QUANTITIES, "profile"]
    if not clean:
        return dict.fromkeys(names, 0.0)
    return {q: float(np.percentile([number(r, q + "_before_um") for r in clean], 95)) for q in names}


def reduction_cells(rows, quantity, times, floor):
    if not rows:
        return ["–"] * 3
    reached = lambda r: ratio(r, quantity) >= times
    return [
        f"{np.median([ratio(r, quantity) for r in rows]):.1f}",
        share(rows, reached),
        share(rows, lambda r: reached(r) or number(r, quantity + "_after_um") <= floor),
    ]


def reduction_row(title, rows, quantities, floor):
    times = 3 if "free." in rows[0]["wanted"] else 10
    cells = [title, len(rows), times]
    for quantity in quantities:
        cells += reduction_cells(rows, quantity, times, floor[quantity])
    return cells


def reduction_header(quantities):
    header = ["what", "cases", "wanted ×"]
    for q in quantities:
        header += [f"{q}: median ×", "reached %", "or at the noise %"]
    return header


def groups_of(rows, tiers):
    """(title, rows): every tier, and its effects one by one."""
    for name in tiers:
        own = [r for r in rows if r["tier"] == name]
        if own:
            yield name, own
    for name, tier in tiers.items():
        own = [r for r in rows if r["tier"] == name]
        for wanted in sorted({r["wanted"] for r in own}) if abs(tier.effects) == 1 else []:
            yield f"{name}: {wanted}", [r for r in own if r["wanted"] == wanted]


def range_lines(rows):
    result = []
    for name in sorted({r["tier"] for r in rows}):
        own = [r for r in rows if r["tier"] == name]
        cells = [name, sum(number(r, "R0_ranges") + number(r, "R_ranges") > 0 for r in own)]
        for q in QUANTITIES:
            stated = sum(number(r, q + "_ranges") for r in own)
            held = sum(number(r, q + "_ranges_hold") for r in own)
            cells += [f"{stated:.0f}", f"{100 * held / stated:.1f}" if stated else "–"]
        if cells[1]:
            result.append(cells)
    header = ["what", "cases with a tie"] + [c for q in QUANTITIES for c in (f"ranges of {q}", "hold %")]
    return markdown(header, result)


def within_lines(rows):
    result = []
    for name in sorted({r["tier"] for r in rows}):
        own = [r for r in rows if r["tier"] == name]
        cells = [name, len(own)]
        for q in QUANTITIES:
            mean = [100 * np.mean([number(r, f"{q}_within_{side}") for r in own]) for side in ("before", "after")]
            cells.append(f"{mean[0]:.0f} → {mean[1]:.0f}")
        result.append(cells)
    return markdown(["what", "cases"] + [f"{q} within U, %" for q in QUANTITIES], result)


def form_error_lines(rows):
    """Form errors of lands and bumps, by the kind of effect."""
    kinds = [("nothing there", lambda r: not r["wanted"]), ("the scanner's effects", is_scanner),
             ("the part's effects", lambda r: r["wanted"] and not is_scanner(r))]  # fmt: skip
    table = []
    for title, test in kinds:
        own = [r for r in rows if test(r)]
        total = lambda column: sum(number(r, column) for r in own)
        hold = lambda held, of: f"{100 * total(held) / total(of):.1f}" if total(of) else "–"
        if own:
            table.append([title, len(own), f"{total('form_errors'):.0f}", hold("form_within", "form_errors"),
                          f"{total('form_ranges'):.0f}", hold("form_ranges_hold", "form_ranges")])  # fmt: skip
    return markdown(["what", "inputs", "form errors", "within U, %", "ranges in place of one", "hold %"], table)


def clean_lines(rows):
    clean = [r for r in rows if r["tier"] == "clean"]
    if not clean:
        return []
    worse = lambda q: share(clean, lambda r: number(r, q + "_after_um") > 1.2 * number(r, q + "_before_um") + 0.02)
    cells = ", ".join(f"{q} {worse(q)} %" for q in QUANTITIES)
    return [f"Clean inputs whose error grew by more than a fifth and 0.02 µm: {cells}.", ""]


def missed_lines(rows):
    """The cases that were not named, so that nobody need look for them."""
    lines = []
    for r in rows:
        good = number(r, "right_coordinate") and not r["claims"] if "free." in r["wanted"] else number(r, "in_class")
        if good:
            continue
        said = " + ".join(filter(None, [r["claims"], r["unattributed"] and "unattributed " + r["unattributed"]]))
        change = ", ".join(f"{r[q + '_before_um']} → {r[q + '_after_um']}" for q in QUANTITIES)
        lines.append([r["tier"], r["index"], r["layout"], r["wanted"] or "nothing", said or r["verdict"], change])
    return markdown(["tier", "case", "layout", "there", "said", "R, h, R0 error, µm"], lines)


def write_scans(folder, rows, tiers, options):
    groups = list(groups_of(rows, tiers))
    floor = floors(rows)
    most = f" --cases {options.cases}" if options.cases else ""
    lines = [
        "# The loop on rendered scans", "",
        f"Made by `python3 tests/bench/loop_scans.py build/foilgauge{most} --seed {options.seed}`: {len(rows)} inputs, a row each in",
        "loop_scans.csv with the effects that were put in. Six designs with and without lip, any rotation, both hands and",
        "polarities, 8 and 16 bit, blur 0.9 to 2 px, noise 0.5 to 2, every bump with its own springback; a third with a tone",
        "curve, a third with shading, a fifth with a halo. Effects of 3 to 30 µm (row steps to 40) at the foil's ends,",
        "log-uniform. An unlisted curve has three turning points or more, and the listed effects can take up less than half",
        "of it.", "",
        "Claims: the verdict is not `clean`. Named: what was said is what is there, and nothing else. In class: what is there",
        "is one of the explanations that the report says it cannot tell apart. Coordinate: `unattributed` is on the right",
        "one.", "",
    ]  # fmt: skip
    header = ["what", "cases", "claims %", "named %", "in class %", "unattributed %", "coordinate %", "s", "most s"]
    lines += markdown(header, [naming_row(*g) for g in groups])
    lines += [
        "", "## Error against truth", "",
        "Effects of the scanner: error of R, h (rms over bumps) and R0 before over after. Reached: at least the wanted",
        f"times. At the noise: or below what 95 % of the clean inputs stay below (R {floor['R']:.2f}, h {floor['h']:.3f}, "
        f"R0 {floor['R0']:.3f} µm).", "",
    ]  # fmt: skip
    scanner = [(t, [r for r in g if is_scanner(r)]) for t, g in groups]
    quantities = list(QUANTITIES)
    lines += markdown(
        reduction_header(quantities), [reduction_row(t, g, quantities, floor) for t, g in scanner if g]
    )
    lines += [
        "", "All effects: the midline. Distance of the true midline, deviations of the part included, from the measured",
        "circles and what the report says deviates from them (rms over bumps and lands; place and direction left free). Bumps",
        "count over the inner 85 % of their arcs, where edges are measured.", "",
    ]  # fmt: skip
    lines += markdown(
        reduction_header(["profile"]),
        [reduction_row(t, g, ["profile"], floor) for t, g in groups if g[0]["wanted"]],
    )
    lines += [
        "", "## Uncertainty", "",
        "How many values lie within U = 2 u of the truth, before and after: of the least-squares circles through the part as",
        "it is.", "", *within_lines(rows), "", *form_error_lines(rows),
    ]  # fmt: skip
    lines += ["", *clean_lines(rows), "## Ties", "", *range_lines(rows)]
    lines += ["", "## Every case that was not in its class", "", *missed_lines(rows)]
    with open(os.path.join(folder, "loop_scans.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("wrote loop_scans.md")


# --- the smallest effect that is found --------------------------------------------------------

COLOURS = ["#1b6ca8", "#c1432e", "#3a8f4d", "#8a5ca8"]
LAYOUT_WORDS = {"single": "one scan", "90": "turned by 90°"}


def rates(rows, kind, layout, sizes):
    """(size, detected, in class, trials) per size."""
    for size in sizes:
        own = [r for r in rows if (r["effect"], r["layout"], float(r["size_um"])) == (kind, layout, size)]
        if own:
            found = np.mean([r["verdict"] != "clean" for r in own])
            yield size, float(found), float(np.mean([number(r, "in_class") for r in own])), len(own)


def svg_curve(rows, kinds, sizes):
    left, top, width, height = 56, 16, 520, 260
    low, high = np.log10(sizes[0]), np.log10(sizes[-1])
    x = lambda size: left + width * (np.log10(size) - low) / (high - low)
    y = lambda rate: top + height * (1 - rate)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left + width + 24} {top + height + 130}" '
        'font-family="sans-serif" font-size="12">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for rate in (0, 0.25, 0.5, 0.75, 1):
        parts.append(f'<path d="M{left} {y(rate):.1f}h{width}" stroke="#ddd"/>')
        parts.append(f'<text x="{left - 6}" y="{y(rate) + 4:.1f}" text-anchor="end">{100 * rate:.0f} %</text>')
    for size in sizes:
        parts.append(f'<path d="M{x(size):.1f} {top}v{height}" stroke="#eee"/>')
        parts.append(f'<text x="{x(size):.1f}" y="{top + height + 16}" text-anchor="middle">{size:g}</text>')
    middle = left + width / 2
    parts.append(f'<text x="{middle}" y="{top + height + 34}" text-anchor="middle">µm at the foil\'s ends</text>')
    for k, (kind, layout) in enumerate(kinds):
        points = list(rates(rows, kind, layout, sizes))
        line = " ".join(f"{x(s):.1f},{y(found):.1f}" for s, found, _, _ in points)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[k]}" stroke-width="2"/>')
        line = " ".join(f"{x(s):.1f},{y(right):.1f}" for s, _, right, _ in points)
        dashes = 'stroke-dasharray="4 3"'
        parts.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[k]}" {dashes}/>')
        at = top + height + 56 + 16 * k
        parts.append(f'<path d="M{left} {at - 4}h24" stroke="{COLOURS[k]}" stroke-width="2"/>')
        words = f"{kind}, {LAYOUT_WORDS[layout]} (dashed: named, or in the class)"
        parts.append(f'<text x="{left + 32}" y="{at}">{words}</text>')
    return "\n".join(parts + ["</svg>"]) + "\n"


def write_curve(folder, rows, kinds, sizes):
    with open(os.path.join(folder, "loop_scans_curve.svg"), "w", encoding="utf-8") as f:
        f.write(svg_curve(rows, kinds, sizes))
    table = []
    for kind, layout in kinds:
        for size, found, right, trials in rates(rows, kind, layout, sizes):
            cells = [kind, LAYOUT_WORDS[layout], f"{size:g}", trials]
            table.append(cells + [f"{100 * found:.0f}", f"{100 * right:.0f}"])
    lines = [
        "# The smallest effect that the loop finds", "",
        f"Made by `python3 tests/bench/loop_scans.py build/foilgauge --curve --trials {max(row[3] for row in table)}`. The scans are",
        "those of loop_scans.md: tone, shading and halo are in some. Found: the verdict is not `clean`. Named: the effect, or it is in",
        "the class.", "",
        "![share of effects found against their size](loop_scans_curve.svg)", "",
    ]  # fmt: skip
    lines += markdown(["effect", "scans", "µm at the ends", "trials", "found %", "named %"], table)
    with open(os.path.join(folder, "loop_scans_curve.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("wrote loop_scans_curve.md and .svg")
