# SPDX-License-Identifier: GPL-3.0-or-later
"""reports/thesis/rotor.md: random shims in table 5.6's bearing (thesis section 5.12), by `foilgauge film`.

    python3 tests/bench/rotor.py build/foilgauge [DRAWS] > reports/thesis/rotor.md
"""
import json
import os
import resource
import subprocess
import sys
import tempfile

BEARING = ["--clearance", "80", "--compliance", "0.67", "--loss-factor", "0.14", "--mesh", "4,6"]
DESIGNS = {"classical": "-50:150", "sinusoidal": "-50:50", "cantilever": "-7:7"}
LOADS, SPEEDS = (2, 5, 10), (30000, 60000, 120000)
PADS = {"three pads of seven": ["--pads", "3", "--bumps", "7"], "a closed ring of 21": ["--pads", "0", "--bumps", "21"]}


def film(program, *options):
    """The report of a run, and the seconds of processors that it took."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "film.json")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([program, "film", *map(str, options), "-o", path], check=False, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        with open(path) as file:
            return json.load(file), seconds


def ratio(value):
    return "stable at every mass" if value is None else f"{value:.3g}"


def share(part):
    return f"{part['count']}"


def draw_row(name, load, speed, report, seconds):
    d = report["draws"]
    q = d["mass_over_perfect"]
    known = d["solved"]["count"] > 0
    quantiles = [ratio(q[k]) if known else "–" for k in ("at_5_pct", "median", "at_95_pct")]
    counts = [share(d[k]) for k in ("solved", "touching", "more_stable", "less_stable")]
    return f"| {name} | {load} | {speed // 1000} | {' | '.join(counts)} | {' | '.join(quantiles)} | {seconds:.0f} |"


HEAD = ("| shims | load, N | speed, 1000 rpm | solved | touching | more stable | less stable | 5 % | median | 95 % | s |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|")


def draw_table(program, pads, loads, speeds, draws, kept):
    print(HEAD)
    for load in loads:
        for speed in speeds:
            for name, shims in DESIGNS.items():
                report, seconds = film(program, *BEARING, *pads, "--load", load, "--speed", speed, "--speeds",
                                       f"{speed}:{speed * 1.01}:2", f"--shims={shims}", "--draws", draws, "--jobs", 1)
                kept[name, load, speed] = report
                print(draw_row(name, load, speed, report, seconds), flush=True)


def perfect_table(kept):
    print("| load, N | speed, 1000 rpm | compressibility number | e / C | thinnest film, um | critical mass, kg | whirl ratio |\n"
          "|---|---|---|---|---|---|---|")
    for (name, load, speed), report in kept.items():
        if name != "classical":
            continue
        p = report["perfect"]
        print(f"| {load} | {speed // 1000} | {p['compressibility_number']:.3f} | {p['eccentricity_ratio']:.3f} | "
              f"{p['min_film_um']:.1f} | {p['critical_mass_kg']:.3g} | {p['whirl_ratio']:.3f} |")


def mesh_table(program):
    print("| cells per bump, over half the length | e / C | critical mass, g |\n|---|---|---|")
    for mesh in ("2,4", "4,6", "6,8", "8,10", "12,16", "16,24"):
        report, _ = film(program, *BEARING[:-2], *PADS["three pads of seven"], "--load", 5, "--speed", 60000, "--speeds",
                         "60000:61000:2", "--mesh", mesh)
        p = report["perfect"]
        print(f"| {mesh} | {p['eccentricity_ratio']:.5f} | {1e3 * p['critical_mass_kg']:.5f} |")


def main():
    program, draws = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    kept, ring = {}, {}
    print(open(os.path.join(os.path.dirname(__file__), "rotor.head.md")).read().replace("DRAWS", str(draws)))
    print("## The mesh\n")
    mesh_table(program)
    print(f"\n## Random shims, three pads of seven, {draws} bearings a row\n")
    draw_table(program, PADS["three pads of seven"], LOADS, SPEEDS, draws, kept)
    print("\nThe bearing without shims:\n")
    perfect_table(kept)
    print(f"\n## The same in a closed ring of 21 shims, {draws} bearings a row\n")
    draw_table(program, PADS["a closed ring of 21"], (5,), SPEEDS, draws, ring)
    print("\nThe ring without shims:\n")
    perfect_table(ring)


main()
