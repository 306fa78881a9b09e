# SPDX-License-Identifier: GPL-3.0-or-later
"""A scanner's driver and the light as they change a scan, for driver.py: one row per kind, of three strengths, and parts of
known size that are drawn with it by `foilgauge render` and by other_scanner.py."""

import math
from dataclasses import dataclass
from typing import Callable

import numpy as np

from loop_cases import GEN2
from other_strip import bump_of, walk_of

DPI = (2400, 4800)
RENDERERS = ("program", "other")
STRENGTHS = ("mild", "medium", "strong")
BUMPS = 3  # a foil of a few bumps is a picture of a second
THICK_MM, TOO_THICK_MM, THICK_LIMIT_MM = 0.1, 0.1085, 0.105
LIMIT_MM = 0.004  # of clearance and diameter, beyond the values of good parts
SIZE_STEP = 24  # px: sizes that every resampling divides
MARGIN_MM = 0.9
LEAF_MM, LEAF_LENGTH_MM, U_KNOWN_MM = 0.1, 6.0, 0.0005


@dataclass
class Kind:
    name: str
    words: str
    strengths: tuple
    change: Callable  # (scanner, strength, random generator)
    renderers: tuple = RENDERERS
    foils_only: bool = False


# --- tone curves ----------------------------------------------------------------------------


def points_of(curve, count=17):
    """[[in, out], ...] of a curve of 0 to 1."""
    x = np.linspace(0, 1, count)
    return [[float(255 * a), float(255 * b)] for a, b in zip(x, np.clip([curve(v) for v in x], 0, 1))]


def s_curve(slope, middle):
    """A hyperbolic tangent with that slope in the middle of the scale."""
    low, high = 0.01, 60.0
    for _ in range(60):
        k = (low + high) / 2
        low, high = (k, high) if k / 2 / math.tanh(k / 2) < slope else (low, k)
    ends = [math.tanh(k * (v - middle)) for v in (0, 1)]
    return points_of(lambda v: (math.tanh(k * (v - middle)) - ends[0]) / (ends[1] - ends[0]), 33)


def random_curve(rng, evenness):
    """Six steps of random height; the lower the evenness, the more they differ."""
    steps = 0.02 + 0.88 * rng.dirichlet(np.full(6, evenness))
    x, y = np.linspace(0, 255, 7), np.concatenate([[0], np.cumsum(steps / steps.sum())])
    return [[float(a), min(float(255 * b), 255.0)] for a, b in zip(x, y)]


def toe_curve(length, is_shoulder):
    """A parabola up to `length`, then straight; a shoulder is a toe turned by 180 degrees."""
    end = 1 - length / 2
    toe = lambda v: (v * v / (2 * length) if v < length else v - length / 2) / end
    return points_of((lambda v: 1 - toe(1 - v)) if is_shoulder else toe)


def ends_of(scanner):
    """Dark and bright level, counts."""
    return sorted((scanner["background"], scanner["background"] + scanner["contrast"]))


def auto_contrast(scanner, clipped):
    """Stretches so that a share of the contrast is clipped at either end."""
    dark, bright = ends_of(scanner)
    cut = clipped * (bright - dark)
    return [[0.0, 0.0], [dark + cut, 0.0], [bright - cut, 255.0], [255.0, 255.0]]


# --- kinds ----------------------------------------------------------------------------------


def unsharp(scanner, amount, rng):
    scanner["unsharp_mask"] = {"amount_pct": amount, "radius_px": 1.0, "threshold": 0}


def levels(scanner, count, rng):
    scanner["levels"] = count


def one_bit(scanner, share, rng):
    dark, bright = ends_of(scanner)
    off = share if rng.random() < 1 / 2 else 1 - share
    scanner.update(levels=2, threshold=float(round(dark + off * (bright - dark))))


def side_band(scanner, amplitude, rng):
    """Longer where it is stronger; half as long in pixels at 2400 dpi."""
    length = (4 + 40 * abs(amplitude)) * scanner["dpi"] / 4800
    scanner["shadow"] = {"amplitude": amplitude, "direction_deg": float(rng.uniform(-180, 180)),
                         "width_deg": float(rng.uniform(45, 100)), "length_px": length, "gap_px": 0.0}  # fmt: skip


