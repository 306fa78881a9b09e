#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""accuracy_wall.py PROGRAM [--seed N] [--scans N] [--out PAGE] [--keep FOLDER]: radii of bumps whose side wall shows beside an
edge, as a scanner's lens sees it, by foilgauge and by both peers: walls of any strength, width, side and tone curve, on clean and
rough edges, bright and dark foils."""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile

import benchlib

HERE = os.path.dirname(os.path.abspath(__file__))
PEERS = {"scikit-image + SciPy": "peer_skimage.py", "OpenCV + SciPy": "peer_opencv.py"}
ROUGH = {"one_sided_blur_px": 1.8, "edge_roughness_um": 1.4, "edge_common_um": 0.7, "correlation_um": 50,
         "halo": {"fraction": 0.15, "length_px": 15}}  # fmt: skip
GROUPS = {
    "all": lambda s: True,
    "rough edges": lambda s: s["rough"],
    "clean edges": lambda s: not s["rough"],
    "bright foil": lambda s: s["bright"],
    "dark foil": lambda s: not s["bright"],
    "wall up to a third": lambda s: s["wall"]["amplitude"] <= 1 / 3,
    "wall above a third": lambda s: s["wall"]["amplitude"] > 1 / 3,
}


def draw(rng, number):
    """Facts of one scan, and its spec."""
    wall = {"amplitude": round(rng.uniform(0.1, 0.6), 3), "direction_deg": round(rng.uniform(0, 360), 1),
            "length_px": round(rng.uniform(3, 15), 2), "gap_px": round(rng.uniform(0, 3), 2)}  # fmt: skip
    bright, rough = number % 2 == 0, number // 2 % 2 == 0
    rough_spec = {**(ROUGH if rough else {}), "side_wall": wall}
    scanner = {"dpi": 4800, "bits": 8, "background": 30 if bright else 205, "contrast": 175 if bright else -165,
               "blur_px": round(rng.uniform(1.5, 2.3), 2), "noise": 1.6, "gamma": round(rng.uniform(0.8, 2.2), 2),
               "noise_correlation": 0.6 if rough else 0, "rough": rough_spec}  # fmt: skip
    design = {"bump_radius_mm": 3.32, "bump_angle_deg": 63.15, "bump_count": 9, "overall_radius_mm": 20.73,
              "fillet_radius_mm": 0.35, "thickness_mm": 0.1}  # fmt: skip
    foil = {"design": design, "overall_radius_mm": round(rng.uniform(20.6, 21), 3),
            "rotate_deg": round(rng.uniform(0, 360), 1),
            "radius_mm": [round(rng.gauss(3.38, 0.03), 5) for _ in range(9)]}  # fmt: skip
    spec = {"schema": "foilgauge/render/1", "seed": rng.randrange(1, 10**6), "foils": [foil], "scanner": scanner}
    return {"number": number, "wall": wall, "bright": bright, "rough": rough, "gamma": scanner["gamma"]}, spec


def run_json(command, path=None):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        foils = benchlib.load(path)["foils"] if path else json.loads(done.stdout)["foils"]
        return foils[0] if len(foils) == 1 else None
    except (OSError, ValueError, KeyError):
        return None


def bump_errors(foil, truth):
    """(error, u or None) of each bump's radius, um; None where the foil has another number of bumps."""
    if not foil or len(foil["bumps"]) != len(truth["bumps"]):
        return None
    return [(1000 * (bump["radius_mm"] - true["radius_mm"]), 1000 * bump.get("u_radius_mm", math.nan))
            for bump, true in zip(foil["bumps"], truth["bumps"])]  # fmt: skip


def measure(program, facts, spec, folder, peers):
    base = os.path.join(folder, f"wall{facts['number']}")
    if not os.path.exists(base + ".png"):
        with open(base + ".json", "w", encoding="utf-8") as out:
            json.dump(spec, out)
        subprocess.run([program, "render", base + ".json", "-o", base + ".png", "-t", base + ".truth.json"], check=True)
    truth = benchlib.load_truth(base + ".truth.json")
    design, report = base + ".design.json", base + ".out.json"
    benchlib.write_design(truth, design)
    if os.path.exists(report):
        os.remove(report)
    found = {"foilgauge": run_json([program, "measure", base + ".png", "--design", design, "-o", report], report)}
    for name in peers:
        script = os.path.join(HERE, PEERS[name])
        kept = f"{base}.{PEERS[name]}.json"
        if not os.path.exists(kept):
            with open(kept, "w", encoding="utf-8") as out:
                subprocess.run(["/usr/bin/python3", script, base + ".png", "--design", design], stdout=out, check=False,
                               stderr=subprocess.DEVNULL)  # fmt: skip
        found[name] = run_json(["true"], kept)
    facts["errors"] = {name: bump_errors(foil, truth) for name, foil in found.items()}
    return facts


