#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Accuracy of `foilgauge measure` against known truth: rms error, ratio to the bound, bias, coverage.

Renders foils with `foilgauge render` from seeded specs, measures each, compares with the truth and
writes one table per tier. With --scans it measures scans that are there already.
"""

import argparse
import csv
import glob
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile

import numpy as np

import benchlib
from accuracy_specs import TIERS

HERE = os.path.dirname(os.path.abspath(__file__))
QUANTITIES = ("R", "h", "alpha", "theta", "R0")
UNITS = {"R": "µm", "h": "µm", "alpha": "deg", "theta": "deg", "R0": "µm"}
BOUND_FLOOR_UM = 0.05  # below this the bound of R is not asked for
GROSS_UM = 25.0  # an error of R beyond this is a wrong arc, not noise


# --- one foil -------------------------------------------------------------------------------


def measure(program, scan, design):
    """(foil, what went wrong). One foil is expected."""
    command, fine = [benchlib.FOILGAUGE, "measure"], (0, 1, 2)
    if program != "foilgauge":
        command, fine = ["/usr/bin/python3", os.path.join(HERE, f"peer_{program}.py")], (0,)
    done = subprocess.run(command + [scan, "--design", design], capture_output=True, text=True)
    if done.returncode not in fine:
        return None, f"exit code {done.returncode}: {done.stderr.strip()[-160:]}"
    foils = json.loads(done.stdout)["foils"]
    if len(foils) != 1:
        return None, f"{len(foils)} foils found"
    return foils[0], ""


def known(item, name):
    """A number of a report; NaN where it says null or, as the peers, nothing."""
    value = item.get(name)
    return float("nan") if value is None else value


def uncertainties(foil, truth):
    pairs = benchlib.match(foil, truth)
    result = {
        short: np.array([known(b, f"u_{name}") * factor for b, _ in pairs])
        for name, short, _, factor in benchlib.BUMP_QUANTITIES
    }
    result["R0"] = np.array([known(foil["overall"], "u_radius_mm") * 1000.0])
    return result


def judge(record, foil, truth):
    """Fills error, u and bound of a record, or says why there is none."""
    wrong = benchlib.errors(foil, truth)
    if wrong is None:
        flags = ", ".join(foil.get("flags", []))
        count = f"{len(foil['bumps'])} of {len(truth['bumps'])} bumps"
        record["failure"] = f"{count}; flags: {flags or 'none'}; {foil.get('error') or ''}".rstrip("; ")
        return record
    bits = int(record["bits"])
    sigma = benchlib.edge_bound_px(
        record["blur_px"], record["contrast"], record["noise"], 16 if bits == 16 else 8
    )
    record["error"] = wrong
    record["u"] = uncertainties(foil, truth)
    record["bound"] = benchlib.foil_bounds(truth, sigma, end_lands_mm=record.get("end_lands_mm", (0, 0)))
    record["flags"] = foil.get("flags", [])
    # An effect of the scanner changes R; that is no gross error of an arc.
    if "scan." not in record.get("effects", "") and np.max(np.abs(wrong["R"])) > GROSS_UM:
        k = int(np.argmax(np.abs(wrong["R"])))
        record["gross"] = f"bump {k + 1}: R off by {wrong['R'][k]:.1f} µm"
    return record


def render_and_measure(job):
    tier, index, seed, folder, program = job
    spec, record = TIERS[tier].make(np.random.default_rng([seed, index]), index)
    stem = os.path.join(folder, f"{tier}-{index}")
    paths = {name: stem + ext for name, ext in
             (("spec", ".spec.json"), ("scan", ".png"), ("truth", ".truth.json"), ("design", ".design.json"))}
    record.update(tier=tier, index=index, name=f"{tier} {index}")
    try:
        with open(paths["spec"], "w", encoding="utf-8") as file:
            json.dump(spec, file)
        done = subprocess.run(
            [benchlib.FOILGAUGE, "render", paths["spec"], "-o", paths["scan"], "--truth", paths["truth"]],
            capture_output=True,
            text=True,
        )
        if done.returncode:
            record["failure"] = f"render: exit code {done.returncode}: {done.stderr.strip()[:200]}"
            return record
        truth = benchlib.load_truth(paths["truth"])
        benchlib.write_design(truth, paths["design"])
        foil, failure = measure(program, paths["scan"], paths["design"])
        if foil is None:
            record["failure"] = failure
            return record
        return judge(record, foil, truth)
    finally:
        for path in paths.values():
            if os.path.exists(path):
                os.remove(path)


def measure_shared(program, scan, folder):
    truth = benchlib.load_truth(scan[: -len(".png")] + ".truth.json")
    facts = truth["scan"]
    bits = facts.get("bits") or (16 if "16bit" in os.path.basename(scan) else 8)
    record = {key: facts[key] for key in ("blur_px", "noise", "contrast")}
    record.update(tier="scans", name=os.path.basename(scan), bits=bits, index=0)
    record["effects"] = ", ".join(effect["id"] for effect in truth["effects"])
    design = os.path.join(folder, "design.json")
    benchlib.write_design(truth, design)
    foil, failure = measure(program, scan, design)
    if foil is None:
        record["failure"] = failure
        return record
    return judge(record, foil, truth)


# --- figures of a set -----------------------------------------------------------------------


def pooled(records, field, quantity):
    parts = [r[field][quantity] for r in records if "error" in r]
    return np.concatenate(parts) if parts else np.array([])


def floored(bound, quantity):
    return np.maximum(bound, BOUND_FLOOR_UM) if quantity == "R" else bound


def figures(records, quantity):
    """rms, bound, ratio, bias with its standard error, coverage of value ± 1.96 u, largest error."""
    error, u = pooled(records, "error", quantity), pooled(records, "u", quantity)
    bound = floored(pooled(records, "bound", quantity), quantity)
    if not error.size:
        return None
    stated = np.isfinite(u)
    covered = np.abs(error[stated]) <= 1.96 * u[stated]
    return {
        "rms": benchlib.rms(error),
        "bound": benchlib.rms(bound),
        "ratio": benchlib.rms(error) / benchlib.rms(bound),
        # Each error in units of its own bound: one bad foil with little noise cannot hide here.
        "normal": benchlib.rms(error / bound),
        "bias": float(np.mean(error)),
        "u_bias": float(np.std(error) / np.sqrt(error.size)),
        "coverage": 100.0 * float(np.mean(covered)) if stated.any() else float("nan"),
        "largest": float(np.max(np.abs(error))),
        "count": int(error.size),
    }


HEADER = ["what", "n", "rms", "bound", "rms / bound", "rms of error / bound", "bias ± se", "coverage %", "largest"]


def per_cent(value, decimals):
    return f"{value:.{decimals}f}" if np.isfinite(value) else "–"


def figure_row(label, f):
    if f is None:
        return [label] + ["–"] * (len(HEADER) - 1)
    n = benchlib.number
    bias = f"{n(f['bias'], 2)} ± {n(f['u_bias'], 1)}"
    cells = [f["count"], n(f["rms"]), n(f["bound"]), f"{f['ratio']:.2f}", f"{f['normal']:.2f}"]
    return [label] + cells + [bias, per_cent(f["coverage"], 1), n(f["largest"])]


SUBSETS = [
    ("blur 0.7–1.2 px", lambda r: r["blur_px"] < 1.2),
    ("blur 1.2–2 px", lambda r: 1.2 <= r["blur_px"] < 2),
    ("blur 2–3 px", lambda r: r["blur_px"] >= 2),
    ("noise below 1", lambda r: r["noise"] < 1),
    ("noise 1 and above", lambda r: r["noise"] >= 1),
    ("light on dark", lambda r: r["contrast"] > 0),
    ("dark on light", lambda r: r["contrast"] < 0),
    ("8 bit", lambda r: r["bits"] == 8),
    ("16 bit", lambda r: r["bits"] == 16),
    ("gamma below 0.8", lambda r: r.get("gamma", 1) < 0.8),
    ("gamma 0.8–1.25", lambda r: 0.8 <= r.get("gamma", 1) <= 1.25),
    ("gamma above 1.25", lambda r: r.get("gamma", 1) > 1.25),
    ("rotation 0–90°", lambda r: r["rotate_deg"] % 360 < 90),
    ("rotation 90–180°", lambda r: 90 <= r["rotate_deg"] % 360 < 180),
    ("rotation 180–270°", lambda r: 180 <= r["rotate_deg"] % 360 < 270),
    ("rotation 270–360°", lambda r: r["rotate_deg"] % 360 >= 270),
    ("one hand", lambda r: not r["mirror"]),
    ("the other hand", lambda r: r["mirror"]),
    ("side wall", lambda r: r.get("side_wall")),
    ("no side wall", lambda r: not r.get("side_wall")),
    ("clipped white", lambda r: r.get("clipped")),
    ("JPEG blocks", lambda r: r.get("jpeg")),
]


def write_tier(out, name, records):
    measured = [r for r in records if "error" in r]
    out.write(f"\n## {TIERS[name].title}\n\n{TIERS[name].text}\n\n")
    out.write(f"{len(measured)} of {len(records)} foils measured with every bump.\n\n")
    rows = [figure_row(f"{q} ({UNITS[q]})", figures(measured, q)) for q in QUANTITIES]
    out.write(benchlib.table(HEADER, rows))
    for quantity in ("R", "h"):
        rows = []
        for label, belongs in SUBSETS:
            part = [r for r in measured if belongs(r)]
            if not part or len(part) == len(measured):
                continue  # a subset that is none says nothing
            rows.append(figure_row(label, figures(part, quantity)))
        out.write(f"\n{quantity} ({UNITS[quantity]}) by subset:\n\n" + benchlib.table(HEADER, rows))


def write_failures(out, records):
    bad = [(r["name"], r.get("failure") or r.get("gross")) for r in records if "failure" in r or "gross" in r]
    out.write("\n## Failures and gross errors\n\n")
    if not bad:
        out.write("None.\n")
        return
    out.write(f"A gross error is one of more than {GROSS_UM:.0f} µm in R.\n\n")
    for name, why in bad:
        out.write(f"- {name}: {why}\n")


INTRO = """Each row: number of values, root mean square error, root mean square of the bound, their ratio, the
rms of every error in units of its own bound, bias with its standard error, how many of the
intervals value ± 1.96 u hold the truth, largest error.