def ellipse(scanner, ratio, rng):
    scanner["blur_px"] = [float(ratio), 1.0]


def turned_ellipse(scanner, ratio, rng):
    ellipse(scanner, ratio, rng)
    scanner["blur_angle_deg"] = float(rng.uniform(20, 160))


def one_channel(scanner, ppm, rng):
    """The channel that is measured, as it has the most contrast, or another one."""
    ppms, odd = [0.0, 0.0, 0.0], int(rng.integers(0, 3))
    ppms[odd] = float(ppm * rng.choice([-1, 1]))
    scanner["magnification_ppm"] = ppms
    scanner["channel_contrast"] = [1.0, 0.9, 0.85] if rng.random() < 1 / 2 else [0.85, 0.9, 1.0]


def stitched(scanner, rows, rng):
    places = np.sort(rng.uniform(0.2, 0.8, int(rng.integers(1, 4))))
    scanner["stitch"] = [[float(p), int(rows * rng.choice([-1, 1]))] for p in places]


def resampled(scanner, factor, rng):
    """Blur is of the sensor's own pixels."""
    scanner["resampled_from_dpi"] = scanner["dpi"] / factor
    scanner["blur_px"] = float(rng.uniform(0.6, 0.9))
    scanner["interpolation"] = str(rng.choice(["linear", "cubic"]))


def shading(scanner, share, rng):
    """The brightest corner stays below the end of the scale."""
    fit = 245 / (ends_of(scanner)[1] * (1 + 1.5 * share))
    if fit < 1:
        scanner["background"] *= fit
        scanner["contrast"] *= fit
    scanner["shading"] = [float(share * rng.choice([-1, 1])), float(share / 2 * rng.choice([-1, 1]))]


def defaults(scanner, amount, rng):
    """Defaults of many drivers, in the order in which they apply them."""
    scanner["tone_curve"] = auto_contrast(scanner, 0.02)
    unsharp(scanner, amount, rng)
    scanner["jpeg_quality"] = {50: 92, 100: 85, 150: 75}[amount]


def set_tone(curve):
    def change(scanner, value, rng):
        scanner["tone_curve"] = curve(scanner, value, rng)

    return change


def set_member(name):
    def change(scanner, value, rng):
        scanner[name] = value

    return change


KINDS = [
    Kind("unsharp", "unsharp mask of 1 px: 50, 100, 150 %", (50, 100, 150), unsharp),
    Kind("s_curve", "S-shaped tone curve: slope 1.5, 2, 4", (1.5, 2, 4),
         set_tone(lambda s, v, rng: s_curve(v, float(rng.uniform(0.42, 0.58))))),
    Kind("points", "tone curve of 6 random steps", (30, 8, 3), set_tone(lambda s, v, rng: random_curve(rng, v))),
    Kind("auto_contrast", "auto contrast that clips 2, 6, 15 % of the contrast at either end", (0.02, 0.06, 0.15),
         set_tone(lambda s, v, rng: auto_contrast(s, v))),
    Kind("toe", "toe or shoulder over 30, 50, 80 % of the scale", (0.3, 0.5, 0.8),
         set_tone(lambda s, v, rng: toe_curve(v, rng.random() < 1 / 2))),
    Kind("levels", "64, 32, 16 gray levels", (64, 32, 16), levels),
    Kind("one_bit", "1 bit, threshold at 0.45, 0.38, 0.3 of the contrast", (0.45, 0.38, 0.3), one_bit),
    Kind("jpeg_png", "PNG that was a JPEG of quality 90, 75, 60", (90, 75, 60), set_member("jpeg_quality")),
    Kind("shadow", "shadow on one side: 8, 15, 30 % of the contrast", (-0.08, -0.15, -0.3), side_band),
    Kind("wall", "lit wall on one side: 10, 20, 40 % of the contrast", (0.1, 0.2, 0.4), side_band),
    Kind("ellipse", "blur of 1.5, 2.2, 3 px along x and 1 along y", (1.5, 2.2, 3), ellipse),
    Kind("turned", "the same blur, turned", (1.5, 2.2, 3), turned_ellipse),
    Kind("channel", "RGB, one channel larger or smaller by 200, 500, 1000 ppm", (200, 500, 1000), one_channel),
    Kind("stitched", "1, 2, 4 rows lost or doubled at 1 to 3 places", (1, 2, 4), stitched),
    Kind("resampled", "resampled from a dpi 1.5, 2, 3 times coarser", (1.5, 2, 3), resampled),
    Kind("gamma_low", "gamma 0.7, 0.5, 0.3", (0.7, 0.5, 0.3), set_member("gamma")),
    Kind("gamma_high", "gamma 1.5, 2.2, 3", (1.5, 2.2, 3.0), set_member("gamma")),
    Kind("thick", "strip 2, 3, 5 times as thick as the design's", (2, 3, 5), lambda s, v, rng: None, foils_only=True),
    Kind("shading", "shading of 10, 20, 35 % at the picture's edges", (0.1, 0.2, 0.35), shading),
    Kind("median", "noise reduction: median of 3 × 3, once, twice, four times", (1, 2, 4), set_member("median"),
         renderers=("other",)),
    Kind("defaults", "auto contrast, unsharp mask of 50, 100, 150 % and JPEG of 92, 85, 75 together", (50, 100, 150),
         defaults),
]  # fmt: skip
PLAIN = Kind("plain", "plain scan", (0,), lambda s, v, rng: None)


