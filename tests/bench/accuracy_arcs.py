# SPDX-License-Identifier: GPL-3.0-or-later
"""Accuracy on plain strips (form "arc") with known truth: writes reports/accuracy_arcs.md.

Strips are rendered by `foilgauge render` in every rotation, light and dark, 8 and 16 bit, clean and
with edges as real scanners make them; on the datums inner and outer, too."""

import argparse
import json
import os
import subprocess
import tempfile

import numpy as np

import benchlib as lib

ROUGH = {"one_sided_blur_px": 1.8, "edge_roughness_um": 1.4, "edge_common_um": 0.7, "correlation_um": 50,
         "halo": {"fraction": 0.15, "length_px": 15}}
DESIGN = {"form": "arc", "overall_radius_mm": 20.73, "subtended_angle_deg": 60.0, "thickness_mm": 0.1}
DATUMS = {"mid": 0.0, "inner": -0.05, "outer": 0.05}


def draw(rng, index, rough):
    dark = index % 2 == 1
    scanner = {
        "dpi": 4800,
        "bits": 16 if index % 4 >= 2 else 8,
        "background": float(rng.uniform(200, 225) if dark else rng.uniform(25, 45)),
        "contrast": float(rng.uniform(-170, -140) if dark else rng.uniform(150, 180)),
        "gamma": [1.0, 1.0, 1.8][index % 3],
        "blur_px": float(rng.uniform(1.5, 2.2) if rough else rng.uniform(0.9, 2.2)),
        "noise": float(rng.uniform(1.0, 3.0)),
    }
    if rough:
        scanner["noise_correlation"] = 0.6
        scanner["rough"] = ROUGH
    foil = {"design": DESIGN, "overall_radius_mm": float(rng.uniform(20.5, 21.5)),
            "subtended_angle_deg": float(rng.uniform(30, 60)), "rotate_deg": float(rng.uniform(0, 360))}
    return {"schema": "foilgauge/render/1", "seed": int(rng.integers(1, 2**31)), "foils": [foil],
            "scanner": scanner}


def measure(spec, datum, folder):
    paths = [os.path.join(folder, name) for name in ("spec.json", "scan.png", "truth.json", "out.json", "d.json")]
    shift = DATUMS[datum]
    design = {"schema": "foilgauge/design/1", **DESIGN, "datum": datum}
    for path, content in ((paths[0], spec), (paths[4], design)):
        with open(path, "w", encoding="utf-8") as file:
            json.dump(content, file)
    subprocess.run([lib.FOILGAUGE, "render", paths[0], "-o", paths[1], "--truth", paths[2]], check=True)
    subprocess.run([lib.FOILGAUGE, "measure", "--design", paths[4], paths[1], "-o", paths[3]], check=True)
    truth, foils = lib.load(paths[2]), lib.load(paths[3])["foils"]
    if len(foils) != 1 or foils[0]["arc"]["subtended_angle_deg"] is None:
        return None
    foil, radius = foils[0], truth["overall_radius_mm"] + shift
    angle = truth["subtended_angle_deg"]
    return [
        ((foil["overall"]["radius_mm"] - radius) * 1e3, foil["overall"]["u_radius_mm"] * 1e3),
        (foil["arc"]["subtended_angle_deg"] - angle, foil["arc"]["u_subtended_angle_deg"]),
        ((foil["arc"]["length_mm"] - radius * np.radians(angle)) * 1e3, foil["arc"]["u_length_mm"] * 1e3),
    ]


NAMES = ["R0, µm", "subtended angle, °", "length, µm"]
HEADER = ["strips", "quantity", "renders", "not found", "bias", "± (standard error)", "rms", "mean u", "in 95 %"]


def summary(label, rows):
    found, table = np.array([row for row in rows if row]), []
    for k, name in enumerate(NAMES):
        e, u = found[:, k, 0], found[:, k, 1]
        table.append([label if k == 0 else "", name, len(rows), len(rows) - len(found), lib.number(np.mean(e), 2),
                      lib.number(np.std(e) / np.sqrt(len(e)), 2), lib.number(lib.rms(e)), lib.number(np.mean(u)),
                      f"{100 * np.mean(abs(e) < 1.96 * u):.1f} %"])
    return table


TEXT = """# Accuracy on plain strips (form "arc")

`tests/bench/accuracy_arcs.sh` writes this page. {version}; 4800 dpi, radius 20.5 to 21.5 mm, 30 to
60 degrees, any rotation, light and dark in turn, 8 and 16 bit, gamma 1 and 1.8, contrast 140 to 180,
noise sd 1 to 3 of 255; seeded. The datum is the midline, the inner and the outer edge in turn; truth is of
that line. Clean: blur 0.9 to 2.2 px. Rough, as of samples/render/rough.json: blur 1.5 to 2.2 px, one-sided
blur 1.8 px, roughness 1.4 µm of each edge and of the cuts (0.7 µm of it common to both edges) over 50 µm,
halo of 15 % over 15 px, noise correlated by 0.6.

An angle of 0.001° is 0.36 µm along the strip. u of the angle is that of both cuts for the most part: their
pixels, their roughness (taken as that of the edges), and the tone curve, which moves both cuts outwards or
inwards as it does the edges of the thickness.

{table}"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--renders", type=int, default=120, help="clean, and as many rough")
    parser.add_argument("--seed", type=int, default=21)
    parser.add_argument("-o", default=os.path.join(lib.ROOT, "reports", "accuracy_arcs.md"))
    arguments = parser.parse_args()
    table = []
    with tempfile.TemporaryDirectory() as folder:
        for label, rough in (("clean", False), ("rough", True)):
            rng = np.random.default_rng(arguments.seed + rough)
            rows = {datum: [] for datum in DATUMS}
            for index in range(arguments.renders):
                datum = list(DATUMS)[index // 3 % 3]
                rows[datum].append(measure(draw(rng, index, rough), datum, folder))
            table += summary(label, sum(rows.values(), []))
            for datum in DATUMS:
                table += summary(f"{label}, datum {datum}", rows[datum])
    page = TEXT.format(version=lib.program_version(), table=lib.table(HEADER, table))
    with open(arguments.o, "w", encoding="utf-8") as file:
        file.write(page)
    print(page)


if __name__ == "__main__":
    main()
