# SPDX-License-Identifier: GPL-3.0-or-later
"""The foils, scanners and effects that the loop is tried on: seeded specs for `foilgauge render`."""

import math

import numpy as np

from loop_foil import Midline, natural_spline

SCANNER_EFFECTS = [
    "scan.scale_y", "scan.shear", "scan.carriage_ripple", "scan.row_step", "scan.optical_quadratic",
    "scan.optical_cubic", "scan.carriage_quadratic", "scan.column_step",
    "scan.carriage_start",
]  # fmt: skip
PART_EFFECTS = ["part.ovality", "part.spiral", "part.bump_crown", "part.bump_skew", "part.thickness_taper"]
# Effects that evidence alone looks for.
EVIDENCE_EFFECTS = [
    "scan.optical_quintic", "scan.keystone", "scan.yaw", "scan.ripple_growth", "scan.chip_tilt",
    "scan.chip_gap", "part.lobes", "part.dent",
]  # fmt: skip
# Coordinate of a free-form curve, and the direction that it moves the picture in.
CURVES = [
    ("scan.x", "x"), ("scan.y", "y"), ("foil.s", None), ("bump.phi", None), ("edge.normal", None),
    ("scan.x", "y"), ("scan.y", "x"),
]  # fmt: skip

MOST_AT_START_UM = 450  # an effect of the carriage's start that is larger at the scan's edge is refused by `render`

# The built-in Gen II design comes every second time.
GEN2 = {
    "form": "classical", "bump_count": 9, "bump_radius_mm": 3.32, "bump_angle_deg": 63.15,
    "overall_radius_mm": 20.73, "pitch_deg": 40 / 3, "fillet_radius_mm": 0.35, "thickness_mm": 0.1,
    "rotor_diameter_mm": 40,
}  # fmt: skip
DESIGNS = [
    GEN2,
    {**GEN2, "bump_count": 7, "bump_radius_mm": 4.0, "bump_angle_deg": 60.0, "overall_radius_mm": 22.0,
     "pitch_deg": 15.5, "rotor_diameter_mm": 42.2},
    GEN2,
    {**GEN2, "form": "sinusoidal", "bump_radius_mm": 3.2, "bump_angle_deg": 60.0, "fillet_radius_mm": 1.1},
    GEN2,
    {**GEN2, "bump_count": 11, "bump_radius_mm": 2.6, "bump_angle_deg": 60.0, "pitch_deg": 10.5},
    GEN2,
    {**GEN2, "bump_count": 6, "bump_radius_mm": 2.9, "bump_angle_deg": 58.0, "overall_radius_mm": 15.0,
     "pitch_deg": 16.0, "rotor_diameter_mm": 28.8},
]  # fmt: skip


def log_uniform(rng, low, high):
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def draw_foil(rng, design):
    """Springback as the declared model knows it: each bump by its own amount, arc length kept."""
    spring = rng.uniform(0.0, 0.04) + 0.008 * rng.standard_normal(design["bump_count"])
    foil = {
        "design": {k: v for k, v in design.items() if k != "form"},
        "overall_radius_mm": float(design["overall_radius_mm"] * (1 + rng.uniform(0.002, 0.02))),
        "radius_mm": [float(design["bump_radius_mm"] * (1 + s)) for s in spring],
        "mirror": bool(rng.integers(0, 2)),
        "first_land_mm": float(rng.uniform(1.5, 2.1)),
        "last_land_mm": float(rng.uniform(1.0, 1.6)),
        "rotate_deg": float(rng.uniform(-180, 180)),
    }
    if design["form"] == "sinusoidal":
        foil["lip"] = None
    return foil


