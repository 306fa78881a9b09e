# SPDX-License-Identifier: GPL-3.0-or-later
"""loop_measured.py PROGRAM [--seeds N] [--check] [--units] [--accept] [--only TABLE] [--out FOLDER]

The tables of tests/data/measured through `foilgauge loop`: the known findings of each beside the claims, with
seeds 1 to N, and after a change of origin or unit. Writes loop_measured.md. With --check every table once, against
tests/data/measured/expected.json (exit code 1 where they differ); with --units origins and units alone (exit code 1
where a table depends on them and is not listed, or the other way round); --accept
writes the findings that are missed today into expected.json.
"""

import argparse
import csv
import fnmatch
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile

from loop_names import classes, member

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DATA = os.path.join(ROOT, "tests", "data", "measured")


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def ask(program, path, case, options, seed=None):
    command = [program, "loop", "--table", path, "--response", case["response"], "--model", case["model"], *options]
    command += ["-o", "-"] + ([] if seed is None else ["--seed", str(seed)])
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):  # 3: suspected
        sys.exit(f"{' '.join(command)}: exit code {done.returncode}: {done.stderr.strip()}")
    return json.loads(done.stdout)


# ---- judging ----


def normal(name):
    """One spelling of a name: "table.interaction(b, a)" and "(a, b)" are the same."""
    identity, where = member(name)
    return f"{identity}({', '.join(sorted(where))})"


def is_one(name, accepted):
    if " + " in name:
        return all(is_one(part, accepted) for part in name.split(" + "))
    own = normal(name)
    if own.startswith("table.outlier(") and len(member(own)[1]) > 1:  # several at once: one that is known is enough
        return any(is_one(f"table.outlier({row})", accepted) for row in member(own)[1])
    if own.startswith("table.random_levels("):  # of a column of many words
        own = own.replace("random_levels", "factor")
    return any(fnmatch.fnmatchcase(own, a if "*" in a else normal(a)) or
               (own.startswith("table.serial_correlation") and a.startswith("table.serial_correlation")) for a in accepted)


def judge(report, case):
    """Missed findings and claims of unknown effects, as words; nothing: right."""
    said = classes(report)
    wrong = [f"misses {f['what']}" for f in case["findings"]
             if not any(is_one(n, f["accepted"]) for names in said for n in names)]
    known = [a for f in case["findings"] for a in f["accepted"]] + case["allowed"]
    wrong += [f"claims {names[0]}" for names in said if not any(is_one(n, known) for n in names)]
    if report["verdict"] in ("explained", "partly explained") and not falls(report):
        wrong.append("explained without an error that falls")
    return wrong


def falls(report):
    """Noise that is known better is no smaller: only effects on the mean must lower the error."""
    noise = ("table.spread", "table.serial_correlation", "table.random_levels")
    if all(c["id"] in noise for c in report["claims"]):
        return True
    return report["after"]["rms"] < 0.999 * report["before"]["rms"]


def words(report):
    return [" = ".join(names[:1] + ([f"{len(names) - 1} more"] if len(names) > 1 else [])) for names in classes(report)]


def signature(report):
    return report["verdict"], tuple(sorted(tuple(sorted(names)) for names in classes(report)))


def spelled(options):
    return " ".join(options) or "no option"


# ---- origin and unit ----


def read_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return rows[0], rows[1:]


def numeric(cells):
    try:
        return [float(c) for c in cells]
    except ValueError:
        return None


