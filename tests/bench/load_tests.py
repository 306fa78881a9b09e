# SPDX-License-Identifier: GPL-3.0-or-later
"""Load-displacement tests of a bearing with known truth: CSV and its truth. Shares no code with the program.

A rotor without turning goes to and fro along an azimuth, x(t) = A sin, from the middle of the clearance:
  elastic force  k d + k3 d^3, d what x is past half of the gap, rounded over w (softplus); the same on the other side;
  friction       (a + b |elastic|), against the way; after a turn it changes sign over exp(-s / l);
  drift          of force and displacement, linear in time;
  noise          of both, white or of first order (ar);
  step           of a digital indicator: displacement rounded to whole ones;
  sampling       at times that are jittered, with samples lost;
  scale          of force and displacement, one for a whole test: what an instrument's calibration is off by.
The truth is of the curves without noise: travel between the loading strokes' +T and -T, largest slope of a loading stroke.
"""
import json
import sys

import numpy as np

KINDS = {  # clearance's range over the azimuths, mm: the thesis's three bearings
    "A": (0.16, 0.20), "B": (0.17, 0.20), "C": (0.14, 0.16)}


def bearing(**changes):
    parts = dict(k=500.0, k3=5e4, w=0.003, amplitude=0.19, a=1.032, b=0.03, way=0.006, noise_n=0.2, noise_um=0.2, ar=0.0,
                 force_drift=0.1, x_drift_um=0.5, cycles=5, samples=600, lost=0.1, jitter=0.3, threshold=5.0,
                 least_at=30.0, azimuths=np.arange(0, 360, 30.0), wander_um=0.0, step_um=0.0)
    parts.update(changes)
    return parts


def elastic(p, gap, x):
    d = p["w"] * np.logaddexp(0, (np.abs(x) - gap / 2) / p["w"])
    d0 = p["w"] * np.logaddexp(0, -gap / 2 / p["w"])
    return np.sign(x) * (p["k"] * (d - d0) + p["k3"] * (d**3 - d0**3))


def friction(p, force, sense, way):
    return sense * (p["a"] + p["b"] * np.abs(force)) * (1 - 2 * np.exp(-way / p["way"]))


def up_stroke(p, gap, x):
    f = elastic(p, gap, x)
    return f + friction(p, f, 1, x + p["amplitude"])


def gap_for(p, clearance):
    """The gap whose loading strokes pass the threshold this far apart."""
    x = np.linspace(0, p["amplitude"], 8001)
    low, high = 0.0, clearance
    for _ in range(30):
        gap = (low + high) / 2
        at = np.interp(p["threshold"], up_stroke(p, gap, x), x)
        low, high = (gap, high) if 2 * at < clearance else (low, gap)
    return gap


def record(p, gap, rng):
    """Displacement and force of all cycles: true values, then what the instruments say."""
    n = p["samples"] * p["cycles"]
    turns = (np.arange(n) + p["jitter"] * rng.uniform(-1, 1, n)) / p["samples"]
    turns = np.sort(turns)[rng.uniform(size=n) > p["lost"]]
    turns = turns[turns >= 0]
    x = p["amplitude"] * np.sin(2 * np.pi * turns)
    cosine = np.cos(2 * np.pi * turns)
    sense = np.where(cosine >= 0, 1.0, -1.0)
    f = elastic(p, gap, x)
    way = p["amplitude"] + sense * x
    slip = friction(p, f, sense, way)
    first = turns < 0.25  # from the middle: nothing has turned yet
    slip[first] = ((p["a"] + p["b"] * np.abs(f)) * (1 - np.exp(-x / p["way"])))[first]
    return turns, x, f + slip


def noise(rng, n, sd, ar):
    white = rng.normal(size=n)
    if not ar:
        return sd * white
    out = np.empty(n)
    last = rng.normal()
    for i in range(n):
        last = ar * last + np.sqrt(1 - ar * ar) * white[i]
        out[i] = last
    return sd * out


