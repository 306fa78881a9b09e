# SPDX-License-Identifier: GPL-3.0-or-later
"""thesis_assembly.py FOLDER OUT: bearings drawn from the thesis's rendered lot, as measured and as rendered.

FOLDER holds foil*.truth and the lots thesis/, tight/ and ten/ of thesis_assembly.sh. The draws are made here anew, from the
seed and nothing else, out of the rendered foils' true radii and angles, and their circles and rotors are found by
least squares and linear programming of NumPy and SciPy: no code is shared with the program.
"""

import json
import math
import pathlib
import sys

import numpy
from scipy.optimize import linprog

MASK = (1 << 64) - 1
PADS, BUMPS, PITCH_DEG = 3, 9, 40 / 3
SLEEVE_MM, STRIP_MM = 20.73, 0.1
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)

# Chapter 5, figure 5.13 and its text; section 6.2.
CLEARANCE_PCT = {"mean": 50, "relative_sd": 70, "min": -50, "max": 150}
TIGHT_MM = 40.11  # as thesis_assembly.sh asks of the lot tight/
BORES_MM, ROTOR_MM = (39.50, 39.44, 39.29), 39.37


def splitmix(state):
    state = (state + 0x9E3779B97F4A7C15) & MASK
    z = state
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return state, z ^ (z >> 31)


def picks(seed, draw, foils):
    """Foils that the program builds into this draw."""
    state = seed ^ 0xD1342543DE82EF95
    state, z = splitmix(state)
    state = z ^ draw
    _, state = splitmix(state)
    chosen = []
    while len(chosen) < PADS:
        state, z = splitmix(state)
        foil = min(int((z >> 11) * 2.0**-53 * foils + 2.0**-54 * foils), foils - 1)
        if foil not in chosen:
            chosen.append(foil)
    return chosen


def fitted_clearances(folder, rotor_mm):
    """True clearance of every bump, its foil pressed into the sleeve: from the true R and alpha."""
    lot = []
    for path in sorted(pathlib.Path(folder).glob("foil*.truth")):
        foil = []
        for bump in json.loads(path.read_text(encoding="utf-8"))["bumps"]:
            half, r = math.radians(bump["bump_angle_deg"]) / 2, bump["radius_mm"]
            chord = r * math.sin(half)
            height = r * (1 - math.cos(half)) + SLEEVE_MM - math.sqrt(SLEEVE_MM**2 - chord**2)
            foil.append(SLEEVE_MM - height - rotor_mm / 2 - STRIP_MM)
        lot.append(foil)
    return numpy.array(lot)


ANGLES = numpy.radians([120 * pad + PITCH_DEG * bump for pad in range(PADS) for bump in range(BUMPS)])
ROWS = numpy.column_stack([numpy.ones(PADS * BUMPS), numpy.cos(ANGLES), numpy.sin(ANGLES)])


def assess(clearance):
    rest = clearance - ROWS @ numpy.linalg.lstsq(ROWS, clearance, rcond=None)[0]
    room = linprog([-1, 0, 0], A_ub=ROWS, b_ub=clearance, bounds=[(None, None)] * 3, method="highs")
    return numpy.ptp(rest), clearance.min(), -room.fun


def true_draws(folder, rotor_mm, foils, bearings, seed):
    lot = fitted_clearances(folder, rotor_mm)[:foils]
    return numpy.array([assess(numpy.concatenate([lot[f] for f in picks(seed, draw, len(lot))]))
                        for draw in range(bearings)])


def limit_rows(lot, truth, values):
    """Shares of the drawn bearings, measured and true, limit by limit, and of all that is asked."""
    drawn, rows, assembled = lot["assembly"]["drawn"], [], numpy.ones(len(truth), bool)
    for limit in drawn["limits"]:
        low, high = limit["min"], limit["max"]
        column = truth[:, values.index(limit["quantity"])]
        inside = (column >= (-math.inf if low is None else low)) & (column <= (math.inf if high is None else high))
        if limit["asked"]:
            assembled &= inside
        words = limit["quantity"] + (f" ≥ {1000 * low:g} µm" if low is not None else "") + (
            f" ≤ {1000 * high:g} µm" if high is not None else "")
        rows.append((words, limit["within"], inside.mean()))
    rows.append(("all that is asked", drawn["assembled"], assembled.mean()))
    return rows


VALUES = ["circularity_mm", "clearance_min_mm", "clearance_centred_min_mm"]
WORDS = {"circularity_mm": "circularity", "clearance_min_mm": "least clearance",
         "clearance_centred_min_mm": "least clearance, rotor centred"}


def section(folder, name, rotor_mm):
    lot = json.loads((folder / name / "lot.json").read_text(encoding="utf-8"))
    assembly = lot["assembly"]
    truth = true_draws(folder, rotor_mm, assembly["foils"], assembly["bearings"], assembly["seed"])
    text = ["> " + "  \n> ".join(assembly["statements"]), ""]
    text += ["| share of the bearings, % | measured | by draws | by foils | by measurement | same draws, true | at design ± 7 % |",
             "|---|---|---|---|---|---|---|"]
    design = assembly["design"]["drawn"]
    at_design = [limit["within"]["share"] for limit in design["limits"]] + [design["assembled"]["share"]]
    for (words, share, true), other in zip(limit_rows(lot, truth, VALUES), at_design):
        pair = lambda a, b: f"{100 * share[a]:.1f} to {100 * share[b]:.1f}"
        text.append(f"| {words} | {100 * share['share']:.1f} | {pair('draws_low', 'draws_high')} | {pair('foils_low', 'foils_high')} "
                    f"| {pair('surely', 'possibly')} | {100 * true:.1f} | {100 * other:.1f} |")
    text += ["", "| quantiles, µm | " + " | ".join(f"{100 * q:.0f} %" for q in QUANTILES) + " |", "|---" * 6 + "|"]
    for k, value in enumerate(VALUES):
        for words, numbers in (("measured", assembly["drawn"]["quantiles"][value]), ("true", numpy.quantile(truth[:, k], QUANTILES)),
                               ("at design", design["quantiles"][value])):
            text.append(f"| {WORDS[value]}, {words} | " + " | ".join(f"{1000 * v:.2f}" for v in numbers) + " |")
    return "\n".join(text), lot, truth


