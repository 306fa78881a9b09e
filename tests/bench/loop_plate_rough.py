# SPDX-License-Identifier: GPL-3.0-or-later
"""A scanner's model from a plate of pins whose edges are rough, on foils whose edges are: rendered scanners with scale,
shear, ripple, lost rows, all four, or nothing; `loop --form discs --model-out` on the plate, `measure --model` on a foil.

Usage: loop_plate_rough.py PROGRAM [--cases N] [--tier NAME]... [--seed S]... [--all] [--threads N] [--fresh] [--report-only]
       [--pictures DIR]

Seed 16 runs only with --all, and nobody looks at it while limits are set. Scanners that the CSV holds are not run again.
Writes reports/loop_plate_rough.csv and .md."""

import argparse
import json
import os
import subprocess
import tempfile

import numpy as np

from loop_cases import GEN2, draw_foil, place
from loop_plate import effects, plate_spec, scanner
from loop_rough import draw_rough, render_others
from loop_rough_asked import asked, verdict_of
from loop_rough_judged import over_floor, worse, worse_than_noise
from loop_run import Results, add_options, errors_um, kept, pair_foils, render, within, write_design
from loop_scans_report import QUANTITIES, markdown, number, share
from other_scanner import draw_other

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
FOUR = ("scan.scale_y", "scan.shear", "scan.carriage_ripple", "scan.row_step")
SETS = [*((one,) for one in FOUR), FOUR, ()]
COUNT = 18  # scanners of every seed and tier
SEEDS, KEPT_ASIDE = [14, 15], 16
TIERS = {"plate": "this renderer", "other-plate": "second renderer"}


def step_through_pin(rng, plate, found):
    """Lost rows where a pin of the plate lies, and the foil as well."""
    for effect in found:
        while effect["id"] == "scan.row_step":
            pin = plate["discs"][int(rng.integers(len(plate["discs"])))]
            effect["y_mm"] = pin["centre_mm"][1] + float(rng.uniform(-0.6, 0.6)) * pin["radius_mm"]
            if pin["radius_mm"] >= 1.5 and 6 < effect["y_mm"] < 14:
                break


def make_scanner(name, index, seed):
    """(effects, spec of the plate, case of the foil)."""
    rng = np.random.default_rng([seed, 70 + list(TIERS).index(name), index])
    found = effects(rng, SETS[index % len(SETS)])
    if name == "plate":
        scan = {**scanner(rng), "rough": draw_rough(rng), "noise_correlation": 0.5, "blur_px": float(rng.uniform(1.4, 2.4))}
    else:
        scan = draw_other(rng)
        # Unequal ones make every pin's height another than its width: no midline shows that, but a pin does.
        scan["lag_px"] = [float(np.mean(scan["lag_px"]))] * 2
    plate = plate_spec(rng, scan, found)
    step_through_pin(rng, plate, found)
    right, bottom = (max(d["centre_mm"][k] + d["radius_mm"] for d in plate["discs"]) for k in (0, 1))
    pixels = lambda mm: int(mm / 25.4 * 4800)
    plate.update(width_px=pixels(right + 1), height_px=pixels(bottom + 1))
    if name != "plate":
        plate["foils"] = []
    foil = {**draw_foil(rng, GEN2), "rotate_deg": float(rng.uniform(-110, -70))}
    width, height = place(rng, [[foil]])
    spec = {"schema": "foilgauge/render/1", "seed": int(rng.integers(1, 2**31)), "foils": [foil], "scanner": scan,
            "effects": found, "width_px": pixels(width), "height_px": pixels(height)}  # fmt: skip
    return found, plate, {"design": GEN2, "same_foil": False, "specs": [spec], "effects": found}


def find_model(program, folder, path):
    """(path of the model or None, the report or None)."""
    model, report = os.path.join(folder, "model.json"), os.path.join(folder, "loop.json")
    command = [program, "loop", path, "--form", "discs", "-o", report]
    # No model is written of a picture that once was a JPEG, and no report with it.
    for more in (["--model-out", model], []):
        if not os.path.exists(report):
            subprocess.run([*command, *more], stderr=subprocess.DEVNULL)
    if not os.path.exists(report):
        return None, None
    with open(report, encoding="utf-8") as f:
        return (model if os.path.exists(model) else None), json.load(f)


