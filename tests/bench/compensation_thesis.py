# SPDX-License-Identifier: GPL-3.0-or-later
"""compensation_thesis.py PROGRAM OUT.json [DPI]: the thesis's classical and sinusoidal lots as rendered scans, the die that
they ask for, and the lot that comes of it, rendered and measured as well.

The thesis has no lot of a second die. Every bump of the first lot loses curvature (1/R_D - 1/R); the next lot's bumps lose
the same curvatures, dealt anew, from the next die's radii, at constant arc length, and the foils open by the same ratios of
the overall radius, dealt anew. The program is told nothing of this.
"""

import json
import math
import pathlib
import random
import statistics
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support")]
import thesis_lot  # noqa: E402
import thesis_lots  # noqa: E402
from formed_lots import die_of_report, run  # noqa: E402

CLASSICAL = {"schema": "foilgauge/design/1", "name": "classical", "bump_radius_mm": 3.32, "bump_angle_deg": 63.15,
             "overall_radius_mm": 20.73, "thickness_mm": 0.1, "bump_count": 9}
SINUSOIDAL = {**thesis_lots.DESIGN, "bump_count": 9}
RENDERED = {"calibration": "not needed: the scans are rendered", "tolerances": {"radius_error_pct": {"min": -10, "max": 10}}}


def measure(program, folder, design, lot, expected=None):
    (folder / "design").mkdir(exist_ok=True)
    (folder / "design" / "design.json").write_text(json.dumps({**design, **RENDERED}))
    for spec in sorted(folder.glob("foil*.json")):
        run(program, "render", spec, "-o", spec.with_suffix(".png"))
    run(program, "lot", folder / "manifest.csv", "-o", lot, "--design", folder / "design" / "design.json", "--pages", "none",
        *(("--expected", expected) if expected else ()))
    for scan in folder.glob("*.png"):
        scan.unlink()


def next_specs(first, second, design, die):
    """The foils of the first lot, dealt anew, from the next die."""
    specs = [json.loads(path.read_text()) for path in sorted(first.glob("foil*.json"))]
    lost = [1 / design["bump_radius_mm"] - 1 / radius for spec in specs for radius in spec["foils"][0]["radius_mm"]]
    opened = [spec["foils"][0]["overall_radius_mm"] / design["overall_radius_mm"] for spec in specs]
    rng = random.Random(7)
    rng.shuffle(lost)
    rng.shuffle(opened)
    second.mkdir(parents=True)
    (second / "manifest.csv").write_text((first / "manifest.csv").read_text())
    for k, (path, spec) in enumerate(zip(sorted(first.glob("foil*.json")), specs)):
        foil, radii, angles = spec["foils"][0], [], []
        for i, (radius, angle) in enumerate(die["bumps"]):
            formed = 1 / (1 / radius - lost[9 * k + i])
            radii.append(round(formed, 5))
            angles.append(round(radius * angle / formed, 5))
        foil.update(radius_mm=radii, bump_angle_deg=angles, overall_radius_mm=round(die["overall"] * opened[k], 4),
                    rotate_deg=round(-90 + rng.uniform(-25, 25), 3))
        foil.setdefault("design", {})["pitch_deg"] = die["pitch"]
        spec["seed"] += 1000
        (second / path.name).write_text(json.dumps(spec))


def one_lot(program, name, make, design, work, dpi):
    first, second = work / name / "first", work / name / "second"
    make(first, dpi)
    for path in first.glob("foil*.json"):  # both kinds say radius and angle of every bump
        spec = json.loads(path.read_text())
        foil = spec["foils"][0]
        foil.setdefault("bump_angle_deg", [round(design["bump_angle_deg"] * design["bump_radius_mm"] / r, 5) for r in foil["radius_mm"]])
        path.write_text(json.dumps(spec))
    lots = [work / name / lot for lot in ("lot1", "lot2")]
    target, report = work / name / "target.json", work / name / "next.json"
    target.write_text(json.dumps({**design, **RENDERED}))
    measure(program, first, design, lots[0])
    run(program, "die", "--target", target, "--lot", lots[0], "--step-um", 1, "-o", report)
    next_specs(first, second, design, die_of_report(report))
    measure(program, second, design, lots[1], report)
    die, expected = json.loads(report.read_text()), json.loads((lots[1] / "expected.json").read_text())
    radii = [bump["radius_mm"] for bump in die["die"]["bumps"]]
    lot = [json.loads((folder / "lot.json").read_text()) for folder in lots]
    return {
        "name": name, "foils": expected["foils"], "design_radius_mm": design["bump_radius_mm"],
        "die_radius_mm": [min(radii), statistics.fmean(radii), max(radii)],
        "die_overall_mm": die["die"]["overall_radius_mm"], "step_share": die["step_share"],
        "mean_error_pct": [row["mean_error_pct"] for row in expected["iterations"]],
        "rms_error_pct": [row["rms_error_pct"] for row in expected["iterations"]],
        "overall_error_pct": [100 * (one["quantities"]["overall.radius_mm"]["mean"] / design["overall_radius_mm"] - 1) for one in lot],
        "inside": expected["inside"], "values": expected["values"], "p_value": expected["p_value"],
        "share_predicted": die["expected"]["share_within"], "share_of_lots": die["expected"]["share_within_of_lots"],
        "passed": [one["counts"]["pass"] / one["counts"]["foils"] for one in lot], "loop": expected["loop"]["sentence"],
    }


def main(program, out, dpi="1200"):
    program = str(pathlib.Path(program).resolve())
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        lots = [one_lot(program, "classical", lambda path, d: thesis_lot.main(path, d), CLASSICAL, work, dpi),
                one_lot(program, "sinusoidal", lambda path, d: thesis_lots.main(path, d), SINUSOIDAL, work, dpi)]
    pathlib.Path(out).write_text(json.dumps({"dpi": int(dpi), "lots": lots}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
