"""Renders foils with known effects of scanner and part, runs `foilgauge loop` on them and counts what was
named, from one scan and from turned pairs, and how much of the error of R, h and R0 is taken out.

Usage: loop_scans.py PROGRAM [--count N] [--seed S]; writes reports/loop_scans.md and loop_scans.csv."""
import argparse
import csv
import json
import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def draw_effect(rng):
    """One effect of 3 to 30 um at the foil's ends, as the renderer takes it."""
    size = float(np.exp(rng.uniform(np.log(3), np.log(30)))) * rng.choice([-1, 1])
    kind = rng.choice(["scan.scale_y", "scan.shear", "scan.carriage_ripple", "scan.optical_quadratic",
                       "scan.optical_cubic", "scan.carriage_quadratic", "part.ovality", "part.spiral"])
    effect = {"id": str(kind)}
    if kind in ("scan.scale_y", "scan.shear"):
        effect["value"] = size / 18000
    elif kind == "scan.carriage_ripple":
        effect.update(amplitude_um=abs(size), period_mm=float(rng.uniform(0.8, 6)),
                      phase_deg=float(rng.uniform(-180, 180)))
    elif kind == "part.ovality":
        effect.update(amplitude_um=abs(size), phase_deg=float(rng.uniform(-90, 90)))
    else:
        effect["amplitude_um"] = size
    return effect


def make_spec(rng, radii, rotation, effects, pair):
    # A scanner's fields are centred on its glass: both pictures of a pair show the same piece of it.
    size = {"width_px": 8200, "height_px": 8200} if pair else {}
    return {"schema": "foilgauge/render/1", "seed": int(rng.integers(1, 2**31)), **size,
            "foils": [{"overall_radius_mm": 20.95, "radius_mm": radii, "rotate_deg": rotation}],
            "scanner": {"dpi": 4800, "background": 30, "contrast": 175, "bits": 8,
                        "blur_px": float(rng.uniform(0.9, 2)), "noise": float(rng.uniform(0.5, 2))},
            "effects": effects}


def error_of(foil, truth):
    if any(b["radius_mm"] is None for b in foil["bumps"]) or not foil["bumps"]:
        return 1e3, 1e3, 1e3  # nothing was measured: as bad as a millimetre
    r = [b["radius_mm"] - t["radius_mm"] for b, t in zip(foil["bumps"], truth["bumps"])]
    h = [b["height_mm"] - t["height_mm"] for b, t in zip(foil["bumps"], truth["bumps"])]
    rms = lambda v: float(np.sqrt(np.mean(np.square(v)))) * 1000
    return rms(r), rms(h), abs(foil["overall"]["radius_mm"] - truth["overall_radius_mm"]) * 1000


def run_case(job):
    program, tier, index, seed = job
    rng = np.random.default_rng([seed, {"clean": 0, "single": 1, "pair": 2}[tier], index])
    radii = [float(v) for v in 3.38 + 0.03 * rng.standard_normal(9)]
    effects = [] if tier == "clean" else [draw_effect(rng)]
    rotation = float(rng.uniform(-180, 180))
    turns = [0, 90 if index % 2 else 45] if tier == "pair" else [0]
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for k, turn in enumerate(turns):
            base = os.path.join(folder, f"s{k}")
            with open(base + ".json", "w") as f:
                json.dump(make_spec(rng, radii, rotation + turn, effects, tier == "pair"), f)
            subprocess.run([program, "render", base + ".json", "-o", base + ".png", "--truth",
                            base + ".truth.json"], check=True)
            paths.append(base + ".png")
        out = os.path.join(folder, "loop.json")
        options = ["--same-foil"] if tier == "pair" else []
        subprocess.run([program, "loop", *options, *paths, "-o", out], check=True)
        with open(out) as f:
            report = json.load(f)
        with open(os.path.join(folder, "s0.truth.json")) as f:
            truth = json.load(f)
    names = [c["id"] for c in report["claims"]]
    classes = [a for c in report["claims"] for a in c.get("alias_class", [])] + names
    wanted = effects[0]["id"] if effects else None
    before = error_of(report["before"]["foils"][0], truth)
    after = error_of(report["after"]["foils"][0], truth)
    inside = []
    for b, t in zip(report["after"]["foils"][0]["bumps"], truth["bumps"]):
        if "radius_range_mm" in b:
            low, high = b["radius_range_mm"]
            inside.append(low <= t["radius_mm"] <= high)
    return {"tier": tier, "index": index, "effect": wanted or "", "verdict": report["verdict"],
            "claims": " ".join(names), "named": names == [wanted] if wanted else not names,
            "in_class": any(wanted in a.split(" + ") for a in classes) if wanted else not names,
            "unattributed": bool(report["unattributed"]),
            "R_before_um": before[0], "R_after_um": after[0], "h_before_um": before[1],
            "h_after_um": after[1], "R0_before_um": before[2], "R0_after_um": after[2],
            "range_holds": float(np.mean(inside)) if inside else ""}