# --- parts and plain scanners ---------------------------------------------------------------


def plain_scanner(rng, dpi, state):
    """A scan that nothing is wrong with: ideal; moderate, with correlated noise; rough, with a little scatter of the edges,
    which the program flags by itself."""
    is_light, px = rng.random() < 2 / 3, dpi / 4800
    scanner = {
        "dpi": dpi, "bits": 8, "gamma": 1.0,
        "background": float(rng.uniform(25, 45) if is_light else rng.uniform(200, 225)),
        "contrast": float(rng.uniform(150, 175) if is_light else -rng.uniform(140, 170)),
        "blur_px": float(rng.uniform(0.7, 1.2) if dpi == 2400 else rng.uniform(1.0, 1.8)),
        "noise": float(rng.uniform(0.7, 1.6)), "scatter_px": 0.0, "correlation_px": 8 * px, "grain": 0.0,
    }  # fmt: skip
    if state != "ideal":
        scanner["grain"] = float(rng.uniform(0.1, 0.4))
    if state == "rough":
        scanner["scatter_px"] = 0.05 * px
    return scanner


def draw_foil(rng, thickness_mm):
    """A foil as it springs back, its arc length kept, and the design that it is held against."""
    design = {k: v for k, v in {**GEN2, "bump_count": BUMPS}.items() if k != "form"}
    spring = rng.uniform(0.0, 0.03) + 0.002 * rng.standard_normal(BUMPS)
    return {
        "design": {**design, "thickness_mm": thickness_mm},
        "overall_radius_mm": float(design["overall_radius_mm"] * (1 + rng.uniform(0.002, 0.02))),
        "radius_mm": [float(design["bump_radius_mm"] * (1 + s)) for s in spring],
        "mirror": bool(rng.integers(0, 2)),
        "first_land_mm": float(rng.uniform(1.5, 2.1)), "last_land_mm": float(rng.uniform(1.0, 1.6)),
        "rotate_deg": float(rng.uniform(-180, 180)),
    }  # fmt: skip


def turned_points(foil):
    """Of the midline, about O, as the foil lies."""
    c, s = math.cos(math.radians(foil["rotate_deg"])), math.sin(math.radians(foil["rotate_deg"]))
    xy = walk_of(foil, 0.02).xy * [1, -1 if foil["mirror"] else 1]
    return xy @ np.array([[c, s], [-s, c]])


def size_px(mm, dpi):
    return int(math.ceil(mm / 25.4 * dpi / SIZE_STEP)) * SIZE_STEP


def add_leaf(spec, rng, bottom_mm):
    """Below the foil, at any slope up to 45 degrees; returns where it ends."""
    angle = float(rng.uniform(-45, 45))
    half = LEAF_LENGTH_MM / 2 * abs(math.sin(math.radians(angle))) + 0.1
    spec["leaves"] = [{"centre_mm": [MARGIN_MM + LEAF_LENGTH_MM / 2, bottom_mm + MARGIN_MM + half],
                       "length_mm": LEAF_LENGTH_MM, "width_mm": float(LEAF_MM + U_KNOWN_MM * rng.standard_normal()),
                       "rotate_deg": angle}]  # fmt: skip
    return bottom_mm + MARGIN_MM + 2 * half