def moved(path, out, column, change):
    header, rows = read_table(path)
    k = header.index(column)
    new = change([float(r[k]) for r in rows])
    with open(out, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(r[:k] + [repr(v)] + r[k + 1:] for r, v in zip(rows, new))


def far(scatter):
    """1e9 scatters away: a double then rounds to 1e-7 of a scatter."""
    return lambda values: [v + 1e9 * scatter for v in values]


def times(factor):
    return lambda values: [v * factor for v in values]


def changes(path, case, before):
    """(what, column, change): the response about the declared model's own scatter, columns about theirs."""
    yield "+ 1e9 scatters", case["response"], far(before["before"]["rms"])
    for factor in (1e-12, 1e12, -1):
        yield f"x {factor:g}", case["response"], times(factor)
    header, rows = read_table(path)
    for k, name in enumerate(header):
        values = numeric([r[k] for r in rows])
        # of a temperature the physical forms know the unit and the zero
        if values is None or name == case["response"] or "temperature" in name or len(set(values)) < 2:
            continue
        yield "+ 1e9 scatters", name, far(statistics.pstdev(values))
        yield "x 1e-12", name, times(1e-12)


def copied(path, out, response):
    """Every column twice: words under other words, numbers in another unit from another origin."""
    header, rows = read_table(path)
    new = [list(r) for r in rows]
    names = list(header)
    for k, name in enumerate(header):
        if name == response:
            continue
        names.append(f"copy_of_{name}")
        values = numeric([r[k] for r in rows])
        for i, row in enumerate(new):
            row.append("L" + rows[i][k] if values is None else repr(3.0 + 2.0 * values[i]))
    with open(out, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([names] + new)


def copy_differences(program, case):
    """A column that codes another one is one candidate: findings stay, under either name, and clean tables
    stay clean."""
    path = os.path.join(DATA, case["table"] + ".csv")
    plain = judge(ask(program, path, case, case["runs"][0]), case)
    with tempfile.TemporaryDirectory() as folder:
        other = os.path.join(folder, "copied.csv")
        copied(path, other, case["response"])
        report = ask(program, other, case, case["runs"][0])
    for claim in report["claims"]:
        claim["name"] = claim["name"].replace("copy_of_", "")
        for alias in claim["alias_class"]:
            alias["name"] = alias["name"].replace("copy_of_", "")
    if report["unattributed"]:
        report["unattributed"]["coordinate"] = report["unattributed"]["coordinate"].replace("copy_of_", "")
    now = judge(report, case)
    return [] if set(now) <= set(plain) else [f"{case['table']} with a copy of every column: {'; '.join(now)}; "
                                              f"before: {'; '.join(plain) or 'right'}"]


def amplitudes(report):
    return sorted(c["amplitude"] for c in report["claims"] if c["amplitude"] is not None)


def unit_differences(program, case):
    """Words for every change of origin or unit that changes the claims."""
    path = os.path.join(DATA, case["table"] + ".csv")
    before = ask(program, path, case, case["runs"][0])
    out = []
    with tempfile.TemporaryDirectory() as folder:
        other = os.path.join(folder, case["table"] + ".csv")
        for what, column, change in changes(path, case, before):
            moved(path, other, column, change)
            report = ask(program, other, case, case["runs"][0])
            if signature(report) != signature(before):
                out.append(f"{case['table']}: {column} {what}: {report['verdict']}: {', '.join(words(report)) or 'nothing'}; "
                           f"before {before['verdict']}: {', '.join(words(before)) or 'nothing'}")
            elif column == case["response"] and what.startswith("x"):
                factor = abs(float(what.split()[1]))
                pairs = zip(amplitudes(before), amplitudes(report))
                out += [f"{case['table']}: {column} {what}: amplitude {b:g} instead of {a * factor:g}" for a, b in pairs
                        if not math.isclose(a * factor, b, rel_tol=1e-3)]
    return out


def all_differences(program, cases):
    return [d for case in cases for d in unit_differences(program, case) + copy_differences(program, case)]


# ---- the report ----


def once(program, case):
    """Of every option set: (options, report, errors as words)."""
    path = os.path.join(DATA, case["table"] + ".csv")
    for options in case["runs"]:
        report = ask(program, path, case, options)
        yield options, report, judge(report, case)


def wrong_of(program, case):
    """Wrong with any of the option sets (of a short test: with the first)."""
    runs = case["runs"] if "FOILGAUGE_TEST_LONG" in os.environ else case["runs"][:1]
    return sorted({w for _, _, wrong in once(program, {**case, "runs": runs}) for w in wrong})


def seeds_differ(program, case, count):
    path = os.path.join(DATA, case["table"] + ".csv")
    said = [signature(ask(program, path, case, case["runs"][0], seed)) for seed in range(1, count + 1)]
    return len(set(said)), len({verdict for verdict, _ in said})


def number(value):
    return "–" if value is None else f"{value:.3g}"


def lines_of(program, case, seeds):
    answers, verdicts = seeds_differ(program, case, seeds)
    for options, report, wrong in once(program, case):
        tied = {n for names in classes(report) for n in names[1:]}
        cross = [report[side]["cross_validated_rms"] for side in ("before", "after")]
        yield [case["table"], f"`{case['model']}`", spelled(options), case["known"],
               ", ".join(names[0] for names in classes(report)) or "nothing", ", ".join(sorted(tied)) or "–",
               f"{number(report['before']['rms'])} → {number(report['after']['rms'])}",
               f"{number(cross[0])} → {number(cross[1])}", report["verdict"], "; ".join(wrong) or "right",
               f"{answers} ({verdicts})"]


def report_page(program, cases, seeds):
    head = ["table", "declared", "option", "known", "found", "tied with", "error before → after", "cross-fitted", "verdict",
            "right?", f"different answers (verdicts) of {seeds} seeds"]
    lines = [line for case in cases for line in lines_of(program, case, seeds)]
    differences = all_differences(program, cases)
    right = sum(line[9] == "right" for line in lines)
    same = sum(line[10] == "1 (1)" for line in lines)
    out = ["# The loop on measured tables", "",
           f"Tables that NIST published, with the effect that each is known for (tests/data/measured). {right} of {len(lines)} right; "
           f"{same} of {len(lines)} say the same with every seed.", "", "    python3 tests/bench/loop_measured.py build/foilgauge", "",
           "| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    out += ["| " + " | ".join(line) + " |" for line in lines]
    out += ["", "## Origin, unit and copies", "", "The response and every column of numbers moved by 1e9 of its scatter, times 1e-12 (the "
            "response also times 1e12 and -1), and every column given twice: " + ("the same claims every time." if not differences else
                                                    f"{len(differences)} times another answer."), ""]
    return "\n".join(out + [f"- {d}" for d in differences]) + "\n"


# ---- check ----


def check(program, cases):
    bad = 0
    for case in cases:
        wrong, listed = wrong_of(program, case), sorted(case.get("not_yet", []))
        if wrong != listed:
            bad += 1
            print(f"{case['table']}: {'; '.join(wrong) or 'right'}" + (f" (listed: {'; '.join(listed)})" if listed else ""))
    return bad


def check_units(program, cases):
    """Number of tables that depend on an origin or unit without being listed as such, or the other way round."""
    bad = 0
    for case in cases:
        differences, listed = all_differences(program, [case]), case.get("units_not_yet", False)
        print("\n".join(differences) or f"{case['table']}: the same claims for every origin and unit" + (" (listed!)" if listed else ""))
        bad += bool(differences) != listed
    return bad


def accept(program, expected):
    for case in expected["tables"]:
        wrong = wrong_of(program, case)
        case.pop("not_yet", None)
        if wrong:
            case["not_yet"] = wrong
    path = os.path.join(DATA, "expected.json")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    lines = [line for line in text.split("\n") if '"not_yet":' not in line or '"about"' in line]
    text = "\n".join(lines)
    for case in expected["tables"]:
        if case.get("not_yet"):
            head = text.index(f'{{"table": "{case["table"]}"')
            at = text.index('"known":', head)
            text = text[:at] + f'"not_yet": {json.dumps(case["not_yet"])},\n   ' + text[at:]
    assert json.loads(text) == expected
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--units", action="store_true")
    parser.add_argument("--accept", action="store_true")
    parser.add_argument("--only", action="append")
    parser.add_argument("--out", default=os.path.join(ROOT, "reports"))
    a = parser.parse_args()
    expected = load(os.path.join(DATA, "expected.json"))
    cases = [c for c in expected["tables"] if not a.only or c["table"] in a.only]
    if a.accept:
        accept(a.program, expected)
    elif a.check:
        sys.exit(1 if check(a.program, cases) else 0)
    elif a.units:
        sys.exit(1 if check_units(a.program, cases) else 0)
    else:
        text = report_page(a.program, cases, a.seeds)
        with open(os.path.join(a.out, "loop_measured.md"), "w", encoding="utf-8") as file:
            file.write(text)
        print(text)


if __name__ == "__main__":
    main()
