# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders foils whose bumps depart from the declared springback model, or only scatter about it, runs
`foilgauge loop` on them and counts the claims at the level `bumps`.

Usage: loop_bumps.py PROGRAM [--count N] [--seed S]; writes reports/loop_bumps.md and loop_bumps.csv."""
import argparse
import csv
import json
import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
BUMPS, R_D, ALPHA_D = 9, 3.32, 63.15
SCATTER = 0.01  # of the springback from bump to bump, relative

# name, scans, same foil in all of them, the effect in them, share of cases
TIERS = [
    ("clean, one foil", 1, False, None, 1),
    ("clean, skewed scatter", 1, False, "skewed", 1),
    ("clean, arc length scatters", 1, False, "arc_scatter", 1),
    ("clean, pair of one foil", 2, True, None, 0.4),
    ("clean, three foils", 3, False, None, 0.4),
    ("lip decay, one foil", 1, False, "part.lip_decay", 1),
    ("lip decay, pair of one foil", 2, True, "part.lip_decay", 0.4),
    ("lip decay, three foils", 3, False, "part.lip_decay", 0.4),
    ("stretch, one foil", 1, False, "part.stretch", 0.7),
]


def draw_springback(rng, kind):
    if kind == "skewed":  # as a press makes it: some bumps open far
        return 0.01 + rng.gamma(1.5, SCATTER / np.sqrt(1.5), BUMPS)
    return 0.02 + SCATTER * rng.standard_normal(BUMPS)


def draw_truth(rng, kind):
    truth = {"kind": kind}
    if kind == "part.lip_decay":
        truth.update(amplitude_rel=float(rng.choice([-1, 1]) * rng.uniform(0.02, 0.09)),
                     decay_bumps=float(rng.uniform(1, 4)))
    if kind == "part.stretch":
        truth["arc_length_rel"] = float(rng.choice([-1, 1]) * np.exp(rng.uniform(np.log(0.001), np.log(0.02))))
    return truth


def make_foil(rng, truth, rotation):
    radii = R_D * (1 + draw_springback(rng, truth["kind"]))
    if truth["kind"] == "part.lip_decay":
        # The renderer's form of it; written into the radii so that every scan of a foil has the same ones.
        radii *= 1 + truth["amplitude_rel"] * np.exp(-np.arange(BUMPS) / truth["decay_bumps"])
    foil = {"overall_radius_mm": 20.95, "radius_mm": radii.tolist(), "rotate_deg": rotation}
    if truth["kind"] in ("arc_scatter", "part.stretch"):
        stretch = truth.get("arc_length_rel", 0) + 0.002 * rng.standard_normal(BUMPS)
        foil["bump_angle_deg"] = (ALPHA_D * R_D * (1 + stretch) / radii).tolist()
    return foil


def make_spec(rng, foil):
    return {"schema": "foilgauge/render/1", "seed": int(rng.integers(1, 2**31)), "foils": [foil],
            "scanner": {"dpi": 4800, "background": 30, "contrast": 175, "bits": 8,
                        "blur_px": float(rng.uniform(0.9, 2)), "noise": float(rng.uniform(0.5, 2))}}


def render_all(program, rng, tier, folder, truth):
    _, scans, same, _, _ = tier
    paths, rotation = [], float(rng.uniform(-180, 180))
    foil = make_foil(rng, truth, rotation)
    for k in range(scans):
        if k and same:
            foil = {**foil, "rotate_deg": rotation + 90}
        elif k:
            foil = make_foil(rng, truth, float(rng.uniform(-180, 180)))
        base = os.path.join(folder, f"s{k}")
        with open(base + ".json", "w") as f:
            json.dump(make_spec(rng, foil), f)
        subprocess.run([program, "render", base + ".json", "-o", base + ".png"], check=True)
        paths.append(base + ".png")
    return paths


def run_case(job):
    program, number, index, seed = job
    tier = TIERS[number]
    rng = np.random.default_rng([seed, number, index])
    truth = draw_truth(rng, tier[3])
    with tempfile.TemporaryDirectory() as folder:
        paths = render_all(program, rng, tier, folder, truth)
        out = os.path.join(folder, "loop.json")
        subprocess.run([program, "loop", *(["--same-foil"] if tier[2] else []), *paths, "-o", out], check=True)
        with open(out) as f:
            report = json.load(f)
    claims = [c for c in report["claims"] if c["level"] == "bumps"]
    first = claims[0] if claims else {"id": "", "parameters": {}, "uncertainty": {}}
    wanted = tier[3] if tier[3] and tier[3].startswith("part.") else None
    row = {"tier": tier[0], "index": index, "effect": wanted or "", "verdict": report["verdict"],
           "claims": " ".join(c["id"] for c in claims), "point_claims": len(report["claims"]) - len(claims),
           "in_class": any(wanted in [c["id"], *c.get("alias_class", [])] for c in claims),
           "size": abs(truth.get("amplitude_rel", truth.get("arc_length_rel", 0))),
           "deviation_in_u": "", "rms_before": "", "rms_after": ""}
    name = "arc_length_rel" if wanted == "part.stretch" else "amplitude_rel"
    if first["id"] == wanted and name in first["parameters"]:
        row["deviation_in_u"] = (first["parameters"][name] - truth[name]) / first["uncertainty"][name]
    response = report["bumps"]["responses"][1 if wanted == "part.stretch" else 0]
    row["rms_before"], row["rms_after"] = response["rms_before"], response["rms_after"]
    return row


def percent(values):
    values = list(values)
    return f"{100 * np.mean(values):.1f}" if values else "-"


def tier_line(name, rows):
    found = [r for r in rows if r["claims"]]
    ratios = [r["rms_before"] / r["rms_after"] for r in found]
    held = [abs(r["deviation_in_u"]) < 2 for r in rows if r["deviation_in_u"] != ""]
    wanted = rows[0]["effect"]
    return (f"| {name} | {len(rows)} | {percent(bool(r['claims']) for r in rows)} | "
            f"{percent(r['in_class'] for r in rows) if wanted else '-'} | "
            f"{percent(r['point_claims'] > 0 for r in rows)} | {percent(held)} | "
            f"{f'{np.median(ratios):.1f}' if ratios else '-'} |")


def size_lines(rows, wanted, edges):
    lines = []
    for low, high in zip(edges, edges[1:]):
        part = [r for r in rows if r["effect"] == wanted and low <= r["size"] < high]
        if part:
            lines.append(f"| {wanted} | {100 * low:g} to {100 * high:g} % | {len(part)} | "
                         f"{percent(r['in_class'] for r in part)} |")
    return lines


def write_report(rows, options):
    with open(os.path.join(ROOT, "reports", "loop_bumps.csv"), "w", newline="") as f:
        writer = csv.DictWriter(f, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    lines = ["# The loop on the bumps of rendered scans", "",
             f"Made by `python3 tests/bench/loop_bumps.py build/foilgauge --count {options.count} --seed "
             f"{options.seed}`.", "",
             f"Foils of {BUMPS} bumps. The springback scatters by {100 * SCATTER:g} % ({1000 * SCATTER * R_D:.0f} um of R) "
             "from bump to bump,",
             "which is no effect. Lip decay: 2 to 9 % of R at bump 1, either sign, fading over 1 to 4 bumps. Stretch: arc",
             "lengths off by 0.1 to 2 % beside a scatter of 0.2 % (the same in `arc length scatters`).",
             "Claims: cases with a claim at the level `bumps`. In class: it is what is there, or tied with it.",
             "Interval: the truth lies within 2 u of what was found. Reduced: median of the rms about the model, before over",
             "after; what is left is the scatter.", "",
             "| what | cases | claims % | in class % | claims on points % | interval holds % | reduced × |",
             "|---|---|---|---|---|---|---|"]
    for name, *_ in TIERS:
        part = [r for r in rows if r["tier"] == name]
        lines.append(tier_line(name, part))
    clean = [r for r in rows if not r["effect"]]
    lines.append(tier_line("all clean ones", clean))
    lines += ["", "| effect | size | cases | in class % |", "|---|---|---|---|"]
    lines += size_lines(rows, "part.lip_decay", [0.02, 0.04, 0.06, 0.075, 0.09])
    lines += size_lines(rows, "part.stretch", [0.001, 0.002, 0.004, 0.01, 0.02])
    with open(os.path.join(ROOT, "reports", "loop_bumps.md"), "w") as f:
        f.write("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    jobs = [(program, t, k, options.seed) for t, tier in enumerate(TIERS)
            for k in range(round(tier[4] * options.count))]
    with ThreadPoolExecutor(2) as pool:
        rows = list(pool.map(run_case, jobs))
    write_report(rows, options)
    print("wrote reports/loop_bumps.md and loop_bumps.csv")


if __name__ == "__main__":
    main()
