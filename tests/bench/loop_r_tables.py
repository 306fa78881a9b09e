# SPDX-License-Identifier: GPL-3.0-or-later
"""loop_r_tables.py PROGRAM [--seeds N] [--only TABLE] [--out FOLDER] [--jobs N]

Measured tables that come with R (loop_r_tables.R; needs Rscript with MASS, boot, nlme, lattice) through `foilgauge loop`:
the findings of the literature beside the claims. R's data go to a temporary folder only. Writes
loop_r_tables.md.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from multiprocessing import Pool

from loop_measured import ROOT, ask, is_one, judge, number, signature
from loop_names import classes

HERE = os.path.dirname(os.path.abspath(__file__))


def as_case(c):
    """The case as loop_measured.py judges it. Where something is known to be lacking, more may be claimed; of a clean
    table nothing may."""
    findings = [{"what": " or ".join(names[:3]) + (" ..." if len(names) > 3 else ""), "accepted": names} for names in c["accepted"]]
    return {**c, "findings": findings, "allowed": ["*"] if findings else []}


SUSPECTS_READ = 2  # of a weak effect: the right cause is the first or second


def suspected(report):
    return [s["name"] for s in report["suspects"]]


def judge_case(report, case):
    """A weak effect may be suspected instead of claimed."""
    wrong = judge(report, case)
    known = [a for f in case["findings"] for a in f["accepted"]]
    if case["weak"] and any(is_one(name, known) for name in suspected(report)[:SUSPECTS_READ]):
        return []
    return wrong


def one(job):
    program, folder, c, seeds = job
    case, path = as_case(c), os.path.join(folder, c["table"] + ".csv")
    report = ask(program, path, case, c["options"])
    others = [ask(program, path, case, c["options"], seed) for seed in range(2, seeds + 1)]
    answers = {signature(r) for r in [report, *others]}
    known = [a for f in case["findings"] for a in f["accepted"]]
    tied = sorted({n for names in classes(report) for n in names[1:] if is_one(n, known)})
    cross = [number(report[side]["cross_validated_rms"]) for side in ("before", "after")]
    return {"case": case, "wrong": judge_case(report, case), "answers": len(answers), "cells": [
        c["table"], c["rows"], f"`{c['model']}`" + (" " + " ".join(c["options"]) if c["options"] else ""), c["known"], c["source"],
        c["evidence"], ", ".join(names[0] for names in classes(report)) or "nothing", ", ".join(tied) or "–",
        f"{number(report['before']['rms'])} → {number(report['after']['rms'])}", " → ".join(cross), report["verdict"],
        ", ".join(f"{s['name']} ({s['p_value']:.2g})" for s in report["suspects"][:3]) or "–"]}


def page(done, seeds):
    holds = [d for d in done if d["case"]["findings"] and not d["case"]["weak"]]
    weak = [d for d in done if d["case"]["weak"]]
    clean = [d for d in done if not d["case"]["findings"]]
    named, accused = sum(not d["wrong"] for d in weak), sum(d["cells"][-2] == "suspected" for d in clean)
    right, quiet = sum(not d["wrong"] for d in holds), sum(not d["wrong"] for d in clean)
    out = ["# The loop on measured tables of the literature", "",
           f"Tables that come with R. Of {len(holds)} whose effect is documented {right} have it claimed or in a claim's class "
           f"({100 * right / max(len(holds), 1):.0f} %); of {len(weak)} that are weak (one test alone shows them, "
           f"nothing can prove them against everything that is tried) {named} are claimed, or suspected with the right cause first or second; "
           f"of {len(clean)} that hold nothing beyond the declared model {quiet} have nothing claimed, and {accused} are suspected.",
           "", f"    python3 tests/bench/loop_r_tables.py build/foilgauge --seeds {seeds}      # needs Rscript with MASS, boot, nlme, lattice", "",
           "Seen in R: the known effect beside the declared model, by `lm` alone, as it would be tested if one knew where to look.", ""]
    head = ["table", "rows", "declared", "known", "source", "seen in R", "found", "of its class: known", "error before → after",
            "cross-fitted", "verdict", "suspected (p)", "right?"] + ([f"answers of {seeds} seeds"] if seeds > 1 else [])
    out += ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for d in done:
        cells = d["cells"] + ["; ".join(d["wrong"]) or "right"] + ([d["answers"]] if seeds > 1 else [])
        out.append("| " + " | ".join(str(c) for c in cells) + " |")
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--only", action="append")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", default=os.path.join(ROOT, "reports"))
    a = parser.parse_args()
    if not shutil.which("Rscript"):
        print("skipped: R is not installed", file=sys.stderr)
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder, Pool(a.jobs) as pool:
        subprocess.run(["Rscript", "--vanilla", os.path.join(HERE, "loop_r_tables.R"), folder], check=True)
        with open(os.path.join(folder, "cases.json"), encoding="utf-8") as file:
            cases = [c for c in json.load(file) if not a.only or c["table"] in a.only]
        done = pool.map(one, [(a.program, folder, c, a.seeds) for c in cases], chunksize=1)
    with open(os.path.join(a.out, "loop_r_tables.md"), "w", encoding="utf-8") as file:
        file.write(page(done, a.seeds))
    for d in done:
        print(f"{d['cells'][0]}: {'; '.join(d['wrong']) or 'right'}: {d['cells'][6]}" + (f" [{d['answers']} answers]" if a.seeds > 1 else ""))
    print(*page(done, a.seeds).split("\n")[2:3])


if __name__ == "__main__":
    main()
