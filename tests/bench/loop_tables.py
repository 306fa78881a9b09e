"""loop_tables.py PROGRAM -o FOLDER [--clean N] [--effects N] [--unlisted N] [--seed N] [--jobs N]

Generated tables with known truth through `foilgauge loop`: false claims on clean tables, effects
named at twice the smallest detectable amplitude, intervals, errors on data kept aside. The
generator shares no code with the program: effects are written out here from their definitions.

The smallest detectable amplitude of an effect is the program's own statement for the same table
without the effect ("smallest_amplitude": found with a power of 80 %); twice that is injected, as
half the range over the rows.
"""

import argparse
import csv
import json
import math
import multiprocessing
import os
import subprocess
import tempfile

import numpy as np

KINDS = ["white", "correlated", "heavy_tailed", "unequal_variance", "outliers", "bump_scatter"]
SIGMA = 0.5


def noise(rng, kind, layout):
    """Noise of sd about SIGMA for every row, and the rows that are outliers by intent."""
    n = layout["n"]
    e = rng.normal(size=n)
    outlier = []
    if kind == "correlated":
        rho = 0.5
        for block in layout["series"]:
            for i, k in zip(block[1:], block[:-1]):
                e[i] = rho * e[k] + math.sqrt(1 - rho * rho) * e[i]
    elif kind == "heavy_tailed":
        e = rng.standard_t(4, size=n) / math.sqrt(2)
    elif kind == "unequal_variance":
        x = layout["columns"][layout["spread_by"]]
        share = (x - x.min()) / (x.max() - x.min())
        scale = 0.4 + 1.6 * share
        e = e * scale / math.sqrt(np.mean(scale**2))
    elif kind == "outliers":
        hit = rng.random(n) < 0.01
        outlier = list(np.flatnonzero(hit))
        e[hit] += rng.choice([-1, 1], size=hit.sum()) * rng.uniform(5, 12, size=hit.sum())
    if layout["group"] is not None:
        level = rng.normal(size=layout["groups"]) * rng.choice([0.3, 0.7, 1.2])
        if kind == "bump_scatter":  # the scatter differs from foil to foil
            e = e * rng.uniform(0.4, 1.8, size=layout["groups"])[layout["group"]]
        e = e + level[layout["group"]]
    return SIGMA * e, outlier


def runs_small(rng):
    """9 to 20 runs: two or three factors at two levels with centre points, in random order."""
    n = int(rng.integers(9, 21))
    design = [(t, d) for t in (500.0, 600.0) for d in (3.0, 5.0)]
    rows = [design[i % 4] if i % 5 < 4 else (550.0, 4.0) for i in range(n)]
    rows = [rows[i] for i in rng.permutation(n)]
    t = np.array([r[0] for r in rows])
    d = np.array([r[1] for r in rows])
    columns = {"run": np.arange(1.0, n + 1), "temperature_C": t, "duration_h": d,
               "humidity_pct": rng.uniform(15, 60, n).round(2)}
    return {"name": "small", "n": n, "columns": columns, "words": {}, "model": "1 + temperature_C + duration_h",
            "x": np.column_stack([np.ones(n), (t - 550) / 50, d - 4]), "group": None,
            "series": [list(range(n))], "spread_by": "humidity_pct", "response": "springback"}