The bound is the Cramér-Rao bound: an edge crossing is known to (n / A) sqrt(2 s sqrt(pi)) px (n: noise
and rounding, A: contrast, s: blur), there is one crossing per pixel of arc on both edges, and the
arc is what the fillets leave; h, alpha and theta carry the overall circle's part as well. For R it
is {floor} µm where it would be below. It takes tone curve, blur and levels as known, and a
gamma between 0.45 and 2.2 changes it by at most 6 %.
"""


def write_header(out, title, command):
    out.write(f"# {title}\n\nMade by `{command}` with {benchlib.program_version()}.\n\n")
    out.write(INTRO.format(floor=BOUND_FLOOR_UM))


def write_csv(path, records):
    facts = ["blur_px", "noise", "contrast", "bits", "gamma", "rotate_deg", "mirror"]
    with open(path, "w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out)
        writer.writerow(["tier", "foil"] + facts + ["bump", "quantity", "unit", "error", "u", "bound"])
        for r in records:
            if "error" not in r:
                continue
            start = [r["tier"], r["name"]] + [
                f"{r[k]:.4g}" if isinstance(r.get(k), float) else r.get(k, "") for k in facts
            ]
            for q in QUANTITIES:
                for k, row in enumerate(zip(r["error"][q], r["u"][q], r["bound"][q])):
                    bump = "" if q == "R0" else k + 1
                    writer.writerow(start + [bump, q, UNITS[q]] + [f"{v:.4g}" for v in row])


def write_scans(out, records):
    header = ["scan", "effects", "what", "rms error", "bound", "bias", "coverage %", "largest"]
    rows = []
    for r in records:
        for q in QUANTITIES:
            f = figures([r], q)
            cells = ["not measured", "", "", "", ""]
            if f:
                n = benchlib.number
                cells = [n(f["rms"]), n(f["bound"]), n(f["bias"], 2), per_cent(f["coverage"], 0), n(f["largest"])]
            rows.append([r["name"], r.get("effects") or "–", f"{q} ({UNITS[q]})"] + cells)
    out.write("\n" + benchlib.table(header, rows))


# --- runs -----------------------------------------------------------------------------------


def suffix(options):
    return "" if options.program == "foilgauge" else f"_{options.program}"


def run_command(options):
    words = ["tests/bench/accuracy.sh"]
    for name in ("program", "seed", "share"):
        if getattr(options, name) != options.defaults[name]:
            words.append(f"--{name} {getattr(options, name)}")
    return " ".join(words)


def run_tiers(options):
    records = []
    with tempfile.TemporaryDirectory() as folder, multiprocessing.Pool(options.jobs) as pool:
        for name, tier in TIERS.items():
            count = max(1, round(tier.count * options.share))
            jobs = [(name, k, options.seed, folder, options.program) for k in range(count)]
            print(f"{name}: rendering and measuring {count} foils", flush=True)
            records += pool.map(render_and_measure, jobs, chunksize=1)
    path = os.path.join(options.out, f"accuracy{suffix(options)}.md")
    with open(path, "w", encoding="utf-8") as out:
        write_header(out, "Accuracy on rendered foils", run_command(options))
        for name in TIERS:
            write_tier(out, name, [r for r in records if r["tier"] == name])
        write_failures(out, records)
    write_csv(os.path.join(options.out, f"accuracy{suffix(options)}.csv"), records)
    return path


def run_scans(options):
    scans = sorted(glob.glob(os.path.join(benchlib.shared_folder(), "scans", "*.png")))
    if not scans:
        print("scans of another renderer: skipped, the shared data folder is not there")
        return None
    with tempfile.TemporaryDirectory() as folder:
        records = [measure_shared(options.program, scan, folder) for scan in scans]
    path = os.path.join(options.out, f"accuracy_shared{suffix(options)}.md")
    with open(path, "w", encoding="utf-8") as out:
        write_header(out, "Accuracy on scans of another renderer", run_command(options))
        out.write(
            "\nA scan with effects of the scanner carries them into its errors: `measure` alone does not\n"
            "correct them. The bound knows white noise only.\n"
        )
        write_scans(out, records)
        write_failures(out, records)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--share", type=float, default=1.0, help="part of every tier, for a quick look")
    parser.add_argument("--program", choices=["foilgauge", "skimage", "opencv"], default="foilgauge",
                        help="whose accuracy: the program's, or a peer's on the same renders")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only-scans", action="store_true", help="no rendering: the shared scans only")
    parser.add_argument("-o", "--out", default=os.path.join(benchlib.ROOT, "reports"))
    options = parser.parse_args()
    options.defaults = vars(parser.parse_args([]))
    os.makedirs(options.out, exist_ok=True)
    if not os.path.exists(benchlib.FOILGAUGE):
        sys.exit("accuracy.py: build/foilgauge is not built")
    paths = [run_scans(options)]
    if not options.only_scans:
        paths.append(run_tiers(options))
    for path in filter(None, paths):
        print(f"wrote {os.path.relpath(path)}")


if __name__ == "__main__":
    main()
