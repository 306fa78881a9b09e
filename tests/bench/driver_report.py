# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of driver.py: tables from rows of values."""

import math
import subprocess

import numpy as np

import benchlib as lib
import driver_kinds as kinds

QUANTITIES = {"thickness": "t", "clearance": "C", "R": "R", "h": "h", "alpha": "α", "R0": "R0", "diameter": "d"}
FACTOR = {"alpha": 1.0}  # others: mm to um


def is_known(row):
    return row["value"] is not None and row["u"] is not None


def ratio(row):
    """Error over u; infinite where u is 0 and the error is not."""
    error = abs(row["value"] - row["true"])
    return error / row["u"] if row["u"] else (math.inf if error else 0.0)


def is_within(row):
    return is_known(row) and ratio(row) <= 2


def is_silent(row):
    """Beyond 4 u without a word."""
    return not row["flagged"] and is_known(row) and ratio(row) > 4


def per_cent(values):
    values = list(values)
    return f"{100 * sum(values) / len(values):.1f}" if values else "–"


def silent_words(rows):
    """Number of values of each quantity that are silently beyond 4 u."""
    counts = {q: sum(is_silent(r) for r in rows if r["quantity"] == q) for q in QUANTITIES}
    return " ".join(f"{QUANTITIES[q]} {n}" for q, n in counts.items() if n)


def median_u(rows, quantity):
    values = [1000 * r["u"] for r in rows if r["quantity"] == quantity and is_known(r)]
    return lib.number(float(np.median(values)), 2) if values else "–"


def summary(title, rows):
    return [title, len(rows), per_cent(map(is_within, rows)), per_cent(bool(r["flagged"]) for r in rows),
            per_cent(is_within(r) or r["flagged"] for r in rows), sum(map(is_silent, rows)), silent_words(rows),
            sum(r["wrong"] and not r["flagged"] for r in rows), sum(r["wrong"] for r in rows),
            median_u(rows, "thickness"), median_u(rows, "diameter")]  # fmt: skip


HEADER = ["", "values", "within 2u %", "flagged %", "within 2u or flagged %", "silently beyond 4u", "of which",
          "wrong verdicts, silent", "wrong verdicts", "median u(t) µm", "median u(d) µm"]  # fmt: skip


def sentence(rows):
    silent, wrong = sum(map(is_silent, rows)), sum(r["wrong"] and not r["flagged"] for r in rows)
    said = per_cent(is_within(r) or r["flagged"] for r in rows)
    return (f"Of {len(rows):,} values {per_cent(map(is_within, rows))} % are within 2u and {said} % within 2u or flagged; "
            f"{silent} ({100 * silent / len(rows):.2f} %) are silently beyond 4u, and {wrong} verdicts silently wrong.")  # fmt: skip


def kinds_table(rows):
    body = [summary(k.words, own) for k in kinds.KINDS if (own := [r for r in rows if r["kind"] == k.name])]
    for name in kinds.RENDERERS:
        own = [r for r in rows if r["renderer"] == name]
        body.append(summary({"program": "**all of `foilgauge render`**", "other": "**all of the second renderer**"}[name], own))
    for dpi in kinds.DPI:
        body.append(summary(f"**all of {dpi} dpi**", [r for r in rows if r["dpi"] == dpi]))
    return lib.table(HEADER, body + [summary("**all**", rows)])


def quantities_table(rows):
    body = [summary(name, own) for name in QUANTITIES if (own := [r for r in rows if r["quantity"] == name])]
    return lib.table(["quantity"] + HEADER[1:6] + HEADER[7:9], [b[:6] + b[7:9] for b in body])


def strengths_table(rows):
    body = []
    for kind in kinds.KINDS:
        cells = []
        for strength in kinds.STRENGTHS:
            own = [r for r in rows if r["kind"] == kind.name and r["strength"] == strength]
            cells.append(f"{per_cent(is_within(r) or r['flagged'] for r in own)} / {sum(map(is_silent, own))}" if own else "–")
        if any(c != "–" for c in cells):
            body.append([kind.name, *cells])
    return lib.table(["kind: within 2u or flagged % / silently beyond 4u", *kinds.STRENGTHS], body)


def thickness_cells(rows):
    own = [r for r in rows if r["quantity"] == "thickness" and is_known(r)]
    if not own:
        return ["–", "–", "–"]
    error = [1000 * abs(r["value"] - r["true"]) for r in own]
    return [lib.number(float(np.median(error)), 2), lib.number(max(error), 2), median_u(own, "thickness")]