def measure(program, folder, case, path, model=None):
    """(errors in um, how many values lie within U)."""
    out = os.path.join(folder, "measure.json")
    options = ["--model", model] if model else []
    command = [program, "measure", path, "--design", write_design(folder, case["design"]), *options, "-o", out]
    subprocess.run(command, stderr=subprocess.DEVNULL)
    with open(out, encoding="utf-8") as f:
        pairs = pair_foils(case, json.load(f)["foils"])
    os.remove(out)
    return errors_um(pairs), within(pairs), u_model_um(pairs)


def u_model_um(pairs):
    return float(np.mean([1000 * f["correction"]["u_overall_radius_mm"] if f.get("correction") else 0 for _, _, f in pairs or []] or [0]))


def work_on(program, key, pictures=None):
    found, plate, case = make_scanner(key["tier"], key["index"], key["seed"])
    bare = {**case, "effects": [], "specs": [{**s, "effects": []} for s in case["specs"]]}
    draw = render if key["tier"] == "plate" else render_others
    draw = kept(draw, os.path.abspath(pictures)) if pictures else draw
    with tempfile.TemporaryDirectory() as folder:
        model, report = find_model(program, folder, draw(program, folder, [plate])[0])
        picture = draw(program, folder, case["specs"])[0]
        sides = {"before": measure(program, folder, case, picture)}
        sides["after"] = measure(program, folder, case, picture, model) if model else sides["before"]
        sides["floor"] = measure(program, folder, bare, draw(program, folder, bare["specs"])[0])
    claims = sorted(c["id"] for c in report["claims"]) if report else []
    wanted = sorted(e["id"] for e in found)
    extra = report is not None and report["unattributed"]
    row = {"wanted": " + ".join(wanted), "verdict": report["verdict"] if report else "failed",
           "claims": " + ".join(claims), "unattributed": extra["coordinate"] if extra else "",
           "named": int(claims == wanted and not extra), "model": int(model is not None)}  # fmt: skip
    for q in QUANTITIES:
        for side, (errors, inside, _) in sides.items():
            row[f"{q}_{side}_um"] = float(f"{errors[q]:.5g}")
            row[f"{q}_within_{side}"] = round(inside[q][0] / inside[q][1], 4) if inside[q][1] else 0
    row["R0_u_model_um"] = float(f"{sides['after'][2]:.5g}")
    row["p_value"] = report["p_value"] if report else ""
    row["effects"] = json.dumps(found, separators=(",", ":"))
    return row


def floors(rows):
    return {q: float(np.median([number(r, q + "_floor_um") for r in rows])) for q in QUANTITIES}


def over_limit(rows):
    """R0 by a model is as good as its foil's noise and the plate's knowledge of its numbers."""
    limits = [float(np.hypot(number(r, "R0_floor_um"), number(r, "R0_u_model_um"))) for r in rows]
    return float(np.median([number(r, "R0_after_um") for r in rows]) / np.median(limits))


def glance(rows):
    """(title, key of the requirement, value, number of cases)."""
    clean, real = [r for r in rows if not r["wanted"]], [r for r in rows if r["wanted"]]
    fixed = [r for r in real if number(r, "model")]
    percent = lambda own, test: 100 * float(np.mean([bool(test(r)) for r in own])) if own else None
    yield "plates without an effect, with a claim, %", "claims", percent(clean, lambda r: r["verdict"] != "clean"), len(clean)
    yield "plates with effects: exactly named, %", "exact", percent(real, lambda r: number(r, "named")), len(real)
    yield "foils made worse, %", "worse", percent(rows, lambda r: worse(r, floors(rows))) if rows else None, len(rows)
    yield "foils made worse beyond noise, %", "worse", percent(rows, lambda r: worse_than_noise(r, floors(rows))), len(rows)
    for q in QUANTITIES:
        yield f"foil {q} after / floor (medians)", "floor", over_floor(real, q) if real else None, len(real)
    yield "foil R0 after / root of floor² and the model's u² (medians)", "floor", over_limit(fixed) if fixed else None, len(fixed)
    for q in QUANTITIES:
        inside = [100 * number(r, q + "_within_after") for r in fixed]
        yield f"intervals of {q} after a correction that hold, %", "within", float(np.mean(inside)) if inside else None, len(fixed)


