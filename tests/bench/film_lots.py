# SPDX-License-Identifier: GPL-3.0-or-later
"""From scans to the rotor: lots of classical, sinusoidal and cantilever foils are rendered, measured and made into
bearings; their gas films from measured numbers are held against those from the truth. Writes reports/thesis/rotor_lots.md
to standard output.

    /usr/bin/python3 tests/bench/film_lots.py build/foilgauge [BEARINGS] > reports/thesis/rotor_lots.md

The clearances of the truth are found here, from the rendered radii and angles, not by the program."""
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import thesis_lot  # noqa: E402
import thesis_lots  # noqa: E402

FOILS, PADS, DPI = 10, 3, 1200
SLEEVE, ROTOR, THICKNESS = 20.73, 20.0, 0.1
CLASSICAL = {"schema": "foilgauge/design/1", "name": "classical", "bump_radius_mm": 3.32, "bump_angle_deg": 63.15,
             "overall_radius_mm": SLEEVE, "thickness_mm": THICKNESS, "bump_count": 9}
SINUSOIDAL = {**thesis_lots.DESIGN, "bump_count": 9}
CANTILEVER = {"schema": "foilgauge/design/1", "name": "cantilever", "form": "cantilever", "beam_count": 8, "beam_length_mm": 9,
              "beam_width_mm": 3, "thickness_mm": THICKNESS, "sagitta_mm": 1, "clearance_mm": 0.126}
CONDITIONS = ["--load", "5", "--speed", "60000", "--speeds", "60000:61000:2", "--compliance", "0.67", "--mesh", "2,4", "--jobs", "1"]
MICROMETER = ["--thickness-measured=0.1:0.0005"]
C_CANTILEVER = 0.08  # mm, table 5.6: the sagitta's change is added to it at 8 beams a pad
QUANTITIES = (("eccentricity_ratio", "e / C"), ("min_film_um", "thinnest film, um"), ("critical_mass_kg", "critical mass"))
WORDS = """
# From scans to the rotor (section 5.12)

`/usr/bin/python3 tests/bench/film_lots.py build/foilgauge > reports/thesis/rotor_lots.md` writes this page: foils with known radii and angles are
rendered at 1200 dpi, `foilgauge measure` measures them, three of them make a bearing, and `foilgauge film` solves it from the
measured clearances and once more from the true ones. What differs is the error that measuring adds to the rotor's numbers, and it is held against the u that the
program states. Classical and sinusoidal foils are those of tests/bench/thesis_lot.py and thesis_lots.py (ten and six of them), the clearance that of each bump as fitted into the sleeve. A cantilever
foil has no bumps: the change of its beams' sagitta shifts the clearance of table 5.6 (80 um) at eight places a pad. 5 N, 60 000 rpm, compliance 0.67,
mesh 2,4; bearings are drawn from a lot's foils with seed 1. Foils with a bump that was not measured are left out. "Micrometer": the strip's thickness was measured apart (0.1 mm, u 0.5 um).

The clearance of bumps is measured far better than its u says without a micrometer: this u is that of the strip's thickness, which a scan alone does not know (the driver's
tone). With a micrometer it hardly adds to the film. A cantilever's clearance follows from the lengths of its beams, which need no micrometer. With a micrometer the critical mass of about a gram
lies within 2 %, and its u is 2 to 6 %; without one its u is 109 to 416 %, all of it the thickness's, which shifts all clearances alike.
Every verdict on the rotor is that of the true clearances.
"""


