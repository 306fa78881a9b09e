#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Foils on scanners whose fault no row of the list names, corrected by the model of a plate of pins of known diameters on
the same scanner: the fields of loop_unlisted.py over the plate and over the foil. A row that is a kind itself is left out
of that kind's plates. The foil reaches a little beyond the plate.

/usr/bin/python3 tests/bench/loop_plate_foils.py build/foilgauge [--cases 60] [--seed 1] [--unknown] [--fresh]
    [--csv reports/loop_plate_foils.csv] [--out reports/loop_plate_foils.md]"""

import argparse
import json
import os
import subprocess
import tempfile

import cv2
import loop_foreign as foreign
import loop_plate as plate
import loop_plate_unlisted as plates
import loop_unlisted as unlisted
import numpy as np
from loop_cases import GEN2, draw_foil, place
from loop_run import errors_um, pair_foils, within, write_design

QUANTITIES = ("R0", "R", "h")
SIDES = ("floor", "before", "after")
FIELDS = ["case", "seed", "cause", "size_um", "edge", "outcome", "verdict", "found", "map", *(f"{q}_{s}" for q in QUANTITIES for s in SIDES),
          *(f"{n}_{q}_{s}" for n in ("inside", "values") for q in QUANTITIES for s in ("before", "after"))]  # fmt: skip


def plan(seed, index):
    combinations = [(um, edge) for um in unlisted.SIZES_UM for edge in ("ideal", "rough")]
    turn, kind = divmod(index, len(plates.OF_FOILS))
    order = np.random.default_rng([seed, 91, kind]).permutation(len(combinations))
    return plates.OF_FOILS[kind], *combinations[order[turn % len(combinations)]]


def draw_scans(options, rng, folder, rough):
    """(the foil's case, paths of plate and foil) without a fault."""
    scanner = unlisted.draw_spec(rng, {"rotate_deg": 0.0}, 0.0, rough)["scanner"]
    foil = {**draw_foil(rng, GEN2), "rotate_deg": float(rng.uniform(-110, -70))}
    width, height = place(rng, [[foil]])
    size = {"width_px": int(width / 25.4 * unlisted.DPI), "height_px": int(height / 25.4 * unlisted.DPI)}
    spec = {"schema": "foilgauge/render/1", "seed": int(rng.integers(1, 2**31)), "foils": [foil], "scanner": scanner, **size}
    paths = []
    for name, what in (("plate", plate.plate_spec(rng, scanner, [])), ("foil", spec)):
        paths.append(os.path.join(folder, name + ".png"))
        with open(paths[-1] + ".json", "w", encoding="utf-8") as out:
            json.dump(what, out)
        subprocess.run([options.program, "render", paths[-1] + ".json", "-o", paths[-1]], check=True)
    return {"design": GEN2, "same_foil": False, "specs": [spec], "effects": []}, paths


def warp_file(path, field):
    picture = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    cv2.imwrite(path, unlisted.warp(picture, field), [cv2.IMWRITE_PNG_COMPRESSION, 1])


def measure(options, case, path, model=None):
    """The case's foil, paired with its truth; None: not measured."""
    out = path + ".measured"
    subprocess.run([options.program, "measure", path, "--dpi", str(unlisted.DPI), "--design",
                    write_design(os.path.dirname(path), case["design"]), *(["--model", model] if model else []), "-o", out],
                   stderr=subprocess.DEVNULL, check=False)  # fmt: skip
    if not os.path.exists(out):
        return None
    with open(out, encoding="utf-8") as file:
        return pair_foils(case, json.load(file)["foils"])


def put(row, side, pairs):
    if not pairs:
        return
    errors, inside = errors_um(pairs), within(pairs)
    for q in QUANTITIES:
        row[f"{q}_{side}"] = f"{errors[q]:.4f}"
        if side != "floor":
            row[f"inside_{q}_{side}"], row[f"values_{q}_{side}"] = (int(n) for n in inside[q])


def run_case(options, index):
    cause, um, edge = plan(options.seed, index)
    rng = np.random.default_rng([options.seed, 92, index])
    row = {"case": index, "seed": options.seed, "cause": cause, "size_um": um, "edge": edge}
    with tempfile.TemporaryDirectory() as folder:
        case, (pins, foil) = draw_scans(options, rng, folder, edge == "rough")
        put(row, "floor", measure(options, case, foil))
        height, width = (n * unlisted.MM for n in cv2.imread(pins, cv2.IMREAD_GRAYSCALE).shape)
        field = unlisted.scanner_fields(rng, width, height, um / 1000)[cause]
        warp_file(pins, field)
        warp_file(foil, field)
        put(row, "before", measure(options, case, foil))
        own = ["--without", unlisted.OWN_ROW[cause]] if cause in unlisted.OWN_ROW else []
        form = ["--form", "discs"] if options.unknown else ["--design", plates.write_known(folder)]
        model = os.path.join(folder, "model.json")
        report, error, _ = foreign.run_loop(options.program, [pins], 1, unlisted.DPI, [*form, *own, "--model-out", model])
        row["verdict"] = report["verdict"] if report else error
        row["outcome"] = "done" if report else "error"
        row["found"] = "; ".join(c["id"] for c in report["claims"] if c["verdict"] == "found") if report else ""
        has_model = os.path.exists(model)
        if has_model:
            with open(model, encoding="utf-8") as file:
                row["map"] = int(bool(json.load(file)["map"]))
        put(row, "after", measure(options, case, foil, model if has_model else None))
    return row


# ---- the page


def is_worse(row, q, noise, times=1):
    before, after = float(row[f"{q}_before"]), float(row[f"{q}_after"])
    return after > before + 2 * noise[row["edge"]][q] and after > times * before


def group_row(name, rows, noise):
    done = [r for r in rows if r["R_after"] and r["R_before"]]
    if not done:
        return f"| {name} | {len(rows)} |" + " - |" * 9
    median = lambda column: np.median([float(r[column]) for r in done])
    change = lambda q: f"{median(q + '_before'):.2f} → {median(q + '_after'):.2f} ({median(q + '_floor'):.2f})"
    share = lambda q: 100 * sum(int(r[f"inside_{q}_after"]) for r in done) / sum(int(r[f"values_{q}_after"]) for r in done)
    worse = [sum(any(is_worse(r, q, noise, times) for q in QUANTITIES) for r in done) for times in (1, 2)]
    cells = [name, len(rows), sum(r["map"] == "1" for r in rows), *map(change, QUANTITIES), *(f"{share(q):.0f} %" for q in QUANTITIES), *worse]
    return "| " + " | ".join(map(str, cells)) + " |"


def noise_of(rows):
    of = lambda e, q: [float(r[f"{q}_floor"]) for r in rows if r["edge"] == e and r[f"{q}_floor"]]
    return {e: {q: np.median(of(e, q)) if of(e, q) else 0.0 for q in QUANTITIES} for e in ("ideal", "rough")}


def write_page(options, rows):
    noise = noise_of(rows)
    groups = [("all", rows), ("with a map", [r for r in rows if r["map"] == "1"]), ("others", [r for r in rows if r["map"] != "1"])]
    groups += [(k, [r for r in rows if r["cause"] == k]) for k in plates.OF_FOILS if any(r["cause"] == k for r in rows)]
    groups += [(f"{um} um", [r for r in rows if r["size_um"] == str(um)]) for um in unlisted.SIZES_UM]
    known = "unknown" if options.unknown else "known"
    lines = [
        f"# Foils corrected by plates of {known} diameters, on scanners whose fault no row names\n",
        f"Twelve pins and a foil, {unlisted.DPI} dpi, each warped by the same field of the scanner (those of loop_unlisted.md, 3, 8, 20 um). The"
        " loop on\nthe plate writes a model; the foil is measured without and with it. A kind that has a row in the list is sought without it"
        " (`--without`).\nThe foil is 42 mm wide and reaches beyond the plate by a tenth. Errors are medians of the foils' rms, um: before → after"
        " (without the\nfault). Within U: values after. Worse: beyond the error before by more than twice that without the fault.\n",
        f"    /usr/bin/python3 tests/bench/loop_plate_foils.py build/foilgauge --cases {len(rows)} --seed {options.seed}"
        f"{' --unknown' if options.unknown else ''}\n",
        "| | foils | by a map | R0 | R | h | R0 within U | R within U | h within U | worse | more than twice |\n|" + "---|" * 11,
        *[group_row(name, own, noise) for name, own in groups],
    ]  # fmt: skip
    with open(options.out, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--csv", default="reports/loop_plate_foils.csv")
    parser.add_argument("--out", default="reports/loop_plate_foils.md")
    parser.add_argument("--unknown", action="store_true", help="the loop is not told the pins' diameters")
    parser.add_argument("--fresh", action="store_true", help="forget the inputs of this seed that the CSV has")
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    foreign.work_on_all(options, lambda index: run_case(options, index), FIELDS)
    write_page(options, foreign.rows_of(options))


if __name__ == "__main__":
    main()