def set_lines(rows):
    table = [["", "**asked**", "", asked("exact"), *["", asked("floor")] * 3, asked("worse"), asked("within")]]
    for name, title in TIERS.items():
        for which in SETS:
            wanted = " + ".join(sorted(which))
            own = [r for r in rows if r["tier"] == name and r["wanted"] == wanted]
            if not own:
                continue
            word = "all four" if len(which) > 1 else wanted or "nothing"
            cells = [title, word, len(own), share(own, lambda r: number(r, "named"))]
            least = floors([r for r in rows if r["tier"] == name])
            for q in QUANTITIES:
                side = {s: np.median([number(r, f"{q}_{s}_um") for r in own]) for s in ("before", "after", "floor")}
                cells += [f"{side['before']:.3g} → {side['after']:.3g}, {side['floor']:.3g}", f"{over_floor(own, q):.2f}"]
            inside = [100 * np.mean([number(r, f"{q}_within_{s}") for r in own for q in QUANTITIES]) for s in ("before", "after")]
            table.append([*cells, share(own, lambda r: worse(r, least)), " → ".join(f"{v:.0f}" for v in inside)])
    header = ["plate", "there", "scanners", "exactly named %"]
    for q in QUANTITIES:
        header += [f"{q}: before → after, floor, µm", "after / floor"]
    return markdown([*header, "worse %", "within U, %"], table)


TEXT = """Made by `python3 tests/bench/loop_plate_rough.py build/foilgauge{options}`: {count} rendered scanners of the seeds {seeds}, a row
each in loop_plate_rough.csv. Edges as in loop_rough.md, of pins and foils. Scale 0.03 to 0.2 %, shear 0.03 to 0.15 %, a ripple of 3 to
12 µm and 1.2 to 5 mm, 1 to 4 rows lost or doubled where a pin lies and the foil. A plate of twelve pins of 1 to 7 mm, whose diameters the
loop is not told, gives the model (`loop --form discs --model-out`); a foil of another scan is measured without it and with it (`measure
--model`), and, as the floor, rendered without the effect. Errors are against the truth, R and h rms over a foil's bumps. Worse: an
error of R, h or R0 is larger after than before, by more than 2 % and a tenth of the median floor; beyond noise: and by more than a fifth
than the same foil's floor."""


def write(folder, rows):
    seeds = sorted({r["seed"] for r in rows})
    text = TEXT.format(options=" --all" if str(KEPT_ASIDE) in seeds else "", count=len(rows), seeds=", ".join(seeds))
    both = [list(glance([r for r in rows if r["tier"] == name])) for name in TIERS]
    table = []
    for (what, key, *first), (_, _, *second) in zip(*both):
        cells = [what, asked(key)]
        for value, count in (first, second):
            cells += ["–" if value is None else f"{value:.3g} (of {count})", verdict_of(key, value)]
        table.append(cells)
    lines = ["# From a plate of pins with rough edges to foils", "", text, "", "## What was asked, and what holds", ""]
    if len(rows) < COUNT * len(TIERS) * len(seeds):
        lines.insert(4, "**A part of the benchmark: not every tier of every seed is whole.**\n")
    lines += markdown(["what", "asked", "this renderer", "holds", "second renderer", "holds"], table)
    lines += ["", "## Effect by effect", "", "Medians over the scanners.", "", *set_lines(rows)]
    lines += ["", "## Plates that were not exactly named", ""]
    missed = [[r["tier"], r["seed"], r["index"], r["wanted"] or "nothing",
               " + ".join(filter(None, [r["claims"], r["unattributed"] and "unattributed " + r["unattributed"]])) or r["verdict"]]
              for r in rows if not number(r, "named")]  # fmt: skip
    lines += markdown(["tier", "seed", "case", "there", "said"], missed)
    with open(os.path.join(folder, "loop_plate_rough.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("wrote loop_plate_rough.md")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, help="at most so many scanners of every tier and seed")
    add_options(parser, TIERS, os.path.join(ROOT, "reports"))
    options = parser.parse_args()
    program, seeds = os.path.abspath(options.program), options.seed or SEEDS + [KEPT_ASIDE] * options.all
    for folder in filter(None, (options.out, options.pictures)):
        os.makedirs(folder, exist_ok=True)
    results = Results(os.path.join(options.out, "loop_plate_rough.csv"), options.fresh, seeds, "R_within_floor")
    count = COUNT if options.cases is None else min(options.cases, COUNT)
    jobs = [{"tier": n, "seed": s, "index": k} for n in options.tier or TIERS for s in seeds for k in range(count)]
    if not options.report_only:
        results.run(jobs, lambda key: work_on(program, key, options.pictures), options.threads)
    write(options.out, results.rows)


if __name__ == "__main__":
    main()