def run(program, *arguments):
    subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def measure(program, spec, folder, design, extra=()):
    """The measured foil and the truth of one rendered scan."""
    scan, truth, report = folder / "scan.png", folder / "truth.json", folder / "report.json"
    run(program, "render", spec, "-o", scan, "-t", truth)
    subprocess.run([program, "measure", str(scan), "-d", str(design), "-o", str(report), *extra], check=False,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    foil = json.loads(report.read_text())["foils"][0]
    return foil, json.loads(truth.read_text())


def true_clearance(bump, thickness):
    """A bump in the sleeve: its arc over its chord, and the sleeve's arc under it."""
    radius, half = bump["radius_mm"], math.radians(bump["bump_angle_deg"]) / 2
    chord = radius * math.sin(half)
    height = radius * (1 - math.cos(half)) + SLEEVE - math.sqrt(SLEEVE**2 - chord**2)
    return SLEEVE - height - ROTOR - thickness


def bump_foil(foil, truth):
    """Clearances of a foil, true and measured with u; the foil may lie the other way round."""
    true = [true_clearance(b, truth["thickness_mm"]) for b in truth["bumps"]]
    found = sorted(foil["bumps"], key=lambda b: b["number"])
    size = [b["radius_mm"] for b in truth["bumps"]]
    if sum(abs(b["radius_mm"] - r) for b, r in zip(found, size)) > sum(abs(b["radius_mm"] - r) for b, r in zip(found, size[::-1])):
        true = true[::-1]
    bumps = [(b["clearance_fitted_mm"], b["u_clearance_fitted_mm"]) for b in found]
    return {"true": true, "found": bumps, "u_shared": foil["u_thickness_mm"]}


def beam_foil(foil, truth):
    shift = [1 - (b["length_mm"] / CANTILEVER["beam_length_mm"]) ** 2 for b in truth["beams"]]
    found = [(b["clearance_change_mm"], b["u_clearance_change_mm"]) for b in sorted(foil["beams"], key=lambda b: b["number"])]
    if sum(abs(c - s) for (c, _), s in zip(found, shift)) > sum(abs(c - s) for (c, _), s in zip(found, shift[::-1])):
        shift = shift[::-1]
    return {"true": [C_CANTILEVER + s for s in shift], "found": [(C_CANTILEVER + c, u) for c, u in found], "u_shared": 0}


def cantilever_specs(folder):
    """Beams whose lengths scatter by 20 um, which changes the clearance by some 4.4 um."""
    folder.mkdir()
    for k in range(FOILS):
        design = {key: value for key, value in CANTILEVER.items() if key not in ("schema", "name")}
        spec = {"schema": "foilgauge/render/1", "seed": 300 + k, "scanner": {"dpi": DPI, "contrast": -175, "background": 225},
                "foils": [{"design": design, "rotate_deg": -90 + 7 * k - 20,
                           "beams": {"layout": "slits", "pitch_mm": 4.5, "length": {"mean_um": 0, "sd_um": 20},
                                     "width": {"mean_um": -10, "sd_um": 30}}}]}
        (folder / f"foil{k:02d}.json").write_text(json.dumps(spec))


def lot(program, work, name, make, design, take, extra=()):
    folder, design_path = work / name, work / f"{design['name']}.json"
    make(folder)
    design_path.write_text(json.dumps(design))
    foils = [take(*measure(program, spec, work, design_path, extra)) for spec in sorted(folder.glob("foil*.json"))[:FOILS]]
    return [foil for foil in foils if len(foil["found"]) == len(foil["true"]) and None not in (c for c, _ in foil["found"])]


def report_of(foils, column):
    """A report of `foilgauge measure` with the clearances of the pads: measured (with u), or true."""
    out = []
    for foil in foils:
        pairs = foil["found"] if column == "found" else [(c, None) for c in foil["true"]]
        shared = foil["u_shared"] if column == "found" else 0
        out.append({"u_thickness_mm": shared, "bumps": [{"number": k + 1, "clearance_mm": c, "u_clearance_mm": u or 0}
                                                        for k, (c, u) in enumerate(pairs)]})
    return {"schema": "foilgauge/measure/1", "foils": out}


def film(program, work, foils, column, extra):
    path, out = work / "bearing.json", work / "film.json"
    path.write_text(json.dumps(report_of(foils, column)))
    out.unlink(missing_ok=True)
    done = subprocess.run([program, "film", *CONDITIONS, *extra, "--foils", str(path), "-o", str(out)], check=False,
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode not in (0, 2) or not out.exists():
        sys.exit(f"film: {done.returncode} {done.stderr}")
    return json.loads(out.read_text())


def hold(program, work, foils, count, extra):
    """Pairs of reports, from measured and from true clearances."""
    rng = random.Random(1)
    pairs = []
    for _ in range(count):
        picked = rng.sample(foils, PADS)
        pairs.append([film(program, work, picked, column, extra) for column in ("found", "true")])
    return pairs


def rms(values):
    return math.sqrt(statistics.fmean(v * v for v in values)) if values else math.nan


def clearance_row(name, foils):
    errors = [1e3 * (c - t) for f in foils for (c, _), t in zip(f["found"], f["true"])]
    us = [1e3 * u for f in foils for _, u in f["found"]]
    true = [1e3 * t for f in foils for t in f["true"]]
    inside = sum(abs(e) <= 2 * u for e, u in zip(errors, us))
    return (f"| {name} | {len(errors)} | {statistics.fmean(true):.1f} | {min(true):.1f} to {max(true):.1f} | {statistics.fmean(errors):+.2f} | "
            f"{rms(errors):.2f} | {rms(us):.2f} | {100 * inside / len(errors):.0f} |")


def film_rows(name, pairs):
    both = [(f, t) for f, t in pairs if "unsolved" not in (f["bearing"]["outcome"], t["bearing"]["outcome"])]
    for key, words in QUANTITIES:
        rows = []
        for found, true in both:
            a, b, u = found["bearing"][key], true["bearing"][key], found.get("uncertainty", {}).get("u_" + key)
            if None not in (a, b, u) and b:
                scale = 100 / b if key == "critical_mass_kg" else 1
                rows.append((scale * (a - b), scale * u, b))
        if not rows:
            print(f"| {name} | {words} | 0 | – | – | – | – |")
            continue
        unit, digits = (" %", 1) if key == "critical_mass_kg" else ("", 4 if key == "eccentricity_ratio" else 2)
        middle = statistics.median(b for *_, b in rows)
        inside = sum(abs(e) <= 2 * u for e, u, _ in rows)
        print(f"| {name} | {words} | {len(rows)} | {middle:.3g}{' kg' if unit else ''} | {rms([e for e, *_ in rows]):.{digits}f}{unit} | "
              f"{rms([u for _, u, _ in rows]):.{digits}f}{unit} | {100 * inside / len(rows):.0f} |")


def interval_row(name, pairs):
    """Share of the true critical masses in the interval of 95 % that the program states; one that is stable at every mass is above it."""
    held = known = 0
    for found, true in pairs:
        low, high = found.get("uncertainty", {}).get("critical_mass_95_kg") or (None, None)
        if None in (low, high) or true["bearing"]["outcome"] == "unsolved":
            continue
        mass = true["bearing"]["critical_mass_kg"]
        known += 1
        held += mass is not None and low <= mass <= high
    return f"| {name} | {len(pairs)} | {known} | {held} |"


def verdict(report):
    at = report["bearing"]
    return at["outcome"] if at["outcome"] != "solved" else at["stability"] if at["critical_mass_kg"] in (None, 0) else "finite"


def main():
    program, count = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2]) if len(sys.argv) > 2 else 8
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        lots = {}
        for name, make, design in (("classical", thesis_lot.main, CLASSICAL), ("sinusoidal", thesis_lots.main, SINUSOIDAL)):
            for words, extra in (("", ()), (", micrometer", MICROMETER)):
                foils = lot(program, work, name + words, lambda p, make=make: make(p, DPI), design, bump_foil, extra)
                lots[name + words] = foils, [str(work / f"{name}.json")]
        lots["cantilever"] = lot(program, work, "cantilever", cantilever_specs, CANTILEVER, beam_foil), ["--bumps", "8", "--clearance", "80"]
        pairs = {name: hold(program, work, foils, count, extra) for name, (foils, extra) in lots.items()}
    print(WORDS.strip())
    print("\n## Clearances\n\nOf every bump or beam; um.\n\n| lot | places | mean | from, to | mean error | rms error | rms u | within 2u, % |\n"
          "|---|---|---|---|---|---|---|---|")
    for name, (foils, _) in lots.items():
        print(clearance_row(name, foils))
    print(f"\n## Films\n\n{count} bearings of a lot. The critical mass in percent of the true one.\n\n"
          "| lot | quantity | bearings | true, median | rms error | rms u | within 2u, % |\n|---|---|---|---|---|---|---|")
    for name, rows in pairs.items():
        film_rows(name, rows)
    print("\n## Intervals of the critical mass\n\nThe program states one of 95 % where all bearings within the u of the clearances are solved, and none of them is stable at every mass.\n\n"
          "| lot | bearings | with an interval | true one in it |\n|---|---|---|---|")
    for name, rows in pairs.items():
        print(interval_row(name, rows))
    print("\n## Verdicts\n\n| lot | bearings | same verdict from measured numbers | verdicts of the true bearings |\n|---|---|---|---|")
    for name, rows in pairs.items():
        words = [(verdict(f), verdict(t)) for f, t in rows]
        true = [t for _, t in words]
        counts = ", ".join(f"{true.count(w)} {w}" for w in sorted(set(true)))
        print(f"| {name} | {len(rows)} | {sum(a == b for a, b in words)} | {counts} |")


main()
