# SPDX-License-Identifier: GPL-3.0-or-later
"""samples/stiffness: a bearing that presses its rotor, P, beside A of bearings.csv, which has a gap, with known truth.

Usage: python3 tests/bench/break_away.py samples/stiffness

  break_away.csv   torque at which the rotor begins to turn, over dead weights of 20 to 319.5 N, three pulls each:
                   (mu (W + preload) + rig) 20 mm, mu 0.03, rig 20 N mm, scatter of 2 % of mu (W + preload).
  preloaded.csv    P pushed and pulled along one azimuth: two foils of 1720 N/mm that press the centred rotor by 10 um, 17.2 N
                   each; each pushes only; friction 0.03 |F| of each, which turns round over 4 um, and 0.5 N of the rig.
It shares no code with the program."""
import json
import math
import pathlib
import random
import sys

WEIGHTS, MU, RIG_NMM, RADIUS_MM = (20, 60, 100, 150, 200, 240, 280, 319.5), 0.03, 20.0, 20.0
PRELOADS = {"A": 0.0, "P": 34.4}
SPRING, PRESSED_MM, RIG_N, TURN_MM, AMPLITUDE_MM = 1720.0, 0.010, 0.5, 0.004, 0.06


def pulls(rng):
    for bearing, preload in PRELOADS.items():
        for weight in WEIGHTS:
            for repeat in range(1, 4):
                slip = MU * (weight + preload) * (1 + rng.gauss(0, 0.02))
                yield f"{bearing},{weight:g},{repeat},{slip * RADIUS_MM + RIG_NMM:.2f}"


def foil(pressed, turned):
    """Force of a foil that is pressed; friction helps it while it is loaded (turned +1), hinders after (-1)."""
    return SPRING * pressed * (1 + 0.03 * turned) if pressed > 0 else 0.0


def samples(rng, cycles=3, count=200):
    for i in range(cycles * count):
        turn = 2 * math.pi * i / count
        x, sense = AMPLITUDE_MM * math.sin(turn), 1 if math.cos(turn) >= 0 else -1
        way = x if i < count / 4 else AMPLITUDE_MM + sense * x
        state = sense * (1 - (1 if i < count / 4 else 2) * math.exp(-way / TURN_MM))
        force = foil(PRESSED_MM + x, state) - foil(PRESSED_MM - x, -state) + RIG_N * state
        yield f"P,0,{i // count + 1},{i / 20:.2f},{x + rng.gauss(0, 1e-4):.5f},{force + rng.gauss(0, 0.1):.2f}"


def main(folder):
    rng, folder = random.Random(622), pathlib.Path(folder)
    (folder / "break_away.csv").write_text("bearing,dead_weight_N,repeat,torque_N_mm\n" + "\n".join(pulls(rng)) + "\n")
    (folder / "preloaded.csv").write_text("bearing,azimuth_deg,cycle,time_s,displacement_mm,force_N\n" + "\n".join(samples(rng)) + "\n")
    truth = json.loads((folder / "truth.json").read_text())
    truth["break_away"] = {name: {"friction_coefficient": MU, "rig_torque_n_mm": RIG_NMM, "preload_n": preload,
                                  "preload_kpa": round(1000 * preload / (math.pi * 40 * 40), 4)} for name, preload in PRELOADS.items()}  # fmt: skip
    truth["P"] = {"0": {"clearance_mm": None, "gap_mm": None, "interference_mm": 2 * PRESSED_MM, "stiffness_centre_n_mm": 2 * SPRING}}
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
