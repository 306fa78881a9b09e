#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop on plates of pins whose cause no row of its table names: renders without an effect, warped by the fields of
loop_unlisted.py, or by forms of the pins; a row that is a kind itself is left out of that kind's inputs.

/usr/bin/python3 tests/bench/loop_plate_unlisted.py build/foilgauge [--cases 110] [--seed 1] [--known] [--fresh]
    [--csv reports/loop_plate_unlisted.csv] [--out reports/loop_plate_unlisted.md]; --known: reports/loop_plate_known.csv and .md"""

import argparse
import json
import os
import subprocess
import tempfile

import cv2
import loop_foreign as foreign
import loop_plate as plate
import loop_unlisted as unlisted
import numpy as np

DPI, MM, RADII = unlisted.DPI, unlisted.MM, np.array(plate.RADII)
FIELDS = ("case seed cause side size_um edge verdict found tied alias unattributed outcome R_before R_after u_R_before R_max"
          " R_max_after inside values seconds").split()  # fmt: skip


def form_of(kind, rng, discs, a):
    """mm outwards, by pin and direction: of every pin its own lobes; a flat on each; all pins alike; a burr on one."""
    phase, n = rng.uniform(0, 6.28, len(discs)), rng.integers(2, 6, len(discs))
    share, one, common = rng.uniform(0, 1, len(discs)), int(rng.integers(len(discs))), rng.uniform(0, 6.28)
    away = lambda t, centre: np.angle(np.exp(1j * (t - centre)))
    return {
        "own_lobes": lambda k, t: a * share[k] * np.cos(n[k] * t - phase[k]),
        "flats": lambda k, t: -a * share[k] * np.exp(-((away(t, phase[k]) / 0.3) ** 2)),
        "alike_lobes": lambda k, t: a * np.cos(n[0] * t - common),
        "burr": lambda k, t: a * (k == one) * np.exp(-((away(t, common) / 0.2) ** 2)),
    }[kind]


PART = ["own_lobes", "flats", "alike_lobes", "burr"]
OF_FOILS = [k for k in unlisted.KINDS if k not in unlisted.part_deviations(np.random.default_rng(0), 1)]
KINDS = [*OF_FOILS, *PART]


def displace_by_forms(discs, form):
    centre = np.array([d["centre_mm"] for d in discs])

    def displace(x, y):
        k = np.argmin((x[:, None] - centre[:, 0]) ** 2 + (y[:, None] - centre[:, 1]) ** 2 - radii_of(discs) ** 2, axis=1)
        dx, dy = x - centre[k, 0], y - centre[k, 1]
        r = np.hypot(dx, dy)
        d = np.empty(len(x))
        for number in range(len(discs)):
            own = k == number
            d[own] = form(number, np.arctan2(dy[own], dx[own]))
        return -d * dx / r, -d * dy / r

    return displace


def radii_of(discs):
    return np.array([d["radius_mm"] for d in discs])


def plan(seed, index):
    """Every eighth input is clean; kinds take turns, each through sizes and edges in an order of its own."""
    combinations = [(um, edge) for um in unlisted.SIZES_UM for edge in ("ideal", "rough")]
    if index % 8 == 7:
        return "clean", 0, ("ideal", "rough")[index // 8 % 2]
    turn, kind = divmod(index - index // 8, len(KINDS))
    order = np.random.default_rng([seed, 79, kind]).permutation(len(combinations))
    return KINDS[kind], *combinations[order[turn % len(combinations)]]


def draw_input(program, seed, index, folder):
    """(row, path of the picture, radii of the pins in order)."""
    kind, um, edge = plan(seed, index)
    rng, path = np.random.default_rng([seed, 80, index]), os.path.join(folder, "plate")
    foil_scanner = unlisted.draw_spec(rng, {"rotate_deg": 0.0}, 0.0, edge == "rough")["scanner"]
    spec = plate.plate_spec(rng, foil_scanner, [])
    with open(path + ".json", "w", encoding="utf-8") as out:
        json.dump(spec, out)
    subprocess.run([program, "render", path + ".json", "-o", path + ".png"], check=True)
    side = "clean" if kind == "clean" else "part" if kind in PART else "scanner"
    if kind != "clean":
        picture = cv2.imread(path + ".png", cv2.IMREAD_GRAYSCALE)
        height, width = (n * MM for n in picture.shape)
        field = (displace_by_forms(spec["discs"], form_of(kind, rng, spec["discs"], um / 1000)) if side == "part"
                 else unlisted.scanner_fields(rng, width, height, um / 1000)[kind])  # fmt: skip
        cv2.imwrite(path + ".png", unlisted.warp(picture, field), [cv2.IMWRITE_PNG_COMPRESSION, 1])
    row = {"case": index, "seed": seed, "cause": kind, "side": side, "size_um": um, "edge": edge}
    return row, path + ".png"


def errors_of(discs):
    found = sorted(discs, key=lambda d: d["radius_mm"])
    if len(found) != len(RADII):
        return None, None
    return 1e3 * (np.array([d["radius_mm"] for d in found]) - RADII), 1e3 * np.array([d["u_radius_mm"] for d in found])


def judge(row, report):
    claims, curve = report["claims"], report["unattributed"]
    row["verdict"] = report["verdict"]
    for verdict in ("found", "tied"):
        row[verdict] = "; ".join(c["id"] for c in claims if c["verdict"] == verdict)
    row["alias"] = "; ".join(name for c in claims if c["verdict"] == "tied" for name in c["alias_class"])[:300]
    row["unattributed"] = f"{curve['coordinate']} {curve.get('moves', '')}" if curve else ""
    row["outcome"] = foreign.outcome(unlisted.ALSO_RIGHT.get(row["cause"], set()), claims, curve)
    (before, u), (after, u_after) = (errors_of(report[side]["discs"]) for side in ("before", "after"))
    if before is None or after is None:
        row["verdict"] += ", a pin is missing"
        return
    row["R_before"], row["R_after"] = f"{foreign.rms(before):.4f}", f"{foreign.rms(after):.4f}"
    row["R_max"], row["R_max_after"] = f"{np.max(np.abs(before)):.4f}", f"{np.max(np.abs(after)):.4f}"
    row["u_R_before"] = f"{foreign.rms(u):.4f}"
    row["inside"], row["values"] = int(np.sum(np.abs(after) <= 2 * u_after)), len(after)


def write_known(folder):
    """Path of a design that tells the diameters."""
    path = os.path.join(folder, "known.json")
    with open(path, "w", encoding="utf-8") as out:
        json.dump({"schema": "foilgauge/design/1", "name": "gauges", "form": "discs", "diameters_mm": list(2 * RADII)}, out)
    return path


def run_case(options, index):
    with tempfile.TemporaryDirectory() as folder:
        row, path = draw_input(options.program, options.seed, index, folder)
        own = ["--without", unlisted.OWN_ROW[row["cause"]]] if row["cause"] in unlisted.OWN_ROW else []
        form = ["--design", write_known(folder)] if options.known else ["--form", "discs"]
        report, error, seconds = foreign.run_loop(options.program, [path], 1, DPI, [*form, *own])
    row["seconds"] = f"{seconds:.2f}"
    if report:
        judge(row, report)
    else:
        row["outcome"], row["verdict"] = "error", error
    return row


# ---- the page

HEAD = ("| | inputs | wrong `found` | right | unattributed | honest tie | tie of listed ones | clean | errors | worse | more than twice |"
        " radius, um | largest, um | s |\n|" + "---|" * 14)  # fmt: skip


def is_worse(row, noise, times=1):
    before, after = float(row["R_before"]), float(row["R_after"])
    return after > before + 2 * noise[row["edge"]] and after > times * before


def noise_of(rows):
    clean = {e: [float(r["R_before"]) for r in rows if (r["cause"], r["edge"]) == ("clean", e)] for e in ("ideal", "rough")}
    return {e: np.median(v) if v else 0.0 for e, v in clean.items()}


def group_row(name, rows, noise):
    done = [r for r in rows if r["R_before"]]
    count = [sum(r["outcome"] == o for r in rows) for o in
             ("wrong", "right", "unattributed", "honest tie", "listed tie", "clean", "error")]  # fmt: skip
    median = lambda column: f"{np.median([float(r[column]) for r in done]):.2f}" if done else "-"
    cells = [name, len(rows), *count, sum(is_worse(r, noise) for r in done), sum(is_worse(r, noise, 2) for r in done),
             f"{median('R_before')} → {median('R_after')}", f"{median('R_max')} → {median('R_max_after')}", median("seconds")]  # fmt: skip
    return "| " + " | ".join(map(str, cells)) + " |"


def write_page(options, rows):
    noise, causes = noise_of(rows), [r for r in rows if r["cause"] != "clean"]
    groups = [("all causes", causes), ("clean inputs", [r for r in rows if r["cause"] == "clean"])]
    groups += [(k, [r for r in rows if r["cause"] == k]) for k in KINDS if any(r["cause"] == k for r in rows)]
    groups += [(f"{um} um", [r for r in causes if r["size_um"] == str(um)]) for um in unlisted.SIZES_UM]
    groups += [(f"{e} edges", [r for r in causes if r["edge"] == e]) for e in ("ideal", "rough")]
    lines = [
        f"# The loop on plates {'of known diameters ' if options.known else ''}whose cause no row names\n",
        f"Renders of twelve pins of 1 to 7 mm without an effect, {DPI} dpi, that are warped by a field of the scanner (those of"
        " loop_unlisted.md) or by\nforms of the pins: each its own lobes, a flat on each, lobes that are alike on all, a burr on"
        " one. Sizes are 3, 8, 20 um. Every eighth input is clean.\nA kind that has a row in the list is measured without it"
        " (`--without`). Errors of the radius are medians of the inputs' rms. Worse: beyond the\nerror before by more than twice that of"
        " clean plates. s: seconds of the processor, while other work ran beside.\n",
        *(["The design tells the pins' diameters, which are exact.\n"] if options.known else []),
        f"    /usr/bin/python3 tests/bench/loop_plate_unlisted.py build/foilgauge --cases {len(rows)} --seed {options.seed}"
        f"{' --known' if options.known else ''}\n",
        HEAD, *[group_row(name, own, noise) for name, own in groups],
        "\n## Wrong `found`\n", "| case | truth | size, um | edges | found | radius, um |\n|" + "---|" * 6,
    ]  # fmt: skip
    for r in (r for r in rows if r["outcome"] == "wrong"):
        cells = [r["case"], r["cause"], r["size_um"], r["edge"], r["found"], f"{r['R_before']} → {r['R_after']}"]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    with open(options.out, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, default=110)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--csv")
    parser.add_argument("--out")
    parser.add_argument("--known", action="store_true", help="the design tells the pins' diameters")
    parser.add_argument("--fresh", action="store_true", help="forget the inputs of this seed that the CSV has")
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    page = "reports/loop_plate_known" if options.known else "reports/loop_plate_unlisted"
    options.csv, options.out = options.csv or page + ".csv", options.out or page + ".md"
    foreign.work_on_all(options, lambda index: run_case(options, index), FIELDS)
    write_page(options, foreign.rows_of(options))


if __name__ == "__main__":
    main()
