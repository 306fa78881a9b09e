# SPDX-License-Identifier: GPL-3.0-or-later
"""A row of loop_rough.py's table against the truth: claims, classes, floors, ranges."""

import numpy as np

from loop_scans_report import QUANTITIES, number

SLACK = 1.02  # an error that grew by less has not
NOISE_TIMES = 1.2  # of the floor: an error below this is as good as it
BEYOND = 0.1  # of the median floor: a smaller growth of an error is noise


def claims(row):
    return row["verdict"] != "clean"


def is_curve(row):
    return "free." in row["wanted"] or row["wanted"].count("scan.column_step") > 1


def right_place(row):
    """A curve over the coordinate that it lives on, or over one that is told to do as well, or told itself as one of the
    explanations of a tie; seams also by their row."""
    if "scan.column_step" in row["wanted"]:
        said = set(filter(None, row["claims"].split(" + ")))
        return said == {"scan.column_step"} or (not said and row["unattributed"].startswith("scan.x"))
    return bool(number(row, "right_coordinate") or number(row, "in_class"))


def own_row(row):
    """An effect that no single row explains is unattributed, or has its own row (seams), or is told as one of the
    explanations of a tie."""
    said = set(filter(None, row["claims"].split(" + ")))
    as_curve = bool(row["unattributed"]) and not said or ("free." in row["wanted"] and bool(number(row, "in_class")))
    return as_curve or ("scan.column_step" in row["wanted"] and said == {"scan.column_step"})


def is_right(row):
    if not row["wanted"]:
        return not claims(row)
    return right_place(row) if is_curve(row) else bool(number(row, "in_class"))


def wrong(row, tied):
    return bool(row["claims"]) and not is_right(row) and bool(number(row, "tied")) == tied


def told(row):
    """Named, and nothing is tied with it: the data tell."""
    return number(row, "named") and not number(row, "tied") and not row["class"]


def with_floor(rows):
    return [r for r in rows if r["R_floor_um"]]


def floors(rows):
    median = lambda q: float(np.median([number(r, q + "_floor_um") for r in with_floor(rows)]))
    return {q: median(q) if with_floor(rows) else 0.0 for q in (*QUANTITIES, "profile")}


def grew(row, quantity, least):
    before, after = (number(row, f"{quantity}_{side}_um") for side in ("before", "after"))
    return after > max(SLACK * before, before + BEYOND * least[quantity])


def worse(row, least):
    return any(grew(row, q, least) for q in QUANTITIES)


def worse_than_noise(row, least):
    """And larger than the same scatter makes it without an effect: an error may be small by chance, and grow to its usual
    size without an effect."""
    beyond = lambda q: not row[q + "_floor_um"] or number(row, q + "_after_um") > NOISE_TIMES * number(row, q + "_floor_um")
    return any(grew(row, q, least) and beyond(q) for q in QUANTITIES)


def corrected(row, quantities=QUANTITIES):
    return any(row[q + "_after_um"] != row[q + "_before_um"] for q in quantities)


def over_floor(rows, quantity):
    """Of medians: one foil's R0 can be right by chance, with the effect and without it."""
    after, floor = ([number(r, f"{quantity}_{side}_um") for r in with_floor(rows)] for side in ("after", "floor"))
    return float(np.median(after) / max(np.median(floor), 1e-4)) if floor else None


def mean_of(rows, name):
    return 100 * float(np.mean([number(r, name) for r in rows])) if rows else None


def ranges_held(rows):
    stated, held = (sum(number(r, f"{q}_{side}") for r in rows for q in QUANTITIES) for side in ("ranges", "ranges_hold"))
    return 100 * held / stated if stated else None


def percent(rows, test):
    return 100 * float(np.mean([bool(test(r)) for r in rows])) if rows else None


def p_values(rows):
    return sorted(number(r, "p_value") for r in rows if not r["wanted"] and r["p_value"] not in ("", "None"))
