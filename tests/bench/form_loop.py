# SPDX-License-Identifier: GPL-3.0-or-later
"""Closing the loop with a forming as the declared model: writes reports/thesis/form_loop.md and form_loop.csv.

Foils whose creep depends on the bump's number, which `foilgauge forming` lacks, are rendered and scanned; `loop` is given
what `form` predicts with one creep rate for all bumps, once of a lot (--lot) and once of scans. Foils that creep as
declared are the control: nothing may be claimed of them.

Usage: form_loop.py [--seeds N] [--first SEED] [--foils N] [--dpi N]"""
import argparse
import csv
import json
import math
import os
import random
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

import benchlib as lib

MATERIAL = {"schema": "foilgauge/material/1", "creep_rate_per_h": 0.0578, "creep_exponent": 4.61, "creep_energy_kj_per_mol": 130}
HEAT = ("--temperature", "650", "--time", "5")
BUMPS, REACH = 9, 2.0  # the rate near the lip is lower by exp(-slower exp(-(bump - 1) / REACH))
LAWS = (("control", 0.0), ("weak law", 0.9), ("law", 2.0))
SCATTERS = (0.0004, 0.0008, 0.0016)  # of the radius, from bump to bump; a seed has one of them
SCANS = (1, 4)  # of the foils, given to the loop as scans


def save(path, value):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(value, file)
    return path


def form(folder, name, rate):
    out = os.path.join(folder, name)
    material = save(out + ".material", dict(MATERIAL, creep_rate_per_h=rate))
    subprocess.run([lib.FOILGAUGE, "forming", "--material", material, *HEAT, "-o", out], check=True)
    return lib.load(out)["bumps"]


def law_of(folder, slower):
    """Radius and arc length of every bump."""
    rate = MATERIAL["creep_rate_per_h"]
    formed = [form(folder, f"law_{slower}_{b}.json", rate * math.exp(-slower * math.exp(-(b - 1) / REACH)))[b - 1]
              for b in range(1, BUMPS + 1)]
    return [(b["radius_mm"], b["radius_mm"] * b["bump_angle_deg"]) for b in formed]


def render(folder, law, rng, foils, dpi, scatter):
    for k in range(foils):
        radii = [r * (1 + rng.gauss(0, scatter)) for r, _ in law]
        spec = {"schema": "foilgauge/render/1", "seed": rng.randrange(1, 2**31),
                "scanner": {"dpi": dpi, "blur_px": rng.uniform(0.9, 1.8), "noise": rng.uniform(0.5, 2)},
                "foils": [{"overall_radius_mm": 20.9 + rng.gauss(0, 0.03), "rotate_deg": rng.uniform(-180, 180), "radius_mm": radii,
                           "bump_angle_deg": [arc / r for (_, arc), r in zip(law, radii)]}]}
        subprocess.run([lib.FOILGAUGE, "render", save(os.path.join(folder, "spec.json"), spec), "-o",
                        os.path.join(folder, "scans", f"{k + 1:02d}.png")], check=True)


def names(claim):
    """Ids of a claim and of those tied with it: of tables objects, of scans texts."""
    others = [a.get("id") if isinstance(a, dict) else a for a in claim.get("alias_class") or []]
    return [claim["id"], *others]


def result(report, radius):
    found = report["claims"]
    return {"verdict": report["verdict"], "claims": " ".join(c["id"] for c in found),
            "in_class": any("part.lip_decay" in names(c) for c in found), **radius}


def run_loop(*arguments):
    """A suspicion (exit code 3) is a report, too."""
    done = subprocess.run([lib.FOILGAUGE, "loop", *arguments], check=False)
    if done.returncode not in (0, 3):
        raise subprocess.CalledProcessError(done.returncode, done.args)


def loop_lot(folder, declared):
    subprocess.run([lib.FOILGAUGE, "lot", os.path.join(folder, "scans"), "-o", os.path.join(folder, "lot")], check=False)
    out = os.path.join(folder, "lot_loop.json")
    run_loop("--lot", os.path.join(folder, "lot"), "--form-model", declared, "-o", out)
    r = lib.load(out)
    return result(r, {"before": 1000 * r["before"]["rms"], "after": 1000 * r["after"]["rms"],
                      "held_before": 1000 * r["before"]["held_out_rms"], "held_after": 1000 * r["after"]["held_out_rms"]})


def loop_scans(folder, declared, count, aside):
    """Of the first foils; the same number of others only confirms."""
    scans = [os.path.join(folder, "scans", f"{k + 1:02d}.png") for k in range(count + aside)]
    out = os.path.join(folder, "scans_loop.json")
    kept = [word for s in scans[count:] for word in ("--hold-out", s)]
    run_loop(*scans[:count], *kept, "--form-model", declared, "-o", out)
    r = lib.load(out)
    radius = r["bumps"]["responses"][0]
    assert r["bumps"]["declared"]["path"] == declared and radius["level"] is not None
    return result(r, {"before": radius["rms_before"], "after": radius["rms_after"], "held_before": radius["held_out_rms_before"],
                      "held_after": radius["held_out_rms_after"]})


