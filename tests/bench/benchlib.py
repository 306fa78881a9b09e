# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared parts of the benchmarks: truth files, the accuracy bound, errors, tables."""

import json
import os
import platform
import resource
import subprocess
import time

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Another build of the program can be named, to compare two.
FOILGAUGE = os.environ.get("FOILGAUGE_PROGRAM") or os.path.join(ROOT, "build", "foilgauge")
MM_PER_INCH = 25.4

# JSON name, unit of the tables, factor from the report's unit to it.
BUMP_QUANTITIES = [
    ("radius_mm", "R", "µm", 1000.0),
    ("height_mm", "h", "µm", 1000.0),
    ("bump_angle_deg", "alpha", "deg", 1.0),
    ("intersection_angle_deg", "theta", "deg", 1.0),
]
OVERALL_QUANTITY = ("radius_mm", "R0", "µm", 1000.0)


def shared_folder():
    folder = os.environ.get("FOILGAUGE_SHARED") or os.path.join(ROOT, "..", "shared")
    return os.path.abspath(folder)


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def load_truth(path):
    """A truth file of one foil. `foilgauge render` may list its foils; others state the one."""
    truth = load(path)
    if truth.get("foils"):
        truth = {**truth, **truth["foils"][0]}
    truth.setdefault("effects", [])
    return truth


def write_design(truth, path):
    """The design that a truth file carries, as a design file for program and peers alike."""
    known = truth["design"]
    design = {
        "schema": "foilgauge/design/1",
        "name": truth.get("name", "bench")[:60],
        "form": known.get("form") or ("sinusoidal" if known["fillet_radius_mm"] > 0.7 else "classical"),
        "datum": "mid",
        "sleeve_radius_mm": known["overall_radius_mm"],
    }
    names = (
        "bump_count bump_radius_mm bump_angle_deg overall_radius_mm pitch_deg fillet_radius_mm "
        "thickness_mm rotor_diameter_mm"
    )
    design.update({name: known[name] for name in names.split() if name in known})
    with open(path, "w", encoding="utf-8") as file:
        json.dump(design, file)


def match(foil, truth):
    """Pairs of (measured, true) bumps in the order of their numbers. None when the count differs.
    Without a lip the number is a convention only: then the order that fits better counts."""
    bumps, true = foil["bumps"], truth["bumps"]
    if len(bumps) != len(true):
        return None
    pairs = list(zip(bumps, true))
    if "no_lip" in foil.get("flags", []):
        back = list(zip(bumps, true[::-1]))

        def distance(candidate):
            return sum((b["radius_mm"] - t["radius_mm"]) ** 2 for b, t in candidate if b["radius_mm"])

        pairs = min(pairs, back, key=distance)
    if any(b[name] is None for b, _ in pairs for name, *_ in BUMP_QUANTITIES):
        return None
    return pairs


def errors(foil, truth):
    """{short name: array of errors} in the tables' units; None when the foil was not measured."""
    pairs = match(foil, truth)
    if pairs is None:
        return None
    result = {
        short: np.array([(b[name] - t[name]) * factor for b, t in pairs])
        for name, short, _, factor in BUMP_QUANTITIES
    }
    difference = foil["overall"]["radius_mm"] - truth["overall_radius_mm"]
    result["R0"] = np.array([difference * 1000.0])
    return result


def rms(values):
    values = np.asarray(values, dtype=float)
    return float(np.sqrt(np.mean(values**2))) if values.size else float("nan")


# --- the bound of one foil ------------------------------------------------------------------


def edge_bound_px(blur_px, contrast, noise, bits=8):
    """Standard deviation of one edge crossing: (n / A) sqrt(2 s sqrt(pi)). Levels are in units of
    an 8-bit scale; rounding to whole numbers adds a twelfth of its step's square."""
    step = 1.0 if bits == 8 else 255.0 / 65535.0
    effective = np.sqrt(noise**2 + step**2 / 12.0)
    return effective / abs(contrast) * np.sqrt(2.0 * blur_px * np.sqrt(np.pi))


def fillet_angles(radius, fillet, centre_to_centre, overall):
    """Half-angles at C and at O where the fillet begins: its centre lies at R + r_f from C and at
    R0 - r_f from O."""
    a, b, x = radius + fillet, overall - fillet, centre_to_centre
    at_bump = np.arccos((x * x + a * a - b * b) / (2 * x * a))
    at_overall = np.arccos((x * x + b * b - a * a) / (2 * x * b))
    return at_bump, at_overall


def arc_moments(middle, half):
    """Integral over an arc of g g' with g = (cos, sin, 1): the information about (x, y, R)."""
    low, high = middle - half, middle + half
    c2 = half + (np.sin(2 * high) - np.sin(2 * low)) / 4
    s2 = half - (np.sin(2 * high) - np.sin(2 * low)) / 4
    cs = (np.sin(high) ** 2 - np.sin(low) ** 2) / 2
    c = np.sin(high) - np.sin(low)
    s = np.cos(low) - np.cos(high)
    return np.array([[c2, cs, c], [cs, s2, s], [c, s, 2 * half]])


