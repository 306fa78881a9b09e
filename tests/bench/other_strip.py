# SPDX-License-Identifier: GPL-3.0-or-later
"""The foil of other_scanner.py: its midline as a walk of arcs, its rough edges, and how much of each pixel it covers.

Lengths in mm, in the foil's own frame: O at the origin, the middle of the bumps along x, bump 1 at the lowest angle.
`side` is the unit normal that looks away from O on the lands and is carried along the walk."""

import math

import numpy as np

from loop_foil import natural_spline

LIP_MM, BEND_MM = 2.0, 0.4


class Walk:
    """Points of a midline at equal steps: xy, side, bump (index from 0; else -1), u (-1 to 1 on a bump's arc)."""

    def __init__(self, step_mm):
        self.step, self.parts = step_mm, []

    def add(self, xy, side, bump=-1, u=None):
        n = len(xy)
        self.parts.append((xy, side, np.full(n, bump), np.zeros(n) if u is None else u))

    def arc(self, centre, radius, start, end, bump=-1):
        """side turns from `start` to `end` (radians); a negative radius has the centre on the side's own hand."""
        n = max(2, int(round(abs((end - start) * radius) / self.step)))
        t = (np.arange(n) + 0.5) / n
        angle = start + (end - start) * t
        side = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        self.add(np.asarray(centre) + radius * side, side, bump, 2 * t - 1)

    def line(self, start, end, side):
        n = max(2, int(round(math.dist(start, end) / self.step)))
        t = ((np.arange(n) + 0.5) / n)[:, None]
        self.add(np.asarray(start) * (1 - t) + np.asarray(end) * t, np.tile(side, (n, 1)))

    def close(self):
        self.xy, self.side, self.bump, self.u = (np.concatenate(p) for p in zip(*self.parts))
        self.psi = np.arctan2(self.xy[:, 1], self.xy[:, 0])
        return self


def polar(radius, angle):
    return radius * np.array([math.cos(angle), math.sin(angle)])


def bump_of(foil, index):
    """Numbers of one bump: arc length as designed, X from the chord that it has in common with the overall circle."""
    design, overall, radius = foil["design"], foil["overall_radius_mm"], foil["radius_mm"][index]
    half = math.radians(design["bump_angle_deg"]) * design["bump_radius_mm"] / radius / 2
    distance = radius * math.cos(half) + math.sqrt(overall**2 - (radius * math.sin(half)) ** 2)
    theta = math.acos((distance**2 - radius**2 - overall**2) / (2 * radius * overall))
    return {
        "index": index + 1, "radius_mm": radius, "bump_angle_deg": 2 * math.degrees(half),
        "intersection_angle_deg": math.degrees(theta), "centre_to_centre_mm": distance,
        "height_mm": overall - (distance - radius),
    }  # fmt: skip


def tangent_angles(overall, fillet, bump):
    """(at O, at C): from the bump's axis to where the fillet's circle touches the land, and the bump."""
    a, b, c = overall - fillet, bump["radius_mm"] + fillet, bump["centre_to_centre_mm"]
    return math.acos((a * a + c * c - b * b) / (2 * a * c)), math.acos((b * b + c * c - a * a) / (2 * b * c))


def add_lip(walk, overall, start):
    """Turns outwards by 90 degrees where the first land begins."""
    out, along = polar(1, start), polar(1, start + math.pi / 2)
    centre = polar(overall + BEND_MM, start)
    foot = centre - BEND_MM * along
    walk.line(foot + LIP_MM * out, foot, along)
    walk.arc(centre, -BEND_MM, start + math.pi / 2, start)