def run_case(job):
    folder, laws, declared, name, seed, options = job
    rng = random.Random(1000 * seed + [n for n, _ in LAWS].index(name))
    scatter = SCATTERS[seed % len(SCATTERS)]
    rows = []
    with tempfile.TemporaryDirectory(dir=folder) as own:
        os.mkdir(os.path.join(own, "scans"))
        render(own, laws[name], rng, options.foils, options.dpi, scatter)
        for what, found in [(f"lot of {options.foils}", loop_lot(own, declared)),
                            *((f"{n} scan{'s' if n > 1 else ''}", loop_scans(own, declared, n, n)) for n in SCANS)]:
            rows.append({"law": name, "data": what, "seed": seed, "scatter_um": 1000 * scatter * 3.34, **found})
    return rows


def mean(rows, key):
    values = [r[key] for r in rows if r[key] is not None]
    return f"{math.sqrt(sum(v * v for v in values) / len(values)):.2f}" if values else "–"


def lines(rows):
    out = []
    for law, _ in LAWS:
        for data in dict.fromkeys(r["data"] for r in rows):
            of = [r for r in rows if r["law"] == law and r["data"] == data]
            found = [r for r in of if r["claims"]] if law != "control" else of
            kept = [r for r in of if r["in_class"]]
            out.append([law, data, len(of), sum(bool(r["claims"]) for r in of), len(kept) if law != "control" else "–",
                        sum(r["verdict"] == "clean" for r in of), mean(found, "before"), mean(found, "after"), mean(found, "held_before"),
                        mean(found, "held_after"), mean(found, "scatter_um")])
    return out


TEXT = """# A forming as the declared model, and a law that it lacks

`/usr/bin/python3 tests/bench/form_loop.py` writes this page and form_loop.csv: {version}, seeds {first} to {last}, {foils} foils of {bumps} bumps
a seed, rendered at {dpi} dpi, turned at random, {scatters} % scatter of the radius from bump to bump.

The material's creep rate near the lip is lower by exp(-s exp(-(bump - 1) / {reach:g})): s = {weak:g} (weak law: {weak_um:.1f} µm of radius at
bump 1), s = {strong:g} (law: {strong_um:.1f} µm) and none (control). Declared is what `foilgauge forming` says with one rate for all bumps. The loop is
closed with `loop --lot DIR --form-model form.json`, and on scans with `loop SCAN... --form-model form.json` beside as many scans that are
kept aside (`--hold-out`).

Claims: cases with any claim, of points or bumps. In class: `part.lip_decay` is claimed, or tied with what is. Errors of the radius about the
declared model, µm rms over the cases with a claim (control: over all); kept aside: of a lot, foils that took no part in the search (the search
repeated without each part in turn); of scans, the others. Scatter: what was put in; below it no error can fall.

{table}
One foil's nine bumps tell little: a law is found on it where it stands far out of the scatter. What is found on few foils is said of these
foils; a claim about all of them takes a lot.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--foils", type=int, default=10)
    parser.add_argument("--dpi", type=int, default=2400)
    parser.add_argument("-o", default=os.path.join(lib.ROOT, "reports", "thesis"))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        formed = form(folder, "declared.json", MATERIAL["creep_rate_per_h"])
        laws = {name: law_of(folder, slower) for name, slower in LAWS}
        jobs = [(folder, laws, os.path.join(folder, "declared.json"), name, seed, options)
                for seed in range(options.first, options.first + options.seeds) for name, _ in LAWS]
        with ThreadPoolExecutor(2) as pool:
            rows = [row for some in pool.map(run_case, jobs) for row in some]
    with open(os.path.join(options.o, "form_loop.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows([{k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows])
    text = TEXT.format(
        version=lib.program_version(), first=options.first, last=options.first + options.seeds - 1, foils=options.foils, bumps=BUMPS, dpi=options.dpi,
        scatters=", ".join(f"{100 * s:g}" for s in SCATTERS), reach=REACH, weak=LAWS[1][1], strong=LAWS[2][1],
        weak_um=1000 * (laws["weak law"][0][0] - formed[0]["radius_mm"]), strong_um=1000 * (laws["law"][0][0] - formed[0]["radius_mm"]),
        table=lib.table(["creep", "data", "cases", "claims", "in class", "clean", "before", "after", "kept aside, before", "after", "scatter"], lines(rows)))
    with open(os.path.join(options.o, "form_loop.md"), "w", encoding="utf-8") as file:
        file.write(text)
    print(text)


if __name__ == "__main__":
    main()