def foil_spec(rng, scanner, thickness_mm, has_leaf):
    foil = draw_foil(rng, thickness_mm)
    points = turned_points(foil)
    low, high = points.min(axis=0) - thickness_mm, points.max(axis=0) + thickness_mm
    foil["centre_mm"] = [float(v) for v in MARGIN_MM + rng.uniform(0, 0.05, 2) - low]
    width, bottom = (float(v) for v in MARGIN_MM + 0.05 + high - low)
    spec = {"foils": [foil], "effects": [], "scanner": scanner}
    if has_leaf:
        bottom, width = add_leaf(spec, rng, bottom), max(width, MARGIN_MM + LEAF_LENGTH_MM)
    dpi = scanner["dpi"]
    return {**spec, "width_px": size_px(width + MARGIN_MM, dpi), "height_px": size_px(bottom + MARGIN_MM, dpi)}


def disc_spec(rng, scanner, is_bad):
    """Pins of one nominal diameter; those that are too large are so by as much as a strip too thick."""
    nominal = float(round(rng.uniform(2, 8), 2))
    count = 3 if nominal < 4 else 2
    truth = [float(nominal + 0.002 * v + (TOO_THICK_MM - THICK_MM) * is_bad) for v in rng.uniform(-1, 1, count)]
    place = lambda k: [MARGIN_MM + nominal / 2 + k * (nominal + MARGIN_MM) + float(rng.uniform(0, 0.05)),
                       MARGIN_MM + nominal / 2 + float(rng.uniform(0, 0.05))]  # fmt: skip
    discs = [{"centre_mm": place(k), "radius_mm": d / 2} for k, d in enumerate(truth)]
    dpi, wide = scanner["dpi"], count * (nominal + MARGIN_MM)
    return {"foils": [], "discs": discs, "effects": [], "scanner": scanner, "nominal_mm": nominal,
            "width_px": size_px(wide + MARGIN_MM, dpi), "height_px": size_px(nominal + 2 * MARGIN_MM, dpi)}  # fmt: skip


def spec_of(case, is_plain=False):
    """The scan of a case, or the plain scan of the same part."""
    index = [k.name for k in KINDS].index(case["kind"]) if case["kind"] != "plain" else 0
    kind = PLAIN if is_plain or case["kind"] == "plain" else KINDS[index]
    key = [case["seed"], case["dpi"], RENDERERS.index(case["renderer"]), index % 4, case["part"] == "discs"]
    rng = np.random.default_rng([30] + key)
    states = ("ideal", "moderate", "rough" if index % 2 else "moderate")
    scanner = plain_scanner(rng, case["dpi"], states[case["seed"] % 3])
    value = kind.strengths[STRENGTHS.index(case["strength"])] if kind is not PLAIN else 0
    own = np.random.default_rng([31, index] + key)
    kind.change(scanner, value, own)
    is_bad = case["seed"] % 3 == 2
    thick = TOO_THICK_MM if is_bad else THICK_MM * (value if kind.name == "thick" else 1)
    spec = disc_spec(rng, scanner, is_bad) if case["part"] == "discs" else foil_spec(rng, scanner, thick, case.get("leaf"))
    return {**spec, "seed": int(own.integers(1, 2**31))}


def truth_of(spec):
    """{(quantity, index of the bump or disc from 0)}: true value, in the report's units."""
    if spec.get("discs"):
        return {("diameter", k): 2 * d["radius_mm"] for k, d in enumerate(spec["discs"])}
    foil = spec["foils"][0]
    design, truth = foil["design"], {}
    for k in range(design["bump_count"]):
        bump = bump_of(foil, k)
        truth["R", k], truth["h", k], truth["alpha", k] = (bump[n] for n in ("radius_mm", "height_mm", "bump_angle_deg"))
        truth["clearance", k] = (design["overall_radius_mm"] - bump["height_mm"] - design["rotor_diameter_mm"] / 2
                                 - design["thickness_mm"])  # fmt: skip
    return {("thickness", 0): design["thickness_mm"], **truth, ("R0", 0): foil["overall_radius_mm"]}


# Stated, as limits are judged where the scale is known. An older build reads it, too.
RENDERED = {"certificate": "rendered", "scale": {"u_rel": 1e-8}}


