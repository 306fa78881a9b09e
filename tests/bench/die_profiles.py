# SPDX-License-Identifier: GPL-3.0-or-later
"""Stylus traces of a die whose dimensions are known: both halves, any number of repeats, as text.

    python3 tests/bench/die_profiles.py FOLDER [--seed N] [--tip-um R] [--repeats N] [--bumps N] ...

It knows nothing of how the program takes the tip off: the surface is a dense line of points, and the trace is the
upper envelope of the tip (a sphere on a cone) that is set on each of them. Numbers of the midline are those of a half's
surface, moved by half a thickness.
"""
import argparse
import json
import math
import os

import numpy as np

DESIGN = dict(radius=3.32, angle=63.15, overall=20.73, pitch=40 / 3, fillet=0.35, thickness=0.1, bumps=9)
HALVES = ("concave", "convex")
THESIS_ERROR_PCT = {"concave": 0.09, "convex": 0.35}


def smooth_noise(rng, count, step, length, sd):
    """Gaussian noise with a Gaussian correlation of that length."""
    if sd <= 0:
        return np.zeros(count)
    reach = max(1, int(round(3 * length / step)))
    if reach > 400:  # on a coarser grid, which it does not see
        coarse = max(2, int(round(length / step / 20)))
        grid = smooth_noise(rng, count // coarse + 4, step * coarse, length, sd)
        return np.interp(np.arange(count) / coarse, np.arange(len(grid)), grid)
    kernel = np.exp(-2 * (np.arange(-reach, reach + 1) * step / length) ** 2)
    values = np.convolve(rng.standard_normal(count + 2 * reach), kernel, "valid")
    return values * sd / math.sqrt(float(np.sum(kernel**2)))


def arc(centre, radius, start, end, step):
    count = max(2, int(abs(end - start) * radius / step))
    angle = np.linspace(start, end, count, endpoint=False)
    return np.column_stack((centre[0] + radius * np.sin(angle), centre[1] + radius * np.cos(angle)))


class Half:
    """The surface of one half. Directions are from the z axis towards x, O is the origin of the line."""

    def __init__(self, name, rng, error_pct, args):
        self.name = name
        side = 1 if name == "concave" else -1
        t = DESIGN["thickness"] / 2
        self.numbers = list(range(args.first, args.first + args.bumps))
        self.radius = {
            n: DESIGN["radius"] * (1 + error_pct / 100) + 1e-3 * args.radius_sd_um * rng.standard_normal()
            for n in self.numbers
        }
        mean = np.mean(list(self.radius.values())) if args.radius_sd_um else 0
        for n in self.numbers:  # the mean is the requested radius
            if args.radius_sd_um:
                self.radius[n] += DESIGN["radius"] * (1 + error_pct / 100) - mean
        self.angle = {n: DESIGN["angle"] * (1 + args.angle_error_pct / 100) for n in self.numbers}
        self.overall = DESIGN["overall"] * (1 + args.overall_error_pct / 100)
        self.centre = {}
        points, step = [], args.step_mm
        lands, f = self.overall - side * t, DESIGN["fillet"] - side * t
        middle = 0.5 * (self.numbers[0] + self.numbers[-1])
        at = math.radians((self.numbers[0] - middle - 0.5) * DESIGN["pitch"])
        for n in self.numbers:
            r, half = self.radius[n], math.radians(self.angle[n] / 2)
            x = r * math.cos(half) + math.sqrt(self.overall**2 - (r * math.sin(half)) ** 2)
            self.centre[n] = x
            bump = r + side * t
            psi = math.radians((n - middle) * DESIGN["pitch"])
            c = (x * math.sin(psi), x * math.cos(psi))
            # The fillet touches the lands from within and the bump from outside.
            turn = math.acos((x**2 + (lands - f) ** 2 - (bump + f) ** 2) / (2 * x * (lands - f)))
            open_ = math.acos((x**2 + (bump + f) ** 2 - (lands - f) ** 2) / (2 * x * (bump + f)))
            for sign in (-1, 1):
                centre = ((lands - f) * math.sin(psi + sign * turn), (lands - f) * math.cos(psi + sign * turn))
                # Directions at the fillet: of the land, and of the line to C.
                towards = psi - sign * open_
                if sign < 0:
                    points.append(arc((0, 0), lands, at, psi - turn, step))
                    points.append(arc(centre, f, psi - turn, towards, step))
                    # along the bump, from its left foot over the crown (towards O) to its right foot
                    points.append(arc(c, bump, psi + math.pi + open_, psi + math.pi - open_, step))
                else:
                    points.append(arc(centre, f, towards, psi + turn, step))
                    at = psi + turn
        end = math.radians((self.numbers[-1] - middle + 0.5) * DESIGN["pitch"])
        points.append(arc((0, 0), lands, at, end, step))
        line = np.concatenate(points)
        if side < 0:
            line[:, 1] = -line[:, 1]  # the die lies outside of the circle: up is towards O
        tangent = np.gradient(line, axis=0)
        tangent /= np.hypot(tangent[:, 0], tangent[:, 1])[:, None]
        self.normal = np.column_stack((-tangent[:, 1], tangent[:, 0]))
        form = smooth_noise(rng, len(line), step, args.form_mm, args.form_um / 1000)
        self.line = line + self.normal * form[:, None]


def trace(half, rng, args):
    """x and z of the tip's lowest point, the die set down anew: tilted, shifted, on another track of the surface."""
    rough = smooth_noise(rng, len(half.line), args.step_mm, args.rough_mm, args.rough_um / 1000)
    line = half.line + half.normal * rough[:, None]
    tilt = math.radians(args.tilt_deg + 0.3 * rng.standard_normal())
    c, s = math.cos(tilt), math.sin(tilt)
    line = line @ np.array([[c, -s], [s, c]])
    line = line[np.argsort(line[:, 0], kind="stable")]
    first, last = line[0, 0] + args.margin_mm, line[-1, 0] - args.margin_mm
    x = np.arange(first, last, args.spacing_mm) + rng.random() * args.spacing_mm
    r = args.tip_um / 1000
    z = np.full(len(x), -np.inf)
    if r > 0:
        low, high = np.searchsorted(line[:, 0], x - r), np.searchsorted(line[:, 0], x + r)
        for i in range(len(x)):
            near = line[low[i] : high[i]]
            z[i] = np.max(near[:, 1] + np.sqrt(np.maximum(r**2 - (near[:, 0] - x[i]) ** 2, 0)), initial=-np.inf) - r
    else:
        z = np.interp(x, line[:, 0], line[:, 1])
    steepest = math.tan(math.radians(args.cone_deg)) * args.spacing_mm
    for i in range(1, len(x)):
        z[i] = max(z[i], z[i - 1] - steepest)
    for i in range(len(x) - 2, -1, -1):
        z[i] = max(z[i], z[i + 1] - steepest)
    z = z + args.noise_um / 1000 * rng.standard_normal(len(x))
    return x - x[0], z - z[len(z) // 2]


def write(path, x, z, name, args):
    per = {"mm": 1, "um": 1000, "mm,um": None}[args.unit]
    sx, sz = (per, per) if per else (1, 1000)
    ux, uz = args.unit.split(",") if "," in args.unit else (args.unit, args.unit)
    mark = {"tab": "\t", "semicolon": ";", "space": " ", "comma": ","}[args.separator]
    digits = {1: 6, 1000: 3}
    with open(path, "w", encoding="latin-1", newline="") as out:
        if args.header:
            out.write(f"Profile of die, {name} half\r\nTip radius: {args.tip_um:g} um\r\nSpeed: 0.5 mm/s\r\n")
            out.write(f"Number of points: {len(x)}\r\n")
            out.write(f"X [{ux}]{mark}Z [{uz}]\r\n".replace("um", "\xb5m") if args.micro else f"X [{ux}]{mark}Z [{uz}]\r\n")
        for a, b in zip(x, z):
            text = f"{a * sx:.{digits[sx]}f}{mark}{b * sz:.{digits[sz]}f}"
            out.write((text.replace(".", ",") if args.decimal_comma else text) + "\r\n")


def parser():
    p = argparse.ArgumentParser()
    p.add_argument("folder")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--repeats", type=int, default=5)
    p.add_argument("--tip-um", type=float, default=2.0)
    p.add_argument("--cone-deg", type=float, default=75.0, help="steepest flank that the tip follows")
    p.add_argument("--bumps", type=int, default=5)
    p.add_argument("--first", type=int, default=3)
    p.add_argument("--error", type=float, nargs=2, default=[THESIS_ERROR_PCT[h] for h in HALVES])
    p.add_argument("--radius-sd-um", type=float, default=0.0, help="of the bumps of a half")
    p.add_argument("--angle-error-pct", type=float, default=0.0)
    p.add_argument("--overall-error-pct", type=float, default=0.0)
    p.add_argument("--form-um", type=float, default=0.15)
    p.add_argument("--form-mm", type=float, default=0.5)
    p.add_argument("--rough-um", type=float, default=0.05)
    p.add_argument("--rough-mm", type=float, default=0.02)
    p.add_argument("--noise-um", type=float, default=0.03)
    p.add_argument("--tilt-deg", type=float, default=0.0)
    p.add_argument("--spacing-mm", type=float, default=0.002)
    p.add_argument("--step-mm", type=float, default=0.0)
    p.add_argument("--margin-mm", type=float, default=0.1)
    p.add_argument("--unit", choices=["mm", "um", "mm,um"], default="mm")
    p.add_argument("--separator", choices=["tab", "semicolon", "space", "comma"], default="tab")
    p.add_argument("--decimal-comma", action="store_true")
    p.add_argument("--micro", action="store_true", help="write µm in Latin-1")
    p.add_argument("--no-header", dest="header", action="store_false")
    return p


def make(args):
    """Writes the traces; returns the truth of each half's midline: numbers, radii, centre distances."""
    if not args.step_mm:
        args.step_mm = min(1e-3, max(args.tip_um, 1) / 20 / 1000)
    rng = np.random.default_rng(args.seed)
    os.makedirs(args.folder, exist_ok=True)
    truth = {}
    for name, error in zip(HALVES, args.error):
        half = Half(name, rng, error, args)
        for repeat in range(1, args.repeats + 1):
            x, z = trace(half, rng, args)
            write(os.path.join(args.folder, f"{name}_{repeat}.txt"), x, z, name, args)
        truth[name] = dict(
            radius_mm=half.radius, centre_to_centre_mm=half.centre, bump_angle_deg=half.angle, overall_mm=half.overall
        )
    return truth


if __name__ == "__main__":
    options = parser().parse_args()
    print(json.dumps(make(options), indent=1))
