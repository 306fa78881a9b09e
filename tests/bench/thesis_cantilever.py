# SPDX-License-Identifier: GPL-3.0-or-later
"""thesis_cantilever.py PROGRAM: a lot of cantilevers as section 5.11 of the thesis has them, rendered, measured and held against
its truth and against what the thesis prints. Writes reports/thesis/cantilever.md and cantilever.html, the lot's page.

The thesis prints by how much its beams deviate (length 0.44 %, width 2.19 %) and what follows, not the beams: the lot has beams
that deviate by as much, one foil those corners themselves. What follows is computed here anew from eq 5.10.
"""

import csv
import json
import math
import pathlib
import random
import re
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOILS, BEAMS, DPI = 12, 8, 2400
LENGTH_MM, WIDTH_MM, SAGITTA_MM, CLEARANCE_MM = 9.0, 3.0, 1.0, 0.126
LENGTH_PCT, WIDTH_PCT = 0.44, 2.19  # printed
PRINTED = {"compliance": 3.56, "sagitta": 0.9, "clearance": 7}
DESIGN = {"form": "cantilever", "beam_count": BEAMS, "beam_length_mm": LENGTH_MM, "beam_width_mm": WIDTH_MM, "thickness_mm": 0.1,
          "sagitta_mm": SAGITTA_MM, "clearance_mm": CLEARANCE_MM}
QUANTITIES = (("length_mm", "length", "µm", 1e3), ("width_mm", "width", "µm", 1e3), ("compliance_error_pct", "compliance", "%", 1),
              ("sagitta_error_pct", "sagitta", "%", 1), ("clearance_change_pct", "clearance", "%", 1))


def follows(length_mm, width_mm):
    """Compliance, sagitta and clearance against the design, percent."""
    length, width = length_mm / LENGTH_MM, width_mm / WIDTH_MM
    return {"compliance_error_pct": 100 * (length**3 / width - 1), "sagitta_error_pct": 100 * (length**2 - 1),
            "clearance_change_pct": 100 * SAGITTA_MM * (1 - length**2) / CLEARANCE_MM}


def deviations(foil):
    """In um, per beam. The first foil has the thesis's corners, and nothing of the others."""
    if foil == 0:
        signs = [(1, -1), (-1, 1), (1, 1), (-1, -1), (1, 0), (-1, 0), (0, -1), (0, 1)]
        return ([10 * LENGTH_MM * LENGTH_PCT * l for l, _ in signs], [10 * WIDTH_MM * WIDTH_PCT * w for _, w in signs])
    draw = random.Random(foil)
    return ([draw.uniform(-1, 1) * 10 * LENGTH_MM * LENGTH_PCT for _ in range(BEAMS)],
            [draw.uniform(-1, 1) * 10 * WIDTH_MM * WIDTH_PCT for _ in range(BEAMS)])


def render(program, folder, tier, foil, scanner):
    length_um, width_um = deviations(foil)
    beams = {"layout": "slits" if foil % 2 else "comb", "pitch_mm": 4.5, "length_um": length_um, "width_um": width_um}
    spec = {"schema": "foilgauge/render/1", "seed": 1000 + foil, "scanner": {**scanner, "dpi": DPI},
            "foils": [{"design": DESIGN, "beams": beams, "rotate_deg": random.Random(-foil).uniform(-180, 180)}]}
    path = folder / f"{tier}_{foil + 1:02d}.json"
    path.write_text(json.dumps(spec))
    subprocess.run([program, "render", path, "-o", path.with_suffix(".png"), "--truth", path.with_suffix(".truth")], check=True)
    return path.with_suffix(".png").name


def lot(program, folder, tier, scans):
    recipe = {"schema": "foilgauge/recipe/1", "name": f"cantilevers as in section 5.11, {tier}",
              "design": {"schema": "foilgauge/design/1", "name": "cantilever foil", **DESIGN, "elastic_modulus_gpa": 214}}
    (folder / f"{tier}.recipe").write_text(json.dumps(recipe))
    code = subprocess.run([program, "lot", *scans, "-o", tier, "--recipe", f"{tier}.recipe", "--pages", "none"], cwd=folder,
                          stdout=subprocess.DEVNULL).returncode
    if code not in (0, 1, 2, 3):
        sys.exit(f"lot {tier}: exit code {code}")
    return json.loads((folder / tier / "lot.json").read_text())


