"""The loop on rendered scans with edges as real scanners make them: scatter that is correlated along the
strip, one-sided blur, halo, the part's wall beside an edge, JPEG.

Usage: loop_rough.py PROGRAM [--cases N] [--tier NAME]... [--seed S]... [--threads N] [--fresh] [--report-only]

Effects are 1.5 times the size that is seen at 5 standard errors by an oracle that knows the effect's form and the
noise's covariance (loop_oracle.py).

Writes reports/loop_rough.csv and .md."""

import argparse
import os
import tempfile
from dataclasses import dataclass

import numpy as np

from loop_cases import CURVES, PART_EFFECTS, SCANNER_EFFECTS, draw_case, log_uniform
from loop_oracle import standard_errors
from loop_run import Results, errors_um, judge, pair_foils, run_loop
from loop_scans_report import markdown, share

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
ALL = SCANNER_EFFECTS + PART_EFFECTS
STANDARD_ERRORS = 7.5


@dataclass
class Tier:
    title: str
    layouts: list
    count: int  # over all seeds
    kinds: list


TIERS = {
    "clean": Tier("nothing there", ["single", "single", "90", "single", "45", "foils"], 201, []),
    "single": Tier("one scan, one effect", ["single"], 102, ALL),
    "pair": Tier("turned by 90° or 45°, one effect", ["90", "45"], 60, ALL),
    "curve": Tier("one scan, an unlisted curve", ["single"], 42, CURVES),
}


def draw_rough(rng):
    """Scatter of 0 to 0.4 px, correlated over 2 to 15 px; what an edge model does not hold comes in a third each."""
    px = 1000 * 25.4 / 4800
    scatter, common = float(rng.uniform(0, 0.4)) * px, float(rng.uniform(0.2, 0.8))
    rough = {
        "edge_roughness_um": scatter * (1 - common**2) ** 0.5,
        "edge_common_um": scatter * common,
        "correlation_um": log_uniform(rng, 2, 15) * px,
    }
    if rng.random() < 1 / 2:
        rough["one_sided_blur_px"] = float(rng.uniform(0.5, 2.2))
    if rng.random() < 1 / 3:
        rough["halo"] = {"fraction": float(rng.uniform(0.05, 0.2)), "length_px": float(rng.uniform(10, 30))}
    if rng.random() < 1 / 3:
        rough["side_wall"] = {"amplitude": float(rng.uniform(-0.2, 0.3)), "length_px": float(rng.uniform(5, 15)),
                              "direction_deg": float(rng.uniform(-180, 180))}  # fmt: skip
    if rng.random() < 1 / 3:
        rough["jpeg"] = {"quality": int(rng.integers(80, 96))}
    return rough


def make_case(name, index, seed):
    tier = TIERS[name]
    rng = np.random.default_rng([seed, 7 + list(TIERS).index(name), index])
    layout = tier.layouts[index % len(tier.layouts)]
    kinds = [tier.kinds[index % len(tier.kinds)]] if tier.kinds else []
    case = draw_case(rng, layout, index, kinds, 10.0 if kinds else None)
    rough = draw_rough(rng)
    for spec in case["specs"]:
        scanner = spec["scanner"]
        scanner.update(rough=rough, bits=8, blur_px=float(rng.uniform(1.4, 2.4)), noise_correlation=0.5)
        scanner["noise"] = float(rng.uniform(1, 2.5))
    for effect in case["effects"]:
        factor = STANDARD_ERRORS / max(standard_errors(case, effect), 1e-9)
        for member in ("amplitude_um", "value"):
            if member in effect:
                effect[member] *= factor
        for knot in effect.get("knots", []):
            knot[1] *= factor
    return layout, case


def floor_um(program, folder, case):
    """Errors of the same foils with the same scatter and no effect, measured."""
    bare = {**case, "effects": [], "specs": [{**s, "effects": []} for s in case["specs"]]}
    report, _, _ = run_loop(program, folder, bare)
    pairs = pair_foils(bare, report["before"]["foils"]) if report else None
    return {f"{q}_floor_um": float(f"{e:.5g}") for q, e in errors_um(pairs).items()}


def work_on(program, key):
    layout, case = make_case(key["tier"], key["index"], key["seed"])
    with tempfile.TemporaryDirectory() as folder:
        report, code, seconds = run_loop(program, folder, case)
        row = {"layout": layout, **judge(case, report, code, seconds)}
        values = [c["p_value"] for c in report["claims"] if c["p_value"] is not None] if report else []
        return {"p_value": min(values, default=""), **row, **floor_um(program, folder, case)}


def number(row, name):
    return float(row[name])


def lines_of(title, rows):
    claims = lambda r: r["verdict"] != "clean"
    wrong = lambda r: r["claims"] and not number(r, "in_class")
    worse = lambda r: any(number(r, f"{q}_after_um") > 1.02 * number(r, f"{q}_before_um") for q in ("R", "h", "R0"))
    median = lambda q: np.median([number(r, q + "_after_um") / number(r, q + "_floor_um") for r in rows])
    cells = [title, len(rows), share(rows, claims), share(rows, lambda r: number(r, "named"))]
    cells += [share(rows, lambda r: number(r, "in_class")), share(rows, wrong), share(rows, lambda r: r["unattributed"])]
    cells += [share(rows, worse)] + [f"{median(q):.2f}" for q in ("R", "h", "R0")]
    return cells + [f"{np.median([number(r, 'seconds') for r in rows]):.1f}"]


def write(out, rows, seeds, cases):
    header = ["tier", "inputs", "claims %", "named %", "in class %", "wrong cause %", "unattributed %", "worse %",
              "R after / floor", "h", "R0", "s"]  # fmt: skip
    table = [lines_of(f"{t.title}, seed {seed}", own) for name, t in TIERS.items() for seed in seeds
             if (own := [r for r in rows if r["tier"] == name and r["seed"] == str(seed)])]  # fmt: skip
    text = ["# The loop on scans with rough edges", "",
            "Made by `python3 tests/bench/loop_rough.py build/foilgauge" + (f" --cases {cases}" if cases else "") + "`. " + (__doc__ or "").split("\n\n")[2].replace("\n", " "),
            "", "Floor: the same foils and scatter without the effect, measured. Worse: an error of R, h or R0 that is more than 2 %",
            "larger after than before. Wrong cause: something is claimed, and what is there is not among the explanations.", ""]  # fmt: skip
    with open(os.path.join(out, "loop_rough.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(text + markdown(header, table)) + "\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, help="at most so many of every tier and seed")
    parser.add_argument("--tier", action="append", choices=TIERS)
    parser.add_argument("--seed", action="append", type=int)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--report-only", action="store_true")
    parser.add_argument("--out", default=os.path.join(ROOT, "reports"))
    options = parser.parse_args()
    program, seeds = os.path.abspath(options.program), options.seed or [11, 12, 13]
    results = Results(os.path.join(options.out, "loop_rough.csv"), options.fresh, "R_floor_um")
    jobs = []
    for name in options.tier or TIERS:
        count = TIERS[name].count // len(seeds)
        count = count if options.cases is None else min(options.cases, count)
        jobs += [{"tier": name, "seed": seed, "index": k} for seed in seeds for k in range(count)]
    if not options.report_only:
        results.run(jobs, lambda key: work_on(program, key), options.threads)
    write(options.out, results.rows, seeds, options.cases)


if __name__ == "__main__":
    main()
