# SPDX-License-Identifier: GPL-3.0-or-later
"""loop_power.py PROGRAM [--kinds K,K] [--sizes 4,6] [--designs D,D] [--tables N] [--clean N] [--clean-kinds K]
                       [--seed N] [--jobs N] [--out FOLDER] [--fresh] [--report-only] [--no-peer] [--keep FOLDER]

Power of `foilgauge loop --table` against an oracle that knows every effect's form and the noise
(loop_power_tables.py), and claims on clean tables. Writes loop_power.csv, which a second run continues, and
loop_power.md. A look in a minute:

    python3 tests/bench/loop_power.py build/foilgauge --out /tmp/look --fresh --designs experiment --sizes 6,10 \
        --kinds drift,outlier --tables 6 --clean 0
"""

import argparse
import csv
import json
import multiprocessing
import os
import shlex
import subprocess
import tempfile
import time

import loop_power_peer as peer
import loop_power_tables as tables
from kept_rows import forget_seeds, read_rows, write_rows
from loop_names import curve_over, member, members
from loop_power_report import summary

FIELDS = ["design", "kind", "size", "table", "seed", "verdict", "found", "claimed", "exact", "wrong", "truth", "claims",
          "alias_class", "unattributed", "suspects", "family_p", "ratio_cross_validated", "peer_claimed", "peer_found", "peer", "oracle_z", "seconds"]
SECONDS_AT_MOST = 300


def write_table(path, design, y):
    columns = {**design.columns, **design.words, "response": y}
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for row in zip(*columns.values()):
            writer.writerow([v if isinstance(v, str) else repr(float(v)) for v in row])


def command_of(program, design, path):
    command = [program, "loop", "--table", path, "--response", "response", "--model", design.model, "-o", "-"]
    if design.group:
        command += ["--group", design.group]
    if design.name != "lot":  # of a lot the bump's number is one by itself
        command += ["--order", design.order[0]]
    return command


def keep(job, design, y, truth):
    """The table as a file, and its truth and command in a list, for a closer look."""
    path = os.path.join(job["keep"], f"{job['design']}_{job['kind']}_{job['size']}_{job['table']}.csv")
    write_table(path, design, y)
    words = "clean" if truth is None else describe(truth)
    with open(os.path.join(job["keep"], "commands.txt"), "a", encoding="utf-8") as file:
        file.write(f"# {words}\n{shlex.join(command_of(job['program'], design, path))}\n")


