# SPDX-License-Identifier: GPL-3.0-or-later
"""Quasi-static mechanics of a rotor that is pushed and pulled in a gas foil bearing, and the true values of a test.

A side of a direction is a foil behind a gap. Its force over the compression y is

    F(y) = K(y) (1 + sum a_i s_i) + sum c_i s_i,    K(y) = k1 y + k3 y^3, or c y^n

with s_i = (y - p_i) / r_i the normalised stop of a play operator p_i of half-width r_i (Prandtl and Ishlinskii): +1
while the load grows and -1 while it falls, after a reversal of 2 r_i. The shares a_i are Coulomb friction that grows
with the load, the c_i friction that does not. A foil pushes only: where F would be negative the rotor leaves it, and the
foil stays where it is until the rotor returns.

The rotor's path is a list of strokes, each monotone in its displacement x; the load cell sees F of the + side, less F
of the - side, and the rig's own dry friction against the motion. Under load control a stroke ends where the cell's
force reaches the largest load, under displacement control where x reaches the place at which a first load had reached it.

True values are of the steady cycle (the third: the first begins with foils that have never been loaded), on a grid of
0.05 um, without noise, gains, offsets or drift. DEFINITIONS has them in words."""

import copy
import math

import numpy as np

GRID_MM = 5e-5
DEFINITIONS = {
    "gap_mm": "free travel of the rotor along the direction: the gaps of both sides together; negative: interference",
    "clearance_mm": "travel between the places where the loading strokes' force passes +T and -T, the rig's friction "
    "included; null where both foils touch the rotor at once (no gap)",
    "clearance_unloading_mm": "the same of the unloading strokes",
    "clearance_foil_mm": "the gap and what each foil yields under T alone, every stop at +1, without the rig's "
    "friction",
    "stiffness_n_mm": "the largest dF/dx of the loading strokes over both sides, the end of the test included",
    "stiffness_both_n_mm": "the largest dF/dx that both sides' loading strokes reach: the lesser of their maxima",
    "course_push": "of the loading stroke on the + side: displacement from the middle in mm, force in N, dF/dx in N/mm",
    "course_pull": "the same on the - side",
    "stiffness_secant_n_mm": "force between the two turning points over the travel between them",
    "loop_area_n_mm": "work of the measured force over the steady cycle, the rig's friction included",
    "loss_factor": "loop area / (pi K X^2), K = stiffness_n_mm, X half of the travel between the turning points",
    "loss_factor_secant": "the same with K = stiffness_secant_n_mm",
    "loss_factor_foil": "of the foils alone: energy lost per cycle / (2 pi x elastic work), elastic work the mean of the "
    "work of loading and of unloading, both sides together: comparable with the gamma of a foil",
    "loss_factor_foil_peak": "the same, elastic work taken as half of force times compression at the turning points",
    "interference_force_n": "mean force of the direction's two foils on the centred rotor, without friction; 0 with a gap",
    "smallest_axis_deg": "direction (mod 180) of the smallest clearance over all directions, not only those tested; null "
    "where the sides' gaps have no even harmonic, so that all directions are alike",
    "smallest_clearance_mm": "clearance_foil_mm in that direction; null where it has no gap",
    "axis_knowable": "the tested directions tell a second harmonic: three different lines or more",
    "preload_n": "mean interference_force_n over the directions",
}


def static_force(foil, y):
    """Force of a foil without friction at the compression y (mm)."""
    if foil["law"] == "power":
        return foil["c_n"] * np.maximum(y, 0) ** foil["exponent"]
    return foil["k1_n_mm"] * y + foil["k3_n_mm3"] * y**3


def at_azimuth(harmonics, azimuth_deg):
    """Sum of harmonics [order, amplitude, phase in degrees] at an azimuth."""
    return sum(a * math.cos(n * math.radians(azimuth_deg - phase)) for n, a, phase in harmonics)


class Side:
    """One foil behind its gap, with the state of its friction."""

    def __init__(self, spec, azimuth_deg):
        self.foil = spec["foil"]
        self.gap = spec["gap"]["mean_mm"] + at_azimuth(spec["gap"]["harmonics"], azimuth_deg)
        self.scale = 1 + at_azimuth(self.foil["stiffness_harmonics"], azimuth_deg)
        friction = self.foil["friction"]
        self.shares, self.constants = (np.array(friction[k], float) for k in ("load_shares", "constants_n"))
        self.widths = np.array(friction["play_mm"], float)
        self.play, self.y = np.zeros(len(self.widths)), 0.0
        self.press(np.linspace(0, max(-self.gap, 0), 200))  # interference: assembled from free

    def raw_force(self, y, play):
        stops = (y - play) / self.widths[:, None]
        return self.scale * static_force(self.foil, y) * (1 + self.shares @ stops) + self.constants @ stops

    def press(self, depth):
        """Compression and force over a monotone course of the rotor's depth behind the gap; moves the state."""
        widths, play = self.widths[:, None], self.play[:, None]
        if depth[-1] >= depth[0]:
            y = np.maximum(depth, self.y)
            moved = np.maximum(play, y - widths)
            force = np.where(depth < y - 1e-12, 0, self.raw_force(y, moved))
        else:
            y = np.clip(depth, 0, self.y)
            moved = np.minimum(play, y + widths)
            force = self.raw_force(y, moved)
            left = np.flatnonzero(force < 0)
            if left.size:
                y[left[0] :], moved[:, left[0] :], force[left[0] :] = y[left[0]], moved[:, left[:1]], 0
        self.y, self.play = y[-1], moved[:, -1]
        return y, np.maximum(force, 0)