def known_table(rows):
    """Thickness by the scan alone, with a micrometer's value, with a leaf on the glass."""
    variants = [v for v in ("scan", "micrometer", "leaf") if any(r["variant"] == v for r in rows)]
    body = []
    for kind in kinds.KINDS + [None]:
        own = [r for r in rows if kind is None or r["kind"] == kind.name]
        line = ["**all**" if kind is None else kind.words]
        for variant in variants:
            part = [r for r in own if r["variant"] == variant and r["part"] == "foils" and r["known"]]
            line += thickness_cells(part)
            line += [per_cent(is_within(r) or r["flagged"] for r in part if r["quantity"] in ("thickness", "clearance")),
                     sum(is_silent(r) for r in part if r["quantity"] in ("thickness", "clearance")),
                     sum(r["wrong"] for r in part)]  # fmt: skip
        if own:
            body.append(line)
    head = [f"{v}: {c}" for v in variants for c in ("median error µm", "largest error µm", "median u µm",
            "t, C within 2u or flagged %", "t, C silently beyond 4u", "wrong verdicts")]  # fmt: skip
    return lib.table([""] + head, body)


def every_value(rows):
    """For who looks for the cause of one."""
    lines = []
    for r in rows:
        factor = FACTOR.get(r["quantity"], 1000.0)
        shown = f"{factor * (r['value'] - r['true']):9.3f} {factor * r['u']:8.3f}" if is_known(r) else "withheld"
        mark = "SILENT" if is_silent(r) else ""
        wrong = "WRONG VERDICT" if r["wrong"] else ""
        lines.append(f"{r['variant']} {r['kind']} {r['strength']} {r['renderer']} {r['dpi']} seed {r['seed']} {r['quantity']} "
                     f"{r['index']}: {shown} {r['verdict']} [{r['flags']}] {mark} {wrong}".rstrip())  # fmt: skip
    return "\n".join(lines)


def version_of(program):
    return subprocess.run([program, "--version"], capture_output=True, text=True).stdout.strip()


TEXT = """# Scans as drivers make them

`/usr/bin/python3 tests/bench/driver.py build/foilgauge{words}` writes this page. {version}.

Foils of three bumps (strips of 100 µm, a third of them of 108.5 µm where the limit is 105) and pins of 2 to 8 mm (a third
too large by 8.5 µm) are drawn by two renderers that share no code: `foilgauge render` and tests/bench/other_scanner.py with
other_driver.py. Each kind comes in three strengths, of {seeds} seeds, at 2400 and 4800 dpi, pins for
a third of that{share}. A third of the scanners is
ideal but for white noise, half have correlated noise, and a sixth edges that scatter by 0.05 px, too, which `rough_edge` says
of the plain scan. t: thickness, C: clearance, d: diameter.

A value is **flagged** where its foil, bump or disc has a flag that the plain scan of the same part has not, or where it is
withheld. **Silently beyond 4u**: not flagged. **Wrong verdict**: a limit that the true value keeps is failed, or one that it
exceeds is passed. Rows that are lost or doubled where a bump ends and its strip runs along the carriage's way look like a bump
of another angle: no edge shows them.

{sentence}

{kinds}
## By quantity

{quantities}
## By strength

{strengths}"""

KNOWN = """
## With something known

{variants}. {which} of the cases above. The stated value is off by its u at random: in one foil of twenty by more than 2u,
with its four clearances and thicknesses.

{known}"""


SHARE_WORDS = {"all": "", "third": " --third", "sixth": " --quick"}
SHARES = {"all": "", "third": "; this page has one seed of three of every case", "sixth": " (a sixth of all cases)"}


VARIANT_WORDS = {
    "scan": "Thickness by the scan alone",
    "micrometer": "with a micrometer's value of u 0.5 µm (`--thickness-measured`)",
    "leaf": "with a feeler leaf of 100 µm, u 0.5 µm, beside the foil (`--gauge`)",
}


def variant_words(rows):
    return "; ".join(words for name, words in VARIANT_WORDS.items() if any(r["variant"] == name for r in rows))


def page(rows, clean, missing, options):
    if not rows:
        return clean or "nothing to do\n"
    scan = [r for r in rows if r["variant"] == "scan"]
    words = "".join([SHARE_WORDS[options.share], f" --kinds {options.kinds}" if options.kinds else "",
                     f" --clean {options.clean}" if options.clean != 200 else "",
                     f" --variants {options.variants}" if options.variants != "micrometer,leaf" else "",
                     " --before OTHER_BUILD" if options.before else ""])  # fmt: skip
    text = TEXT.format(words=words, version=version_of(options.program), seeds=options.seeds, sentence=sentence(scan),
                       kinds=kinds_table(scan),
                       share=SHARES[options.share], quantities=quantities_table(scan),
                       strengths=strengths_table(scan))  # fmt: skip
    if any(r["variant"] != "scan" for r in rows):
        text += KNOWN.format(known=known_table(rows), variants=variant_words(rows), which="All" if options.known_all else "A sixth")
    if clean:
        text += "\n## Plain scans\n\n" + clean
    if missing:
        text += "\n## Not drawn\n\n" + "\n".join(f"- {m}" for m in missing) + "\n"
    return text