def foil_bounds(truth, sigma_px, dpi=4800.0, pitch_deg=40.0 / 3.0, end_lands_mm=(0.0, 0.0)):
    """Cramér-Rao bound of every bump's R, h, alpha, theta and of R0, in the tables' units: edge
    crossings of both edges, one per pixel of arc, each of sigma_px, on the arcs that are left
    between the fillets. Lands beyond the first and last bump count by their stated length."""
    px = MM_PER_INCH / dpi
    sigma = sigma_px * px
    overall, fillet = truth["overall_radius_mm"], truth["design"]["fillet_radius_mm"]
    bumps = truth["bumps"]
    x = np.array([b["centre_to_centre_mm"] for b in bumps])
    radius = np.array([b["radius_mm"] for b in bumps])
    w, land_start = fillet_angles(radius, fillet, x, overall)
    place = np.radians(pitch_deg) * np.arange(len(bumps))

    lands = [(a + u, b - v) for a, u, b, v in zip(place, land_start, place[1:], land_start[1:])]
    first, last = place[0] - land_start[0], place[-1] + land_start[-1]
    lands.append((first - end_lands_mm[0] / overall, first))
    lands.append((last, last + end_lands_mm[1] / overall))
    density = 2.0 / px  # crossings per mm of arc: two edges
    information = sum(
        arc_moments((a + b) / 2, (b - a) / 2) * overall * density for a, b in lands if b > a
    )
    cov_overall = np.linalg.inv(information) * sigma**2

    result = {"R0": np.array([np.sqrt(cov_overall[2, 2]) * 1000.0])}
    names = ("R", "h", "alpha", "theta")
    rows = []
    for k in range(len(bumps)):
        # Frame of the bump: its axis along O to C. c: place of C along it; the arc faces O.
        cov_bump = np.linalg.inv(arc_moments(np.pi, w[k]) * radius[k] * density) * sigma**2
        axis = np.array([np.cos(place[k]), np.sin(place[k])])
        along = np.zeros((2, 3))
        along[0, :2], along[1, 2] = axis, 1.0
        o_r0 = along @ cov_overall @ along.T
        # Variables: (c, R) of the bump, (o, R0) of the overall circle along the axis; X = c - o.
        cov = np.zeros((4, 4))
        cov[:2, :2] = cov_bump[np.ix_([0, 2], [0, 2])]
        cov[2:, 2:] = o_r0
        rows.append([np.sqrt(g @ cov @ g) for g in gradients(x[k], radius[k], overall)])
    for name, column, factor in zip(names, np.array(rows).T, (1000.0, 1000.0, 1.0, 1.0)):
        result[name] = column * factor
    return result


def gradients(x, radius, overall):
    """d(R, h, alpha, theta) by (c, R, o, R0), with h = R0 - (X - R)."""
    ca = (x * x + radius**2 - overall**2) / (2 * x * radius)
    ct = (x * x - radius**2 - overall**2) / (2 * radius * overall)
    da = -2 / np.sqrt(1 - ca * ca)
    dt = -1 / np.sqrt(1 - ct * ct)
    a_x = da * (1 / radius - ca / x)
    a_r = da * (1 / x - ca / radius)
    a_0 = da * (-overall / (x * radius))
    t_x = dt * x / (radius * overall)
    t_r = dt * (-1 / overall - ct / radius)
    t_0 = dt * (-1 / radius - ct / overall)
    deg = np.degrees(1.0)
    return np.array(
        [
            [0, 1, 0, 0],
            [-1, 1, 1, 1],
            [a_x * deg, a_r * deg, -a_x * deg, a_0 * deg],
            [t_x * deg, t_r * deg, -t_x * deg, t_0 * deg],
        ]
    )


# --- machine and tables ---------------------------------------------------------------------


def machine():
    model = platform.processor()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            model = next(line.split(":", 1)[1].strip() for line in file if "model name" in line)
    except (OSError, StopIteration):
        pass
    return f"{os.cpu_count()} cores, {model}, Linux {platform.release().split('-')[0]}"


class MachineLoad:
    """Use of the machine by others since this was made: what all processors did, without this process and its children."""

    def __init__(self):
        self.began = time.monotonic()
        self.busy, self.stolen = self.ticks()
        self.own = self.own_seconds()

    @staticmethod
    def ticks():
        """Seconds of all processors: busy (user, nice, system, interrupts) and stolen by the host."""
        with open("/proc/stat", encoding="ascii") as file:
            columns = [int(text) / os.sysconf("SC_CLK_TCK") for text in file.readline().split()[1:9]]
        return columns[0] + columns[1] + columns[2] + columns[5] + columns[6], columns[7]

    @staticmethod
    def own_seconds():
        return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))

    def said(self):
        busy, stolen = self.ticks()
        whole = (time.monotonic() - self.began) * os.cpu_count()
        other = max(0.0, busy - self.busy - (self.own_seconds() - self.own))
        return (f"Meanwhile other programs took {100 * other / whole:.1f} % of the machine, "
                f"and its host kept {100 * (stolen - self.stolen) / whole:.1f} % back.")


def program_version():
    return subprocess.run([FOILGAUGE, "--version"], capture_output=True, text=True).stdout.strip()


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def number(value, digits=3):
    """Fixed significant digits; a dash for an unknown value."""
    if value is None or not np.isfinite(value):
        return "–"
    return f"{value:.{digits}g}"
