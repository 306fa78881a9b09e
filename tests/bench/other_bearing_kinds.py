# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of records that other_bearing.py makes: each a function of a random generator that draws a whole spec.

KINDS names and describes them. All else of a spec is drawn alike: gap, foil, friction, largest load,
noise. A new kind is a new row."""

import copy
import zlib

import numpy as np


def quiet(rng):
    """Spec of a good record: displacement control, many samples, little noise, three cycles."""
    return {
        "azimuths": 6, "span_deg": 360, "cycles": 3, "threshold_n": 5,
        "gap": {"mean_mm": rng.uniform(0.05, 0.1), "harmonics": [[1, rng.uniform(0, 0.006), rng.uniform(0, 360)]]},
        "foil": draw_foil(rng),
        "rig": {"control": "displacement", "pace": "sine", "max_force_n": rng.uniform(30, 90), "friction_n": 0.0,
                "samples_per_cycle": 600, "samples_in_gap": 0, "readings": 1, "cycle_s": rng.uniform(30, 120)},
        "instruments": {"u_force_pct": 1.0, "u_displacement_pct": 1.3,
                        "offset_n": rng.uniform(-0.5, 0.5), "offset_mm": rng.uniform(-0.02, 0.02),
                        "force_noise_n": 0.05, "force_correlated_n": 0.0,
                        "displacement_noise_mm": 5e-5, "displacement_correlated_mm": 0.0, "correlation_samples": 20,
                        "force_step_n": 0.001, "displacement_step_mm": 1e-5,
                        "drift_mm_per_cycle": 0.0, "warming_mm": 0.0, "warming_cycles": 1.0},
        "dropouts": [],
    }  # fmt: skip


def draw_foil(rng):
    """A foil that hardens: 5 N press it by 5 to 12 um; loss factors of 0.03 to 0.14."""
    y5 = rng.uniform(0.005, 0.012)
    if rng.random() < 0.5:
        share = rng.uniform(0.02, 0.15)  # of the 5 N that the cubic term bears
        law = {"law": "cubic", "k1_n_mm": 5 * (1 - share) / y5, "k3_n_mm3": 5 * share / y5**3}
    else:
        n = rng.uniform(1.2, 2.0)
        law = {"law": "power", "c_n": 5 / y5**n, "exponent": n}
    parts = rng.dirichlet([2.0, 2.0, 2.0]) * rng.uniform(0.1, 0.45)
    friction = {"load_shares": [float(p) for p in parts], "constants_n": [0.0] * 3,
                "play_mm": [float(w) for w in rng.uniform(2e-4, 2e-3, 3)]}  # fmt: skip
    return law | {"stiffness_harmonics": [], "friction": friction}


def ordinary(rng, **rig):
    """Spec of an ordinary record: displacement control with the noise of a rig in a workshop."""
    spec = quiet(rng)
    spec["rig"] |= rig
    spec["instruments"] |= {"force_noise_n": rng.uniform(0.1, 0.3), "displacement_noise_mm": rng.uniform(1e-4, 3e-4)}
    return spec


def with_instruments(rng, **instruments):
    spec = ordinary(rng)
    spec["instruments"] |= instruments
    return spec


def load_control(rng, in_gap):
    return ordinary(rng, control="load", samples_in_gap=in_gap)


def dead_weights(rng):
    """An odd number of levels a stroke: the last is the largest load, and none is without a weight."""
    return ordinary(rng, control="load", samples_per_cycle=3 * (4 * int(rng.integers(15, 31)) + 2), readings=3)


def dropouts(rng):
    spec = ordinary(rng)
    spec["dropouts"] = [{"share": 0.05} for _ in range(4)]
    return spec


def dropout_at_contact(rng):
    """Every stroke of every direction loses the samples about the + contact."""
    spec = ordinary(rng)
    edge = spec["gap"]["mean_mm"] + spec["instruments"]["offset_mm"]
    spec["dropouts"] = [{"from_mm": edge - rng.uniform(0.005, 0.02), "to_mm": edge + rng.uniform(0.005, 0.02)}]
    return spec


def unequal(rng, azimuths):
    """Gaps with an ellipse, a lobe of three, and sides of unequal stiffness."""
    spec = ordinary(rng)
    spec["azimuths"] = azimuths
    mean = spec["gap"]["mean_mm"]
    spec["gap"]["harmonics"] += [[2, rng.uniform(0.05, 0.15) * mean, rng.uniform(0, 180)],
                                 [3, rng.uniform(0, 0.05) * mean, rng.uniform(0, 120)]]  # fmt: skip
    spec["foil"]["stiffness_harmonics"] = [[1, rng.uniform(0, 0.1), rng.uniform(0, 360)]]
    return spec


def gap_none(rng, **rig):
    """Both foils press the rotor by 3 to 12 um, whatever its place."""
    spec = ordinary(rng, **rig)
    spec["gap"] = {"mean_mm": -rng.uniform(0.003, 0.012), "harmonics": []}
    return spec


def friction_without_load(rng):
    """Half of the foils' friction does not grow with the load: a foil that is left behind."""
    spec = ordinary(rng)
    spec["foil"]["friction"]["constants_n"] = [float(c) for c in rng.dirichlet([2.0] * 3) * rng.uniform(0.5, 2.0)]
    return spec


