# SPDX-License-Identifier: GPL-3.0-or-later
"""loop_cycles.py PROGRAM [--tables N] [--clean N] [--seed N] [--jobs N] [--out FOLDER]

Cycles over a column through `foilgauge loop --table`: encoders, screws and scales whose errors are known, made in two
ways that share nothing with the program. "orders" adds one to three orders of a base period to a slope, a backlash,
a drift and noise. "physics" computes what an instrument does: an eccentric disc read by one head or two, quadrature
signals with unequal gain, offset and phase, a counter's steps, a screw whose nut sits askew, a shaft that warms up;
its orders are the Fourier coefficients of the error without noise. Half of the tables declare the base (a turn of an
angle, --period), half leave it to be sought. Writes loop_cycles.md.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from multiprocessing import Pool

import numpy as np
from scipy import stats

ROWS = (40, 60, 72, 120, 240, 400, 1000, 2000)
WAYS = ("orders", "physics")
PLACES = ("even", "uneven", "repeated")
CLEAR = 10  # standard errors of an order that is found whatever its noise: none is missed, so none is chosen for its luck
HARMONICS = 400  # of the Fourier series of a physical error


def places(rng, kind, rows, span):
    if kind == "even":
        return np.arange(rows) * span / rows
    if kind == "uneven":
        return np.sort(rng.uniform(0, span, rows))
    return np.repeat(np.arange(math.ceil(rows / 3)) * span / math.ceil(rows / 3), 3)[:rows]


def highest_order(kind, rows, turns):
    """Of a turn, half as many as it has places: none is asked for that another one looks like."""
    own = rows / turns / (3 if kind == "repeated" else 1)
    return max(1, int(0.4 * own))


def by_orders(rng, x, base, most):
    """Order: (amplitude relative to the first's, phase)."""
    count = int(rng.integers(1, 4))
    orders = sorted(rng.choice(np.arange(1, min(most, 12) + 1), size=min(count, most, 12), replace=False).tolist())
    truth = {k: (1.0 if i == 0 else rng.uniform(0.4, 1), rng.uniform(0, 2 * np.pi)) for i, k in enumerate(orders)}
    return sum(a * np.cos(2 * np.pi * k * x / base - p) for k, (a, p) in truth.items()), truth


def eccentric(theta, e, at):
    """Reading of a disc whose axis lies e of its radius off, by one head."""
    return np.arctan2(np.sin(theta) - e * math.sin(at), np.cos(theta) - e * math.cos(at)) - theta


def wrapped(error):
    return (error + np.pi) % (2 * np.pi) - np.pi


def quadrature(theta, lines, gain, offset, skew):
    """Interpolation of sine and cosine that are not ideal, of one turn of `lines` periods."""
    phase = lines * theta
    read = np.arctan2((1 + gain) * np.sin(phase + skew) + offset[0], np.cos(phase) + offset[1])
    return wrapped(read - phase) / lines


def instrument(rng, most):
    """An error over a turn (radians in and out), as a function."""
    e, at = 10 ** rng.uniform(-4, -2.5), rng.uniform(0, 2 * np.pi)
    lines = int(rng.integers(2, max(3, most // 2 + 1)))
    gain, skew = rng.normal(0, 0.03, 2)
    offset = rng.normal(0, 0.03, 2)
    heads = rng.integers(1, 3)
    share = 10 ** rng.uniform(-0.5, 0.5)

    def error(theta):
        one = wrapped(eccentric(theta, e, at))
        if heads == 2:  # opposite heads take the odd orders out, nearly
            one = (1.15 * one + 0.85 * wrapped(eccentric(theta + np.pi, e, at))) / 2
        inner = quadrature(theta, lines, gain, offset, skew)
        return one / max(np.abs(one).max(), 1e-300) + share * inner / max(np.abs(inner).max(), 1e-300)
    return error


def by_physics(rng, x, base, most):
    error = instrument(rng, most)
    fine = 2 * np.pi * np.arange(8192) / 8192
    series = np.fft.rfft(error(fine)) / 4096
    truth = {k: (abs(series[k]), -np.angle(series[k])) for k in range(1, HARMONICS + 1)}
    return error(2 * np.pi * x / base % (2 * np.pi)) - series[0].real / 2, truth


def oracle_sees(y, x, base, beside, orders, largest, searched):
    """An F test of the largest order, its period known, beside all else that is true, at 1 % over as many periods as were
    searched: the best that is possible."""
    wave = lambda k: [np.sin(2 * np.pi * k * x / base), np.cos(2 * np.pi * k * x / base)]
    others = sorted((k for k in orders if k != largest and orders[k] > 0), key=lambda k: -orders[k])[:6]
    null = np.column_stack([np.ones(len(x)), x, *beside, *[c for k in others for c in wave(k)]])
    full = np.column_stack([null, *wave(largest)])
    rss = [float(np.sum((y - m @ np.linalg.lstsq(m, y, rcond=None)[0])**2)) for m in (null, full)]
    dof = len(x) - np.linalg.matrix_rank(full)
    return bool(dof > 0 and stats.f.sf((rss[0] - rss[1]) / 2 / (rss[1] / dof), 2, dof) < 0.01 / searched)


def make(seed, way, kind, rows, known, size):
    """A table, its command's options and its truth: the largest order is `size` standard errors large."""
    rng = np.random.default_rng([seed, WAYS.index(way), PLACES.index(kind), rows, known, int(10 * size)])
    base = 360.0 if known and rng.random() < 0.5 else round(float(10 ** rng.uniform(-0.3, 1.5)), 3)
    angle = base == 360.0
    turns = rng.choice([1, 2, 3]) if known else int(rng.integers(4, 9))
    x = places(rng, kind, rows, base * turns)
    most = highest_order(kind, rows, turns)
    cycle, truth = (by_orders if way == "orders" else by_physics)(rng, x, base, most)
    direction = np.where(rng.random(rows) < 0.5, 1, -1)
    order = rng.permutation(rows)
    run = np.empty(rows)
    run[order] = np.arange(rows)
    largest = max(truth, key=lambda k: truth[k][0])
    unit = math.sqrt(2 / rows)  # standard error of an amplitude, in sd of the noise
    scale = size * unit / truth[largest][0] if size else 0.0
    y = 12.0 + 0.03 * x / base + rng.standard_normal(rows) + scale * cycle
    disturbed = size and rng.random() < 0.5
    if disturbed:
        y = y + 8 * unit * direction / 2 + 8 * unit * (run / rows - 0.5) * math.sqrt(3)
    column = "angle_deg" if angle else "place_mm"
    searched = len(np.unique(x)) / (2 * turns if known else 1)
    sees = bool(size) and oracle_sees(y, x, base, [direction, run] if disturbed else [],
                                      {k: a for k, (a, _) in truth.items()}, largest, searched)
    lines = [f"run,{column},direction,room_C,error_um"]
    room = 20 + rng.normal(0, 0.5, rows)
    for i in order:
        lines.append(f"{int(run[i]) + 1},{x[i]:.6g},{'up' if direction[i] > 0 else 'down'},{room[i]:.2f},{y[i]:.6f}")
    options = ["--period", f"{column}={base:g}"] if known and not angle else []
    return "\n".join(lines) + "\n", column, options, {
        "base": base, "column": column, "orders": {k: scale * a for k, (a, _) in truth.items()}, "largest": largest,
        "unit": unit, "turns": int(turns), "disturbed": bool(disturbed), "oracle": sees}


def ask(program, text, column, options):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "table.csv")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        done = subprocess.run([program, "loop", "--table", path, "--response", "error_um", "--model", f"1 + {column}",
                               *options, "-o", "-"], capture_output=True, text=True)
    if done.returncode not in (0, 2, 3) or not done.stdout:  # 3: suspected
        raise RuntimeError(f"exit code {done.returncode}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def cycles_of(report, column):
    """The claimed orders as (period, amplitude, U, u of the period)."""
    out = []
    for claim in report["claims"]:
        if claim["id"] != "table.periodic" or claim["coordinates"] != [column]:
            continue
        base, u = claim["parameters"]["period"], claim["uncertainty"]["period"] or 0.0
        t = (claim["amplitude_interval_95"][1] - claim["amplitude"]) / claim["u_amplitude"] if claim["u_amplitude"] else 2
        out += [(base / o["order"], o["amplitude"], t * o["u_amplitude"], u / o["order"]) for o in claim["orders"]]
    return out


def judge(report, truth):
    """Of the largest order: found, its period's relative error, amplitude within U; orders that are none."""
    said = cycles_of(report, truth["column"])
    true = {truth["base"] / k: a for k, a in truth["orders"].items()}
    period = truth["base"] / truth["largest"]
    near = [s for s in said if abs(s[0] / period - 1) < 0.02]
    extra = [s for s in said if not any(abs(s[0] / p - 1) < 0.03 and a > 0 for p, a in true.items())]
    tied = any(f"table.periodic({truth['column']})" in [a["name"] for a in c["alias_class"]] for c in report["claims"])
    pairs = [(a >= CLEAR * truth["unit"], abs(s[1] - a) <= s[2]) for s in said for p, a in true.items() if abs(s[0] / p - 1) < 0.02]
    return {"found": bool(near), "tied": tied, "off": abs(near[0][0] / period - 1) if near else None,
            "period_within": abs(near[0][0] - period) <= 2 * near[0][3] if near and near[0][3] else None,
            "within": [w for _, w in pairs], "within_clear": [w for clear, w in pairs if clear], "extra": len(extra), "claims": [c["name"] for c in report["claims"]],
            "curve": bool(report["unattributed"]), "verdict": report["verdict"]}


def one(job):
    program, seed, way, kind, rows, known, size = job
    text, column, options, truth = make(seed, way, kind, rows, known, size)
    return {"way": way, "kind": kind, "rows": rows, "known": known, "size": size, "disturbed": truth["disturbed"],
            "oracle": truth["oracle"], **judge(ask(program, text, column, options), truth)}


def jobs(program, seed, count, sizes, start=0):
    """Every way, kind of places and base in turn, at the sizes and numbers of rows."""
    out = []
    for i in range(start, start + count):
        rows = ROWS[(i // 2) % len(ROWS)]
        out.append((program, seed + i, WAYS[i % 2], PLACES[(i // 3) % 3], rows, (i // 2) % 2 == (i // 16) % 2,
                    sizes[(i // 5) % len(sizes)]))
    return out


def percent(part, whole):
    return f"{100 * part / whole:.0f} % of {whole}" if whole else "–"


def line(name, done):
    """A row of the page's table."""
    found = [d for d in done if d["found"]]
    off = sorted(d["off"] for d in found if not d["known"])
    within, clear = ([w for d in done for w in d[which]] for which in ("within", "within_clear"))
    bound = [d["period_within"] for d in found if d["period_within"] is not None]
    return [name, len(done), percent(sum(d["oracle"] for d in done), len(done)), percent(len(found), len(done)), percent(sum(d["found"] or d["tied"] for d in done), len(done)),
            f"{100 * statistics.median(off):.2f} %" if off else "–",
            percent(sum(o < 0.002 for o in off), len(off)), percent(sum(bound), len(bound)), percent(sum(within), len(within)),
            percent(sum(clear), len(clear)),
            percent(sum(d["extra"] > 0 for d in done), len(done))]


def page(done, clean, arguments):
    out = ["# Cycles over a column", "",
           "Encoders, screws and scales made from known errors, beside a declared slope; in half of them also a backlash and a",
           "drift over the runs. The size is that of the largest order, in standard errors of an amplitude. The",
           "oracle tests that order alone, with its period and all else that is true given, at 1 % over the periods that a search tries.", "",
           f"    /usr/bin/python3 tests/bench/loop_cycles.py build/foilgauge --tables {arguments.tables} --clean {arguments.clean} "
           f"--seed {arguments.seed}", ""]
    head = ["tables", "number", "an oracle sees it", "largest order found", "found or tied", "sought period off, median", "off by less than 0.2 %",
            "period within U", "amplitudes within U",
            f"of orders of {CLEAR} standard errors or more", "with an order that is none"]
    out += ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    groups = [("all", done)]
    groups += [(f"size {s:g}", [d for d in done if d["size"] == s]) for s in sorted({d["size"] for d in done})]
    for known in (True, False):
        word = "base known" if known else "base sought"
        groups += [(f"{word}, size {s:g}", [d for d in done if d["known"] == known and d["size"] == s])
                   for s in sorted({d["size"] for d in done})]
    groups += [(w, [d for d in done if d["way"] == w]) for w in WAYS]
    groups += [(f"{k} places", [d for d in done if d["kind"] == k]) for k in PLACES]
    groups += [("with backlash and drift", [d for d in done if d["disturbed"]]), ("without", [d for d in done if not d["disturbed"]])]
    groups += [(f"{r} rows", [d for d in done if d["rows"] == r]) for r in ROWS]
    out += ["| " + " | ".join(str(c) for c in line(n, g)) + " |" for n, g in groups if g]
    claimed = [d for d in clean if d["claims"] or d["curve"]]
    cyclic = [d for d in clean if any(c.startswith("table.periodic") for c in d["claims"])]
    out += ["", "An order that is hardly seen is found where noise makes it larger: of those the amplitudes lie beyond U more often. A sought",
            "period is as sharp as its rows let it be (u / P = sqrt(3) / pi / (its cycles × its size)): of 4 to 8 cycles 1.1 to",
            "2.3 % at 6 standard errors, 0.3 to 0.7 % at 20; 0.2 % needs more turns, or a base that is known.", ""]
    out += [f"Clean tables: of {len(clean)} {len(claimed)} have a claim ({100 * len(claimed) / max(len(clean), 1):.1f} %), "
            f"{len(cyclic)} of a cycle.", ""]
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--tables", type=int, default=240)
    parser.add_argument("--clean", type=int, default=240)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sizes", type=float, nargs="+", default=[6, 10, 20])
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", default="reports")
    parser.add_argument("--show", action="store_true", help="every table that is not as it should be")
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.program)
    asked = jobs(program, arguments.seed, arguments.tables, arguments.sizes)
    asked += [(*j[:6], 0.0) for j in jobs(program, arguments.seed + 100000, arguments.clean, [0.0])]
    with Pool(arguments.jobs) as pool:
        answers = pool.map(one, asked, chunksize=1)
    done, clean = [a for a in answers if a["size"]], [a for a in answers if not a["size"]]
    if arguments.show:
        for job, answer in zip(asked, answers):
            if answer["size"] and (not answer["found"] or answer["extra"]) or not answer["size"] and answer["claims"]:
                print(job[1:], answer, file=sys.stderr)
    with open(os.path.join(arguments.out, "loop_cycles.md"), "w", encoding="utf-8") as file:
        file.write(page(done, clean, arguments))


if __name__ == "__main__":
    main()
