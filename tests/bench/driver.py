#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scans as a scanner's driver makes them: the measured values, whether U holds the truth, the messages, and the
verdicts. Writes reports/driver.md.

Foils and pins of known size are drawn by two renderers (driver_kinds.py) with 21 kinds of what drivers and light do,
each in three strengths, of three seeds, at two resolutions; every third part is too thick by 8.5 um. A value is flagged
where its foil or disc has a flag that the plain scan of the same part has not, or where it is withheld.

  driver.py build/foilgauge                          all of it
  driver.py build/foilgauge --third                  every strength by one seed of three
  driver.py build/foilgauge --quick                  a sixth
  driver.py build/foilgauge --kinds unsharp,levels   single kinds
  driver.py build/foilgauge --show unsharp           and every value of them
  driver.py build/foilgauge --kinds plain            plain scans only"""

import argparse
import csv
import hashlib
import json
import math
import multiprocessing
import os
import subprocess
import sys
import tempfile

import numpy as np

import driver_kinds as kinds
import driver_report
import other_scanner

BUMP = {"R": "radius_mm", "h": "height_mm", "alpha": "bump_angle_deg", "clearance": "clearance_mm"}
LIMITED = {"thickness_mm": "thickness", "clearance_mm": "clearance", "diameter_mm": "diameter"}
OPTIONS = {"micrometer": "--thickness-measured", "leaf": "--gauge"}  # the variants that need one
NOT_FLAGS = {"out_of_tolerance"}
COLUMNS = ("variant renderer part kind strength seed dpi quantity index true value u flagged verdict wrong flags").split()


# --- cases ----------------------------------------------------------------------------------


def is_in_third(kind_index, strength, seed):
    """Every strength by one seed of three, which differs from kind to kind."""
    return seed % 3 == (strength + kind_index) % 3


def is_in_sample(kind_index, strength, seed, dpi_index, renderer_index):
    """Half of the third: either renderer at one resolution."""
    return is_in_third(kind_index, strength, seed) and (dpi_index + renderer_index + kind_index) % 2 == 0


def is_asked(share, part, in_third, sample):
    """Of the sixth, the third or all foils with a third of the pins."""
    return sample or (share == "third" and in_third) or (share == "all" and (part == "foils" or in_third))


def cases_of(names, seeds, share, parts):
    """Foils of every kind, and pins for a third of them. `sample`: of the sixth."""
    result = []
    for i, kind in enumerate(kinds.KINDS):
        if names and kind.name not in names:
            continue
        for part in parts[:1] if kind.foils_only else parts:
            for r, renderer in enumerate(kind.renderers):
                for d, dpi in enumerate(kinds.DPI):
                    for s, strength in enumerate(kinds.STRENGTHS):
                        for seed in range(seeds):
                            sample = is_in_sample(i, s, seed, d, r + (len(kind.renderers) == 1))
                            if is_asked(share, part, is_in_third(i, s, seed), sample):
                                result.append({"kind": kind.name, "part": part, "renderer": renderer, "dpi": dpi,
                                               "seed": seed, "strength": strength, "sample": sample})  # fmt: skip
    return result


# --- pictures -------------------------------------------------------------------------------


class NotDrawn(Exception):
    """The renderer knows no such member."""


def render_program(program, spec, path):
    base = path[:-4] + ".spec.json"
    with open(base, "w", encoding="utf-8") as file:
        json.dump(kinds.for_program(spec), file)
    done = subprocess.run([program, "render", base, "-o", path], capture_output=True, text=True)
    os.remove(base)
    if done.returncode == 65:
        raise NotDrawn(done.stderr.split(" is {")[0].split(" is [")[0].strip())
    done.check_returncode()


def picture(program, cache, spec, renderer):
    """Drawn once for all runs: by the hash of what the renderer is told."""
    told = kinds.for_program(spec) if renderer == "program" else kinds.for_other(spec)
    text = json.dumps([renderer, told], sort_keys=True)
    path = os.path.join(cache, hashlib.sha256(text.encode()).hexdigest()[:24] + ".png")
    if not os.path.exists(path):
        fresh = f"{path[:-4]}.{os.getpid()}.png"
        if renderer == "program":
            render_program(program, spec, fresh)
        else:
            other_scanner.render_other(told, fresh)
        os.replace(fresh, path)
    return path


# --- measuring ------------------------------------------------------------------------------


def measure(program, folder, path, spec, words=()):
    """(the report or None, the messages on standard error)."""
    with open(os.path.join(folder, "design.json"), "w", encoding="utf-8") as file:
        json.dump(kinds.design_of(spec), file)
    out = os.path.join(folder, "out.json")
    if os.path.exists(out):
        os.remove(out)
    command = [program, "measure", path, "-d", os.path.join(folder, "design.json"), "-o", out, "--threads", "1", *words]
    done = subprocess.run(command, capture_output=True, text=True)
    if "OpenCV cannot be loaded" in done.stderr:
        raise RuntimeError(done.stderr.strip())  # every disc would count as withheld
    if not os.path.exists(out):
        return None, done.stderr.strip()
    with open(out, encoding="utf-8") as file:
        return json.load(file), done.stderr.strip()


def foil_of(report):
    """The foil with bumps; a leaf beside it may be listed, too."""
    foils = [f for f in report["foils"] if len(f.get("bumps") or []) == kinds.BUMPS and f["thickness_mm"] is not None]
    return foils[0] if foils else None


def in_order(foil, truth):
    """Bumps as the truth counts them: without a lip the number is a convention only."""
    bumps = foil["bumps"]
    miss = lambda b: sum(abs((x["radius_mm"] or 0) - truth["R", k]) for k, x in enumerate(b))
    return bumps[::-1] if "no_lip" in foil["flags"] and miss(bumps[::-1]) < miss(bumps) else bumps


def verdicts_of(judgements, number):
    return {(LIMITED[j["quantity"]]): j["verdict"] for j in judgements or []
            if j["quantity"] in LIMITED and j.get("bump", number) in (number, None)}  # fmt: skip


def of_foil(report, truth):
    """{(quantity, index): (value, u, flags, verdict)}"""
    foil = foil_of(report)
    if foil is None:
        return {key: (None, None, {"not_measured"}, None) for key in truth}
    flags, strip = set(foil["flags"]), verdicts_of(foil["judgements"], 0)
    found = {("thickness", 0): (foil["thickness_mm"], foil["u_thickness_mm"], flags, strip.get("thickness")),
             ("R0", 0): (foil["overall"]["radius_mm"], foil["overall"]["u_radius_mm"], flags, None)}  # fmt: skip
    for k, bump in enumerate(in_order(foil, truth)):
        own = verdicts_of(foil["judgements"], bump["number"])
        for short, name in BUMP.items():
            verdict = own.get(short) if short == "clearance" else None
            found[short, k] = (bump[name], bump["u_" + name], flags | set(bump["flags"]), verdict)
    return found


def of_discs(report, spec, truth):
    found = {}
    for k, true in enumerate(spec["discs"]):
        near = [d for d in report["discs"] if d["centre_mm"] and d["radius_mm"]
                and math.dist(d["centre_mm"], true["centre_mm"]) < 0.2]  # fmt: skip
        if len(near) != 1:
            found["diameter", k] = (None, None, {"not_measured"}, None)
            continue
        disc = near[0]
        verdict = verdicts_of(disc.get("judgements"), None).get("diameter")
        found["diameter", k] = (2 * disc["radius_mm"], 2 * disc["u_radius_mm"], set(disc["flags"]), verdict)
    return found


def found_in(report, spec, truth):
    if report is None:
        return {key: (None, None, {"not_measured"}, None) for key in truth}
    return of_discs(report, spec, truth) if spec.get("discs") else of_foil(report, truth)


def true_verdict(key, true, design):
    """Of a limit that the truth keeps or does not; None where there is none."""
    name = {short: long for long, short in LIMITED.items()}.get(key[0])
    if name is None or name not in design["tolerances"]:
        return None
    limit = design["tolerances"][name]
    return "pass" if limit.get("min", -math.inf) <= true <= limit.get("max", math.inf) else "fail"


def rows_of(case, variant, spec, report, plain_flags):
    truth, design = kinds.truth_of(spec), kinds.design_of(spec)
    found, rows = found_in(report, spec, truth), []
    for key, true in truth.items():
        value, u, flags, verdict = found[key]
        new = flags - plain_flags.get(key, set()) - NOT_FLAGS
        right = true_verdict(key, true, design)
        rows.append({**case, "variant": variant, "quantity": key[0], "index": key[1], "true": true, "value": value, "u": u,
                     "flagged": int(bool(new) or value is None or u is None), "verdict": verdict or "",
                     "wrong": int(verdict in ("pass", "fail") and verdict != right),
                     "flags": " ".join(sorted(new))})  # fmt: skip
    return rows


def words_of(variant, spec):
    """Options that state the user's known value, which is off by its own uncertainty."""
    if variant == "micrometer":
        rng = np.random.default_rng([32, spec["seed"]])
        value = spec["foils"][0]["design"]["thickness_mm"] + kinds.U_KNOWN_MM * rng.standard_normal()
        return ["--thickness-measured", f"{value:.5f}:{kinds.U_KNOWN_MM}"]
    return ["--gauge", f"leaf:{kinds.LEAF_MM}:{kinds.U_KNOWN_MM}"] if variant == "leaf" else []


