# SPDX-License-Identifier: GPL-3.0-or-later
"""loop_strata.py PROGRAM [--lots N] [--rendered N] [--relabelled N] [--relabelled-rendered N] [--dpi DPI] [--out FOLDER]

Strata of a lot: bumps in foils in dies, coils and days, with operator and oven place. One of them is planted, at
five standard errors of the difference between its levels' means (foils are the rows that count); or the foils' labels
are drawn anew, and no claim is right. First tables like a lot's; then lots that are rendered, measured by
`foilgauge lot` and searched by `loop --lot`: the thesis's (thesis_lot.py) and those with a planted stratum, and of both the
foils' labels drawn anew (`lot --resume` with another manifest). Writes loop_strata.md.
"""

import argparse
import csv
import json
import os
import random
import shutil
import subprocess
import tempfile

import thesis_lot

FOILS, BUMPS = 24, 9
LEVELS = {"die": 3, "coil": 4, "day": 4, "operator": 2, "oven_place": 6}
FOIL_SD, ROW_SD, ERRORS = 1.0, 0.7, 5.0


def labels(draw):
    """Nested in time: coils and days follow each other; dies, operators and places are mixed."""
    rows = []
    for f in range(FOILS):
        rows.append({"coil": f * LEVELS["coil"] // FOILS, "day": (f * 5 // 4) % FOILS * LEVELS["day"] // FOILS})
    for name in ("die", "operator", "oven_place"):
        mixed = [f % LEVELS[name] for f in range(FOILS)]
        draw.shuffle(mixed)
        for row, level in zip(rows, mixed):
            row[name] = level
    return rows


def planted_levels(name, draw):
    """Levels with an sd that stands ERRORS standard errors from nothing."""
    count = LEVELS[name]
    values = [draw.gauss(0, 1) for _ in range(count)]
    mean = sum(values) / count
    size = (sum((v - mean) ** 2 for v in values)) ** 0.5
    error = ((FOIL_SD ** 2 + ROW_SD ** 2 / BUMPS) / (FOILS / count)) ** 0.5
    reach = ERRORS * error * max(1, (count - 1) ** 0.5)
    return [(v - mean) / size * reach for v in values]


def stratum_of(claim):
    return {n[n.rindex("(") + 1:-1] for n in claim}


def write_lot(path, planted, seed):
    draw = random.Random(f"{planted} {seed}")
    foils = labels(draw)
    effect = planted_levels(planted, draw) if planted else None
    with open(path, "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["foil", "bump", *LEVELS, "radius_mm"])
        for f, foil in enumerate(foils):
            level = draw.gauss(0, FOIL_SD) + (effect[foil[planted]] if planted else 0)
            for bump in range(1, BUMPS + 1):
                radius = 3 + 0.01 * (level + draw.gauss(0, ROW_SD))
                out.writerow([f"F{f + 1:03}", bump, *(f"{n[0].upper()}{foil[n] + 1}" for n in LEVELS), f"{radius:.6f}"])


def names(claim):
    return [claim["name"], *(a["name"] for a in claim["alias_class"])]


def ask(program, planted, seed):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "lot.csv")
        write_lot(path, planted, seed)
        command = [program, "loop", "--table", path, "--response", "radius_mm", "--model", "1", "--group", "foil", "-o", "-"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    report = json.loads(done.stdout)
    return report["verdict"], [names(c) for c in report["claims"]]


# ---- rendered lots ----


def render(program, folder, foil, radii, seed, dpi):
    spec = {"schema": "foilgauge/render/1", "seed": seed,
            "foils": [{"overall_radius_mm": 20.9, "radius_mm": radii, "bump_angle_deg": [63.15] * len(radii), "rotate_deg": -90}],
            "scanner": {"dpi": dpi, "bits": 8, "background": 30, "contrast": 175, "blur_px": 1.2, "noise": 1.5}}
    path = os.path.join(folder, f"{foil}.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(spec, file)
    subprocess.run([program, "render", path, "-o", os.path.join(folder, f"{foil}.png"), "--truth",
                    os.path.join(folder, f"{foil}.truth")], check=True, capture_output=True)


def write_manifest(folder, names_of, columns):
    with open(os.path.join(folder, "manifest.csv"), "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["scan", "foil", *columns[0]])
        out.writerows([f"{n}.png", n, *row.values()] for n, row in zip(names_of, columns))


def measure(program, folder, resume=False):
    command = [program, "lot", "manifest.csv", "-o", "lot", "--pages", "none", *(["--resume"] if resume else [])]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1, 3):
        raise RuntimeError(done.stderr)


def ask_lot(program, folder):
    command = [program, "loop", "--lot", "lot", "--response", "radius_mm", "--model", "1", "-o", "-"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return [names(c) for c in json.loads(done.stdout)["claims"]]


def spelled(foils):
    return [{k: f"{k[0].upper()}{v + 1}" for k, v in foil.items()} for foil in foils]


def planted_lot(program, folder, planted, seed, dpi):
    """Levels of foils and bumps as in the tables, 0.02 mm for their 1."""
    draw = random.Random(f"rendered {planted} {seed}")
    foils = labels(draw)
    effect = planted_levels(planted, draw) if planted else None
    names_of = [f"F{f + 1:03}" for f in range(FOILS)]
    for f, foil in enumerate(foils):
        level = draw.gauss(0, FOIL_SD) + (effect[foil[planted]] if planted else 0)
        radii = [round(3.32 + 0.02 * (level + draw.gauss(0, ROW_SD)), 5) for _ in range(BUMPS)]
        render(program, folder, names_of[f], radii, 1000 * seed + f + 1, dpi)
    write_manifest(folder, names_of, spelled(foils))
    measure(program, folder)
    return names_of, spelled(foils)


def shuffled(columns, draw):
    """The foils' labels, each column in another order."""
    out = [dict(row) for row in columns]
    for name in columns[0]:
        values = [row[name] for row in columns]
        draw.shuffle(values)
        for row, value in zip(out, values):
            row[name] = value
    return out


def relabelled_claims(program, folder, names_of, columns, count):
    """Lots with a claim of a stratum, of `count` orders of the labels."""
    wrong = 0
    for k in range(count):
        write_manifest(folder, names_of, shuffled(columns, random.Random(k)))
        measure(program, folder, resume=True)
        wrong += any(stratum_of(c) & set(columns[0]) for c in ask_lot(program, folder))
    return wrong


def thesis_lines(program, dpi, relabelled):
    lines = ["", "## The thesis's lot", ""]
    with tempfile.TemporaryDirectory() as folder:
        thesis_lot.main(folder, dpi)
        for spec in sorted(os.listdir(folder)):
            if spec.endswith(".json"):
                stem = os.path.join(folder, spec[:-5])
                subprocess.run([program, "render", stem + ".json", "-o", stem + ".png", "--truth", stem + ".truth"], check=True,
                               capture_output=True)
        measure(program, folder)
        claims = ask_lot(program, folder)
        with open(os.path.join(folder, "manifest.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        names_of = [r.pop("foil") for r in rows]
        for r in rows:
            r.pop("scan")
        wrong = relabelled_claims(program, folder, names_of, rows, relabelled)
    said = "; ".join(c[0] for c in claims) or "nothing"
    return lines + [f"14 foils of 9 bumps without an effect of die, bearing or pad: {said} is claimed. With these labels drawn anew: "
                    f"{wrong} of {relabelled} with a claim of one.", ""]


def rendered_lines(program, args):
    lines = ["", "## Rendered lots", "",
             f"{FOILS} foils of {BUMPS} bumps each rendered at {args.dpi} dpi, measured and searched (sd between foils {0.02 * FOIL_SD:g} mm,"
             f" within {0.02 * ROW_SD:g} mm).", "", "| planted | lots | named | in class | another claim |", "|---|---|---|---|---|"]
    for planted in LEVELS:
        counted = [0, 0, 0]
        for seed in range(args.rendered):
            folder = tempfile.mkdtemp()
            planted_lot(program, folder, planted, seed, args.dpi)
            for i, value in enumerate(judged(ask_lot(program, folder), planted)):
                counted[i] += value
            shutil.rmtree(folder)
        lines.append(f"| {planted} | {args.rendered} | " + " | ".join(map(str, counted)) + " |")
    folder = tempfile.mkdtemp()
    names_of, columns = planted_lot(program, folder, None, 99, args.dpi)
    wrong = relabelled_claims(program, folder, names_of, columns, args.relabelled_rendered)
    shutil.rmtree(folder)
    return lines + ["", f"A lot without an effect, its labels drawn anew: {wrong} of {args.relabelled_rendered} with a claim of a stratum.", ""]


def judged(claims, planted):
    """Named, in a class, and claims without it."""
    right = [c for c in claims if any(f"({planted})" in n for n in c)]
    return any(f"({planted})" in c[0] for c in right), bool(right), len(right) < len(claims)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--lots", type=int, default=20)
    parser.add_argument("--rendered", type=int, default=6)
    parser.add_argument("--relabelled", type=int, default=100)
    parser.add_argument("--relabelled-rendered", type=int, default=50)
    parser.add_argument("--dpi", type=int, default=1200)
    parser.add_argument("--out", default="reports")
    args = parser.parse_args()
    args.program = os.path.abspath(args.program)
    lines = ["# Strata of a lot in the loop on tables", "",
             f"{FOILS} foils of {BUMPS} bumps (sd between foils {FOIL_SD}, within {ROW_SD}); one stratum planted at {ERRORS:g}"
             " standard errors.", "", f"    python3 tests/bench/loop_strata.py build/foilgauge --lots {args.lots} --rendered {args.rendered}"
             f" --relabelled {args.relabelled} --relabelled-rendered {args.relabelled_rendered} --dpi {args.dpi}",
             "", "## Tables", "", "| planted | lots | named | in class | another claim |", "|---|---|---|---|---|"]
    for planted in LEVELS:
        counted = [0, 0, 0]
        for seed in range(args.lots):
            for i, value in enumerate(judged(ask(args.program, planted, seed)[1], planted)):
                counted[i] += value
        lines.append(f"| {planted} | {args.lots} | " + " | ".join(map(str, counted)) + " |")
    wrong = sum(bool(ask(args.program, None, seed)[1]) for seed in range(args.relabelled))
    lines += ["", f"Labels drawn anew: {wrong} of {args.relabelled} tables with a claim."]
    if args.rendered:
        lines += rendered_lines(args.program, args) + thesis_lines(args.program, str(args.dpi), args.relabelled_rendered)[1:]
    with open(os.path.join(args.out, "loop_strata.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