def rms(errors):
    return math.sqrt(sum(e * e for e, _ in errors) / len(errors)) if errors else math.nan


def pooled(scans, name):
    return [pair for scan in scans for pair in scan["errors"].get(name) or []]


def summary_rows(scans, names):
    for group, belongs in GROUPS.items():
        chosen = [scan for scan in scans if belongs(scan)]
        own = pooled(chosen, "foilgauge")
        held = 100 * sum(abs(e) <= 2 * u for e, u in own) / len(own) if own else math.nan
        yield [group, str(len(chosen)), f"{held:.1f} %"] + [
            f"{rms(pooled(chosen, name)):.2f} ({max((abs(e) for e, _ in pooled(chosen, name)), default=math.nan):.1f})"
            for name in names]  # fmt: skip


def scan_rows(scans, names):
    for scan in scans:
        wall = scan["wall"]
        own = scan["errors"]["foilgauge"] or []
        within = sum(abs(e) <= 2 * u for e, u in own)
        cells = [f"{rms(scan['errors'][name]):.2f}" if scan["errors"].get(name) else "not measured" for name in names]
        yield [str(scan["number"]), "bright" if scan["bright"] else "dark", "rough" if scan["rough"] else "clean",
               f"{wall['amplitude']:.2f}", f"{wall['length_px']:.1f}", f"{wall['gap_px']:.1f}", f"{scan['gamma']:.2f}",
               f"{within} of {len(own)}"] + cells  # fmt: skip


def write_page(path, scans, names, command):
    own = [pair for scan in scans if scan["errors"]["foilgauge"] for pair in scan["errors"]["foilgauge"]]
    both = [scan for scan in scans if all(scan["errors"].get(name) for name in names)]
    held = 100 * sum(abs(e) <= 2 * u for e, u in own) / len(own)
    best = min((rms(pooled(both, name)) for name in names if name != "foilgauge"), default=math.nan)
    with open(path, "w", encoding="utf-8") as out:
        out.write(
            "# Radii beside a side wall\n\n"
            f"Made by `{command}` with {benchlib.program_version()}.\n"
            "Foils of nine bumps at 4800 dpi whose wall shows beside the edges that face one direction: its light is 0.1 to 0.6\n"
            "of the contrast, fades over 3 to 15 px and begins 0 to 3 px from the edge; tone curves of gamma 0.8 to 2.2; every\n"
            "second foil is dark on a light ground, every second pair of scans has rough edges, a halo and a blur of one side.\n"
            "Errors of R, µm, rms (largest), of all bumps; beside foilgauge stand two peers that take the half of the levels.\n\n"
            f"- foilgauge: {held:.1f} % of {len(own)} radii within 2u\n"
            f"- scans that all measured: {len(both)} of {len(scans)}; R there: foilgauge {rms(pooled(both, 'foilgauge')):.2f} µm rms, "
            f"{rms(pooled(both, 'foilgauge')) / best:.2f} × the better peer's\n\n"
        )
        out.write(benchlib.table(["scans", "number", "within 2u"] + names, summary_rows(scans, names)))
        out.write("\n## Every scan\n\nThe wall's strength, width and gap (px); R µm rms.\n\n")
        header = ["scan", "foil", "edges", "strength", "width", "gap", "gamma", "within 2u"] + names
        out.write(benchlib.table(header, scan_rows(scans, names)))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scans", type=int, default=32)
    parser.add_argument("--out", default=os.path.join(benchlib.ROOT, "reports", "accuracy_wall.md"))
    parser.add_argument("--keep", help="folder that keeps scans and the peers' answers")
    parser.add_argument("--no-peers", action="store_true")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    peers = [] if options.no_peers else list(PEERS)
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or temporary
        os.makedirs(folder, exist_ok=True)
        scans = [measure(options.program, *draw(rng, number), folder, peers) for number in range(options.scans)]
    command = f"/usr/bin/python3 tests/bench/accuracy_wall.py build/foilgauge --seed {options.seed} --scans {options.scans}"
    write_page(options.out, scans, ["foilgauge"] + peers, command)
    print(open(options.out, encoding="utf-8").read() if options.keep else f"wrote {options.out}")


if __name__ == "__main__":
    sys.exit(main())
