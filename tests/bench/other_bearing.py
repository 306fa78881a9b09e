# SPDX-License-Identifier: GPL-3.0-or-later
"""Load-displacement tests of gas foil bearings as a test rig writes them, with their truth: a generator that shares no
line and no law of friction with foilgauge or with load_tests.py. `foilgauge stiffness` is judged on these records,
which its makers did not make.

Usage: other_bearing.py OUT.csv [--truth OUT.json] --seed S [--kind KIND | --spec SPEC.json]
       other_bearing.py --list

  /usr/bin/python3 tests/bench/other_bearing.py b7.csv --truth b7.json --seed 7 --kind load_gap_0

The truth has the whole spec in its member `spec`; changed by hand and given with --spec, it makes another record. What
each true value means stands in its member `definitions`.

A rig samples the quasi-static path of other_bearing_mechanics.py in equal steps of force (`control`: `load`; the rotor
jumps through the gap, where `samples_in_gap` of a crossing are caught) or along a course of the displacement in equal
times (`displacement`; `pace`: `sine` or `triangle`). Then, in this order: the drift of the displacement, linear and
warming; the gains, one of force and one of displacement for a whole record, normal with the standard uncertainties
u_force_pct and u_displacement_pct; the offsets; noise, white and of first order autoregression; stretches that are
lost; the steps of the columns.

The kinds that begin with `pulls` are break-away tests: the rotor is turned until it slips."""

import argparse
import json
import math

import numpy as np

from other_bearing_kinds import KINDS, PULL_KINDS, draw_spec
from other_bearing_mechanics import strokes_of, truth_of

COLUMNS = "bearing,azimuth_deg,cycle,time_s,displacement_mm,force_N"
BREAK_AWAY_DEFINITIONS = {
    "friction_coefficient": "break-away force over normal force, with the preload; null where it falls with load",
    "preload_n": "normal force of the foils on the rotor without a dead weight",
    "preload_kpa": "preload_n over pi x diameter x length",
    "friction_no_weight_n": "break-away force without a dead weight and without the rig's torque",
}


def azimuths_of(spec):
    return [spec["span_deg"] * k / spec["azimuths"] for k in range(spec["azimuths"])]


def path_of(strokes):
    """Displacement, force, stroke and `in the gap` along the whole path; a reversal's drop of force is a vertical."""
    x, force = (np.concatenate([getattr(s, k) for s in strokes]) for k in ("x", "force"))
    free = np.concatenate([s.free for s in strokes])
    number = np.concatenate([np.full(len(s.x), i) for i, s in enumerate(strokes)])
    return x, force, number, free