def partly_pressed(rng):
    """An ellipse so large that along its small axis both foils press the rotor, and along the other there is a gap."""
    spec = unequal(rng, 6)
    ellipse = [2, rng.uniform(0.02, 0.03), rng.uniform(0, 180)]
    spec["gap"] = {"mean_mm": rng.uniform(0.008, 0.015), "harmonics": [ellipse]}
    return spec


def anything(rng):
    """Whatever a rig may do, at once."""
    spec = unequal(rng, int(rng.integers(3, 13)))
    spec["cycles"] = int(rng.integers(1, 6))
    spec["rig"] |= {"control": str(rng.choice(["load", "displacement"])), "pace": str(rng.choice(["sine", "triangle"])),
                    "friction_n": float(rng.choice([0, rng.uniform(0.2, 2)])),
                    "samples_in_gap": int(rng.integers(0, 11)), "samples_per_cycle": int(rng.integers(200, 1001))}  # fmt: skip
    spec["instruments"] |= {"drift_mm_per_cycle": rng.uniform(-0.002, 0.002), "warming_mm": rng.uniform(-0.004, 0.004),
                            "displacement_step_mm": float(rng.choice([1e-5, 1e-4, 1e-3])),
                            "force_correlated_n": rng.uniform(0, 0.1)}  # fmt: skip
    spec["dropouts"] = [{"share": rng.uniform(0.01, 0.06)} for _ in range(rng.integers(0, 3))]
    return spec


