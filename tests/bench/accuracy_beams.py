# SPDX-License-Identifier: GPL-3.0-or-later
"""Accuracy on flat foils with beams of known length and width: writes reports/accuracy_beams.md.

Foils are rendered by `foilgauge render` and, apart from all of it, by tests/bench/other_beams.py: polygons with exact
area coverage. Combs with and without shoulders and fillets, sheets with slits whose ends are round or square, any
angle, light and dark, 8 and 16 bit, sharp and rounded corners."""

import argparse
import json
import math
import os
import subprocess
import tempfile

import numpy as np

import benchlib as lib
import other_beams

QUANTITIES = [("length_mm", "L", 1000.0, "µm"), ("width_mm", "w", 1000.0, "µm"), ("taper_um_per_mm", "taper", 1.0, "µm/mm"),
              ("compliance_error_pct", "e_S", 1.0, "%")]
COUNT = 5


def design_of(length, width):
    return {"schema": "foilgauge/design/1", "form": "cantilever", "beam_count": COUNT, "beam_length_mm": length,
            "beam_width_mm": width, "thickness_mm": 0.1}


def truth_of(design, sizes):
    """Length, width halfway, taper and compliance error of every beam from left to right, the tips up."""
    beams = []
    for length, root, tip in sizes:
        width = 0.5 * (root + tip)
        ratio = (length / design["beam_length_mm"]) ** 3 * design["beam_width_mm"] / width
        beams.append({"length_mm": length, "width_mm": width, "taper_um_per_mm": 1000 * (root - tip) / length,
                      "compliance_error_pct": 100 * (ratio - 1)})
    return beams


def kinds(index):
    """Layout, square corners, square slit ends."""
    return ["comb", "slits", "comb", "slits"][index % 4], index % 4 < 2, index % 8 == 3


def random_scan(rng, index, kind):
    scan = {"dpi": 1200.0 if kind == "coarse" else [2400.0, 4800.0][index % 2], "turn": float(rng.uniform(-180, 180)), "light": bool(rng.integers(2)),
            "bits": int(rng.choice([8, 16])), "blur": 1.2, "noise": 2.0, "rough": 0.0, "length": 8.0}
    if kind == "rough":
        scan.update(blur=float(rng.uniform(1.0, 2.0)), noise=float(rng.uniform(2, 4)),
                    rough=float(rng.uniform(0.15, 0.3)), length=float(rng.uniform(5, 11)))
    return scan


def by_numpy(rng, index, kind, folder):
    """A foil of the other renderer, and its truth."""
    layout, sharp, square = kinds(index)
    scan, length, width = random_scan(rng, index, kind), rng.uniform(2.5, 3.5), rng.uniform(0.6, 0.9)
    design = design_of(round(length, 3), round(width, 3))
    sizes = []
    for _ in range(COUNT):
        middle, taper = width + rng.normal(0, 0.02), 0 if sharp else rng.uniform(-0.03, 0.03)
        sizes.append((length + rng.normal(0, 0.03), middle + taper / 2, middle - taper / 2))
    radius = 0 if sharp else float(rng.uniform(0.03, 0.12))
    if layout == "comb":
        shoulder = float(rng.choice([0, 0.8]))
        straight = [(a, 0.5 * (b + c), 0.5 * (b + c)) for a, b, c in sizes]
        sizes = sizes if shoulder else straight
        outlines = other_beams.comb(sizes, rng.uniform(0.4, 0.9), 1.5, radius, radius, shoulder)
    else:
        outlines = other_beams.sheet(sizes, width + 0.8, rng.uniform(0.12, 0.25), 1.0, radius, not square)
    picture = other_beams.render(outlines, rng, scan["dpi"], scan["turn"], scan["blur"], scan["noise"], scan["light"],
                                 scan["bits"], scan["rough"], scan["length"])
    other_beams.write_png(os.path.join(folder, "scan.png"), picture, scan["dpi"])
    return design, truth_of(design, sizes)


def by_program(rng, index, kind, folder):
    """A foil of `foilgauge render`, and its truth."""
    layout, sharp, _ = kinds(index)
    scan = random_scan(rng, index, kind)
    design = design_of(round(rng.uniform(2.5, 3.5), 3), round(rng.uniform(0.6, 0.9), 3))
    beams = {"layout": layout, "pitch_mm": design["beam_width_mm"] + float(rng.uniform(1.1, 1.3)), "base_mm": 1.5,
             "shoulder_mm": 0.8, "corner_radius_mm": 0.001 if sharp else float(rng.uniform(0.03, 0.12)),
             "length": {"sd_um": 30}, "width": {"sd_um": 20}, "taper_um": 0 if sharp or layout == "slits" else float(rng.uniform(-30, 30))}
    if layout == "slits":
        beams["kerf_mm"] = float(rng.choice([0.125, 0.15, 0.2, 0.25]))
    else:
        beams["root_radius_mm"] = 0.001 if sharp else float(rng.uniform(0.05, 0.2))
    scanner = {"dpi": scan["dpi"], "bits": scan["bits"], "blur_px": scan["blur"], "noise": scan["noise"],
               "background": 30 if scan["light"] else 215, "contrast": 175 if scan["light"] else -175}
    if scan["rough"]:
        um = 25400 / scan["dpi"]
        scanner["rough"] = {"edge_roughness_um": scan["rough"] * um, "correlation_um": scan["length"] * um}
    spec = {"schema": "foilgauge/render/1", "seed": int(rng.integers(1, 2**31)), "scanner": scanner,
            "foils": [{"design": {k: v for k, v in design.items() if k != "schema"}, "beams": beams,
                       "rotate_deg": scan["turn"]}]}
    paths = [os.path.join(folder, name) for name in ("spec.json", "scan.png", "truth.json")]
    with open(paths[0], "w", encoding="utf-8") as file:
        json.dump(spec, file)
    subprocess.run([lib.FOILGAUGE, "render", paths[0], "-o", paths[1], "--truth", paths[2]], check=True)
    true = lib.load_truth(paths[2])["beams"]
    sizes = [(b["length_mm"], b["width_mm"] + b["taper_um"] / 2000, b["width_mm"] - b["taper_um"] / 2000) for b in true]
    return design, truth_of(design, sizes)


