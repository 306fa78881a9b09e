#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Verdicts of the loop on scans under other expectations: the inputs of loop_unlisted.py again, no row left out,
with the sizes of causes and their probabilities three times as large, and a third of it.

/usr/bin/python3 tests/bench/loop_priors.py build/foilgauge [--cases 60] [--seed 1] [--out reports/loop_priors.md]"""

import argparse
import json
import os
import subprocess
import tempfile

import loop_foreign as foreign
import loop_unlisted as unlisted

# Factors on sizes and on probabilities.
SETTINGS = [(1, 1), (3, 1), (1 / 3, 1), (1, 3), (1, 1 / 3)]
NAMES = ["as they are", "sizes × 3", "sizes / 3", "probabilities × 3", "probabilities / 3"]


def run(tool, paths, setting):
    """(outcome, names found)."""
    out = os.path.join(os.path.dirname(paths[0]), "loop.json")
    command = [tool, *(repr(f) for f in setting), str(unlisted.DPI), out, *paths]
    if subprocess.run(command, stderr=subprocess.DEVNULL, check=False).returncode:
        return "error", ()
    with open(out, encoding="utf-8") as file:
        report = json.load(file)
    found = tuple(sorted({c["id"] for c in report["claims"] if c["verdict"] == "found"}))
    return ("found" if found else foreign.outcome(set(), report["claims"], report["unattributed"])), found


def differs(a, b):
    """One found cause is another: neither list holds the other."""
    return bool(a[1] and b[1] and not set(a[1]) <= set(b[1]) and not set(b[1]) <= set(a[1]))


def write_page(path, results, options):
    lines = [
        "# What the loop's verdicts on scans hang on\n",
        f"{len(results)} inputs of loop_unlisted.py, no row of the list left out: found, an honest tie (with an unnamed explanation"
        " in it), a tie of listed causes,\nunattributed or clean, where the expectations before a scan is seen are three times as"
        " large, or a third of it: the sizes of all causes, named or not,\nor the probability of each.\n",
        f"    /usr/bin/python3 tests/bench/loop_priors.py build/foilgauge --cases {options.cases} --seed {options.seed}\n",
        "| | found | unattributed | honest tie | tie of listed ones | clean | errors | other verdict | other cause found |\n|"
        + "---|" * 9,
    ]
    changed = []
    for k, name in enumerate(NAMES):
        own, base = [r[k] for _, r in results], [r[0] for _, r in results]
        counts = [sum(o == kind for o, _ in own) for kind in ("found", "unattributed", "honest tie", "listed tie", "clean", "error")]
        other = [i for i, (a, b) in enumerate(zip(own, base)) if a[0] != b[0]]
        wrong = sum(differs(a, b) for a, b in zip(own, base))
        share = f"{len(other)} ({100 * len(other) / len(own):.0f} %)" if k else "-"
        lines.append("| " + " | ".join(map(str, [name, *counts, share, wrong if k else "-"])) + " |")
        changed += [(results[i][0], name, base[i], own[i]) for i in other] if k else []
    lines += ["\n## Changed verdicts\n", "| case | truth | um | edges | scans | changed | from | to |\n|" + "---|" * 8]
    for row, name, a, b in changed:
        told = [f"{kind} {', '.join(found)}".strip() for kind, found in (a, b)]
        lines.append("| " + " | ".join(map(str, [row["case"], row["cause"], row["size_um"], row["edge"], row["scans"], name, *told])) + " |")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", default="reports/loop_priors.md")
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    tool, results = os.path.join(os.path.dirname(options.program), "bench", "loop_priors"), []
    for index in range(options.cases):
        with tempfile.TemporaryDirectory() as folder:
            row, paths, _ = unlisted.draw_input(options.program, options.seed, index, folder)
            results.append((row, [run(tool, paths, setting) for setting in SETTINGS]))
        print(index, row["cause"], *results[-1][1], flush=True)
        write_page(options.out, results, options)


if __name__ == "__main__":
    main()
