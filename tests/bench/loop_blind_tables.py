# SPDX-License-Identifier: GPL-3.0-or-later
"""loop_blind_tables.py FOLDER: FOLDER/tables.md from the loop's JSON reports that lie there."""

import glob
import json
import os
import sys


def described(claim):
    names = " / ".join(other if isinstance(other, str) else other["id"] for other in claim.get("alias_class") or [])
    values = ", ".join(f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}"
                       for name, value in claim["parameters"].items() if not isinstance(value, (list, dict)))
    return f"{claim['id']} ({values}; p = {claim['p_value']:.2g})" + (f", or {names}" if names else "")


def row(path):
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    claims = "; ".join(described(claim) for claim in report["claims"])
    if report["unattributed"]:
        claims += f"; a curve over {report['unattributed']['coordinate']}"
    after = report["after"] or report["before"]
    error = f"{report['before']['rms']:.3g} → {after['rms']:.3g}"
    crossed = f"{report['before']['held_out_rms']:.3g} → {after['held_out_rms']:.3g}"
    return f"| {os.path.basename(path)[:-5]} | {claims or 'nothing'} | {report['verdict']} | {error} | {crossed} |"


def main():
    folder = sys.argv[1]
    rows = [row(path) for path in sorted(glob.glob(os.path.join(folder, "[tl][0-9].json")))]
    lines = ["# Tables with or without an effect that nobody declared", "",
             "Their truth is not published. `tests/bench/loop_reports.sh` makes the reports beside this page, and this page of them. p is over all",
             "candidates together; errors are rms in the response's unit, before → after, on the rows and cross-fitted.", "",
             "| table | what was found | verdict | error | cross-fitted |", "|---|---|---|---|---|"] + rows
    with open(os.path.join(folder, "tables.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


main()