def measure(design, folder):
    paths = [os.path.join(folder, name) for name in ("design.json", "scan.png", "out.json")]
    with open(paths[0], "w", encoding="utf-8") as file:
        json.dump(design, file)
    subprocess.run([lib.FOILGAUGE, "measure", paths[1], "--design", paths[0], "-o", paths[2]], check=False,
                   stderr=subprocess.DEVNULL)
    try:
        foils = lib.load(paths[2])["foils"]
    except FileNotFoundError:
        foils = []
    if os.path.exists(paths[2]):
        os.remove(paths[2])
    return foils[0]["beams"] if len(foils) == 1 else []


def rows_of(true, found, keep):
    """Errors and uncertainties of every beam; None of one that was not measured."""
    rows = []
    for i, want in enumerate(true):
        beam = found[i] if len(found) == len(true) else None
        if beam is None or any(beam[name] is None for name, *_ in QUANTITIES):
            rows.append(None)
            continue
        rows.append([(factor * (beam[name] - want[name]), factor * beam["u_" + name]) for name, _, factor, _ in QUANTITIES])
    if keep and any(r is None or any(abs(e) > 4 * u for e, u in r) for r in rows):
        print(keep, [None if r is None else [f"{e:.3f}/{u:.3f}" for e, u in r] for r in rows])
    return rows


def run(render, foils, kind, seed, folder, keep):
    rng, rows = np.random.default_rng(seed), []
    for index in range(foils):
        design, true = render(rng, index, kind, folder)
        name = f"{render.__name__} seed {seed} {kind} foil {index} {kinds(index)}" if keep else ""
        rows += rows_of(true, measure(design, folder), name)
        if keep and name:
            os.makedirs(keep, exist_ok=True)
    return rows


def summary(label, rows):
    """A line per quantity."""
    found = np.array([row for row in rows if row])
    lines = []
    for k, (_, symbol, _, unit) in enumerate(QUANTITIES):
        e, u = found[:, k, 0], found[:, k, 1]
        lines.append([label, symbol, unit, len(rows), len(rows) - len(found), lib.number(lib.rms(e)),
                      lib.number(np.mean(e), 2), lib.number(np.std(e) / math.sqrt(len(e)), 2), lib.number(np.max(np.abs(e))),
                      lib.number(np.median(u)), f"{100 * np.mean(np.abs(e) <= 2 * u):.1f} %"])
    return lines


HEADER = ["scans", "of", "unit", "beams", "not measured", "rms error", "bias", "± of it", "largest error", "median u",
          "within U = 2 u"]

TEXT = """# Accuracy on flat foils with beams

`python3 tests/bench/accuracy_beams.py` writes this page. {version}; {foils} foils of {count} beams each per line and
seed, seeds {seeds}; 2400 and 4800 dpi, and 1200 dpi; any angle, light and dark, 8 and 16 bit. Half of the foils are combs (with
shoulders and without), half are sheets with slits of 0.12 to 0.25 mm whose ends are round, or square in one of eight of
numpy's; half have sharp corners, half corners of 0.03 to 0.12 mm, fillets and a taper of up to 30 µm. L is the length, w
the width halfway, e_S the compliance against the design's (include/foilgauge/foil.h defines them). "program" is
`foilgauge render`, "numpy" tests/bench/other_beams.py, which shares nothing with it.

## Clean

Blur 1.2 px, noise 2 of a contrast of 175.

{clean}
## Rough

Edges scatter by 0.15 to 0.3 px, correlated over 5 to 11 px; blur 1 to 2 px, noise 2 to 4.

{rough}
## At 1200 dpi

As clean ones. The slits are 6 to 12 px wide, so that their round ends are few pixels.

{coarse}"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--foils", type=int, default=8, help="per renderer and seed")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--show", metavar="WORD", default="", help="prints foils with errors above 4 u")
    parser.add_argument("-o", default=os.path.join(lib.ROOT, "reports", "accuracy_beams.md"))
    a = parser.parse_args()
    pages = {}
    with tempfile.TemporaryDirectory() as folder:
        for kind in ("clean", "rough", "coarse"):
            lines, everything = [], []
            for render, label in ((by_program, "program"), (by_numpy, "numpy")):
                rows = []
                for seed in a.seeds:
                    rows += run(render, a.foils, kind, seed, folder, a.show)
                everything += rows
                lines += summary(label, rows)
            pages[kind] = lib.table(HEADER, lines + summary("both", everything))
    page = TEXT.format(version=lib.program_version(), foils=a.foils, count=COUNT, seeds=", ".join(map(str, a.seeds)),
                       **pages)
    with open(a.o, "w", encoding="utf-8") as file:
        file.write(page)
    print(page)


if __name__ == "__main__":
    main()
