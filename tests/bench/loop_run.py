# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders one case, runs `foilgauge loop` on it, and sets the answer against the truth: the measurand, circles through
the part as it is."""

import hashlib
import json
import os
import subprocess
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from kept_rows import append_row, forget_seeds, read_rows
from loop_foil import Midline, measurand_of, profile_error_um

MM_PER_PX = 25.4 / 4800
NOT_MEASURED_UM = 1e3  # as bad as a millimetre


def render(program, folder, specs):
    paths = []
    for k, spec in enumerate(specs):
        base = os.path.join(folder, f"s{k}")
        with open(base + ".json", "w", encoding="utf-8") as f:
            json.dump(spec, f)
        subprocess.run([program, "render", base + ".json", "-o", base + ".png"], check=True)
        paths.append(base + ".png")
    return paths


def kept(draw, folder_of_pictures):
    """A renderer that looks first whether it has drawn a spec before: programs are compared on the same pictures."""

    def draw_or_find(program, folder, specs):
        paths = []
        for k, spec in enumerate(specs):
            text = draw.__name__ + json.dumps(spec, sort_keys=True)
            own = os.path.join(folder_of_pictures, hashlib.sha256(text.encode()).hexdigest()[:24] + ".png")
            if not os.path.exists(own):
                with tempfile.TemporaryDirectory(dir=folder_of_pictures) as fresh:
                    os.replace(draw(program, fresh, [spec])[0], own)
            paths.append(os.path.join(folder, f"s{k}.png"))
            if os.path.lexists(paths[-1]):
                os.remove(paths[-1])
            os.symlink(own, paths[-1])
        return paths

    return draw_or_find


def write_design(folder, design):
    path = os.path.join(folder, "design.json")
    with open(path, "w", encoding="utf-8") as f:
        json.dump({"schema": "foilgauge/design/1", **design}, f)
    return path


def run_timed(command):
    """(exit status, seconds): the clock's, or the processor's where those are less, as other inputs are worked on beside."""
    start = time.monotonic()
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, min(time.monotonic() - start, used.ru_utime + used.ru_stime)


def run_loop(program, folder, case, more=(), draw=render):
    """(report or None, exit status, seconds). draw: who renders."""
    paths = draw(program, folder, case["specs"])
    out = os.path.join(folder, "loop.json")
    options = ["--same-foil"] if case["same_foil"] else []
    command = [program, "loop", *options, *paths, "--design", write_design(folder, case["design"])]
    code, seconds = run_timed([*command, "-o", out, *more])
    if not os.path.exists(out):
        return None, code, seconds
    with open(out, encoding="utf-8") as f:
        return json.load(f), code, seconds


def measured_foils(program, folder, case, draw=render):
    """Foils that `measure` reports of every scan, or None."""
    paths, out = draw(program, folder, case["specs"]), os.path.join(folder, "measure.json")
    command = [program, "measure", *paths, "--design", write_design(folder, case["design"]), "-o", out]
    subprocess.run(command, stderr=subprocess.DEVNULL)
    if not os.path.exists(out):
        return None
    with open(out, encoding="utf-8") as f:
        report = json.load(f)
    return [foil for scan in report.get("scans", [report]) for foil in scan["foils"]]


def true_foils(case):
    """(midline with its measurand, O on the scan in mm, which scan) of every foil, scans in order."""
    foils = []
    for k, spec in enumerate(case["specs"]):
        for foil in spec["foils"]:
            midline = Midline(foil, case["design"])
            deviation_um = lambda m, effects=spec.get("effects", []): m.part_shift_um(effects)
            midline.measurand = measurand_of(foil, case["design"], deviation_um)
            foils.append((midline, np.array(foil["centre_mm"]), k))
    return foils


def pair_foils(case, measured):
    """Measured foils in the order of the true ones: of a scan that shows several, the nearest by O. None
    where a foil, or a bump of it, was not measured."""
    true = true_foils(case)
    if len(measured) != len(true):
        return None
    result = []
    at = 0
    for k, spec in enumerate(case["specs"]):
        own = measured[at : at + len(spec["foils"])]
        at += len(spec["foils"])
        for midline, centre, _ in (t for t in true if t[2] == k):
            far = [np.hypot(*(np.array(f["overall"]["centre_mm"] or [1e9, 1e9]) - centre)) for f in own]
            foil = own[int(np.argmin(far))]
            if len(foil["bumps"]) != midline.count or any(b["radius_mm"] is None for b in foil["bumps"]):
                return None
            result.append((midline, centre, foil))
    return result


def pair_bumps(midline, centre, foil):
    """(index, measured bump): the nearest by centre."""
    for i in range(midline.count):
        axis = np.array([np.cos(midline.axis[i]), np.sin(midline.axis[i])])
        place = midline.to_scan(midline.distance[i] * axis[None])[0] + centre
        yield i, min(foil["bumps"], key=lambda b: np.hypot(*(np.array(b["centre_mm"]) - place)))


def errors_um(pairs):
    """rms over all bumps of R and h, over all foils of R0."""
    if pairs is None:
        return dict.fromkeys(("R", "h", "R0"), NOT_MEASURED_UM)
    radius, height, overall = [], [], []
    for midline, centre, foil in pairs:
        for i, bump in pair_bumps(midline, centre, foil):
            radius.append(bump["radius_mm"] - midline.measurand.radius[i])
            height.append(bump["height_mm"] - midline.measurand.height[i])
        overall.append(foil["overall"]["radius_mm"] - midline.measurand.overall)
    rms = lambda v: float(1000 * np.sqrt(np.mean(np.square(v))))
    return {"R": rms(radius), "h": rms(height), "R0": rms(overall)}


def profile_um(case, pairs, report):
    """rms over foils; report: whose claims deviate from the circles, None for none."""
    if pairs is None:
        return NOT_MEASURED_UM
    squares = []
    for midline, centre, foil in pairs:
        shift = midline.part_shift_um(case["effects"])
        squares.append(profile_error_um(midline, centre, shift, foil, report) ** 2)
    return float(np.sqrt(np.mean(squares)))


def ranges(pairs):
    """Number of reported ranges that hold the truth: {R, h, R0: (held, stated)}."""
    count = {"R": [0, 0], "h": [0, 0], "R0": [0, 0]}

    def look(name, circle, member, truth):
        if member in circle:
            low, high = circle[member]
            count[name][1] += 1
            count[name][0] += low <= truth <= high

    for midline, centre, foil in pairs or []:
        for i, bump in pair_bumps(midline, centre, foil):
            look("R", bump, "radius_range_mm", midline.measurand.radius[i])
            look("h", bump, "height_range_mm", midline.measurand.height[i])
        look("R0", foil["overall"], "radius_range_mm", midline.measurand.overall)
    return count


def within(pairs):
    """Number of values within U = 2 u of the truth: {R, h, R0: (held, all)}."""
    count = {"R": [0, 0], "h": [0, 0], "R0": [0, 0]}

    def look(name, value, u, truth):
        count[name][1] += 1
        count[name][0] += abs(value - truth) <= 2 * u

    for midline, centre, foil in pairs or []:
        for i, bump in pair_bumps(midline, centre, foil):
            look("R", bump["radius_mm"], bump["u_radius_mm"], midline.measurand.radius[i])
            look("h", bump["height_mm"], bump["u_height_mm"], midline.measurand.height[i])
        overall = foil["overall"]
        look("R0", overall["radius_mm"], overall["u_radius_mm"], midline.measurand.overall)
    return count


def form_errors(pairs):
    """Form errors of lands and bumps: how many lie within U = 2 u, how many ranges, in place of a value, hold the truth:
    {column: (held, stated)}."""
    count = {"form_within": [0, 0], "form_ranges_hold": [0, 0]}

    def look(circle, truth_um):
        um = circle.get("form_error_um")
        if um is not None:
            count["form_within"][0] += abs(um - truth_um) <= 2 * circle["u_form_error_um"]
            count["form_within"][1] += 1
        elif "form_error_range_um" in circle:
            low, high = circle["form_error_range_um"]
            count["form_ranges_hold"][0] += low <= truth_um <= high
            count["form_ranges_hold"][1] += 1

    for midline, centre, foil in pairs or []:
        look(foil["overall"], midline.measurand.overall_form_um)
        for i, bump in pair_bumps(midline, centre, foil):
            look(bump, midline.measurand.form_um[i])
    return count


def as_told(effects):
    """The names by which a class tells effects: a curve of the glass with the axis that it moves, "free.scan.y.dx"."""
    moved = lambda e: f".d{e['moves']}" if e["id"].startswith("free.scan.") and "moves" in e else ""
    return frozenset(e["id"] + moved(e) for e in effects)


def judge_names(report, wanted, told):
    """named: the claims are the true effects, and no others. in_class: the true effects together are one of the
    explanations that the report says it cannot tell apart, by their names or as they are told. Curves count as
    `unattributed`."""
    if "scan.carriage_quadratic" in wanted:  # about another middle it is the scale
        wanted = [w for w in wanted if w != "scan.scale_y"]
    if "scan.optical_cubic" in wanted:  # about another middle it is the quadratic
        wanted = [w for w in wanted if w != "scan.optical_quadratic"]
    claims = [c["id"] for c in report["claims"]]
    curve = report["unattributed"]
    said = sorted(claims + (["free." + curve["coordinate"]] if curve else []))
    named = said == wanted
    tied = [*report["claims"], *([curve] if curve else [])]
    classes = {frozenset(member.split(" + ")) for c in tied for member in c.get("alias_class", [])}
    curves = [curve, *curve.get("others", [])] if curve else []
    places = ["free." + c["coordinate"] for c in curves] + [m for c in classes if curve and len(c) == 1 for m in c]
    right = any(place.startswith(w) for place in places for w in wanted if w.startswith("free."))
    return {
        "claims": " + ".join(claims),
        "class": " | ".join(sorted(" + ".join(sorted(m)) for m in classes)),
        "unattributed": curve["coordinate"] + ":" + str(curve.get("moves")) if curve else "",
        "tied": int(any(c["verdict"] == "tied" for c in report["claims"])),
        "named": int(named),
        "in_class": int(named or frozenset(wanted) in classes or told in classes),
        "right_coordinate": int(right),
    }


def judge(case, report, code, seconds):
    wanted = sorted(e["id"] for e in case["effects"])
    row = {"wanted": " + ".join(wanted), "exit": code, "seconds": round(seconds, 2)}
    if report is None:
        blank = {"claims": "", "class": "", "unattributed": "", "tied": 0, "named": 0, "in_class": 0}
        blank["right_coordinate"] = 0
        row.update(verdict="failed", **blank)
        before = after = None
    else:
        row.update(verdict=report["verdict"], **judge_names(report, wanted, as_told(case["effects"])))
        before, after = (pair_foils(case, report[side]["foils"]) for side in ("before", "after"))
    for name, pairs in (("before", before), ("after", after)):
        for quantity, error in errors_um(pairs).items():
            row[f"{quantity}_{name}_um"] = float(f"{error:.5g}")
        claims = report if name == "after" else None
        row[f"profile_{name}_um"] = float(f"{profile_um(case, pairs, claims):.5g}")
    for quantity, (held, stated) in ranges(after).items():
        row[f"{quantity}_ranges"] = stated
        row[f"{quantity}_ranges_hold"] = held
    for name, pairs in (("before", before), ("after", after)):
        for quantity, (held, count) in within(pairs).items():
            row[f"{quantity}_within_{name}"] = round(held / count, 4) if count else 0
    for column, (held, stated) in form_errors(after).items():
        row[column.replace("_hold", "").replace("_within", "_errors")] = stated
        row[column] = held
    row["effects"] = json.dumps(case["effects"], separators=(",", ":"))
    return row


class Results:
    """A CSV that grows by a row as each case is done; cases that it holds already are not done again. With `fresh` it
    forgets those of `seeds`."""

    def __init__(self, path, fresh, seeds, column):
        self.path, self.lock = path, threading.Lock()
        if fresh:
            forget_seeds(path, seeds)
        self.rows = read_rows(path)
        if self.rows and column not in self.rows[0]:
            raise SystemExit(f"{path}: has no column {column}: another benchmark's; move it away, and run all seeds again")

    def has(self, **key):
        return any(all(row[k] == str(v) for k, v in key.items()) for row in self.rows)

    def add(self, row):
        with self.lock:
            append_row(self.path, row, list(row))
            self.rows.append({k: str(v) for k, v in row.items()})

    def run(self, jobs, work, threads):
        """jobs: keys as dicts; work(key) gives the rest of the row."""
        todo = [key for key in jobs if not self.has(**key)]
        print(f"{len(jobs) - len(todo)} done, {len(todo)} to do", flush=True)

        def one(key):
            self.add({**key, **work(key)})

        with ThreadPoolExecutor(threads) as pool:
            for n, _ in enumerate(pool.map(one, todo), 1):
                if n % 20 == 0:
                    print(f"{n} of {len(todo)}", flush=True)


def add_options(parser, tiers, out):
    """Those that the benchmarks on rough edges share."""
    parser.add_argument("--tier", action="append", choices=tiers)
    parser.add_argument("--seed", action="append", type=int)
    parser.add_argument("--all", action="store_true", help="the seed that is kept aside too")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--fresh", action="store_true", help="forget the inputs of these seeds that the CSV has")
    parser.add_argument("--report-only", action="store_true")
    parser.add_argument("--pictures", help="a folder that keeps what was rendered, for other programs")
    parser.add_argument("--out", default=out)