def walk_of(foil, step_mm):
    design, overall = foil["design"], foil["overall_radius_mm"]
    fillet, count = design["fillet_radius_mm"], design["bump_count"]
    bumps = [bump_of(foil, i) for i in range(count)]
    reach = [tangent_angles(overall, fillet, b) for b in bumps]
    axes = [(i - (count - 1) / 2) * math.radians(design["pitch_deg"]) for i in range(count)]
    start = axes[0] - reach[0][0] - foil["first_land_mm"] / overall
    end = axes[-1] + reach[-1][0] + foil["last_land_mm"] / overall
    walk = Walk(step_mm)
    if "lip" not in foil or foil["lip"]:
        add_lip(walk, overall, start)
    at = start
    for i, (axis, (land, arc)) in enumerate(zip(axes, reach)):
        walk.arc((0, 0), overall, at, axis - land)
        walk.arc(polar(overall - fillet, axis - land), fillet, axis - land, axis + arc)
        walk.arc(polar(bumps[i]["centre_to_centre_mm"], axis), -bumps[i]["radius_mm"], axis + arc, axis - arc, i)
        walk.arc(polar(overall - fillet, axis + land), fillet, axis - arc, axis + land)
        at = axis + land
    walk.arc((0, 0), overall, at, end)
    walk.half_span = (end - start) / 2
    return walk.close()


def deviate(walk, effects):
    """Moves the midline as the part's effects say; returns what each edge moves outwards (mm)."""
    radial = walk.xy / np.linalg.norm(walk.xy, axis=1, keepdims=True)
    moved, wider, end = np.zeros_like(walk.xy), np.zeros(len(walk.xy)), walk.psi / walk.half_span
    for e in effects:
        mm = e.get("amplitude_um", 0) / 1000
        way = walk.side if e.get("along") == "normal" else radial
        on = (walk.bump >= 0) * 1.0
        if e["id"] == "part.ovality":
            moved += mm * np.cos(2 * (walk.psi - math.radians(e.get("phase_deg", 0))))[:, None] * way
        elif e["id"] == "part.spiral":
            moved += mm * (end**3)[:, None] * way
        elif e["id"] == "free.foil.s":
            moved += natural_spline(e["knots"], end)[:, None] / 1000 * way
        elif e["id"] == "part.bump_crown":  # away from C is against the side
            moved -= (mm * on * (1 + np.cos(np.pi * walk.u)) / 2)[:, None] * walk.side
        elif e["id"] == "part.bump_skew":
            moved -= (mm * on * walk.u * (1 - walk.u**2) * 1.5 * math.sqrt(3))[:, None] * walk.side
        elif e["id"] == "free.bump.phi":
            moved -= (on * natural_spline(e["knots"], walk.u) / 1000)[:, None] * walk.side
        elif e["id"] == "free.bump.index":
            first, every = e.get("first", e.get("every")), e.get("every")
            raised = e.get("bumps") or range(first, walk.bump.max() + 2, every)
            moved -= (mm * np.isin(walk.bump + 1, list(raised)) * (1 + np.cos(np.pi * walk.u)) / 2)[:, None] * walk.side
        elif e["id"] == "part.thickness_taper":
            wider += e["thickness_change_um"] / 1000 * end / 4
    walk.xy = walk.xy + moved
    return wider


def scatter(rng, count, step, length, form):
    """Unit variance along the walk; `length`: where the correlation is 1/e. Exponential, or Matern with 3/2."""
    n = 1 << (count + int(20 * length / step) - 1).bit_length()
    decay = 1 / length if form == "exponential" else 2.1462 / length
    k = 2 * np.pi * np.fft.rfftfreq(n, step)
    power = (decay**2 + k**2) ** (-1.0 if form == "exponential" else -2.0)
    weight = np.full(len(k), 2.0)
    weight[0] = weight[-1] = 1
    power *= n / np.sum(weight * power)
    return np.fft.irfft(np.fft.rfft(rng.standard_normal(n)) * np.sqrt(power), n)[:count]