def table_row(name, rows):
    share = lambda key: 100 * np.mean([bool(r[key]) for r in rows])
    reduced = [r for r in rows if r["effect"].startswith("scan.")]
    ratio = lambda a, b: np.median([r[a] / max(r[b], 1e-4) for r in reduced]) if reduced else float("nan")
    claims = 100 * np.mean([r["verdict"] != "clean" for r in rows])
    return (f"| {name} | {len(rows)} | {claims:.1f} | {share('named'):.1f} | {share('in_class'):.1f} | "
            f"{ratio('R_before_um', 'R_after_um'):.0f} | {ratio('h_before_um', 'h_after_um'):.0f} | "
            f"{ratio('R0_before_um', 'R0_after_um'):.0f} |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    jobs = [(program, tier, k, options.seed) for tier in ("clean", "single", "pair")
            for k in range(options.count)]
    with ThreadPoolExecutor(2) as pool:
        rows = list(pool.map(run_case, jobs))
    with open(os.path.join(ROOT, "reports", "loop_scans.csv"), "w", newline="") as f:
        writer = csv.DictWriter(f, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    lines = ["# The loop on rendered scans", "",
             f"Made by `python3 tests/bench/loop_scans.py build/foilgauge --count {options.count} "
             f"--seed {options.seed}`.", "",
             "One Gen II foil of nine bumps per case; one effect of 3 to 30 um at the ends of the foil; pairs are the",
             "same foil turned by 90 or 45 degrees. Named: the only claim is the effect that is there. In class: it is",
             "among the claims and the explanations they are tied with. Reduced: median of the error before over the",
             "error after, effects of the scanner only (a part that is oval has no one truth for its circles).", "",
             "| what | cases | claims % | named % | in class % | R reduced × | h reduced × | R0 reduced × |",
             "|---|---|---|---|---|---|---|---|"]
    for tier in ("clean", "single", "pair"):
        lines.append(table_row(tier, [r for r in rows if r["tier"] == tier]))
    for tier in ("single", "pair"):
        for effect in sorted({r["effect"] for r in rows if r["tier"] == tier}):
            lines.append(table_row(f"{tier}, {effect}",
                                   [r for r in rows if r["tier"] == tier and r["effect"] == effect]))
    held = [r["range_holds"] for r in rows if r["range_holds"] != "" and r["effect"].startswith("scan.")]
    if held:
        lines += ["", f"Where a tie was reported ({len(held)} scans with an effect of the scanner), the range of R "
                      f"held the truth for {100 * np.mean(held):.1f} % of the bumps."]
    with open(os.path.join(ROOT, "reports", "loop_scans.md"), "w") as f:
        f.write("\n".join(lines) + "\n")
    print("wrote reports/loop_scans.md and loop_scans.csv")


if __name__ == "__main__":
    main()