def draw_scanner(rng, index):
    """Bits and polarity alternate; tone, shading and flare, which the edge model does not contain, come
    in a third, a third and a fifth of the cases."""
    light = (index // 2) % 2 == 0
    scanner = {
        "dpi": 4800,
        "bits": 16 if index % 2 else 8,
        "blur_px": float(rng.uniform(0.9, 2.0)),
        "noise": log_uniform(rng, 0.5, 2.0),
        "background": float(rng.uniform(25, 45) if light else rng.uniform(200, 225)),
        "contrast": float(rng.uniform(150, 180) if light else -rng.uniform(140, 170)),
    }
    if rng.random() < 1 / 3:
        scanner["gamma"] = log_uniform(rng, 0.6, 1.8)
    if rng.random() < 1 / 3:
        scanner["shading"] = {axis: float(rng.uniform(-0.04, 0.04)) for axis in ("x", "y", "quadratic")}
    if rng.random() < 1 / 5:
        halo = {"fraction": float(rng.uniform(0.03, 0.12)), "length_px": float(rng.uniform(8, 25))}
        scanner["rough"] = {"halo": halo}
    return scanner


def half_size_mm(foils):
    """Half the chord: where "the ends of the foil" are."""
    return float(max(np.ptp(Midline(f, f["design"], 0.5).xy[:, 1]) / 2 for f in foils))


def draw_place(rng, low, high):
    return float(low + (high - low) * rng.uniform(0.25, 0.75))


def draw_evidence_effect(rng, kind, amplitude_um, half_mm, ranges_mm):
    """Members of one of EVIDENCE_EFFECTS."""
    (x, x_end), (y, y_end) = ranges_mm
    phase = float(rng.uniform(-90, 90))
    if kind == "scan.optical_quintic":
        return {"amplitude_um": amplitude_um, "half_width_mm": half_mm, "centre_mm": draw_place(rng, x, x_end)}
    if kind == "scan.keystone":
        middle = {"x_mm": draw_place(rng, x, x_end), "y_mm": draw_place(rng, y, y_end)}
        return {"amplitude_um": amplitude_um, "half_width_mm": half_mm, **middle}
    if kind in ("scan.chip_tilt", "scan.chip_gap"):  # a tilted chip's ends lie above and below
        size = amplitude_um * (2 if kind == "scan.chip_tilt" else 1)
        return {"amplitude_um": size, "x_mm": draw_place(rng, x, x_end), "pitch_mm": float(rng.uniform(6, 14))}
    if kind == "scan.yaw":
        return {"amplitude_um": amplitude_um, "period_mm": log_uniform(rng, 6, 30), "phase_deg": 2 * phase}
    if kind == "scan.ripple_growth":
        growth = float(rng.choice([-1, 1]) / half_mm)
        return {"amplitude_um": amplitude_um / 2, "period_mm": log_uniform(rng, 2, 8), "phase_deg": 2 * phase, "growth_per_mm": growth}
    along = {"along": str(rng.choice(["radius", "normal"]))}
    if kind == "part.lobes":
        return {"amplitude_um": amplitude_um, "phase_deg": phase, "lobes": int(rng.integers(3, 6)), **along}
    place = {"place_deg": float(rng.uniform(-50, 50)), "width_deg": log_uniform(rng, 0.8, 4)}
    return {"amplitude_um": amplitude_um, **place, "along": "normal"}


def draw_effect(rng, kind, half_mm, ranges_mm, size=None):
    """One effect, of 3 to 30 um at the foil's ends unless its size is given; ranges_mm: of x and of y,
    what every foil of the case crosses."""
    sign = float(rng.choice([-1, 1]))
    size = size or log_uniform(rng, 3, 40 if kind.endswith("_step") else 30)
    effect = {"id": kind}
    if kind in ("scan.scale_y", "scan.shear"):
        effect["value"] = sign * size / (1000 * half_mm)
    elif kind == "scan.carriage_ripple":
        period, phase = log_uniform(rng, 0.8, 6), float(rng.uniform(-180, 180))
        effect.update(amplitude_um=size, period_mm=period, phase_deg=phase)
    elif kind == "scan.row_step":
        effect.update(amplitude_um=sign * size, y_mm=draw_place(rng, *ranges_mm[1]))
    elif kind == "scan.carriage_start":  # its size is told where the foil begins
        y = ranges_mm[1][0]
        length = max(log_uniform(rng, 2, 12), y / math.log(MOST_AT_START_UM / size))
        effect.update(amplitude_um=sign * size * math.exp(y / length), length_mm=length)
    elif kind == "scan.column_step":
        effect.update(amplitude_um=sign * size, x_mm=draw_place(rng, *ranges_mm[0]))
    elif kind in ("part.ovality", "part.spiral"):
        oval = kind == "part.ovality"
        effect["amplitude_um"] = size if oval else sign * size
        if oval:
            effect["phase_deg"] = float(rng.uniform(-90, 90))
        effect["along"] = str(rng.choice(["radius", "normal"]))
    elif kind in EVIDENCE_EFFECTS:
        effect.update(draw_evidence_effect(rng, kind, sign * size, half_mm, ranges_mm))
    elif kind == "part.thickness_taper":
        effect["thickness_change_um"] = sign * size
    elif kind.startswith("part."):
        effect["amplitude_um"] = sign * size
    else:
        effect.update(amplitude_um=sign * size, half_width_mm=half_mm)
        if rng.random() < 0.5:  # else about the middle of the picture
            effect["centre_mm"] = float(rng.uniform(8, 30))
    return effect


def relatives(coordinate, x, moves):
    """Columns of the table's effects and of the geometry over a coordinate."""
    u = (x - x.mean()) / (np.ptp(x) / 2)
    if coordinate == "edge.normal":
        return np.stack([np.ones_like(x), np.cos(np.radians(x)), np.sin(np.radians(x))], axis=1)
    if coordinate == "bump.phi":
        return np.stack([u**k for k in range(5)], axis=1)
    columns = [u**k for k in range(4)]
    if coordinate == "foil.s":
        columns += [f(k * u) for k in (1.0, 2.0) for f in (np.cos, np.sin)]
    return np.stack(columns, axis=1)


def is_new(coordinate, moves, x, y):
    """Three turning points or more, and less than half of it (rms) left to the listed effects."""
    if np.count_nonzero(np.diff(np.sign(np.diff(y)))) < 3:
        return False
    base = relatives(coordinate, x, moves)
    bases = [base]
    if (coordinate, moves) == ("scan.y", "y"):
        for period in np.exp(np.linspace(math.log(1.0), math.log(40), 60)):
            wave = 2 * np.pi * x / period
            bases.append(np.column_stack([base, np.cos(wave), np.sin(wave)]))
    left = min(np.linalg.norm(y - b @ np.linalg.lstsq(b, y, rcond=None)[0]) for b in bases)
    return left > 0.5 * np.linalg.norm(y)


def draw_knots(rng, coordinate, low, high):
    if coordinate == "edge.normal":
        # A scanner sees edges, not which side of the foil they are on: odd harmonics.
        at = np.arange(0, 360, 10.0)
        amplitude, phase = rng.uniform(0.3, 1, 2), rng.uniform(0, 2 * np.pi, 2)
        waves = zip(amplitude, (3, 5), phase)
        return at, sum(a * np.cos(k * np.radians(at) + p) for a, k, p in waves)
    count = int(rng.integers(3, 8))
    gaps = rng.uniform(0.6, 1.4, count + 1)
    at = low + (high - low) * (np.cumsum(gaps)[:-1] / gaps.sum())
    value = rng.uniform(0.4, 1, count) * (-1) ** np.arange(count)
    at, value = np.concatenate([[low], at, [high]]), np.concatenate([[0], value, [0]])
    if coordinate == "bump.phi":  # flat at the ends, so that the fillets are left alone
        at = np.concatenate([[-1, -0.985], at[1:-1] * 0.97, [0.985, 1]])
        value = np.concatenate([[0, 0], value[1:-1], [0, 0]])
    return at, value


def draw_curve(rng, coordinate, moves, low, high, size=None):
    """A smooth curve that is no near copy of a listed effect; its largest value is its size."""
    period = 360.0 if coordinate == "edge.normal" else 0.0
    while True:
        at, value = draw_knots(rng, coordinate, low, high)
        x = np.linspace(0, 360, 721)[:-1] if period else np.linspace(low, high, 600)
        y = natural_spline(list(zip(at, value)), x, period)
        if is_new(coordinate, moves, x, y):
            break
    scale = (size or log_uniform(rng, 3, 30)) / np.max(np.abs(y))
    effect = {"id": "free." + coordinate, "knots": [[float(a), float(v * scale)] for a, v in zip(at, value)]}
    if moves:
        effect["moves"] = moves
    if coordinate == "foil.s":
        effect["along"] = str(rng.choice(["radius", "normal"]))
    return effect


def extent_mm(foils):
    """Range of every foil's midline about its O: [foil][x or y][low, high], in the scan's axes."""
    result = []
    for foil in foils:
        midline = Midline(foil, foil["design"], 0.5)
        xy = midline.to_scan(midline.xy)
        result.append([[float(xy[:, a].min()), float(xy[:, a].max())] for a in (0, 1)])
    return result


def place(rng, scans):
    """Every scan has the same size, and its foils lie about its middle: a scanner's fields are centred on
    its glass. Foils of one scan lie below each other. Returns the size in mm."""
    margin, gap = 4.0, 2.5
    sizes = []
    for foils in scans:
        boxes = extent_mm(foils)
        height = sum(y[1] - y[0] for _, y in boxes) + gap * (len(foils) - 1)
        sizes.append((max(x[1] - x[0] for x, _ in boxes), height))
    size = [max(s[axis] for s in sizes) + 2 * margin for axis in (0, 1)]
    for foils, (_, height) in zip(scans, sizes):
        top = (size[1] - height) / 2 + rng.uniform(-0.8, 0.8)
        for foil, (x, y) in zip(foils, extent_mm(foils)):
            left = (size[0] - (x[1] - x[0])) / 2 + rng.uniform(-0.8, 0.8)
            foil["centre_mm"] = [float(left - x[0]), float(top - y[0])]
            top += y[1] - y[0] + gap
    return size


def common_mm(scans, axis):
    """Range of x or y that every scan's first foil crosses."""
    lows, highs = [], []
    for foils in scans:
        low, high = extent_mm(foils)[0][axis]
        lows.append(foils[0]["centre_mm"][axis] + low)
        highs.append(foils[0]["centre_mm"][axis] + high)
    return max(lows), min(highs)


def draw_scans(rng, layout, index):
    """(design, foils of each scan, whether the scans show the same foil)."""
    design = DESIGNS[int(rng.integers(len(DESIGNS)))]
    if layout == "foils":
        if index % 2:  # one scan that shows three
            scans = [[draw_foil(rng, design) for _ in range(3)]]
            for foil in scans[0]:
                foil["rotate_deg"] = float(rng.choice([-90, 90]) + rng.uniform(-12, 12))
        else:
            scans = [[draw_foil(rng, design)] for _ in range(3)]
        return design, scans, False
    foil = draw_foil(rng, design)
    if layout == "single":
        return design, [[foil]], False
    turned = {**foil, "rotate_deg": foil["rotate_deg"] + float(layout)}
    return design, [[foil], [turned]], True


def draw_case(rng, layout, index, kinds, size=None):
    """A case: specs (one per scan), the design, the effects. kinds: ids of listed effects, or one
    (coordinate, moves)."""
    design, scans, same = draw_scans(rng, layout, index)
    scanner = draw_scanner(rng, index)
    mm = place(rng, scans)
    foils = [f for s in scans for f in s]
    half, ranges = half_size_mm(foils), [common_mm(scans, axis) for axis in (0, 1)]
    effects = []
    for kind in kinds:
        if isinstance(kind, str):
            effects.append(draw_effect(rng, kind, half, ranges, size))
            continue
        coordinate, moves = kind
        low, high = (-1.0, 1.0)
        if coordinate.startswith("scan."):
            low, high = 2.0, mm[0 if coordinate == "scan.x" else 1] - 2.0
        effects.append(draw_curve(rng, coordinate, moves, low, high, size))
    pixels = [int(math.ceil(v / 25.4 * 4800)) for v in mm]
    specs = [
        {"schema": "foilgauge/render/1", "seed": int(rng.integers(1, 2**31)), "width_px": pixels[0],
         "height_px": pixels[1], "foils": f, "scanner": scanner, "effects": effects}
        for f in scans
    ]  # fmt: skip
    return {"design": design, "same_foil": same, "specs": specs, "effects": effects}