def work(job):
    """Rows of one case in every variant that is asked for; a message where the renderer cannot draw it."""
    case, options = job
    rows = []
    try:
        with tempfile.TemporaryDirectory() as folder:
            has_variants = case["part"] == "foils" and (case["sample"] or options["known_all"])
            for variant in options["variants"] if has_variants else ["scan"]:
                own = {**case, "leaf": variant == "leaf"}
                specs = [kinds.spec_of(own, is_plain) for is_plain in (False, True)]
                cache = options["cache"] or folder
                paths = [picture(options["renderer"], cache, spec, case["renderer"]) for spec in specs]
                words = words_of(variant, specs[0])
                flags = {}
                if case["kind"] != "plain":
                    plain, _ = measure(options["program"], folder, paths[1], specs[1], words_of(variant, specs[1]))
                    flags = {k: v[2] for k, v in found_in(plain, specs[1], kinds.truth_of(specs[1])).items()}
                report, _ = measure(options["program"], folder, paths[0], specs[0], words)
                rows += rows_of({**case, "known": has_variants}, variant, specs[0], report, flags)
    except NotDrawn as missing:
        return [], f"{case['kind']} ({case['renderer']}): {str(missing).split(': ', 2)[-1]}"
    return rows, None


# --- the run --------------------------------------------------------------------------------


