# SPDX-License-Identifier: GPL-3.0-or-later
"""Coverage of the uncertainties of `foilgauge stiffness`: share of the truths within U, over seeds."""
import json
import subprocess
import tempfile

import numpy as np

import load_tests

HYSTERESIS_N = 1.032


def run(program, rows, *options):
    with tempfile.TemporaryDirectory() as folder:
        load_tests.write_csv(folder + "/t.csv", rows)
        code = subprocess.run([program, "stiffness", folder + "/t.csv", "-o", folder + "/r.json", *options]).returncode
        if code not in (0, 2):  # 2: an azimuth is not measured
            raise RuntimeError(f"exit code {code}")
        return json.load(open(folder + "/r.json"))


def add(found, name, value, truth, u):
    found.setdefault(name, []).append(((value - truth) / u, (value - truth) / truth, u / truth) if value is not None and u else (np.nan,) * 3)


def coverage(program, seeds, names="A", changes=None, scale=True):
    """found[name]: (error over u, relative error, relative u) of every direction of every seed."""
    found = {}
    p = load_tests.bearing(**(changes or {}))
    for seed in seeds:
        rows, truth = load_tests.test_of(names, np.random.default_rng(seed), changes, scale=scale)
        report = run(program, rows)
        u = "u_" if scale else "u_repeat_"
        for a in report["azimuths"]:
            of = truth[a["bearing"]][a["azimuth_deg"]]
            add(found, "clearance_mm", a["clearance_mm"], of["clearance_mm"], a[u + "clearance_mm"])
            if a["push_mm"] is None or a["pull_mm"] is None:
                continue
            # A spring that hardens has its largest stiffness where the test ends: the truth is that of the place reported.
            at = (a["stiffness_at_mm"] - (a["push_mm"] + a["pull_mm"]) / 2) / (1 + of["scale_x"])
            stiffness = load_tests.slope_at(p, of["gap_mm"], at)
            add(found, "stiffness_n_mm", a["stiffness_n_mm"], stiffness, a[u + "stiffness_n_mm"])
            loss = of["area_n_mm"] / (np.pi * stiffness * p["amplitude"]**2)
            add(found, "loss_factor", a["loss_factor"], loss, a[u + "loss_factor"])
        for b in report["bearings"]:
            add(found, "radial_hysteresis_n", b["radial_hysteresis_n"], HYSTERESIS_N, b[u + "radial_hysteresis_n"])
            low, high = load_tests.KINDS[b["name"]]
            add(found, "clearance_min_mm", b["clearance_min_mm"], low, b[u + "clearance_min_mm"])
            add(found, "clearance_max_mm", b["clearance_max_mm"], high, b[u + "clearance_max_mm"])
            if b["smallest_at_deg"] is None:
                continue
            off = b["smallest_at_deg"] - 30
            off -= 180 * round(off / 180)
            found.setdefault("smallest_at_deg", []).append((off / b["u_smallest_at_deg"], off, b["u_smallest_at_deg"]))
    return {name: np.array(values) for name, values in found.items()}


def shares(found):
    return {name: (np.mean(np.abs(v[:, 0]) <= 2), np.isfinite(v[:, 0]).mean(), np.mean(v[:, 0]), np.std(v[:, 1]), np.median(v[:, 2]))
            for name, v in found.items()}