def pairs_of(folder, tier):
    """(foil, measured, true) of every beam: a beam is the one whose number it has."""
    found = list(csv.DictReader(open(folder / tier / "beams.csv", encoding="utf-8")))
    pairs, missed = [], 0
    for foil in range(FOILS):
        truth = {b["number"]: b for b in json.loads((folder / f"{tier}_{foil + 1:02d}.truth").read_text())["beams"]}
        rows = [row for row in found if row["scan"].endswith(f"{tier}_{foil + 1:02d}.png")]
        seen = {int(row["beam"]): row for row in rows}
        for number, beam in truth.items():
            row = seen.get(number)
            if row is None or not row["length_mm"] or not row["width_mm"]:
                missed += 1
                continue
            true = {"length_mm": beam["length_mm"], "width_mm": beam["width_mm"]}
            pairs.append((foil, row, {**true, **follows(true["length_mm"], true["width_mm"])}))
    return pairs, missed


def accuracy(pairs, quantities=QUANTITIES):
    lines = []
    for name, words, unit, factor in quantities:
        errors = [factor * (float(row[name]) - true[name]) for _, row, true in pairs]
        us = [factor * float(row["u_" + name]) for _, row, _ in pairs]
        inside = sum(abs(e) <= 2 * u for e, u in zip(errors, us))
        lines.append((words, unit, statistics.mean(errors), math.sqrt(statistics.mean(e * e for e in errors)),
                      math.sqrt(statistics.mean(u * u for u in us)), 100 * inside / len(errors)))
    return lines


def statistics_of(pairs, report):
    lines = []
    for name, words, unit, factor in QUANTITIES[:4]:
        true = [t[name] for _, _, t in pairs]
        q = report["quantities"][name]
        unit, factor = ("mm", 1) if unit == "µm" else (unit, 1)
        lines.append((words, unit, q["mean"], statistics.mean(true), q["sd"], statistics.stdev(true), q["min"], min(true), q["max"],
                      max(true)))
    return lines


def value(row, name, decimals):
    return f"{float(row[name]):+.{decimals}f} ± {2 * float(row['u_' + name]):.{decimals}f}"


def thesis_table(pairs, out):
    rows = {int(row["beam"]): row for foil, row, _ in pairs if foil == 0}
    more, less = rows[1], rows[2]
    both = [follows(LENGTH_MM * (1 + s * LENGTH_PCT / 100), WIDTH_MM * (1 - s * WIDTH_PCT / 100)) for s in (1, -1)]
    apart = 100 * ((1 + LENGTH_PCT / 100) ** 3 - 1) + 100 * (1 / (1 - WIDTH_PCT / 100) - 1)
    print("| figure | thesis | by its equations | measured of rendered beams |\n|---|---|---|---|", file=out)
    print(f"| length, % | ± {LENGTH_PCT} | – | {value(more, 'length_error_pct', 4)}, {value(less, 'length_error_pct', 4)} |", file=out)
    print(f"| width, % | ± {WIDTH_PCT} | – | {value(more, 'width_error_pct', 4)}, {value(less, 'width_error_pct', 4)} |", file=out)
    for name, words, decimals in (("compliance_error_pct", "compliance", 2), ("sagitta_error_pct", "sagitta", 2),
                                  ("clearance_change_pct", "clearance", 1)):
        print(f"| {words}, % | ± {PRINTED[words]} | {both[0][name]:+.{decimals}f}, {both[1][name]:+.{decimals}f} | "
              f"{value(more, name, decimals + 1)}, {value(less, name, decimals + 1)} |", file=out)
    change = SAGITTA_MM * both[0]["sagitta_error_pct"] / 100
    print(f"""
Length too long with width too narrow, and the other way round: the signs that add up in S = L³ / (3 E I), I = w t³ / 12 (eq 5.10).
Such a beam is not as far off to one side as to the other: (1 ± dL)³ / (1 ∓ dw) - 1. The printed 3.56 % is the sum of what length and
width make each by itself, without their product: {100 * ((1 + LENGTH_PCT / 100)**3 - 1):.2f} + {100 * (1 / (1 - WIDTH_PCT / 100) - 1):.2f} = {apart:.2f} %; to first order
it is 3 · {LENGTH_PCT} + {WIDTH_PCT} = {3 * LENGTH_PCT + WIDTH_PCT:.2f} %. The sagitta goes with L² (printed as 0.9 %, of a sagitta of 1.0 mm). The clearance that
7 % belong to is not printed: a sagitta that is {change:.4f} mm larger takes 7 % of {change / 0.07:.3f} mm, which the design states here.
""", file=out)


