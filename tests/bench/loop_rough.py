# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop on rendered scans with edges as real scanners make them: scatter that is correlated along the
strip, one-sided blur, halo, the part's wall beside an edge, JPEG; and on scans of a second renderer (other_scanner.py).

Usage: loop_rough.py PROGRAM [--cases N] [--tier NAME]... [--seed S]... [--all] [--threads N] [--fresh] [--report-only]
       [--pictures DIR] [--busy]

Seeds 11 and 12 are for whoever works on the loop; 13 runs only with --all, and nobody looks at it while limits are set.
Inputs that the CSV holds are not run again (--fresh: those of its seeds are), so that a run can be broken off and taken up, or be
made tier by tier.

Effects are 1.5 times the size that is seen at 5 standard errors by an oracle that knows the effect's form and the
noise's covariance (loop_oracle.py); unlisted curves by what the table's smooth effects leave of them; a taper of the
thickness, which moves no midline, is 10 µm.

Writes reports/loop_rough.csv, .md and .svg."""

import argparse
import os
import tempfile
from dataclasses import dataclass

import numpy as np

import loop_rough_report
from loop_cases import CURVES, PART_EFFECTS, SCANNER_EFFECTS, draw_case, log_uniform
from loop_oracle import standard_errors, standard_errors_apart
from loop_run import Results, add_options, errors_um, judge, kept, measured_foils, pair_foils, profile_um, render, run_loop
from loop_scans_report import is_scanner
from other_scanner import draw_other, render_other

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
ALL = SCANNER_EFFECTS + PART_EFFECTS
ODD = ["seams", "every", "one", "two"]
STANDARD_ERRORS = 7.5
SEEDS, KEPT_ASIDE = [11, 12], 13
NEXT_SEED = 20  # every seed goes on further along the kinds: together they have all of them about equally often
MM_PER_PX = 25.4 / 4800


@dataclass
class Tier:
    title: str
    layouts: list
    count: int  # of every seed
    kinds: list
    other: bool = False  # the second renderer


# New ones at the end: a tier's place is part of its seed.
TIERS = {
    "clean": Tier("nothing there", ["single", "single", "90", "single", "45", "foils"], 67, []),
    "single": Tier("one scan, one effect", ["single"], 34, ALL),
    "pair": Tier("turned by 90° or 45°, one effect", ["90", "45"], 20, ALL),
    "curve": Tier("one scan, an unlisted curve", ["single"], 14, CURVES),
    "odd": Tier("one scan, seams in x or single bumps raised", ["single"], 12, ODD),
    "other-clean": Tier("second renderer, nothing there", ["single", "single", "90", "single"], 15, [], True),
    "other-single": Tier("second renderer, one scan, one effect", ["single"], 14, ALL, True),
    "other-pair": Tier("second renderer, turned, one effect", ["90", "45"], 5, ALL, True),
    "other-curve": Tier("second renderer, an unlisted curve", ["single"], 5, CURVES, True),
}


def draw_rough(rng):
    """Scatter of 0 to 0.4 px, correlated over 2 to 15 px; what an edge model does not hold comes in a third each."""
    scatter, common = float(rng.uniform(0, 0.4)) * 1000 * MM_PER_PX, float(rng.uniform(0.2, 0.8))
    rough = {
        "edge_roughness_um": scatter * (1 - common**2) ** 0.5,
        "edge_common_um": scatter * common,
        "correlation_um": log_uniform(rng, 2, 15) * 1000 * MM_PER_PX,
        "correlation_form": str(rng.choice(["gaussian", "exponential"])),
    }
    if rng.random() < 1 / 2:
        rough["one_sided_blur_px"] = float(rng.uniform(0.5, 2.2))
        rough["one_sided_way"] = str(rng.choice(["+y", "-y"]))
    if rng.random() < 1 / 3:
        rough["halo"] = {"fraction": float(rng.uniform(0.05, 0.2)), "length_px": float(rng.uniform(10, 30))}
    if rng.random() < 1 / 3:
        rough["side_wall"] = {"amplitude": float(rng.uniform(-0.2, 0.3)), "length_px": float(rng.uniform(5, 15)),
                              "direction_deg": float(rng.uniform(-180, 180))}  # fmt: skip
    if rng.random() < 1 / 3:
        rough["jpeg"] = {"quality": int(rng.integers(80, 96))}
    return rough


def as_rough(scanner):
    """The second renderer's scanner by the first one's names, as the oracle needs it."""
    um = scanner["scatter_px"] * 1000 * MM_PER_PX
    rough = {"edge_roughness_um": um * (1 - scanner["common"] ** 2) ** 0.5, "edge_common_um": um * scanner["common"],
             "correlation_um": scanner["correlation_px"] * 1000 * MM_PER_PX, "correlation_form": scanner["form"]}  # fmt: skip
    return {**scanner, "rough": rough, "noise_correlation": scanner["grain"], "noise_form": "moving"}


def draw_odd(rng, kind, case):
    """Two or three seams between the sensor's chips, as far apart as chips are long; bumps that stand out one by one or
    with a period."""
    size = case["specs"][0]["width_px"] * MM_PER_PX
    if kind == "seams":
        chip, first = float(rng.uniform(0.25, 0.35)) * size, float(rng.uniform(0.15, 0.3)) * size
        places = [x for x in (first, first + chip, first + 2 * chip) if x < 0.85 * size]
        return [{"id": "scan.column_step", "x_mm": x, "amplitude_um": float(rng.choice([-1, 1]) * rng.uniform(5, 10))}
                for x in places]  # fmt: skip
    effect = {"id": "free.bump.index", "amplitude_um": float(rng.choice([-1, 1]) * 10)}
    count = case["design"]["bump_count"]
    if kind == "every":
        effect.update(every=int(rng.integers(2, 5)))
    else:
        effect["bumps"] = sorted(int(n) for n in rng.choice(np.arange(1, count + 1), ODD.index(kind) - 1, False))
    return [effect]


def for_oracle(case):
    return {**case, "specs": [{**s, "scanner": as_rough(s["scanner"])} for s in case["specs"]]} if case["other"] else case


def size_by_oracle(case, unlisted):
    factor = STANDARD_ERRORS / max(standard_errors(for_oracle(case), case["effects"], unlisted), 1e-9)
    for effect in case["effects"]:
        for member in ("amplitude_um", "value"):
            if member in effect:
                effect[member] *= factor
        for knot in effect.get("knots", []):
            knot[1] *= factor


def make_case(name, index, seed):
    tier = TIERS[name]
    rng = np.random.default_rng([seed, 7 + list(TIERS).index(name), index])
    layout = tier.layouts[index % len(tier.layouts)]
    kind = tier.kinds[(index + NEXT_SEED * (seed - SEEDS[0])) % len(tier.kinds)] if tier.kinds else None
    listed = [kind] if kind and kind not in ODD else []
    case = {**draw_case(rng, layout, index, listed, 10.0 if listed else None), "other": tier.other}
    if kind in ODD:
        case["effects"] += draw_odd(rng, kind, case)
    scanner = draw_other(rng) if tier.other else None
    rough = None if tier.other else draw_rough(rng)
    for spec in case["specs"]:
        if tier.other:
            spec["scanner"] = scanner
            continue
        spec["scanner"].update(rough=rough, bits=8, blur_px=float(rng.uniform(1.4, 2.4)), noise_correlation=0.5)
        spec["scanner"]["noise"] = float(rng.uniform(1, 2.5))
    if case["effects"]:
        size_by_oracle(case, unlisted=tier.kinds in (CURVES, ODD))
    return layout, case


def apart(row):
    """The oracle's distance of a row's effect from the nearest other: (standard errors, the other, share named)."""
    _, case = make_case(row["tier"], int(row["index"]), int(row["seed"]))
    return standard_errors_apart(for_oracle(case))


def render_others(program, folder, specs):
    paths = [os.path.join(folder, f"s{k}.png") for k in range(len(specs))]
    for spec, path in zip(specs, paths):
        render_other(spec, path)
    return paths


def floor_um(program, folder, case, draw, row):
    """Errors of the same foils with the same scatter and no effect, measured; not of effects of the part."""
    names = ("R", "h", "R0", "profile")
    if not case["effects"]:
        return {f"{q}_floor_um": row[f"{q}_before_um"] for q in names}
    if not is_scanner(row):
        return {f"{q}_floor_um": "" for q in names}
    bare = {**case, "effects": [], "specs": [{**s, "effects": []} for s in case["specs"]]}
    foils = measured_foils(program, folder, bare, draw)
    pairs = pair_foils(bare, foils) if foils is not None else None
    errors = {**errors_um(pairs), "profile": profile_um(bare, pairs, None)}
    return {f"{q}_floor_um": float(f"{e:.5g}") for q, e in errors.items()}


def work_on(program, key, pictures=None):
    layout, case = make_case(key["tier"], key["index"], key["seed"])
    draw = render_others if case["other"] else render
    draw = kept(draw, os.path.abspath(pictures)) if pictures else draw
    with tempfile.TemporaryDirectory() as folder:
        report, code, seconds = run_loop(program, folder, case, draw=draw)
        row = {"layout": layout, **judge(case, report, code, seconds)}
        chance = report["p_value"] if report else ""
        return {"p_value": "" if chance is None else chance, **row, **floor_um(program, folder, case, draw, row)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, help="at most so many of every tier and seed")
    parser.add_argument("--busy", action="store_true", help="other work ran beside: times by the clock are not judged")
    add_options(parser, TIERS, os.path.join(ROOT, "reports"))
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    seeds = options.seed or SEEDS + [KEPT_ASIDE] * options.all
    for folder in filter(None, (options.out, options.pictures)):
        os.makedirs(folder, exist_ok=True)
    results = Results(os.path.join(options.out, "loop_rough.csv"), options.fresh, seeds, "form_within")
    jobs = []
    for name in options.tier or TIERS:
        count = TIERS[name].count if options.cases is None else min(options.cases, TIERS[name].count)
        jobs += [{"tier": name, "seed": seed, "index": k} for seed in seeds for k in range(count)]
    if not options.report_only:
        results.run(jobs, lambda key: work_on(program, key, options.pictures), options.threads)
    loop_rough_report.write(options.out, results.rows, TIERS, apart, options.busy)


if __name__ == "__main__":
    main()
