# SPDX-License-Identifier: GPL-3.0-or-later
"""reports/loop_width.md: from which size on the loop claims a thickness that changes along the foil, and how often it
claims one where there is none.

Usage: python3 tests/bench/loop_width.py build/foilgauge
"""

import functools
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parents[2]
ID = "part.thickness_taper"
# Group of renders: its description; the number of them without a taper, and with each of the sizes, um.
GROUPS = {
    "ideal": ("noise, blur, both polarities, 8 and 16 bits", {0: 20, 1: 10, 2: 10, 4: 10, 6: 10}),
    "shaded": ("also a gamma curve, shading over the glass, flare", {0: 10}),
    "rough": ("the scanner of samples/render/rough.json", {0: 10, 6: 10}),
    "coarse": ("1200 dpi, where a strip is some three blurs wide, and noise of 1 to 3", {0: 40, 10: 20}),
}
HEAD = """# A thickness that changes along the foil

`python3 tests/bench/loop_width.py build/foilgauge`: one scan of one foil each, at any rotation, seeded. Claimed: how many
reports say `part.thickness_taper`; other claims: whatever else they say. Error and U = 2u are of the change from end to end,
over the renders where it is claimed. Shows from: the smallest change that the others say would have shown, median. U is
never below what an error of the edge model over the place on the glass would make of it (`PLACE_UM` in
src/effect_search/width_search.c), which one scan cannot tell from a taper, and holds what pixels' noise makes of the strip's
level and blur, which few blurs of width hardly tell from the width (src/effect_search/shape_noise.h).

| renders | change, µm | scans | claimed | other claims | error within U | median error, µm | mean error, µm | median U, µm | shows from, µm |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|
"""


def draw_ideal(rng):
    light = rng.random() < 0.5
    return {
        "dpi": 4800, "bits": rng.choice([8, 16]), "blur_px": rng.uniform(0.9, 2.0), "noise": rng.uniform(0.5, 2.0),
        "background": rng.uniform(25, 45) if light else rng.uniform(200, 225),
        "contrast": rng.uniform(150, 180) if light else -rng.uniform(140, 170),
    }  # fmt: skip


def draw_scanner(rng, group):
    if group == "rough":
        return json.loads((ROOT / "samples/render/rough.json").read_text())["scanner"]
    scanner = draw_ideal(rng)
    if group == "coarse":
        scanner.update(dpi=1200, blur_px=rng.uniform(1.2, 1.6), noise=rng.uniform(1, 3))
    if group == "shaded":
        scanner["gamma"] = math.exp(rng.uniform(math.log(0.6), math.log(1.8)))
        scanner["shading"] = {axis: rng.uniform(-0.04, 0.04) for axis in ("x", "y", "quadratic")}
        scanner["rough"] = {"halo": {"fraction": rng.uniform(0, 0.12), "length_px": rng.uniform(8, 25)}}
    return scanner


def draw_spec(group, change_um, seed):
    rng = random.Random(f"{group} {change_um} {seed}")
    foil = {
        "overall_radius_mm": rng.uniform(20.78, 21.1), "mirror": rng.random() < 0.5,
        "radius_springback": {"mean": rng.uniform(0, 0.04), "sd": 0.007}, "rotate_deg": rng.uniform(-180, 180),
    }  # fmt: skip
    effects = []
    if change_um:
        effects = [{"id": ID, "thickness_change_um": change_um * rng.choice([-1, 1])}]
    return {"schema": "foilgauge/render/1", "seed": rng.randrange(1, 2**31), "foils": [foil],
            "scanner": draw_scanner(rng, group), "effects": effects}  # fmt: skip


def run(program, folder, group, change_um, seed):
    spec = draw_spec(group, change_um, seed)
    base = folder / f"{group}{change_um}_{seed}"
    base.with_suffix(".json").write_text(json.dumps(spec))
    picture, out = base.with_suffix(".png"), base.with_suffix(".out")
    subprocess.run([program, "render", base.with_suffix(".json"), "-o", picture], check=True)
    code = subprocess.run([program, "loop", "--threads", "1", picture, "-o", out]).returncode
    if code:
        sys.exit(f"the loop on {base.with_suffix('.json')} ends with {code}")
    picture.unlink()
    report = json.loads(out.read_text())
    answer = {"others": sum(c["id"] != ID for c in report["claims"]), "curve": report["unattributed"] is not None}
    for claim in report["claims"]:
        if claim["id"] == ID:
            answer["error"] = claim["parameters"]["thickness_change_um"] - sum(
                e["thickness_change_um"] for e in spec["effects"])  # fmt: skip
            answer["U"] = 2 * claim["uncertainty"]["thickness_change_um"]
    for one in report["rejected"]:
        if one["id"] == ID:
            answer["shows"] = one["smallest_amplitude"]
    return answer


def middle(values):
    return f"{statistics.median(values):.2g}" if values else ""


def line(group, change_um, answers):
    claimed = [a for a in answers if "error" in a]
    errors, expanded = [a["error"] for a in claimed], [a["U"] for a in claimed]
    others = sum(a["others"] + a["curve"] for a in answers)
    cells = [
        group, str(change_um), str(len(answers)), str(len(claimed)), str(others),
        str(sum(abs(a["error"]) <= a["U"] for a in claimed)) if claimed else "", middle([abs(e) for e in errors]),
        f"{statistics.mean(errors):+.2g}" if errors else "", middle(expanded),
        middle([a["shows"] for a in answers if "shows" in a]),
    ]  # fmt: skip
    return "| " + " | ".join(cells) + " |\n"


def main(program):
    text = HEAD
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(2) as pool:
        for group, (_, sizes) in GROUPS.items():
            for change_um, count in sizes.items():
                one = functools.partial(run, program, pathlib.Path(name), group, change_um)
                answers = list(pool.map(one, range(count)))
                text += line(group, change_um, answers)
                print(line(group, change_um, answers), end="", flush=True)
    text += "\n" + "; ".join(f"{group}: {what}" for group, (what, _) in GROUPS.items()) + ".\n"
    (ROOT / "reports" / "loop_width.md").write_text(text)


if __name__ == "__main__":
    main(sys.argv[1])