class Stroke:
    """A monotone stroke of the rotor: x, the cell's force, and compression and force of the + and the - side."""

    def __init__(self, sides, x, friction_n):
        self.way = 1 if x[-1] >= x[0] else -1
        self.x = x
        self.y_plus, self.f_plus = sides[0].press(x - sides[0].gap)
        self.y_minus, self.f_minus = sides[1].press(-x - sides[1].gap)
        self.force = self.f_plus - self.f_minus + self.way * friction_n
        self.free = (self.f_plus == 0) & (self.f_minus == 0)


def stroke_until(sides, x0, way, limit_n, rig_friction, depth_mm):
    """The stroke from x0 in the direction `way` until the force reaches limit_n, or the side is pressed by depth_mm."""
    end = way * ((sides[0] if way > 0 else sides[1]).gap + depth_mm)
    x = np.linspace(x0, end, max(int(abs(end - x0) / GRID_MM), 2))
    if limit_n:
        trial = Stroke(copy.deepcopy(sides), x, rig_friction)
        beyond = np.flatnonzero(way * trial.force >= limit_n)
        x = x[: max(beyond[0], 1) + 1] if beyond.size else x
    return Stroke(sides, x, rig_friction)


def depth_at(spec, azimuth_deg, force_n):
    """Compression at which a foil that is loaded reaches a force: every stop at +1."""
    side = Side(spec, azimuth_deg)
    y = np.arange(0, 0.4, GRID_MM / 10)
    force = side.scale * static_force(side.foil, y) * (1 + side.shares.sum()) + side.constants.sum()
    return float(np.interp(force_n, force, y))


def strokes_of(spec, azimuth_deg, cycles):
    """Strokes of a direction: from the middle to +, -, ... and back to the middle."""
    sides = [Side(spec, azimuth_deg), Side(spec, azimuth_deg + 180)]
    rig = spec["rig"]
    by_load = rig["control"] != "displacement"
    depths = [depth_at(spec, azimuth_deg + turn, rig["max_force_n"]) for turn in (0, 180)]
    out, x = [], 0.0
    for turn in range(2 * cycles):
        way, depth = (1, depths[0]) if turn % 2 == 0 else (-1, depths[1])
        out.append(stroke_until(sides, x, way, by_load and rig["max_force_n"], rig["friction_n"],
                                depth * (1.5 if by_load else 1)))  # fmt: skip
        x = out[-1].x[-1]
    out.append(Stroke(sides, np.linspace(x, 0, max(int(abs(x) / GRID_MM), 2)), rig["friction_n"]))
    return out


def passes(stroke, level):
    """Displacement where a stroke's force last passes a level on its way."""
    below = stroke.way * (stroke.force - level) < 0
    change = np.flatnonzero(below[:-1] & ~below[1:])
    if not change.size:
        return None
    i = change[-1]
    f0, f1 = stroke.force[i : i + 2]
    return stroke.x[i] + (level - f0) / (f1 - f0) * (stroke.x[i + 1] - stroke.x[i])


def largest_slope(stroke):
    """Largest dF/dx over 0.5 um of the loading half of a stroke (beyond the middle of the gap)."""
    step = 10
    slope = (stroke.force[step:] - stroke.force[:-step]) / (stroke.x[step:] - stroke.x[:-step])
    side_force = stroke.f_plus if stroke.way > 0 else stroke.f_minus
    return float(slope[side_force[:-step] > 0].max())


def course(stroke):
    """Every 0.5 um of the loading half of a stroke: displacement, force, dF/dx."""
    pressed = (stroke.f_plus if stroke.way > 0 else stroke.f_minus) > 0
    slope = np.gradient(stroke.force, stroke.x)
    chosen = np.flatnonzero(pressed)[::-10][::-1]
    return [[round(float(v), 6) for v in row] for row in zip(stroke.x[chosen], stroke.force[chosen], slope[chosen])]


def work(force, way):
    return float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(way)))


def foil_energy(up, down, y, f):
    """Work of loading and of unloading of one side over the steady cycle."""
    return work(getattr(up, f), getattr(up, y)), -work(getattr(down, f), getattr(down, y))