def outline_of(rng, foil, effects, edges, step_mm):
    """Closed outline about O, turned as the foil lies on the scan, and the normals out of the strip (mm)."""
    walk = walk_of(foil, step_mm)
    half = foil["design"]["thickness_mm"] / 2 + deviate(walk, effects)
    draw = lambda: scatter(rng, len(half), step_mm, edges["correlation_mm"], edges["form"])
    common, *own = edges["common_mm"] * draw(), edges["own_mm"] * draw(), edges["own_mm"] * draw()
    outer = walk.xy + (common + half + own[0])[:, None] * walk.side
    inner = walk.xy + (common - half + own[1])[:, None] * walk.side
    outline = np.concatenate([outer, inner[::-1]])
    normal = np.concatenate([walk.side, -walk.side[::-1]])
    c, s = math.cos(math.radians(foil["rotate_deg"])), math.sin(math.radians(foil["rotate_deg"]))
    turn = np.array([[c, s], [-s, c]]) * ([[1], [-1]] if foil.get("mirror") else [[1], [1]])
    return outline @ turn, normal @ turn


def disc_outline(rng, disc, edges, step_mm):
    """A pin's outline (mm): its one edge has both scatters. Closed over a seam that no correlation crosses."""
    angle = np.linspace(0, 2 * np.pi, max(16, int(2 * np.pi * disc["radius_mm"] / step_mm)), endpoint=False)
    draw = lambda: scatter(rng, len(angle), step_mm, edges["correlation_mm"], edges["form"])
    radius = disc["radius_mm"] + edges["common_mm"] * draw() + edges["own_mm"] * draw()
    return np.array(disc["centre_mm"]) + radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def leaf_outline(leaf):
    """A feeler leaf on its edge (mm): straight, its edges smooth."""
    c, s = math.cos(math.radians(leaf["rotate_deg"])), math.sin(math.radians(leaf["rotate_deg"]))
    x, y = leaf["length_mm"] / 2, leaf["width_mm"] / 2
    corners = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    return np.array(leaf["centre_mm"]) + corners @ np.array([[c, s], [-s, c]])


def cut(points):
    """Pieces of a closed polygon's sides, cut where they cross whole x or y; sides are shorter than a pixel."""
    ends = np.roll(points, -1, axis=0)
    at = [np.zeros(len(points)), np.ones(len(points))]
    for axis in (0, 1):
        low, high = points[:, axis], ends[:, axis]
        line = np.maximum(np.floor(low), np.floor(high))
        crosses = np.floor(low) != np.floor(high)
        at.append(np.where(crosses, (line - low) / np.where(crosses, high - low, 1), 0))
    at = np.sort(np.stack(at), axis=0)[:, :, None]
    places = points + at * (ends - points)
    return places[:-1].reshape(-1, 2), places[1:].reshape(-1, 2)


def split_long(points):
    """The polygon with points added until no side is longer than half a pixel."""
    ends = np.roll(points, -1, axis=0)
    count = np.maximum(1, np.ceil(2 * np.hypot(*(ends - points).T)).astype(int))
    index = np.repeat(np.arange(len(points)), count)
    t = (np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count)) / count[index]
    return points[index] + t[:, None] * (ends - points)[index]


def coverage(polygons, width, height):
    """The share of every pixel that closed polygons (px) cover, exactly: signed areas of cut sides, summed along
    rows."""
    total = np.zeros(height * (width + 2))
    for polygon in polygons:
        a, b = cut(split_long(polygon + 0.5))  # pixel centres lie at whole numbers
        middle, rise = (a + b) / 2, b[:, 1] - a[:, 1]
        inside = (middle[:, 1] >= 0) & (middle[:, 1] < height)
        cell = np.floor(middle[inside]).astype(np.int64)
        x = np.clip(cell[:, 0], 0, width)
        part = np.clip(middle[inside, 0] - x, 0, 1)
        at = cell[:, 1] * (width + 2) + x
        np.add.at(total, at, rise[inside] * (1 - part))
        np.add.at(total, at + 1, rise[inside] * part)
    total, result = total.reshape(height, width + 2), np.empty((height, width), np.float32)
    for row in range(height):
        result[row] = np.abs(np.cumsum(total[row])[:width])
    return result
