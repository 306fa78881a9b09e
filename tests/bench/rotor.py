# SPDX-License-Identifier: GPL-3.0-or-later
"""Random shims in table 5.6's bearing (thesis section 5.12), by `foilgauge film`: writes reports/thesis/rotor.md to
standard output.

    python3 tests/bench/rotor.py build/foilgauge [DRAWS] > reports/thesis/rotor.md
"""
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
import time

BEARING = ["--clearance", "80", "--compliance", "0.67", "--loss-factor", "0.14", "--mesh", "6,8"]
DESIGNS = {"classical": "-50:150", "sinusoidal": "-50:50", "cantilever": "-7:7"}
WORDS = """
# Random shims, and the rotor (section 5.12)

`python3 tests/bench/rotor.py build/foilgauge > reports/thesis/rotor.md` writes this page. The bearing of table 5.6: D 40 mm, L/D 1, C 80 um, compliance 0.67,
loss factor 0.14, air at 101.325 kPa; three pads of seven bumps, 17.14 degrees apart, the load towards 270 degrees. Under every bump a shim of random height,
of equal probability within the thesis's limits: classical -50 to +150 % of the clearance, sinusoidal -50 to +50 %, cantilever -7 to +7 %; a higher shim closes
the clearance. Seed 1. Critical masses at 5, 50 and 95 % of the bearings, over the perfect bearing's ("no mass": unstable at every one; "every mass": stable at every one); `s`: seconds of one processor.

The thesis has 311 (classical), 552 (sinusoidal) and 979 (cantilever) of 1000 solved, nearly all of them more stable than the perfect bearing, and a threshold of
the cantilever's that hardly changed. It does not print load, speeds, the shape between shims, the sign of a shim's height, the law of the heights, or when a
bearing counts as converged: **its counts cannot be held against these**, its order and its sentences can.

- The order is the thesis's under every load and speed: fewest classical bearings have a film (8 to 17 %), most sinusoidal ones (72 to 99 %), nearly every cantilever
  one (96 % or more).
- **That nearly all of them are more stable than the perfect bearing is not found.** Under light loads 70 to 93 % of the classical ones that have a film are, 60 to
  70 % of the sinusoidal ones and 52 to 55 % of the cantilever ones. Most others are unstable at every mass (of cantilever ones 12 to 45 %): where the damping of their
  film vanishes, its stiffness is below 0, so that no rotor is light enough; and films that every rotor falls off count to them, where no other one is found.
- Of the classical ones with a film 25 to 76 % are stable at every mass under light loads.
- **That the cantilever's threshold hardly changes is found in the median alone,** which is 1.1 to 2.3 times that of the perfect bearing under light loads, 1.05 to 1.1 times
  at 20 and 40 N. But 3 to 45 % of these bearings are unstable at every mass, and 5 % have a critical mass above 3.8 to 29 times the perfect one's, or are stable at every one:
  under a light load a round bearing whirls near one half of the speed at almost no mass, and what is not round changes that at once, to both sides.
- The critical mass of the perfect bearing is below 14 grams, so that a rotor of the load's own weight is unstable on it; but for 15 N at 30,000 rpm: there it has two films, and on the
  one towards the load it is stable at every mass, so that drawn bearings have no mass to be held against.
- Bearings without a film are those whose rotor meets a bump, or the edge of a pad, which does not yield in the model, before the film carries it.
- A film in time has the threshold of the frequency domain within 0.1 %. The mesh of the random shims (6,8) is 1.1 % from the finest for the critical mass.
- A thousand bearings take 11 to 26 s on two cores.
"""

CONDITIONS = [(load, speed) for load in (2, 5, 10) for speed in (30000, 60000, 120000)]
HEAVY = [(15, 30000), (20, 60000), (40, 120000)]
TIMED = 1000
PADS = ["--pads", "3", "--bumps", "7"]


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


def mass(value):
    return "every mass" if value is None else f"{value:.3g}" if value else "no mass"


def count_masses(path):
    """Of drawn bearings with a film: those that are stable at every mass, and at none."""
    with open(path) as file:
        films = [row for row in csv.DictReader(file) if row["outcome"] != "unsolved"]
    masses = [row["critical_mass_kg"] for row in films]
    return masses.count(""), masses.count("0")


def share(part):
    return f"{part['count']}"


def draw_row(name, load, speed, report, masses, seconds):
    d = report["draws"]
    q = d["mass_over_perfect"]
    known = d["solved"]["count"] > 0 and report["perfect"]["critical_mass_kg"]
    quantiles = [mass(q[k]) if known else "–" for k in ("at_5_pct", "median", "at_95_pct")]
    counts = [share(d[k]) for k in ("solved", "touching", "more_stable", "less_stable")] + [str(count) for count in masses]
    return f"| {name} | {load} | {speed // 1000} | {' | '.join(counts)} | {' | '.join(quantiles)} | {seconds:.0f} |"


HEAD = ("| shims | load, N | speed, 1000 rpm | solved | touching | more stable | less stable | stable at every mass | at no mass | 5 % | median | 95 % | s |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|")