def ask(program, design, y):
    """The program's report, or None where it failed, and the seconds it took."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "t.csv")
        write_table(path, design, y)
        command = command_of(program, design, path)
        start = time.monotonic()
        try:
            done = subprocess.run(command, capture_output=True, timeout=SECONDS_AT_MOST)
            report = json.loads(done.stdout) if done.returncode in (0, 3) else None
        except subprocess.TimeoutExpired:
            report = None
        return report, time.monotonic() - start


# ---- claims against the truth ----


def right_member(name, truth):
    """That one name, or that sum of two, is the truth."""
    parts = [member(part) for part in name.split(" + ")]
    rows = frozenset(str(r + 1) for r in truth.rows)
    if rows:  # outliers: the rows themselves, one by one, together or exchanged
        lone = [p for p in parts if p[0] in ("table.outlier", "table.exchanged_runs")]
        return len(lone) == len(parts) and frozenset().union(*(p[1] for p in lone)) == rows
    if len(parts) > 1:
        return False
    identity, where = parts[0]
    if truth.anywhere:
        return truth.anywhere in where
    if identity == "table.serial_correlation":
        return any(i == identity for i, _ in truth.accepted)
    return (identity, where) in truth.accepted


def part_of_it(name, truth):
    """Of several wrong rows, one or some of them and no other."""
    parts = [member(part) for part in name.split(" + ")]
    rows = {str(r + 1) for r in truth.rows}
    return bool(rows) and all(i == "table.outlier" and where <= rows for i, where in parts)


def lone_rows(report):
    return {row for c in report["claims"] if c["id"] == "table.outlier" for row in member(members(c)[0])[1]}


def judge(report, truth):
    said = [members(c) for c in report["claims"]]
    curve = curve_over(report)
    right = [any(right_member(n, truth) for n in names) for names in said]
    found = any(right) or bool(truth.anywhere and truth.anywhere in curve)
    exact = any(right_member(names[0], truth) for names in said) or bool(truth.anywhere and truth.anywhere in curve)
    if truth.rows:  # several outliers may be claimed one by one
        all_of_them = {str(r + 1) for r in truth.rows} <= lone_rows(report)
        found, exact = found or all_of_them, exact or all_of_them
        right = [r or any(part_of_it(n, truth) for n in names) for r, names in zip(right, said)]
    return {"found": int(found), "claimed": int(bool(said or curve)), "exact": int(exact),
            "wrong": int(not all(right)), **said_words(report, said, curve)}


def said_words(report, said, curve):
    return {"verdict": report["verdict"], "claims": " | ".join(n[0] for n in said), "unattributed": curve,
            "alias_class": " | ".join("; ".join(n[1:]) for n in said),
            "suspects": " | ".join("; ".join([s["name"]] + [a["name"] for a in s["alias_class"]]) for s in report.get("suspects", [])),
            "family_p": smallest_p(report), "ratio_cross_validated": report["error_ratio"].get("cross_validated", "")}


def smallest_p(report):
    """Over everything that was tried: what the report states for all of it, else the least p-value in it."""
    if report.get("family_p_value") is not None:
        return report["family_p_value"]
    p = [c["p_value"] for c in report["claims"] + report["rejected"] if c.get("p_value") is not None]
    curve = report["unattributed"]
    p += [curve["p_value"]] if curve and curve["p_value"] is not None else []
    return min(p) if p else ""


ALLOWED = tables.ALLOWED


def judge_clean(report, kind):
    """found: a claim that the noise does not justify. Unequal spread may be called table.spread, correlation
    table.serial_correlation or a name that is tied with it."""
    said = [members(c) for c in report["claims"]]
    allowed = ALLOWED.get(kind)
    false = [not any(allowed and member(n)[0] == allowed for n in names) for names in said]
    curve = curve_over(report)
    return {"found": int(any(false) or bool(curve)), "claimed": int(bool(said or curve)), "exact": "", "wrong": "",
            **said_words(report, said, curve)}


def blank():
    return {"verdict": "failed", "found": 0, "claimed": 0, "exact": 0, "wrong": 0, "claims": "", "unattributed": "",
            "alias_class": "", "suspects": "", "family_p": "", "ratio_cross_validated": ""}


# ---- one table ----


def describe(truth):
    if truth.rows:
        return "rows " + " ".join(str(r + 1) for r in sorted(truth.rows))
    if truth.anywhere:
        return f"curve({truth.anywhere})"
    return " or ".join(sorted(f"{i}({', '.join(sorted(c))})" for i, c in truth.accepted))


def beside(job, design, y, truth):
    if job["no_peer"]:
        return {"peer_claimed": "", "peer_found": "", "peer": ""}
    passed, identity, where = peer.search(design, y, job["table"])
    name = f"{identity}({', '.join(str(w + 1) if identity == 'table.outlier' else w for w in where)})"
    right = passed and truth is not None and right_member(name, truth)
    return {"peer_claimed": int(passed), "peer_found": int(right), "peer": name if passed else ""}


def run(job):
    clean = job["size"] == 0
    if clean:
        design, y = tables.clean_table(job["design"], job["kind"], job["seed"], job["table"])
        truth = None
    else:
        made = tables.effect_table(job["design"], job["kind"], job["size"], job["seed"], job["table"])
        if made is None:
            return None
        design, truth, y = made
    if job["keep"]:
        keep(job, design, y, truth)
    report, seconds = ask(job["program"], design, y)
    row = {k: job[k] for k in ("design", "kind", "size", "table", "seed")}
    row.update(blank() if report is None else judge_clean(report, job["kind"]) if clean else judge(report, truth))
    row.update(truth="" if clean else describe(truth), seconds=round(seconds, 2),
               oracle_z="" if clean else tables.oracle_z(truth, design, y), **beside(job, design, y, truth))
    return row


def jobs(a):
    effects = [(d, k, s, t) for t in range(a.tables) for s in a.sizes for d in a.designs for k in a.kinds]
    clean = [(d, k, 0, t) for t in range(a.clean) for d in a.designs for k in a.clean_kinds]
    for d, k, s, t in clean + effects:
        yield {"design": d, "kind": k, "size": s, "table": t, "seed": a.seed, "program": a.program, "no_peer": a.no_peer,
               "keep": a.keep}


def key(row):
    return tuple(str(row[k]) for k in ("design", "kind", "size", "table", "seed"))


def work(a, path):
    done = {key(r) for r in read_rows(path)}
    todo = [j for j in jobs(a) if key(j) not in done]
    print(f"{len(done)} done, {len(todo)} to do", flush=True)
    new = not done
    with open(path, "a", newline="", encoding="utf-8") as file, multiprocessing.Pool(a.jobs) as pool:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        if new:
            writer.writeheader()
        for n, row in enumerate(pool.imap_unordered(run, todo, chunksize=1), 1):
            if row:
                writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})
                file.flush()
            if n % 50 == 0:
                print(f"{n} of {len(todo)}", flush=True)


def options():
    words = lambda known: lambda text: [w for w in text.split(",") if w in known or parser.error(f"no {w}: {known}")]
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program")
    parser.add_argument("--kinds", type=words(tables.KINDS), default=tables.KINDS)
    parser.add_argument("--sizes", type=lambda text: [int(s) for s in text.split(",")], default=[4, 6, 8, 10])
    parser.add_argument("--designs", type=words(list(tables.DESIGNS)), default=list(tables.DESIGNS))
    parser.add_argument("--tables", type=int, default=6, help="of each kind, size and design")
    parser.add_argument("--clean", type=int, default=12, help="clean tables of each noise and design")
    parser.add_argument("--clean-kinds", type=words(tables.CLEAN), default=tables.CLEAN)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", default="reports")
    parser.add_argument("--fresh", action="store_true", help="forget the rows of this seed that the CSV has")
    parser.add_argument("--report-only", action="store_true")
    parser.add_argument("--no-peer", action="store_true")
    parser.add_argument("--keep", help="a folder for the tables and their commands")
    return parser.parse_args()


def main():
    a = options()
    for folder in filter(None, (a.out, a.keep)):
        os.makedirs(folder, exist_ok=True)
    path = os.path.join(a.out, "loop_power.csv")
    if a.fresh:
        forget_seeds(path, [a.seed])
    if not a.report_only:
        work(a, path)
        rows = sorted(read_rows(path), key=lambda r: (r["design"], r["kind"], int(r["size"]), int(r["table"]), int(r["seed"])))
        write_rows(path, rows, FIELDS)
    text = summary(read_rows(path), tables)
    with open(os.path.join(a.out, "loop_power.md"), "w", encoding="utf-8") as file:
        file.write(text)
    print(text)


if __name__ == "__main__":
    main()