def runs_medium(rng, n=None):
    """A central composite design with replicates, and columns the model does not use."""
    n = n or int(rng.integers(24, 41))
    corner = [(p, t, d) for p in (300, 400) for t in (500, 600) for d in (3, 5)]
    axial = [(350, 450, 4), (350, 650, 4), (350, 550, 1), (350, 550, 7), (350, 550, 4)]
    points = (corner + axial) * (n // 13 + 1)
    rows = np.array([points[i] for i in rng.permutation(n)], dtype=float)
    p, t, d = rows.T
    shelf = rng.integers(0, 3, n)
    columns = {"run": np.arange(1.0, n + 1), "pressure_bar": p, "temperature_C": t, "duration_h": d,
               "humidity_pct": rng.uniform(15, 60, n).round(2)}
    c = (t - 550) / 50
    return {"name": "medium", "n": n, "columns": columns, "words": {"shelf": [f"S{k + 1}" for k in shelf]},
            "model": "1 + pressure_bar + temperature_C + duration_h + temperature_C^2",
            "x": np.column_stack([np.ones(n), (p - 350) / 50, c, d - 4, c * c]), "group": None,
            "series": [list(range(n))], "spread_by": "humidity_pct", "response": "springback"}


def lot(rng):
    """14 foils of 9 bumps."""
    foil = np.repeat(np.arange(14), 9)
    bump = np.tile(np.arange(1.0, 10), 14)
    coil = np.array([1 + k // 5 for k in range(14)], dtype=float)
    room = rng.uniform(18, 23, 14).round(3)
    columns = {"foil": foil + 1.0, "bump": bump, "coil": coil[foil], "room_C": room[foil]}
    return {"name": "lot", "n": 126, "columns": columns,
            "words": {"die_cavity": ["ABC"[k % 3] for k in foil]}, "model": "1",
            "x": np.ones((126, 1)), "group": foil, "groups": 14,
            "series": [list(range(9 * k, 9 * k + 9)) for k in range(14)], "spread_by": "bump",
            "response": "radius_change"}


LAYOUTS = {"small": runs_small, "medium": runs_medium, "lot": lot}


def unit(f):
    """Half range 1."""
    return 2 * (f - f.min()) / (f.max() - f.min()) - 1


def dummies(rng, words):
    levels = sorted(set(words))
    size = rng.permutation(np.linspace(-1, 1, len(levels)))
    return unit(np.array([size[levels.index(w)] for w in words]))


# name as the program writes it: what is added to the response, of half range 1
EFFECTS = {
    "small": {
        "table.linear(humidity_pct)": lambda rng, l: unit(l["columns"]["humidity_pct"]),
        "table.interaction(temperature_C, duration_h)": lambda rng, l: unit(
            (l["columns"]["temperature_C"] - 550) * (l["columns"]["duration_h"] - 4)),
        "table.order_drift(run)": lambda rng, l: unit(l["columns"]["run"]),
        "table.outlier": "outlier",
    },
    "medium": {
        "table.linear(humidity_pct)": lambda rng, l: unit(l["columns"]["humidity_pct"]),
        "table.quadratic(humidity_pct)": lambda rng, l: unit(
            (l["columns"]["humidity_pct"] - rng.uniform(32, 42)) ** 2),
        "table.threshold(humidity_pct)": lambda rng, l: unit(
            (l["columns"]["humidity_pct"] > rng.uniform(28, 45)).astype(float)),
        "table.factor(shelf)": lambda rng, l: dummies(rng, l["words"]["shelf"]),
        "table.interaction(pressure_bar, temperature_C)": lambda rng, l: unit(
            (l["columns"]["pressure_bar"] - 350) * (l["columns"]["temperature_C"] - 550)),
        "table.order_drift(run)": lambda rng, l: unit(l["columns"]["run"]),
        "table.order_transient(run)": lambda rng, l: unit(
            np.exp(-(l["columns"]["run"] - 1) / rng.uniform(2, 6))),
        "table.periodic(run)": lambda rng, l: unit(
            np.sin(2 * math.pi * l["columns"]["run"] / rng.uniform(4, 9) + rng.uniform(0, 6.28))),
        "process.log_time(duration_h)": lambda rng, l: unit(np.log(l["columns"]["duration_h"])),
        "table.outlier": "outlier",
        "table.exchanged_runs": "exchange",
    },
    "lot": {
        "part.lip_decay(bump)": lambda rng, l: unit(
            np.exp(-(l["columns"]["bump"] - 1) / rng.uniform(1, 3))),
        "table.order_drift(bump)": lambda rng, l: unit(l["columns"]["bump"]),
        "table.order_drift(foil)": lambda rng, l: unit(l["columns"]["foil"]),
        "table.linear(room_C)": lambda rng, l: unit(l["columns"]["room_C"]),
        "table.factor(die_cavity)": lambda rng, l: dummies(rng, l["words"]["die_cavity"]),
        "table.threshold(foil)": lambda rng, l: unit(
            (l["columns"]["foil"] > rng.integers(4, 11) + 0.5).astype(float)),
    },
}


def hump(x, rng):
    at = rng.uniform(0.3, 0.7)
    return np.exp(-(((x - at) / 0.1) ** 2) / 2)


def two_humps(x, rng):
    at = rng.uniform(0.15, 0.3)
    return np.exp(-(((x - at) / 0.08) ** 2) / 2) - np.exp(-(((x - at - 0.5) / 0.08) ** 2) / 2)


def triangles(x, rng):
    return 2 * np.abs(((2 * x + rng.uniform(0, 1)) % 1) - 0.5)


def plateau(x, rng):
    at = rng.uniform(0.25, 0.4)
    return 1 / (1 + np.exp(-(x - at) / 0.03)) - 1 / (1 + np.exp(-(x - at - 0.3) / 0.03))


SHAPES = [hump, plateau, two_humps, triangles]


def write_table(path, layout, y):
    columns = {**layout["columns"], **layout["words"], layout["response"]: y}
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for row in zip(*columns.values()):
            writer.writerow([v if isinstance(v, str) else repr(float(v)) for v in row])


def loop(program, layout, y, seed):
    with tempfile.TemporaryDirectory() as folder:
        table = os.path.join(folder, "t.csv")
        write_table(table, layout, y)
        command = [program, "loop", "--table", table, "--response", layout["response"], "--model",
                   layout["model"], "--seed", str(seed), "-o", "-"]
        if layout["group"] is not None:
            command += ["--group", "foil"]
        done = subprocess.run(command, capture_output=True, check=True)
        return json.loads(done.stdout)


def base(rng, layout):
    return layout["x"] @ rng.normal(size=layout["x"].shape[1]) * 3


def bare(name):
    return name.split("(")[0] if name.startswith(("table.outlier", "table.exchanged")) else name


def classes(report):
    """For every claim the names in its class, its own first."""
    return [[bare(c["name"])] + [bare(a["name"]) for a in c["alias_class"]] for c in report["claims"]]


def held(report):
    return [r - 1 for r in report["inputs"][0]["kept_aside"]]


def oracle(layout, y, extra, aside):
    """Squared error on rows kept aside of a fit that knows the effect's form."""
    if not aside:
        return None
    keep = np.setdiff1d(np.arange(layout["n"]), aside)
    x = np.column_stack([layout["x"]] + extra)
    beta = np.linalg.lstsq(x[keep], y[keep], rcond=None)[0]
    return float(np.mean((y[aside] - x[aside] @ beta) ** 2))


def record(job, layout, report, **more):
    row = {"index": job["index"], "class": job["class"], "kind": job["kind"], "layout": layout["name"],
           "rows": layout["n"], "verdict": report["verdict"], "truth": job.get("truth", ""),
           "claims": " | ".join(c["name"] for c in report["claims"]),
           "unattributed": (report["unattributed"] or {}).get("coordinate", ""),
           "held_out_before": report["before"]["held_out_rms"],
           "held_out_after": report["after"]["held_out_rms"]}
    row.update(more)
    return row


def run_clean(job, rng):
    layout = LAYOUTS[job["layout"]](rng)
    e, outliers = noise(rng, job["kind"], layout)
    report = loop(job["program"], layout, base(rng, layout) + e, job["index"])
    true_outliers = false = 0
    for claim in report["claims"]:
        if claim["id"] == "table.outlier" and claim["parameters"]["row"] - 1 in outliers:
            true_outliers += 1
        else:
            false += 1
    false += report["unattributed"] is not None
    return record(job, layout, report, false=int(false > 0), true_outliers=true_outliers)


def smallest(report, name):
    for one in report["rejected"]:
        if bare(one["name"]) == name and one["smallest_amplitude"] is not None:
            return one["smallest_amplitude"]
    return None


def inject_lone(rng, what, layout, y, size, aside):
    """In rows that take part: what is kept aside cannot be found wrong."""
    n = layout["n"]
    y = y.copy()
    rows = np.setdiff1d(np.arange(n), aside)
    i = int(rng.choice(rows))
    if what == "outlier":
        y[i] += rng.choice([-1, 1]) * size
        f = np.zeros(n)
        f[i] = 1
        return y, [f], size, [i]
    for i in rng.permutation(rows):
        far = [k for k in rows if abs(y[k] - y[i]) >= 2 * size]
        if far:
            k = int(rng.choice(far))
            true = y.copy()
            y[i], y[k] = true[k], true[i]
            return y, true, abs(true[i] - true[k]) / 2, [int(i), int(k)]
    return None, None, None, None


def run_effect(job, rng):
    layout = LAYOUTS[job["layout"]](rng)
    e, _ = noise(rng, job["kind"], layout)
    start = base(rng, layout)
    clean = loop(job["program"], layout, start + e, job["index"])
    names = list(EFFECTS[job["layout"]])
    for name in np.roll(names, -(job["index"] // 6 % len(names))):
        name = str(name)
        least = smallest(clean, name)
        if least is None:
            continue
        form = EFFECTS[job["layout"]][name]
        amplitude, rows, extra, put_right = 2 * least, None, [], None
        if isinstance(form, str):
            y, got, amplitude, rows = inject_lone(rng, form, layout, start + e, amplitude,
                                                   held(clean))
            if y is None:
                continue
            if form == "outlier":
                extra = got
            else:
                put_right = got
        else:
            f = form(rng, layout)
            extra = [f]
            y = start + e + amplitude * f * rng.choice([-1, 1])
        break
    else:
        return None
    job["truth"] = name
    report = loop(job["program"], layout, y, job["index"])
    found = classes(report)
    named = any(name in c for c in found)
    exact = any(c[0] == name for c in found)
    wrong = any(name not in c for c in found)
    if rows is not None:
        rows_found = [{c["parameters"].get("row"), c["parameters"].get("second_row")} - {None}
                      for c in report["claims"] if c["id"] == name]
        exact = any(r == {k + 1 for k in rows} for r in rows_found)
    covered = ""
    for claim in report["claims"]:
        if bare(claim["name"]) == name and name != "table.exchanged_runs":
            low, high = claim["amplitude_interval_95"]
            covered = int(low <= amplitude <= high)
    aside = held(report)
    floor = oracle(layout, y if put_right is None else put_right, extra, aside)
    return record(job, layout, report, named=int(named), exact=int(exact), wrong=int(wrong),
                  tied=sum(len(c) - 1 for c in found), amplitude=amplitude, covered=covered,
                  floor_squared="" if floor is None else floor)


def run_unlisted(job, rng):
    layout = runs_medium(rng, int(rng.integers(40, 81)))
    e, _ = noise(rng, job["kind"], layout)
    start = base(rng, layout)
    clean = loop(job["program"], layout, start + e, job["index"])
    column = "humidity_pct" if job["index"] % 3 else "run"
    least = smallest(clean, f"table.threshold({column})")
    if least is None:
        return None
    # over the order waves and two humps are (nearly) a periodic change, which the table lists
    shape = SHAPES[job["index"] // 3 % (2 if column == "run" else len(SHAPES))]
    x = layout["columns"][column]
    f = unit(shape((x - x.min()) / (x.max() - x.min()), rng))
    job["truth"] = f"{shape.__name__}({column})"
    report = loop(job["program"], layout, start + e + 4 * least * f, job["index"])
    right = (report["unattributed"] or {}).get("coordinate") == column
    floor = oracle(layout, start + e + 4 * least * f, [f], held(report))
    wrong = any(column not in name for names in classes(report) for name in names[:1])
    return record(job, layout, report, named=int(right), wrong=int(wrong), amplitude=4 * least,
                  floor_squared="" if floor is None else floor)


RUN = {"clean": run_clean, "effect": run_effect, "unlisted": run_unlisted}


def run(job):
    rng = np.random.default_rng([job["seed"], job["index"]])
    return RUN[job["class"]](job, rng)


def jobs(arguments):
    index = 0
    for i in range(arguments.clean):
        kind = KINDS[i % 6]
        layout = "lot" if kind == "bump_scatter" else ["small", "medium", "medium", "lot"][(i // 6) % 4]
        yield {"class": "clean", "kind": kind, "layout": layout, "index": index}
        index += 1
    for i in range(arguments.effects):
        yield {"class": "effect", "kind": ["white", "white", "heavy_tailed", "unequal_variance"][i % 4],
               "layout": ["medium", "medium", "medium", "lot", "lot", "small"][i % 6], "index": index}
        index += 1
    for _ in range(arguments.unlisted):
        yield {"class": "unlisted", "kind": "white", "layout": "medium", "index": index}
        index += 1


def share(rows, key):
    values = [int(r[key]) for r in rows if r.get(key, "") != ""]
    return sum(values), len(values)


def percent(count, total):
    return f"{count} of {total} ({100 * count / total:.1f} %)" if total else "none"


def pooled(rows):
    pairs = [(float(r["held_out_after"]) ** 2, float(r["floor_squared"])) for r in rows
             if r.get("floor_squared", "") != "" and r["held_out_after"] is not None]
    if not pairs:
        return "-"
    a, b = np.array(pairs).T
    return f"{math.sqrt(a.sum() / b.sum()):.3f}"


def table(rows, head, line):
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] + [line(*r) for r in rows] + [""]


def by(rows, key):
    return {k: [r for r in rows if r[key] == k] for k in dict.fromkeys(r[key] for r in rows)}


def summary(rows, arguments):
    clean, effect, unlisted = (by(rows, "class").get(k, []) for k in ("clean", "effect", "unlisted"))
    out = ["# The loop on generated tables", "",
           f"{len(rows)} tables: {len(clean)} clean, {len(effect)} with one effect of the table at twice its "
           f"smallest detectable amplitude, {len(unlisted)} with an effect that the table does not list.",
           "Small tables have 9 to 20 runs, medium ones 24 to 40 (unlisted: 40 to 80), lots 14 foils of 9 bumps.", "",
           f"    tests/bench/loop_tables.sh        # seed {arguments.seed}; every table's own seed is its index", "",
           "## Clean tables: false claims", ""]
    out += table(by(clean, "kind").items(), ["noise", "false claims", "true outliers named"],
                 lambda k, r: f"| {k} | {percent(*share(r, 'false'))} | {share(r, 'true_outliers')[0]} |")
    out += table(by(clean, "layout").items(), ["layout", "false claims"],
                 lambda k, r: f"| {k} | {percent(*share(r, 'false'))} |")
    out += ["A wrong response (1 % outliers) that the loop names as one is no false claim and is counted apart.", "",
            "## Effects of the table, at twice the smallest detectable amplitude", "",
            "Named: the truth is a claim or in a claim's alias class. Exact: the claim itself. Wrong cause: a claim "
            "without the truth in its class. Covered: 95 % intervals of the amplitude. Kept aside: error after, over "
            "that of a fit which knows the form.", ""]
    head = ["effect", "named", "exact", "wrong cause", "covered", "kept aside"]
    line = lambda k, r: (f"| {k} | {percent(*share(r, 'named'))} | {percent(*share(r, 'exact'))} | "
                         f"{percent(*share(r, 'wrong'))} | {percent(*share(r, 'covered'))} | {pooled(r)} |")
    out += table(list(by(effect, "truth").items()) + [("all", effect)], head, line)
    out += table(by(effect, "layout").items(), ["layout"] + head[1:], line)
    out += table(by(effect, "kind").items(), ["noise"] + head[1:], line)
    out += ["## Effects that the table does not list", "",
            "Four times the smallest step that would show. Named: `unattributed` on the right column.", ""]
    out += table(list(by(unlisted, "truth").items()) + [("all", unlisted)],
                 ["shape(column)", "named", "wrong column", "kept aside"],
                 lambda k, r: f"| {k} | {percent(*share(r, 'named'))} | {percent(*share(r, 'wrong'))} | {pooled(r)} |")
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--clean", type=int, default=2040)
    parser.add_argument("--effects", type=int, default=800)
    parser.add_argument("--unlisted", type=int, default=200)
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    work = [{**j, "program": arguments.program, "seed": arguments.seed} for j in jobs(arguments)]
    with multiprocessing.Pool(arguments.jobs) as pool:
        rows = [r for r in pool.imap(run, work, chunksize=4) if r]
    names = list(dict.fromkeys(k for r in rows for k in r))
    with open(os.path.join(arguments.output, "loop_tables.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in r.items()} for r in rows)
    with open(os.path.join(arguments.output, "loop_tables.md"), "w", encoding="utf-8") as file:
        file.write(summary(rows, arguments))
    print(summary(rows, arguments))


if __name__ == "__main__":
    main()
