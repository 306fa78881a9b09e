#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop on scans whose cause no row of its table names: renders without an effect, warped by any field of a scanner
or any deviation of a part, measured by the program; judged and told as in loop_foreign.py. A row that is a kind itself is
left out of that kind's inputs.

/usr/bin/python3 tests/bench/loop_unlisted.py build/foilgauge [--cases 40] [--seed 1] [--threads 1]
    [--kinds first|late|last] [--fresh] [--csv reports/loop_unlisted.csv] [--out reports/loop_unlisted.md]
The warp knows nothing of the program: true place = nominal place + field, by cubic splines over the picture."""

import argparse
import json
import os
import subprocess
import tempfile

import cv2
import loop_foreign as foreign
import numpy as np
from loop_cases import GEN2
from loop_foil import measurand_of
from loop_kinds_last import last_deviations, last_fields
from loop_kinds_late import late_deviations, late_fields
from scipy import ndimage

DPI = 2400
MM = 25.4 / DPI
# Rows of the list that are a kind itself: they are left out of its inputs (--without).
OWN_ROW = {
    "chip_tilt": "scan.chip_tilt", "chip_gap": "scan.chip_gap", "keystone": "scan.keystone", "yaw": "scan.yaw",
    "quintic": "scan.optical_quintic", "ripple_growth": "scan.ripple_growth", "lobes": "part.lobes", "dent": "part.dent",
}  # fmt: skip
# Listed effects that are the cause itself, cut into pieces: a ripple that grows, a stair of rows, gaps of chips.
# None of loop_kinds_last.py is a row or pieces of one: looked at before their first run by who knows the list.
ALSO_RIGHT = {
    "ripple_growth": {"scan.carriage_ripple"},
    "stairs": {"scan.row_step"},
    "chip_gap": {"scan.column_step"},
    "slip": {"scan.row_step"},
    "belts": {"scan.carriage_ripple", "scan.ripple_growth"},
    "burr": {"part.dent"},
    "flat_tops": {"part.dent"},
}
SIZES_UM = [3, 8, 20]
EVERY_CLEAN = 10


def draw_foil(rng):
    scatter = rng.uniform(0.005, 0.02)
    return {
        "overall_radius_mm": 20.73 * (1 + rng.uniform(0.002, 0.02)),
        "radius_mm": [float(3.32 * (1.015 + scatter * rng.standard_normal())) for _ in range(9)],
        "rotate_deg": float(rng.uniform(-180, 180)),
        "mirror": bool(rng.integers(0, 2)),
    }


def draw_spec(rng, foil, turn_deg, rough):
    scanner = {"dpi": DPI, "blur_px": float(rng.uniform(1.0, 2.0)), "noise": 1.0}
    if rough:
        scanner["rough"] = {"edge_roughness_um": 1.2, "edge_common_um": 0.6, "correlation_um": float(rng.uniform(15, 60)),
                            "correlation_form": str(rng.choice(["gaussian", "exponential"]))}  # fmt: skip
    foil = {**foil, "rotate_deg": foil["rotate_deg"] + turn_deg}
    return {"schema": "foilgauge/render/1", "seed": int(rng.integers(1e9)), "foils": [foil], "scanner": scanner}


def saw(at):
    return at - np.floor(at) - 0.5


def scanner_fields(rng, width, height, a):
    """Kinds of fields, mm, of an amplitude `a` in mm: (x, y) to (dx, dy)."""
    cx, cy, sign = width / 2, height / 2, rng.choice([-1, 1])
    pitch, period, phase = rng.uniform(0.25, 0.4) * width, float(np.exp(rng.uniform(np.log(3), np.log(9)))), rng.uniform(0, 6.28)
    first = rng.uniform(0, pitch)
    waves, sizes, phases = rng.uniform(0.1, 0.35, (6, 2)), rng.standard_normal((2, 6)), rng.uniform(0, 6.28, 6)
    places, signs = np.sort(rng.uniform(0.1 * height, 0.9 * height, 3)), rng.choice([-1, 1], 3)
    turn = 2 * np.pi / (1.3 * height)

    def glass(x, y):
        dx = sum(s * np.sin(u * x + v * y + p) for s, (u, v), p in zip(sizes[0], waves, phases))
        dy = sum(s * np.cos(v * x - u * y + p) for s, (u, v), p in zip(sizes[1], waves, phases))
        return 0.7 * a * dx, 0.7 * a * dy

    def barrel(x, y):
        square = ((x - cx) / cx) ** 2 + ((y - cy) / cy) ** 2
        return 1.5 * a * sign * (x - cx) / cx * square, 1.5 * a * sign * (y - cy) / cx * square

    return {
        "chip_tilt": lambda x, y: (0 * x, 2 * a * sign * saw((x - first) / pitch)),
        "chip_gap": lambda x, y: (a * sign * np.floor((x - first) / pitch), 0 * y),
        "keystone": lambda x, y: (a * sign * (x - cx) * (y - cy) / (cx * cy), 0 * y),
        "yaw": lambda x, y: (a * np.sin(turn * y + phase), a * (x - cx) / cx * np.cos(turn * y + phase)),
        "ripple_growth": lambda x, y: (0 * x, a * sign * y / height * np.sin(2 * np.pi * y / period + phase)),
        "quintic": lambda x, y: (1.5 * a * sign * ((x - cx) / cx) ** 5, 0 * y),
        "barrel": barrel,
        "glass": glass,
        "stairs": lambda x, y: (0 * x, a * sum(s * (y > at) for s, at in zip(signs, places))),
        "slip": lambda x, y: (0 * x, 2 * a * sign * np.clip(3 * saw(y / (2.2 * period) + phase), -0.5, 0.5)),
        "drift": lambda x, y: (a * sign * (x - cx) / cx * np.tanh((y - cy) / (0.3 * height)), 0 * y),
        "belts": lambda x, y: (0 * x, 0.5 * a * (np.sin(2 * np.pi * y / period) + np.sin(2 * np.pi * y / (1.13 * period) + phase))),
        "late_shear": lambda x, y: (2 * a * sign * np.clip(y - places[1], 0, None) / height, 0 * y),
        "curled_end": lambda x, y: (0 * x, 2 * a * sign * np.exp((x - width) / (0.12 * width))),
        "sway": lambda x, y: (a * np.sin(2 * np.pi * (y / (3 * period)) ** 1.5 + phase), 0 * y),
    }


def part_deviations(rng, a):
    """Kinds of radial deviations, mm: (radius, direction about O in the part's frame) to mm outwards."""
    sign, n, phase = rng.choice([-1, 1]), int(rng.integers(3, 6)), rng.uniform(0, 6.28)
    period, number = float(np.exp(rng.uniform(np.log(3), np.log(9)))), int(rng.integers(-3, 4))
    pitch, bump, tops = np.radians(40 / 3), np.radians(40 / 3) * number, rng.uniform(0, 1, 9)
    inner = lambda r: np.clip((20.85 - r) / 0.2, 0, 1)
    away = lambda t, centre: np.angle(np.exp(1j * (t - centre))) * 21

    def flat_tops(r, t):
        """The crown of every bump is flattened, of each by another amount."""
        k = np.clip(np.rint(np.angle(np.exp(1j * t)) / pitch), -4, 4).astype(int)
        return a * tops[k + 4] * np.exp(-((away(t, k * pitch) / 0.4) ** 2)) * inner(r)

    return {
        "lobes": lambda r, t: a * sign * np.cos(n * t - phase),
        "waves": lambda r, t: a * sign * np.sin(2 * np.pi * 20.9 * t / period + phase),
        "dent": lambda r, t: a * np.exp(-((away(t, bump) / 0.5) ** 2)) * inner(r),
        "flat_tops": flat_tops,
        "burr": lambda r, t: a * np.exp(-np.abs(away(t, bump + sign * 0.3 * pitch)) / 0.15) * inner(r),
    }


def warp(picture, displace):
    """Pixels near edges show what lies at their place plus `displace` of it, mm."""
    coarse = picture[::4, ::4].astype(np.float32)
    near = ndimage.maximum_filter(coarse, 5) - ndimage.minimum_filter(coarse, 5) > 12
    near = np.kron(ndimage.binary_dilation(near, iterations=4), np.ones((4, 4), bool))[: picture.shape[0], : picture.shape[1]]
    rows, columns = np.nonzero(near)
    dx, dy = displace((columns + 0.5) * MM, (rows + 0.5) * MM)
    out = picture.astype(np.float32)
    splines = ndimage.spline_filter(out, order=3, output=np.float32)
    at = [rows + dy / MM, columns + dx / MM]
    out[rows, columns] = ndimage.map_coordinates(splines, at, order=3, prefilter=False, mode="nearest")
    return np.clip(np.rint(out), 0, 255).astype(np.uint8)


# The kinds by when they were invented. Draws of an input go through them in this order: a new set comes last.
SETS = {
    "first": (scanner_fields, part_deviations),
    "late": (late_fields, late_deviations),
    "last": (last_fields, last_deviations),
}  # fmt: skip
KINDS_OF = {
    name: [*fields(np.random.default_rng(0), 40, 40, 1), *deviations(np.random.default_rng(0), 1)]
    for name, (fields, deviations) in SETS.items()
}
KINDS = KINDS_OF["first"]
INVENTED = {
    "first": "",
    "late": ", invented when every limit of the program stood",
    "last": ", invented by one who had not read the program",
}  # fmt: skip


def causes(rng, a):
    """(fields of the scanner, deviations of the part) by kind, of one scanner and one part."""
    fields, deviations = {}, {}
    # The first set's two draws, then the next one's: the order in which the stored inputs were drawn.
    for draw_fields, draw_deviations in SETS.values():
        fields.update(draw_fields(rng, 38, 38, a))
        deviations.update(draw_deviations(rng, a))
    return fields, deviations


def make_scan(program, path, spec, kind, a, seed):
    with open(path + ".json", "w", encoding="utf-8") as out:
        json.dump(spec, out)
    subprocess.run([program, "render", path + ".json", "-o", path + ".png", "--truth", path + ".truth"], check=True)
    with open(path + ".truth", encoding="utf-8") as text:
        truth = json.load(text)
    ox, oy = (v * MM for v in truth["overall_centre_px"])
    rng = np.random.default_rng(seed)  # the same scanner, or part, for both scans of a pair
    fields, deviations = causes(rng, a)
    turn = np.radians(spec["foils"][0]["rotate_deg"])

    if kind == "clean":
        return

    def deviate(x, y):
        r = np.hypot(x - ox, y - oy)
        d = deviations[kind](r, np.arctan2(y - oy, x - ox) - turn)
        return -d * (x - ox) / r, -d * (y - oy) / r

    picture = cv2.imread(path + ".png", cv2.IMREAD_GRAYSCALE)
    cv2.imwrite(path + ".png", warp(picture, fields.get(kind, deviate)), [cv2.IMWRITE_PNG_COMPRESSION, 1])


def truth_of_part(foil, kind, a, seed):
    """R0, R and h of the measurand, mm: circles through the part as it is. The scanner's fields leave it as it was drawn."""

    def deviate_um(midline):
        deviations = causes(np.random.default_rng(seed), a)[1]
        if kind not in deviations:
            return np.zeros(len(midline.xy))
        return 1000 * deviations[kind](np.linalg.norm(midline.xy, axis=1), midline.mirror * midline.psi) * midline.radial_share()

    measurand = measurand_of({**foil, "first_land_mm": 1.8, "last_land_mm": 1.3}, GEN2, deviate_um)
    return measurand.overall, measurand.radius, measurand.height


def plan(seed, index, kinds=None):
    """Every tenth input is clean; the kinds take turns, each through its combinations in an order of its own."""
    combinations = [(um, edge, count) for um in SIZES_UM for edge in ("ideal", "rough") for count in (1, 2)]
    if index % EVERY_CLEAN == EVERY_CLEAN - 1:
        return "clean", 0, ("ideal", "rough")[index // 10 % 2], 1 + index // 20 % 2
    kinds = kinds or KINDS
    turn, kind = divmod(index - index // EVERY_CLEAN, len(kinds))
    order = np.random.default_rng([seed, 78, kind]).permutation(len(combinations))
    return kinds[kind], *combinations[order[turn % len(combinations)]]


def draw_input(program, seed, index, folder, kinds=None):
    kind, um, edge, count = plan(seed, index, kinds)
    rng, of_cause = np.random.default_rng([seed, index]), [seed, index, 1]
    foil, turn = draw_foil(rng), float(rng.choice([45, 90]))
    turns, paths = [0.0, turn][:count], [os.path.join(folder, f"s{k}") for k in range(count)]
    for path, angle in zip(paths, turns):
        make_scan(program, path, draw_spec(rng, foil, angle, edge == "rough"), kind, um / 1000, of_cause)
    side = "clean" if kind == "clean" else "part" if kind in causes(rng, 1)[1] else "scanner"
    row = {"case": index, "seed": seed, "cause": kind, "side": side, "factor": f"{um} um", "size_um": um, "edge": edge,
           "scans": count, "turn_deg": turn if count == 2 else ""}  # fmt: skip
    return row, [p + ".png" for p in paths], truth_of_part(foil, kind, um / 1000, of_cause)


def run_case(options, index):
    with tempfile.TemporaryDirectory() as folder:
        row, paths, truth = draw_input(options.program, options.seed, index, folder, KINDS_OF[options.kinds])
        own = ["--without", OWN_ROW[row["cause"]]] if row["cause"] in OWN_ROW else []
        report, error, seconds = foreign.run_loop(options.program, paths, options.threads, DPI, own)
    row["seconds"] = f"{seconds:.2f}"
    if report:
        foreign.judge(row, report, truth, ALSO_RIGHT)
    else:
        row["outcome"], row["verdict"] = "error", error
    return row


def page_of(kinds):
    """Page and table of a set of kinds, without their suffix."""
    return "reports/loop_unlisted" + ("" if kinds == "first" else f"_{kinds}")


def command_end(kinds):
    return "" if kinds == "first" else f" --kinds {kinds}"


def page_head(options, count):
    return [
        "# The loop on causes that no row names\n",
        f"Renders without an effect, {DPI} dpi, that are warped by a field of the scanner or a deviation of the part, of"
        f" {len(KINDS_OF[options.kinds])} kinds{INVENTED[options.kinds]}; radii scatter\nby 0.5 to 2 %. Sizes are {', '.join(map(str, SIZES_UM))} um. Every tenth input is"
        " clean. The second scan of a pair is turned by 45 or 90 degrees. A kind that has a row\nin the list is measured without it"
        " (`--without`). Right: a cause that is listed effects cut into pieces is called by them (a stair is row\nsteps,"
        " gaps of chips are column steps, belts are ripples, a burr is a dent).\n"
        + foreign.HOW_JUDGED,
        f"    /usr/bin/python3 tests/bench/loop_unlisted.py build/foilgauge --cases {count} --seed {options.seed}"
        f"{command_end(options.kinds)}\n",
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--csv", help="default: the table of the kinds, as reports/loop_unlisted_late.csv")
    parser.add_argument("--out", help="default: their page")
    parser.add_argument("--kinds", choices=SETS, default="first", help="by when they were invented")
    parser.add_argument("--late", dest="kinds", action="store_const", const="late", help="as --kinds late")
    parser.add_argument("--fresh", action="store_true", help="forget the inputs of this seed that the CSV has")
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    options.csv, options.out = options.csv or page_of(options.kinds) + ".csv", options.out or page_of(options.kinds) + ".md"
    foreign.work_on_all(options, lambda index: run_case(options, index))
    rows = foreign.rows_of(options)
    foreign.write_page(options.out, rows, page_head(options, len(rows)))


if __name__ == "__main__":
    main()