KINDS = {
    "clean": (quiet, "displacement control, little noise"),
    "ordinary": (ordinary, "displacement control, noise of 0.1 to 0.3 N and um"),
    "load_gap_0": (lambda rng: load_control(rng, 0), "equal steps of force, no sample in the gap"),
    "load_gap_1": (lambda rng: load_control(rng, 1), "the same, one sample a crossing"),
    "load_gap_3": (lambda rng: load_control(rng, 3), "the same, three samples a crossing"),
    "dead_weights": (dead_weights, "15 to 30 weights a side, three readings each, none in the gap"),
    "dropouts": (dropouts, "four stretches of 5 % lost in every direction"),
    "dropout_contact": (dropout_at_contact, "10 to 40 um about the + contact lost in every stroke"),
    "drift": (lambda rng: with_instruments(rng, drift_mm_per_cycle=rng.uniform(0.001, 0.004)), "1 to 4 um a cycle"),
    "warming": (lambda rng: with_instruments(rng, warming_mm=rng.uniform(0.002, 0.008),
                                             warming_cycles=rng.uniform(0.5, 3)), "2 to 8 um, exponential"),
    "noise_high": (lambda rng: with_instruments(rng, force_noise_n=0.6, displacement_noise_mm=6e-4), "0.6 N, 0.6 um"),
    "noise_correlated": (lambda rng: with_instruments(rng, force_correlated_n=0.15, displacement_correlated_mm=3e-4),
                         "0.15 N and 0.3 um more, over 20 samples"),
    "steps": (lambda rng: with_instruments(rng, displacement_step_mm=0.001, force_step_n=0.1), "1 um and 0.1 N"),
    "unequal_3": (lambda rng: unequal(rng, 3), "ellipse and lobes, 3 azimuths"),
    "unequal_4": (lambda rng: unequal(rng, 4), "4 azimuths: two lines, no axis to be known"),
    "unequal_6": (lambda rng: unequal(rng, 6), "6 azimuths: three lines, each twice"),
    "unequal_12": (lambda rng: unequal(rng, 12), "12 azimuths"),
    "interference": (gap_none, "no gap: 3 to 12 um a side"),
    "interference_load": (lambda rng: gap_none(rng, control="load"), "the same under load control"),
    "rig_friction": (lambda rng: ordinary(rng, friction_n=rng.uniform(0.5, 2)), "0.5 to 2 N of the rig"),
    "foil_friction": (friction_without_load, "0.5 to 2 N of the foils that do not grow with the load"),
    "one_cycle": (lambda rng: copy.deepcopy(ordinary(rng)) | {"cycles": 1}, "one cycle"),
    "five_cycles": (lambda rng: copy.deepcopy(ordinary(rng)) | {"cycles": 5}, "five cycles"),
    "partly_pressed": (partly_pressed, "an ellipse with a gap along one axis and none along the other"),
    "anything": (anything, "3 to 12 azimuths, either control, drift, dropouts, steps, friction, 1 to 5 cycles at once"),
}  # fmt: skip


def pulls(rng, **others):
    """Spec of a break-away test as the thesis planned it, with the friction of foils that press the rotor."""
    spec = {"dead_weights_n": [10, 20, 40, 80, 120, 160, 200, 240, 280, 319.5], "repeats": 5,
            "friction_coefficient": rng.uniform(0.02, 0.08), "falls_with_load": 0.0, "preload_n": rng.uniform(10, 80),
            "diameter_mm": 40, "length_mm": 40, "column": "torque_N_mm", "scatter_pct": 3.0, "noise_n": 0.02,
            "u_force_pct": 1.0, "u_weight_pct": 1.0, "step": 0.001,
            "rig_torque_n_mm": 0.0, "rig_torque_given": True}  # fmt: skip
    return spec | others


PULL_KINDS = {
    "pulls": (pulls, "ten dead weights to 319.5 N, five pulls each, scatter of 3 %"),
    "pulls_force": (lambda rng: pulls(rng, column="force_N"), "the column is the force at the rotor's surface"),
    "pulls_nmm": (lambda rng: pulls(rng, column="torque_Nmm"), "the column is named torque_Nmm"),
    "pulls_no_preload": (lambda rng: pulls(rng, preload_n=0.0), "foils that do not press"),
    "pulls_scatter": (lambda rng: pulls(rng, scatter_pct=12.0), "scatter of 12 %"),
    "pulls_few": (lambda rng: pulls(rng, dead_weights_n=[20, 80, 160, 319.5], repeats=2), "four weights, two pulls"),
    "pulls_rig": (lambda rng: pulls(rng, rig_torque_n_mm=rng.uniform(2, 15)), "the rig's own torque, which is given"),
    "pulls_rig_unknown": (lambda rng: pulls(rng, rig_torque_n_mm=rng.uniform(2, 15), rig_torque_given=False),
                          "the same, not given"),
    "pulls_curved": (lambda rng: pulls(rng, falls_with_load=rng.uniform(0.1, 0.25)),
                     "a coefficient that falls with the load's power: no line through the weights"),
}  # fmt: skip


def generator_of(kind, seed):
    """Random generator of a kind and a seed, whatever other kinds there are."""
    return np.random.default_rng([seed, zlib.crc32(kind.encode())])


def draw_spec(kind, seed):
    """The spec of a record of a kind; follows from kind and seed alone."""
    return (KINDS | PULL_KINDS)[kind][0](generator_of(kind, seed))