def measured(p, turns, x, f, rng, scale_f, scale_x):
    x = x + noise(rng, len(x), p["noise_um"] / 1000, p["ar"]) + p["x_drift_um"] / 1000 * turns
    if p["wander_um"]:
        x = x + np.interp(turns, np.arange(p["cycles"] * 2 + 2) / 2, np.cumsum(rng.normal(size=p["cycles"] * 2 + 2)) * p["wander_um"] / 1000)
    f = f + noise(rng, len(f), p["noise_n"], p["ar"]) + p["force_drift"] * turns
    x = x * (1 + scale_x)
    if p["step_um"]:  # what an indicator shows
        x = np.round(x * 1000 / p["step_um"]) * p["step_um"] / 1000
    return x, f * (1 + scale_f)


def slope_at(p, gap, x):
    """Slope of a loading stroke, x from the middle of the clearance."""
    h = 1e-5
    return (up_stroke(p, gap, abs(x) + h) - up_stroke(p, gap, abs(x) - h)) / (2 * h)


def truth_of(p, gap, clearance):
    x = np.linspace(0, p["amplitude"] * (1 - 2 * 0.01), 20001)
    slope = slope_at(p, gap, x)
    fine = np.linspace(0, 1, 20001)
    xs = p["amplitude"] * np.cos(np.pi * fine)  # one stroke down
    e = elastic(p, gap, xs)
    slip = (p["a"] + p["b"] * np.abs(e)) * (1 - 2 * np.exp(-(p["amplitude"] - xs) / p["way"]))
    area = 2 * np.trapezoid(slip, -xs) if hasattr(np, "trapezoid") else 2 * np.trapz(slip, -xs)
    return dict(clearance_mm=clearance, gap_mm=gap, stiffness_n_mm=float(slope.max()), area_n_mm=float(area),
                loss_factor=float(area / (np.pi * slope.max() * p["amplitude"]**2)))


def test_of(names, rng, changes=None, shift=None, scale=True):
    """Rows (bearing, azimuth, cycle, time, x, f) and truth[bearing][azimuth]. shift(bearing, azimuth): added clearance, mm. scale: the
    instruments are off."""
    rows, truth = [], {}
    p = bearing(**(changes or {}))
    scale_f, scale_x = scale * 0.010 * rng.normal(), scale * 0.013 * rng.normal()
    for name in names:
        low, high = KINDS[name]
        truth[name] = {}
        for azimuth in p["azimuths"]:
            clearance = (low + high) / 2 - (high - low) / 2 * np.cos(2 * np.radians(azimuth - p["least_at"]))
            clearance += shift(name, azimuth) if shift else 0
            gap = gap_for(p, clearance)
            turns, x, f = record(p, gap, rng)
            truth[name][float(azimuth)] = dict(truth_of(p, gap, clearance), scale_x=scale_x)
            x, f = measured(p, turns, x, f, rng, scale_f, scale_x)
            for t, a, b in zip(turns, x, f):
                rows.append((name, azimuth, int(t) + 1, 20 * t, a, b))
    return rows, truth


def write_csv(path, rows, separator=",", comma=False, unit="mm"):
    factor = {"mm": 1.0, "um": 1000.0}[unit]
    with open(path, "w") as out:
        out.write(separator.join(["bearing", "azimuth_deg", "cycle", "time_s", "displacement_" + unit, "force_N"]) + "\n")
        for name, azimuth, cycle, t, x, f in rows:
            cells = [name, f"{azimuth:g}", str(cycle), f"{t:.5f}", f"{x * factor:.6f}", f"{f:.4f}"]
            text = separator.join(cells)
            out.write((text.replace(".", ",") if comma else text) + "\n")


if __name__ == "__main__":  # load_tests.py SEED OUT.csv TRUTH.json [NAMES [CHANGES as JSON]]
    names = sys.argv[4] if len(sys.argv) > 4 else "ABC"
    changes = json.loads(sys.argv[5]) if len(sys.argv) > 5 else {}
    if "azimuths" in changes:
        changes["azimuths"] = np.array(changes["azimuths"], float)
    rows, truth = test_of(names, np.random.default_rng(int(sys.argv[1])), changes)
    write_csv(sys.argv[2], rows)
    json.dump(truth, open(sys.argv[3], "w"))