def write(folder, tiers, out):
    print(f"""# Cantilevers

Section 5.11 of the thesis: flat foils with beams cut out of them, whose lengths and widths decide compliance, sagitta and clearance.
`/usr/bin/python3 tests/bench/thesis_cantilever.py build/foilgauge` renders a lot of {FOILS} foils with {BEAMS} beams of {LENGTH_MM:g} by {WIDTH_MM:g} mm at
{DPI} dpi, combs and beams cut free by slits in turn, at any angle; measures it with `foilgauge lot` and writes this page. The lot's page:
[cantilever.html](cantilever.html). The beams themselves are not printed in the thesis.

## The thesis's numbers
""", file=out)
    thesis_table(tiers["clean"]["pairs"], out)
    print("""## The lot

Lengths and widths are drawn evenly within the thesis's deviations; one foil has the corners. As measured / as rendered, over all beams:
""", file=out)
    for tier, found in tiers.items():
        print(f"**{tier.capitalize()} scans**\n\n| quantity | mean | s | smallest | largest |\n|---|---|---|---|---|", file=out)
        for words, unit, *numbers in statistics_of(found["pairs"], found["report"]):
            d = 5 if unit == "mm" else 3
            cells = " | ".join(f"{a:.{d}f} / {b:.{d}f}" for a, b in zip(numbers[::2], numbers[1::2]))
            print(f"| {words}, {unit} | {cells} |", file=out)
        print(file=out)
    print("""## How far the values are from the truth

Rms error beside the mean of u in squares, and the share of beams whose U = 2 u holds the truth: 95 % is right, and a share of 96 beams
is good to some 2 points. Clean: blur 1.2 px, noise of 1 count. Rough: the scanner of samples/render/rough.json (blur that differs by the
carriage's way, halo, edges that scatter by 1.6 µm over 50 µm, dust, scratches, clipped white, tone curve, JPEG).

| scans | quantity | mean error | rms error | u | in U |
|---|---|---|---|---|---|""", file=out)
    for tier, found in tiers.items():
        lines = accuracy(found["pairs"])
        for odd, layout in ((0, "combs"), (1, "slits")):  # the roots' ends differ
            lines += accuracy([pair for pair in found["pairs"] if pair[0] % 2 == odd], [("length_mm", f"length in {layout}", "µm", 1e3)])
        for words, unit, mean, rms, u, share in lines:
            d = 3 if unit == "µm" else 4
            print(f"| {tier} | {words}, {unit} | {mean:+.{d}f} | {rms:.{d}f} | {u:.{d}f} | {share:.0f} % |", file=out)
    print("""
Beams of a foil lie at one angle and share errors of some thousandths of a pixel, so that the share in U differs by several points from one dozen of
foils to the next: combs of six foils have 88 % here, of twelve 93 %. Widths on rough scans err alike
in all beams, by what clipped white and the tone curve do to the level of an edge; u holds it.""", file=out)
    for tier, found in tiers.items():
        if found["missed"]:
            print(f"Of the {tier} scans {found['missed']} of {FOILS * BEAMS} beams have no length or no width.", file=out)


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    rough = json.loads((ROOT / "samples/render/rough.json").read_text())["scanner"]
    scanners = {"clean": {"contrast": -175, "background": 225}, "rough": rough}
    with tempfile.TemporaryDirectory() as name:
        folder, tiers = pathlib.Path(name), {}
        for tier, scanner in scanners.items():
            scans = [render(program, folder, tier, foil, scanner) for foil in range(FOILS)]
            report = lot(program, folder, tier, scans)
            pairs, missed = pairs_of(folder, tier)
            tiers[tier] = {"pairs": pairs, "missed": missed, "report": report}
        reports = ROOT / "reports/thesis"
        with open(reports / "cantilever.md", "w", encoding="utf-8") as out:
            write(folder, tiers, out)
        page = (folder / "rough" / "index.html").read_text()
        # The scans are not kept, so nothing leads to them.
        (reports / "cantilever.html").write_text(re.sub(r'<a href="\.\./[^"]*">(.*?)</a>', r"\1", page))


main()