def places_by_load(rng, rig, force, number, free, cycles):
    """Places along the path at equal steps of force, and those that are caught in the gap."""
    way = np.concatenate([[0], np.cumsum(np.abs(np.diff(force)))])
    levels = max(rig["samples_per_cycle"] * cycles // rig["readings"], 4)
    phase = 0.5 if rig["readings"] > 1 else rng.uniform(0.2, 0.8)  # weights: the same up and down
    steps = (np.arange(levels) + phase) * way[-1] / levels
    places = np.interp(np.repeat(steps, rig["readings"]), way, np.arange(len(way)))
    caught = [rng.choice(np.flatnonzero(free & (number == n)), rig["samples_in_gap"], replace=False)
              for n in np.unique(number) if np.count_nonzero(free & (number == n)) > rig["samples_in_gap"]]  # fmt: skip
    return np.sort(np.concatenate([places, *caught]))


def places_by_displacement(rig, x, number, cycles):
    """Indices along the path at equal times of a sine's or a triangle's course; a turning point every half cycle."""
    way = np.concatenate([[0], np.cumsum(np.abs(np.diff(x)))])
    half_cycles = np.linspace(0, 2 * cycles, rig["samples_per_cycle"] * cycles)
    stroke = np.floor(half_cycles + 0.5).astype(int)
    since_middle = half_cycles - stroke
    course = np.sin(math.pi * since_middle) if rig["pace"] == "sine" else 2 * since_middle
    part = (1 + course) / 2
    part[stroke == 0], part[stroke == 2 * cycles] = course[stroke == 0], 1 + course[stroke == 2 * cycles]
    ends = np.append(way[np.searchsorted(number, np.arange(2 * cycles + 1))], way[-1])
    return np.interp(ends[stroke] + part * np.diff(ends)[stroke], way, np.arange(len(x)))


def correlated(rng, n, sd, length):
    """Noise of first order autoregression with the standard deviation sd."""
    if not sd:
        return np.zeros(n)
    rho, shocks = math.exp(-1 / length), rng.normal(0, sd, n)
    out = shocks.copy()
    for i in range(1, n):
        out[i] = rho * out[i - 1] + math.sqrt(1 - rho**2) * shocks[i]
    return out


def lost(rng, spec, x):
    """Marks the samples that a record lacks: stretches in time, and stretches of the displacement column."""
    gone = np.zeros(len(x), bool)
    for drop in spec["dropouts"]:
        if "share" in drop:
            length = int(drop["share"] * len(x))
            start = rng.integers(0, len(x) - length + 1)
            gone[start : start + length] = True
        else:
            gone |= (x >= drop["from_mm"]) & (x <= drop["to_mm"])
    return gone


def direction_rows(rng, spec, azimuth_deg, gains):
    """Cycle, time, displacement and force of one direction as the rig writes them."""
    rig, tool, cycles = spec["rig"], spec["instruments"], spec["cycles"]
    x, force, number, free = path_of(strokes_of(spec, azimuth_deg, cycles))
    places = (places_by_displacement(rig, x, number, cycles) if rig["control"] == "displacement"
              else places_by_load(rng, rig, force, number, free, cycles))  # fmt: skip
    x, force = (np.interp(places, np.arange(len(number)), v) for v in (x, force))
    number = number[np.round(places).astype(int)]
    n = len(x)
    cycle = np.minimum((number + 1) // 2 + ((number % 2 == 0) & (x >= 0)), cycles)
    turns = np.linspace(0, cycles, n)
    x = x + tool["drift_mm_per_cycle"] * turns + tool["warming_mm"] * (1 - np.exp(-turns / tool["warming_cycles"]))
    x = gains[1] * x + tool["offset_mm"] + rng.normal(0, tool["displacement_noise_mm"], n)
    force = gains[0] * force + tool["offset_n"] + rng.normal(0, tool["force_noise_n"], n)
    x = x + correlated(rng, n, tool["displacement_correlated_mm"], tool["correlation_samples"])
    force = force + correlated(rng, n, tool["force_correlated_n"], tool["correlation_samples"])
    keep = ~lost(rng, spec, x)
    return [v[keep] for v in (cycle, turns * rig["cycle_s"], x, force)]


def decimals(step):
    return max(0, -math.floor(math.log10(step) + 1e-9))


def make_record(spec, seed, name="B", deviates=None):
    """A record as CSV text, and its truth; `deviates` fixes the gains of force and displacement, in their u."""
    rng = np.random.default_rng([seed, 1])
    tool = spec["instruments"]
    drawn = rng.normal(0, 1, 2) if deviates is None else deviates
    gains = [1 + z * tool[k] / 100 for z, k in zip(drawn, ("u_force_pct", "u_displacement_pct"), strict=True)]
    steps = tool["displacement_step_mm"], tool["force_step_n"]
    row = f"{name},%g,%d,%.3f,%.{decimals(steps[0])}f,%.{decimals(steps[1])}f"
    lines = [COLUMNS]
    for azimuth in azimuths_of(spec):
        cycle, time, x, force = direction_rows(rng, spec, azimuth, gains)
        x, force = (np.round(v / s) * s for v, s in zip((x, force), steps, strict=True))
        lines += [row % (azimuth, *values) for values in zip(cycle, time, x, force, strict=True)]
    truth = truth_of(spec, azimuths_of(spec)) | {"gain_force": gains[0], "gain_displacement": gains[1], "seed": seed,
                                                 "bearing": name, "spec": spec}  # fmt: skip
    return "\n".join(lines) + "\n", truth


def pull_force(spec, weight):
    """Force at the rotor's surface at which the foils let go, under a true dead weight."""
    normal = max(weight + spec["preload_n"], 1e-9)
    return spec["friction_coefficient"] * normal * (normal / 100) ** -spec["falls_with_load"]


def make_break_away(spec, seed, deviates=None):
    """A break-away test: the rotor is turned until it slips, under growing dead weights; CSV text and truth."""
    rng = np.random.default_rng([seed, 2])
    drawn = rng.normal(0, 1, 2) if deviates is None else deviates
    gain, weight_gain = (1 + z * spec[k] / 100 for z, k in zip(drawn, ("u_force_pct", "u_weight_pct"), strict=True))
    radius = spec["diameter_mm"] / 2
    arm = 1 if spec["column"] == "force_N" else radius
    lines = [f"dead_weight_N,{spec['column']},repeat"]
    for weight in spec["dead_weights_n"]:
        for repeat in range(1, spec["repeats"] + 1):
            slip = pull_force(spec, weight * weight_gain) * (1 + rng.normal(0, spec["scatter_pct"] / 100))
            slip += spec["rig_torque_n_mm"] / radius + rng.normal(0, spec["noise_n"])
            value = round(gain * slip * arm / spec["step"]) * spec["step"]
            lines.append(f"{weight:g},{value:.{decimals(spec['step'])}f},{repeat}")
    area = math.pi * spec["diameter_mm"] * spec["length_mm"]
    truth = {"friction_coefficient": None if spec["falls_with_load"] else spec["friction_coefficient"],
             "preload_n": spec["preload_n"], "preload_kpa": 1000 * spec["preload_n"] / area,
             "friction_no_weight_n": pull_force(spec, 0), "gain_force": gain, "gain_weight": weight_gain,
             "definitions": BREAK_AWAY_DEFINITIONS, "spec": spec, "seed": seed}  # fmt: skip
    return "\n".join(lines) + "\n", truth


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", nargs="?")
    parser.add_argument("--truth")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=[*KINDS, *PULL_KINDS], default="ordinary")
    parser.add_argument("--spec")
    parser.add_argument("--list", action="store_true")
    args = parser.parse_args()
    if args.list or not args.out:
        print("\n".join(f"{name:18} {words}" for name, (_, words) in (KINDS | PULL_KINDS).items()))
        return
    spec = {}
    if args.spec:
        with open(args.spec, encoding="utf-8") as file:
            spec = json.load(file)
        spec = spec.get("spec", spec)
    if args.kind in PULL_KINDS or "dead_weights_n" in spec:
        text, truth = make_break_away(spec or draw_spec(args.kind, args.seed), args.seed)
    else:
        text, truth = make_record(spec or draw_spec(args.kind, args.seed), args.seed)
    with open(args.out, "w", encoding="utf-8") as file:
        file.write(text)
    if args.truth:
        with open(args.truth, "w", encoding="utf-8") as file:
            json.dump(truth, file, indent=1)


if __name__ == "__main__":
    main()