def variants_of(program, asked):
    """Variants that were asked for and whose option the program's own help lists."""
    text = subprocess.run([program, "measure", "--help"], capture_output=True, text=True).stdout
    return ["scan"] + [v for v, option in OPTIONS.items() if option in text and v in asked]


def run(cases, options, jobs):
    rows, missing = [], set()
    with multiprocessing.Pool(jobs) as pool:
        for k, (own, message) in enumerate(pool.imap_unordered(work, [(case, options) for case in cases], 1)):
            rows += own
            missing |= {message} if message else set()
            if sys.stderr.isatty() or k % 50 == 49:
                print(f"{k + 1} of {len(cases)} scans", file=sys.stderr, flush=True)
    order = {name: i for i, name in enumerate([k.name for k in kinds.KINDS] + ["plain"])}
    rows.sort(key=lambda r: (r["variant"], order[r["kind"]], r["part"], r["renderer"], r["dpi"], r["strength"], r["seed"]))
    return rows, sorted(missing)


def write_csv(path, rows):
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--renderer", help="the program that draws [PROGRAM]")
    parser.add_argument("--before", help="a build to compare plain scans with")
    parser.add_argument("--kinds", default="", help="of " + ",".join(k.name for k in kinds.KINDS))
    parser.add_argument("--show", default="", help="as --kinds, and print every value")
    parser.add_argument("--parts", default="foils,discs")
    parser.add_argument("--strengths", default=",".join(kinds.STRENGTHS))
    parser.add_argument("--variants", default="micrometer,leaf", help="beside the scan alone")
    parser.add_argument("--known-all", action="store_true", help="variants of all cases [of a sixth]")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--clean", type=int, default=200, help="plain scans")
    parser.add_argument("--third", action="store_const", dest="share", const="third", default="all", help="a third of the cases")
    parser.add_argument("--quick", action="store_const", dest="share", const="sixth",
                        help="a sixth of the cases, a quarter of the plain scans")  # fmt: skip
    parser.add_argument("--cache", help="folder where pictures are kept [none are]")
    parser.add_argument("--csv", help="every value")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("-o", default=os.path.join(driver_report.lib.ROOT, "reports", "driver.md"))
    return parser.parse_args()


def main():
    options = read_options()
    names = [n for n in (options.show or options.kinds).split(",") if n]
    cases = cases_of(names, options.seeds, options.share, options.parts.split(","))
    cases = [case for case in cases if case["strength"] in options.strengths.split(",")]
    told = {"program": options.program, "renderer": options.renderer or options.program, "cache": options.cache,
            "known_all": options.known_all, "variants": variants_of(options.program, options.variants.split(","))}  # fmt: skip
    if options.cache:
        os.makedirs(options.cache, exist_ok=True)
    rows, missing = run(cases, told, options.jobs)
    if options.show:
        print(driver_report.every_value(rows))
    clean, count = None, options.clean // 4 if options.share == "sixth" else options.clean
    if names in ([], ["plain"]) and count:
        import driver_clean  # it measures by this module

        clean = driver_clean.run(count, told, options.before, options.jobs)
    page = driver_report.page(rows, clean, missing, options)
    with open(options.o, "w", encoding="utf-8") as file:
        file.write(page)
    if options.csv:
        write_csv(options.csv, rows)
    print(page)


if __name__ == "__main__":
    main()