def design_of(spec):
    """With limits that good parts keep by LIMIT_MM and that a strip or pin too thick by 8.5 um does not."""
    if spec.get("discs"):
        nominal = spec["nominal_mm"]
        limits = {"diameter_mm": {"min": nominal - 0.002 - LIMIT_MM, "max": nominal + 0.002 + LIMIT_MM}}
        return {"schema": "foilgauge/design/1", "name": "pins", "form": "discs", "tolerances": limits,
                "calibration": RENDERED}  # fmt: skip
    design = spec["foils"][0]["design"]
    truth = truth_of(spec)
    good = [v + design["thickness_mm"] - THICK_MM for (name, _), v in truth.items() if name == "clearance"]
    limits = {"thickness_mm": {"max": THICK_LIMIT_MM},
              "clearance_mm": {"min": min(good) - LIMIT_MM, "max": max(good) + LIMIT_MM}}  # fmt: skip
    return {"schema": "foilgauge/design/1", "name": "driver", "form": "classical", "datum": "mid",
            "sleeve_radius_mm": design["overall_radius_mm"], **design, "thickness_mm": THICK_MM,
            "tolerances": limits, "calibration": RENDERED}  # fmt: skip


# --- what a renderer is told ----------------------------------------------------------------

SAME = ("dpi", "bits", "gamma", "background", "contrast", "blur_px", "noise", "blur_angle_deg", "tone_curve",
        "unsharp_mask", "levels", "threshold", "shadow", "resampled_from_dpi")  # fmt: skip


def for_program(spec):
    """As `foilgauge render` has it."""
    scanner, dpi = spec["scanner"], spec["scanner"]["dpi"]
    own = {name: scanner[name] for name in SAME if name in scanner}
    rough = {}
    if scanner["grain"]:
        own["noise_correlation"] = scanner["grain"]
    if scanner["scatter_px"]:
        rough = {"edge_roughness_um": scanner["scatter_px"] * 25400 / dpi,
                 "correlation_um": scanner["correlation_px"] * 25400 / dpi}  # fmt: skip
    if "jpeg_quality" in scanner:
        rough["jpeg"] = {"quality": scanner["jpeg_quality"]}
    if rough:
        own["rough"] = rough
    if "shading" in scanner:
        own["shading"] = dict(zip("xy", scanner["shading"]))
    if "stitch" in scanner:
        height_mm = spec["height_px"] / dpi * 25.4
        own["rows_lost"] = [{"y_mm": share * height_mm, "count": rows} for share, rows in scanner["stitch"]]
    if "magnification_ppm" in scanner:
        contrasts = [scanner["contrast"] * share for share in scanner["channel_contrast"]]
        own["colour_lines"] = {"magnification_ppm": scanner["magnification_ppm"], "contrast": contrasts}
    foils = list(spec["foils"]) + [straight_foil(leaf) for leaf in spec.get("leaves", [])]
    result = {"schema": "foilgauge/render/1", "seed": spec["seed"], "scanner": own,
              "width_px": spec["width_px"], "height_px": spec["height_px"]}  # fmt: skip
    return {**result, **({"discs": spec["discs"]} if spec.get("discs") else {"foils": foils})}


def straight_foil(leaf):
    """A leaf is a plain strip of a radius of 3 m: it bends by 1.5 um over 6 mm."""
    radius, angle = 3000.0, leaf["rotate_deg"] + 90
    centre = [leaf["centre_mm"][0] - radius * math.cos(math.radians(angle)),
              leaf["centre_mm"][1] - radius * math.sin(math.radians(angle))]  # fmt: skip
    design = {"form": "arc", "overall_radius_mm": radius, "thickness_mm": leaf["width_mm"],
              "subtended_angle_deg": math.degrees(leaf["length_mm"] / radius)}  # fmt: skip
    return {"design": design, "rotate_deg": angle, "centre_mm": centre}


def for_other(spec):
    """As other_scanner.py has it."""
    scanner = dict(spec["scanner"])
    scanner.update(common=0.5, form="exponential", lag_px=[1e-3, 1e-3], columns=0.0, grain=max(scanner["grain"], 1e-4))
    if np.min(scanner["blur_px"]) < 1.3:
        scanner["oversampling"] = 2
    return {**spec, "scanner": scanner}
