# SPDX-License-Identifier: GPL-3.0-or-later
"""reports/loop_power.md from loop_power.csv."""

import numpy as np
from scipy import stats

GOALS = {6: 0.80, 10: 0.98}  # of "found and in class"


def share(rows, name):
    known = [int(r[name]) for r in rows if r[name] != ""]
    return f"{sum(known)}/{len(known)}" if known else "–"


def percent(rows, name):
    known = [int(r[name]) for r in rows if r[name] != ""]
    return f"{100 * sum(known) / len(known):.1f} %" if known else "–"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows] + [""]


def of(rows, **wanted):
    return [r for r in rows if all(r[k] == str(v) for k, v in wanted.items())]


def power(rows, tables):
    sizes = sorted({int(r["size"]) for r in rows})
    designs = [d for d in tables.DESIGNS if of(rows, design=d)]
    total = []
    for size in sizes:
        own = of(rows, size=size)
        total.append([size, percent(own, "found"), f"{100 * GOALS[size]:.0f} %" if size in GOALS else "–",
                      percent(own, "claimed"), percent(own, "exact"), percent(own, "wrong"),
                      percent(own, "peer_claimed"), percent(own, "peer_found"), len(own)])
    out = table(["size", "found and in class", "to reach", "anything claimed", "the claim itself", "a claim without the truth",
                 "plain search: anything", "plain search: the truth first", "tables"], total)
    for design in designs:
        out += [f"### {design}", "",
                "Found and in class of all tables; in brackets what the plain search calls anything at all.", ""]
        lines = []
        for kind in (k for k in tables.KINDS if of(rows, design=design, kind=k)):
            cells = [of(rows, design=design, kind=kind, size=s) for s in sizes]
            wrong = of(rows, design=design, kind=kind)
            lines.append([kind] + [f"{share(c, 'found')} ({share(c, 'peer_claimed')})" if c else "–" for c in cells]
                         + [share(wrong, "wrong")])
        out += table(["kind"] + [str(s) for s in sizes] + ["a claim without the truth"], lines)
    return out


def oracle_line(rows):
    """Check of the tables themselves, of kinds whose size is of one amplitude: the oracle's estimate less the size."""
    off = np.array([float(r["oracle_z"]) - float(r["size"]) for r in rows if r["oracle_z"] and r["kind"] != "masked_outliers"])
    if len(off) < 5:
        return []
    return [f"The oracle's own estimate, less the size: {off.mean():.2f} on average, standard deviation {off.std():.2f} "
            f"({len(off)} tables; 0 and 1 were the tables exactly what they are said to be).", ""]


def uniform(rows):
    """Of family p-values of clean tables: how many lie in each tenth, and Kolmogorov and Smirnov's p."""
    p = np.array([float(r["family_p"]) for r in rows if r["family_p"] != ""])
    if len(p) < 5:
        return ["–", "–"]
    tenths = np.histogram(p, np.linspace(0, 1, 11))[0]
    return [" ".join(str(t) for t in tenths), f"{stats.kstest(p, 'uniform').pvalue:.2g}"]


def suspected_of_another(row, allowed):
    """Suspects something, and first something else than what the noise is."""
    first = row["suspects"].split(" | ")[0]
    return row["verdict"] == "suspected" and not (allowed and allowed in first)


def suspected(rows, tables, false=False):
    own = sum(suspected_of_another(r, tables.ALLOWED.get(r["kind"])) if false else r["verdict"] == "suspected" for r in rows)
    return f"{own}/{len(rows)} ({100 * own / len(rows):.1f} %)" if rows else "–"


def clean(rows, tables):
    lines = []
    for kind in (k for k in tables.CLEAN if of(rows, kind=k)):
        own = of(rows, kind=kind)
        by = [share(of(own, design=d), "found") for d in tables.DESIGNS]
        lines.append([kind, share(own, "found"), percent(own, "found"), *by, share(own, "claimed"), share(own, "peer_claimed"),
                      suspected(own, tables), suspected(own, tables, True), *uniform(own)])
    everything = ["all", share(rows, "found"), percent(rows, "found"),
                  *[share(of(rows, design=d), "found") for d in tables.DESIGNS], share(rows, "claimed"),
                  share(rows, "peer_claimed"), suspected(rows, tables), suspected(rows, tables, True), *uniform(rows)]
    return table(["noise", "false claims", "share", *tables.DESIGNS, "any claim", "plain search: any claim",
                  "suspected, nothing claimed", "of them first of another", "family p-values by tenths", "uniform (KS)"], lines + [everything])


def summary(rows, tables):
    effects, unlike = [r for r in rows if r["size"] != "0"], [r for r in rows if r["size"] == "0"]
    failed = sum(r["verdict"] == "failed" for r in rows)
    seconds = [float(r["seconds"]) for r in rows]
    tables_a_cell, clean_a_cell = (1 + max((int(r["table"]) for r in part), default=-1) for part in (effects, unlike))
    sizes = ",".join(str(s) for s in sorted({int(r["size"]) for r in effects}))
    sizes = f"--sizes {sizes} " if effects and sizes != "4,6,8,10" else ""
    title = "Power of the loop on tables, against an oracle" if effects else "Clean tables in the loop"
    out = [f"# {title}", "",
           f"{len(effects)} tables with one effect, {len(unlike)} clean ones. `/usr/bin/python3 tests/bench/loop_power.py build/foilgauge "
           f"{sizes}--tables {tables_a_cell} --clean {clean_a_cell}` "
           f"(seeds {', '.join(sorted({r['seed'] for r in rows}, key=int))}; "
           f"{np.median(seconds) if seconds else 0:.2f} s a table, {max(seconds, default=0):.1f} s at most; the program failed on {failed}).",
           "", "Designs: an experiment of 24 runs (`1 + T + D + T:D`), a lot of 14 foils of 9 bumps (`1`, `--group foil`), a series of "
           "200 readings (`1`, or a trend with a column). A size is in standard errors of the amplitude for an oracle that knows "
           "the effect's form with all its non-linear parameters, and the noise; for spread and serial correlation it is the square root "
           "of twice the expected log likelihood ratio. A dash: no such table exists (24 runs cannot be correlated that much).", "",
           "Found and in class: a claim is the truth, on its column, or its alias class holds it; of a curve that nothing lists, "
           "anything that names its coordinate. The plain search: the largest F over candidates with shapes on a grid, limit "
           "simulated under white noise; it knows the levels' variance, and nothing of correlation, spread or heavy tails.", ""]
    if effects:
        out += ["## Effects", ""] + oracle_line(effects) + power(effects, tables)
    if unlike:
        out += ["## Clean tables", "", "False: a claim that the noise does not justify (of unequal spread anything but "
                "`table.spread`, of correlated noise anything but `table.serial_correlation` or a class that holds it).", ""]
        out += clean(unlike, tables)
    return "\n".join(out)