def direction_truth(spec, azimuth_deg):
    """True values of one direction."""
    strokes = strokes_of(spec, azimuth_deg, 3)
    down, up = strokes[3], strokes[4]
    sides = [Side(spec, azimuth_deg), Side(spec, azimuth_deg + 180)]
    gap, level = sides[0].gap + sides[1].gap, spec["threshold_n"]
    half = abs(up.x[-1] - down.x[-1]) / 2
    area = work(up.force, up.x) + work(down.force, down.x)
    slopes = [largest_slope(up), largest_slope(down)]
    secant = (up.force[-1] - down.force[-1]) / (2 * half)
    truth = {"azimuth_deg": azimuth_deg, "gap_mm": gap, "has_gap": gap > 0, "push_gap_mm": sides[0].gap,
             "pull_gap_mm": sides[1].gap, "travel_mm": 2 * half, "stiffness_n_mm": max(slopes),
             "stiffness_both_n_mm": min(slopes), "stiffness_secant_n_mm": secant, "loop_area_n_mm": area,
             "loss_factor": area / (math.pi * max(slopes) * half**2),
             "loss_factor_secant": area / (math.pi * secant * half**2)}  # fmt: skip
    energies = [foil_energy(up, down, "y_plus", "f_plus"), foil_energy(down, up, "y_minus", "f_minus")]
    lost, elastic = sum(a - b for a, b in energies), sum((a + b) / 2 for a, b in energies)
    peak = sum(f[-1] * (y[-1] - y.min()) / 2 for f, y in ((up.f_plus, up.y_plus), (down.f_minus, down.y_minus)))
    truth |= {"course_push": course(up), "course_pull": course(down)}
    truth |= {"loss_factor_foil": lost / (2 * math.pi * elastic), "loss_factor_foil_peak": lost / (2 * math.pi * peak)}
    return truth | clearances(spec, azimuth_deg, gap, level, down, up) | interference(sides)


def clearances(spec, azimuth_deg, gap, level, down, up):
    """Clearances of loading, of unloading and of the foils alone; None where there is no gap."""
    if gap <= 0:
        return {"clearance_mm": None, "clearance_unloading_mm": None, "clearance_foil_mm": None}
    loading = passes(up, level) - passes(down, -level)
    yields = sum(depth_at(spec, azimuth_deg + turn, level) for turn in (0, 180))
    unloading = [passes_back(down, level), passes_back(up, -level)]
    return {"clearance_mm": loading, "clearance_foil_mm": gap + yields,
            "clearance_unloading_mm": None if None in unloading else unloading[0] - unloading[1]}  # fmt: skip


def passes_back(stroke, level):
    """Displacement where the unloading half of a stroke passes a level on its way back to the gap."""
    beyond = (stroke.force - level) * np.sign(level) > 0
    inside = np.flatnonzero(beyond[:-1] & ~beyond[1:])
    return None if not inside.size else float(stroke.x[inside[0]])


def interference(sides):
    """Mean force of both foils where the rotor stands in the middle."""
    forces = [s.scale * float(static_force(s.foil, max(-s.gap, 0.0))) for s in sides]
    return {"interference_force_n": sum(forces) / 2}


def smallest_axis(spec):
    """Direction of the smallest clearance over all directions, and the clearance there."""
    even = any(n % 2 == 0 and a for n, a, _ in spec["gap"]["harmonics"] + spec["foil"]["stiffness_harmonics"])
    if not even or spec["gap"]["mean_mm"] <= 0:
        return None, None
    angles = np.arange(0, 180, 0.5)
    yields = [depth_at(spec, a, spec["threshold_n"]) for a in np.arange(0, 360, 7.5)]
    gaps = [sum(Side(spec, a + t).gap for t in (0, 180)) for a in angles]
    both = np.interp(angles, np.arange(0, 360, 7.5), yields) + np.interp(angles + 180, np.arange(0, 367.5, 7.5),
                                                                         yields + yields[:1])  # fmt: skip
    clearance = np.array(gaps) + both
    i = int(np.argmin(clearance))
    before, here, after = clearance[i - 1], clearance[i], clearance[(i + 1) % len(angles)]
    shift = (before - after) / (2 * (before - 2 * here + after))
    return float((angles[i] + 0.5 * shift) % 180), float(here) if gaps[i] > 0 else None


def truth_of(spec, azimuths):
    """True values of a record: of every direction, and of the bearing."""
    directions = [direction_truth(spec, a) for a in azimuths]
    known = [d["clearance_mm"] for d in directions if d["clearance_mm"] is not None]
    axis, smallest = smallest_axis(spec)
    return {"directions": directions, "clearance_mean_mm": sum(known) / len(known) if known else None,
            "smallest_axis_deg": axis, "smallest_clearance_mm": smallest,
            "axis_knowable": len({round(a % 180, 6) for a in azimuths}) >= 3,
            "preload_n": sum(d["interference_force_n"] for d in directions) / len(directions),
            "definitions": DEFINITIONS}  # fmt: skip