def bearing_errors(folder, name, rotor_mm):
    """Clearances, circularity and room of the lot's own bearings against the truth, µm."""
    lot = json.loads((folder / name / "lot.json").read_text(encoding="utf-8"))
    truth = fitted_clearances(folder, rotor_mm)
    place, value, u = [], [], []
    for number, bearing in enumerate(lot["bearings"]):
        if None in bearing["clearance_mm"]:
            continue
        true = numpy.concatenate([truth[number * PADS + pad] for pad in range(PADS)])
        place.append(numpy.array(bearing["clearance_mm"]) - true)
        value.append(numpy.array([bearing["circularity_mm"], bearing["min_mm"], bearing["centred_min_mm"]]) - assess(true))
        u.append([bearing["u_circularity_mm"], bearing["u_min_mm"], bearing["u_centred_min_mm"]])
    rms = lambda a: 1000 * numpy.sqrt(numpy.mean(numpy.square(a), axis=0))
    return len(place), float(rms(numpy.concatenate(place))), rms(value), 1000 * numpy.mean(u, axis=0)


TEXT = """# Bearings drawn from the thesis's lot

{foils} foils × 9 bumps, rendered at {dpi} dpi with the distribution of the thesis's figure 5.11 (thesis_lot.py), measured, and built into
bearings of three different foils each, 1,000 times (`lot`, section "How many bearings of this lot assemble"). Beside what was measured stands
the truth of the same draws: the rendered radii and angles, drawn by the same seed, assessed by other code (NumPy, SciPy's linear programming).
`tests/bench/thesis_assembly.sh` makes this page.

## The thesis's numbers

| figure | thesis | here, measured |
|---|---|---|
| clearance against design over all bumps, mean, % | {clearance[mean]:g} | {mean:.1f} |
| the same, relative s, % | {clearance[relative_sd]:g} | {relative:.1f} |
| the same, least and most, % | {clearance[min]:g} to {clearance[max]:g} | {least:.1f} to {most:.1f} |
| clearances of one bearing, bores {bores} mm against a rotor of {rotor:g} mm (section 6.2), µm | {gaps} | see below |
| peak to valley of these three, µm | {valley:.0f} | {median:.0f} in half of the bearings drawn |
| clearance of a bearing at design, ± 7 %, µm | 65.5 ± 4.6 | {design:.2f} ± {deviation:.2f} |

The thesis takes clearances from its springback model and the bump's radius alone; here they are of the measured foils pressed into the
sleeve. Its bearing of section 6.2 touches its rotor (−40 µm): a bore with a peak to valley of 105 µm on one of diameter 39.37. A lot of
figure 5.11 alone makes bearings nearly as far from round; that it also touches takes clearances that are smaller by some 50 µm, as against the
second rotor below.

## Against the design's rotor, 40 mm; circularity within 110 µm

{thesis}

## Against a rotor of 40.11 mm: 10.5 µm of clearance at design

{tight}

## Ten of the foils

{ten}

With fewer foils the interval by foils widens, that by draws does not: the first is what more scans would buy, the second what more draws would.

## Around the lot's own bearings

{bearings} whole bearings of the first lot, foils in the order of the manifest, against the truth. Every clearance carries what the strip's thickness is in
doubt of (the scanner's tone curve, the same in every scan), which a circularity does not.

| | rms error, µm | mean u, µm |
|---|---|---|
| clearance of a bump | {place:.2f} | |
| circularity | {value[0]:.2f} | {u[0]:.2f} |
| least clearance | {value[1]:.2f} | {u[1]:.2f} |
| least clearance, rotor centred | {value[2]:.2f} | {u[2]:.2f} |
"""


def main(folder, out, dpi):
    folder = pathlib.Path(folder)
    first, lot, _ = section(folder, "thesis", 40.0)
    second, _, _ = section(folder, "tight", TIGHT_MM)
    third, _, _ = section(folder, "ten", 40.0)
    gaps = [1000 * (bore - ROTOR_MM) / 2 for bore in BORES_MM]
    spread = lot["clearance_fitted_relative_to_design_pct"]
    count, place, value, u = bearing_errors(folder, "thesis", 40.0)
    pathlib.Path(out).write_text(TEXT.format(
        foils=lot["assembly"]["foils"], dpi=dpi, thesis=first, tight=second, ten=third, mean=spread["mean"],
        relative=spread["relative_sd_pct"], least=spread["min"], most=spread["max"], clearance=CLEARANCE_PCT,
        bores=", ".join(f"{b:.2f}" for b in BORES_MM), rotor=ROTOR_MM,
        gaps=", ".join(f"{g:.0f}" for g in gaps).replace("-", "−"), valley=max(gaps) - min(gaps),
        median=1000 * lot["assembly"]["drawn"]["quantiles"]["circularity_mm"][2],
        design=1000 * lot["nominal"]["clearance_mm"], deviation=70 * lot["nominal"]["clearance_mm"],
        bearings=count, place=place, value=value, u=u), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
