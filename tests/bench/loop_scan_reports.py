# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs `foilgauge loop` on scans whose truth is not published and writes a report each, and a table.

Usage: loop_scan_reports.py PROGRAM FOLDER; FOLDER holds b1.png .. and pairs b10a.png, b10b.png of one foil."""
import glob
import json
import os
import re
import subprocess
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def number(name):
    return [int(t) if t.isdigit() else t for t in re.split(r"(\d+)", name)]


def describe(report):
    parts = []
    for claim in report["claims"]:
        values = ", ".join(f"{k} {v:.4g} ± {2 * (claim['uncertainty'].get(k) or 0):.1g}"
                           for k, v in claim["parameters"].items())
        tie = ""
        if claim["verdict"] == "tied":
            others = [a for a in claim["alias_class"] if a != claim["id"]]
            tie = f"; not to be told from {', '.join(others)}"
        parts.append(f"{claim['id']} ({values}{tie})")
    if report["unattributed"]:
        parts.append(f"unattributed, a curve over {report['unattributed']['coordinate']} "
                     f"that moves {report['unattributed']['moves']}")
    return "; ".join(parts) or "nothing"


def main():
    program, folder = os.path.abspath(sys.argv[1]), sys.argv[2]
    target = os.path.join(ROOT, "reports", "blind")
    names = sorted((os.path.basename(p)[:-4] for p in glob.glob(os.path.join(folder, "b*.png"))), key=number)
    singles = [[n] for n in names if n[-1].isdigit()]
    pairs = [[n, n[:-1] + "b"] for n in names if n.endswith("a")]
    lines = ["# Scans with or without an effect that nobody declared", "",
             "Their truth is not published. Made by `python3 tests/bench/loop_scan_reports.py build/foilgauge FOLDER`; a JSON",
             "report each beside this page. Errors are the rms of the edge points about their circles, before → after; the",
             "noise is what the model with everything in it leaves. ± is two standard uncertainties.", "",
             "| scan | what was found | verdict | error, µm | noise, µm | R0, mm |", "|---|---|---|---|---|---|"]
    for group in singles + pairs:
        name = group[0] if len(group) == 1 else group[0][:-1]
        out = os.path.join(target, name + ".json")
        options = ["--same-foil"] if len(group) > 1 else []
        subprocess.run([program, "loop", *options, *[g + ".png" for g in group], "-o", out],
                       cwd=folder, check=True)
        with open(out) as f:
            report = json.load(f)
        r0 = [side["foils"][0]["overall"]["radius_mm"] for side in (report["before"], report["after"])]
        lines.append(f"| {' + '.join(group)} | {describe(report)} | {report['verdict']} | "
                     f"{report['before']['rms']:.3f} → {report['after']['rms']:.3f} | "
                     f"{report['noise_floor']:.3f} | {r0[0]:.5f} → {r0[1]:.5f} |")
    with open(os.path.join(target, "scans.md"), "w") as f:
        f.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