def draw_table(program, draws, conditions, kept):
    print(HEAD)
    slowest = 0
    for load, speed in conditions:
        for name, shims in DESIGNS.items():
            with tempfile.NamedTemporaryFile() as drawn:
                report, seconds = film(program, *BEARING, *PADS, "--load", load, "--speed", speed, "--speeds",
                                       f"{speed}:{speed * 1.01}:2", f"--shims={shims}", "--draws", draws,
                                       "--draws-out", drawn.name)
                masses = count_masses(drawn.name)
            kept[name, load, speed] = report
            print(draw_row(name, load, speed, report, masses, seconds), flush=True)
            slowest = max(slowest, seconds)
    print(f"\nThe slowest row took {slowest:.0f} s of one processor.")


def time_table(program, draws):
    """Wall time on all cores of a run of every design at 10 N and 30,000 rpm, among the slowest rows."""
    print("| shims | load, N | speed, 1000 rpm | wall, s | processors, s | load of the machine before |\n|---|---|---|---|---|---|")
    for load, speed in ((10, 30000),):
        for name, shims in DESIGNS.items():
            busy, start = os.getloadavg()[0], time.monotonic()
            _, seconds = film(program, *BEARING, *PADS, "--load", load, "--speed", speed, "--speeds", f"{speed}:{speed * 1.01}:2",
                              f"--shims={shims}", "--draws", draws)
            print(f"| {name} | {load} | {speed // 1000} | {time.monotonic() - start:.1f} | {seconds:.1f} | {busy:.1f} |", flush=True)


def number(value):
    return "–" if value is None else f"{value:.3f}"


def word(report):
    """The film that the page of the bearing names beside its own."""
    other = report.get("other_film")
    return f"{other['eccentricity_ratio']:.3f}, {mass(other['critical_mass_kg'])}" if other else "–"


def perfect_table(kept):
    print("| load, N | speed, 1000 rpm | compressibility number | e / C | thinnest film, um | critical mass, kg | whirl ratio | another film: e / C, critical mass |\n"
          "|---|---|---|---|---|---|---|---|")
    for (name, load, speed), report in kept.items():
        if name != "classical":
            continue
        p = report["perfect"]
        print(f"| {load} | {speed // 1000} | {p['compressibility_number']:.3f} | {p['eccentricity_ratio']:.3f} | "
              f"{p['min_film_um']:.1f} | {mass(p['critical_mass_kg'])} | {number(p['whirl_ratio'])} | {word(report)} |")


def mesh_table(program):
    print("| cells per bump, over half the length | e / C | critical mass, g |\n|---|---|---|")
    for mesh in ("2,4", "4,6", "6,8", "8,10", "12,16", "16,24"):
        report, _ = film(program, *BEARING[:-2], *PADS, "--load", 5, "--speed", 60000, "--speeds",
                         "60000:61000:2", "--mesh", mesh)
        p = report["perfect"]
        print(f"| {mesh} | {p['eccentricity_ratio']:.5f} | {1e3 * p['critical_mass_kg']:.5f} |")


def orbit_table(program):
    """Growth of the orbit in time of rotors beside the critical mass, and where it is zero."""
    print("| load, N | speed, 1000 rpm | critical mass, g | growth a turn at 0.97 | at 1.03 | critical mass in time, g | differs by |\n"
          "|---|---|---|---|---|---|---|")
    for load, speed in ((5, 60000), (10, 30000), (10, 60000)):
        common = [*BEARING[:-1], "2,4", *PADS, "--load", load, "--speed", speed, "--speeds", f"{speed}:{speed * 1.01}:2"]
        mass = film(program, *common)[0]["perfect"]["critical_mass_kg"]
        growth = [film(program, *common, "--mass", mass * share, "--orbit", 60)[0]["orbit"]["growth_per_turn"]
                  for share in (0.97, 1.03)]
        zero = 0.97 - 0.06 * growth[0] / (growth[1] - growth[0])
        print(f"| {load} | {speed // 1000} | {1e3 * mass:.5g} | {growth[0]:.5f} | {growth[1]:.5f} | {1e3 * mass * zero:.5g} | "
              f"{100 * (zero - 1):+.2f} % |", flush=True)


def main():
    program, draws = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    kept = {}
    print(WORDS.strip())
    print("\n## The mesh\n\n5 N, 60 000 rpm, without shims:\n")
    mesh_table(program)
    print("\n## The threshold in time\n\nFilm and rotor integrated together over 60 turns (mesh 2,4):\n")
    orbit_table(program)
    print(f"\n## Random shims\n\n{draws} bearings a row.\n")
    draw_table(program, draws, CONDITIONS, kept)
    print("\nLoads that bring the rotor to three quarters of the clearance and beyond.\n")
    draw_table(program, draws, HEAVY, kept)
    print(f"\n## Time\n\nA whole run of {TIMED} bearings on {os.cpu_count()} cores, from the command line to the report:\n")
    time_table(program, TIMED)
    print("\n## The bearing without shims\n")
    perfect_table(kept)


main()
