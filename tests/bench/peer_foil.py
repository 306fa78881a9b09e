# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared parts of both peers: from sub-pixel edge points of a strip to the foil's dimensions.

Written as a competent user of SciPy would: the design says roughly where bumps and lands are, the
circles are Nelder-Mead fits on orthogonal distances. It uses nothing of foilgauge.
"""

import argparse
import json

import numpy as np
from scipy.optimize import minimize

GEN2 = {
    "form": "classical",
    "bump_radius_mm": 3.32,
    "bump_angle_deg": 63.15,
    "overall_radius_mm": 20.73,
    "fillet_radius_mm": 0.35,
    "thickness_mm": 0.1,
}


def arguments(description):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("scan")
    parser.add_argument("--design", help="design JSON; without it the Gen II design")
    parser.add_argument("--dpi", type=float, default=4800.0)
    options = parser.parse_args()
    options.nominal = dict(GEN2)
    if options.design:
        with open(options.design, encoding="utf-8") as file:
            options.nominal.update(json.load(file))
    return options


def taubin(x, y):
    """Algebraic start (Taubin 1991), by the singular vectors of the centred moments."""
    mx, my = x.mean(), y.mean()
    u, v = x - mx, y - my
    z = u * u + v * v
    zm = z.mean()
    z0 = (z - zm) / (2 * np.sqrt(zm))
    a = np.linalg.svd(np.column_stack((z0, u, v)), full_matrices=False)[2][2]
    a0 = a[0] / (2 * np.sqrt(zm))
    a3 = -zm * a0
    cx, cy = -a[1] / (2 * a0), -a[2] / (2 * a0)
    radius = np.sqrt(a[1] ** 2 + a[2] ** 2 - 4 * a0 * a3) / (2 * abs(a0))
    return cx + mx, cy + my, radius


def fit_circle(points, offset):
    """Circle through both edges at once: a point of offset d lies at R + d. Nelder-Mead on the
    orthogonal distances, in a frame centred and scaled by the start."""
    x, y = points[:, 0], points[:, 1]
    start = np.array(taubin(x, y))
    scale = max(np.ptp(x), np.ptp(y))
    u, v, d = (x - start[0]) / scale, (y - start[1]) / scale, offset / scale

    def cost(p):
        r = np.sqrt((u - p[0]) ** 2 + (v - p[1]) ** 2) - d - p[2]
        return np.dot(r, r)

    first = np.array([0.0, 0.0, start[2] / scale])
    step = 1e-3
    simplex = np.vstack([first] + [first + step * row for row in np.eye(3)])
    best = minimize(
        cost,
        first,
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "xatol": 1e-8, "fatol": 1e-16, "maxiter": 2000},
    ).x
    cx, cy, radius = best * scale + np.array([start[0], start[1], 0.0])
    rms = np.sqrt(cost(best) / len(u)) * scale
    return cx, cy, radius, rms


def fit_robust(points, offset):
    """Fits twice: dust and burrs beyond four robust standard deviations are left out."""
    cx, cy, radius, _ = fit_circle(points, offset)
    r = np.hypot(points[:, 0] - cx, points[:, 1] - cy) - offset - radius
    keep = np.abs(r - np.median(r)) < 4 * 1.4826 * np.median(np.abs(r - np.median(r))) + 1e-6
    return fit_circle(points[keep], offset[keep])


def find_overall(points, nominal, rng):
    """The circle near the design's radius that most edge points lie on: three random points at a
    time, because bumps and lip outnumber the lands."""
    sample = points[rng.integers(0, len(points), 1500)]
    trio = sample[rng.integers(0, len(sample), (6000, 3))]
    ax, ay = trio[:, 0, 0], trio[:, 0, 1]
    bx, by = trio[:, 1, 0] - ax, trio[:, 1, 1] - ay
    cx, cy = trio[:, 2, 0] - ax, trio[:, 2, 1] - ay
    with np.errstate(divide="ignore", invalid="ignore"):
        d = 2 * (bx * cy - by * cx)
        ux = (cy * (bx**2 + by**2) - by * (cx**2 + cy**2)) / d
        uy = (bx * (cx**2 + cy**2) - cx * (bx**2 + by**2)) / d
        radius = np.hypot(ux, uy)
    good = np.abs(radius / nominal["overall_radius_mm"] - 1) < 0.1
    ux, uy, radius = (ux + ax)[good], (uy + ay)[good], radius[good]
    distance = np.hypot(sample[:, 0] - ux[:, None], sample[:, 1] - uy[:, None])
    hits = np.sum(np.abs(distance - radius[:, None]) < 0.03, axis=1)
    best = np.argmax(hits)
    circle = ux[best], uy[best], radius[best]
    for _ in range(5):  # a trio is a rough start: all points that lie near it know better
        distance = np.hypot(points[:, 0] - circle[0], points[:, 1] - circle[1])
        circle = taubin(*points[np.abs(distance - circle[2]) < 0.03].T)
    return circle


def fillet_limits(nominal, radius, centre_to_centre, overall):
    """Half-angles (at C and at O) at which the fillet between the two circles begins. Its centre
    lies at R + r_f from C and at R0 - r_f from O."""
    a, b, x = radius + nominal["fillet_radius_mm"], overall - nominal["fillet_radius_mm"], centre_to_centre
    at_bump = np.arccos((x * x + a * a - b * b) / (2 * x * a))
    at_overall = np.arccos((x * x + b * b - a * a) / (2 * x * b))
    return at_bump, at_overall


def nominal_limits(nominal):
    radius, overall = nominal["bump_radius_mm"], nominal["overall_radius_mm"]
    half = np.radians(nominal["bump_angle_deg"]) / 2
    x = radius * np.cos(half) + np.sqrt(overall**2 - (radius * np.sin(half)) ** 2)
    return fillet_limits(nominal, radius, x, overall)


class Edges:
    """The edge points of one strip in mm, each known to be of the inner or the outer edge."""

    def __init__(self, points, normals, centre):
        self.points = points
        outward = points - np.asarray(centre)
        self.side = np.where(np.sum(outward * normals, axis=1) > 0, 1.0, -1.0)
        self.place(centre)

    def place(self, centre):
        """Polar coordinates about O; angles are unwrapped round the foil's middle."""
        v = self.points - np.asarray(centre[:2])
        self.r = np.hypot(v[:, 0], v[:, 1])
        angle = np.arctan2(v[:, 1], v[:, 0])
        middle = np.arctan2(np.sin(angle).mean(), np.cos(angle).mean())
        self.psi = (angle - middle + np.pi) % (2 * np.pi) - np.pi


def find_bumps(edges, overall, nominal):
    """Angular places of the crowns: runs of inner-edge points well inside the overall circle."""
    inner = edges.side < 0
    psi, depth = edges.psi[inner], overall - nominal["thickness_mm"] / 2 - edges.r[inner]
    order = np.argsort(psi)
    psi, depth = psi[order], depth[order]
    high = np.flatnonzero((depth > 0.15) & (depth < 1.5))
    runs = np.split(high, np.flatnonzero(np.diff(psi[high]) > 0.02) + 1)
    width = 2 * nominal_limits(nominal)[1]
    return [
        (psi[run[0]] + psi[run[-1]]) / 2
        for run in runs
        if len(run) > 50 and 0.3 * width < np.ptp(psi[run]) < 1.5 * width
    ]


def lip_side(edges, overall):
    """-1 or +1: the end, by angle, that leaves the overall circle outwards; 0 without a lip."""
    out = edges.r > overall + 0.4
    if np.count_nonzero(out) < 50:
        return 0
    return 1 if edges.psi[out].mean() > 0 else -1


def land_mask(edges, overall, crowns, at_overall, lip, thickness, band):
    near = np.abs(edges.r - edges.side * thickness / 2 - overall) < band
    away = np.min(np.abs(edges.psi[:, None] - np.asarray(crowns)), axis=1) > at_overall
    # The end lands: without the cap of the free end and without the bend of the lip.
    margin = 0.4 / overall
    low, high = edges.psi.min() + margin, edges.psi.max() - margin
    if lip:
        out = edges.psi[edges.r > overall + 0.25]
        bend = 1.0 / overall
        low, high = (low, out.min() - bend) if lip > 0 else (out.max() + bend, high)
    return near & away & (edges.psi > low) & (edges.psi < high)


def fit_overall(edges, start, nominal):
    thickness = nominal["thickness_mm"]
    at_overall = nominal_limits(nominal)[1] * 1.04 + 0.05 / nominal["overall_radius_mm"]
    centre, overall = start[:2], start[2]
    # The random circle may lie on either edge of the strip: settle before anything is cut away.
    for band in (0.12, 0.06, 0.06):
        edges.place(centre)
        crowns = find_bumps(edges, overall, nominal)
        lip = lip_side(edges, overall)
        mask = land_mask(edges, overall, crowns, at_overall, lip, thickness, band)
        inner, outer = mask & (edges.side < 0), mask & (edges.side > 0)
        thickness = float(np.median(edges.r[outer]) - np.median(edges.r[inner]))
        cx, cy, overall, _ = fit_robust(edges.points[mask], edges.side[mask] * thickness / 2)
        centre = (cx, cy)
    edges.place(centre)
    return centre, overall, thickness, find_bumps(edges, overall, nominal), lip


def fit_bump(edges, crown, centre, overall, thickness, nominal):
    """Two passes: the arc is cut by the design's angle first, then by the fitted circles."""
    near = np.abs(edges.psi - crown) < 1.2 * nominal_limits(nominal)[1]
    points, side = edges.points[near], edges.side[near]
    limit = 0.8 * nominal_limits(nominal)[1]
    arc = np.abs(edges.psi[near] - crown) < limit
    for last in (False, True):
        cx, cy, radius, rms = fit_robust(points[arc], -side[arc] * thickness / 2)
        x = np.hypot(cx - centre[0], cy - centre[1])
        if last:
            return cx, cy, radius, x, rms, int(arc.sum())
        w = 0.97 * fillet_limits(nominal, radius, x, overall)[0]
        axis = np.array([centre[0] - cx, centre[1] - cy]) / x
        v = points - np.array([cx, cy])
        r = np.hypot(v[:, 0], v[:, 1])
        arc = (v @ axis > r * np.cos(w)) & (np.abs(r + side * thickness / 2 - radius) < 0.06)


def derive(number, bump, centre, overall):
    cx, cy, radius, x, rms, count = bump
    alpha = 2 * np.arccos((x * x + radius**2 - overall**2) / (2 * x * radius))
    theta = np.arccos((x * x - radius**2 - overall**2) / (2 * radius * overall))
    return {
        "number": number,
        "radius_mm": radius,
        "centre_mm": [cx, cy],
        "centre_to_centre_mm": x,
        "bump_angle_deg": float(np.degrees(alpha)),
        "intersection_angle_deg": float(np.degrees(theta)),
        "height_mm": overall - (x - radius),
        "rms_um": 1000 * rms,
        "points": count,
    }


def measure(points_px, normals, nominal, dpi):
    """Edge points (x, y) in px with the strip's outward normals, to the report."""
    points = points_px * (25.4 / dpi)
    rng = np.random.default_rng(1)
    start = find_overall(points, nominal, rng)
    edges = Edges(points, normals, start[:2])
    centre, overall, thickness, crowns, lip = fit_overall(edges, start, nominal)
    # Image y runs down, so a rising angle is clockwise as seen; without a lip that is the order.
    crowns.sort(reverse=lip > 0)
    bumps = [
        derive(k + 1, fit_bump(edges, crown, centre, overall, thickness, nominal), centre, overall)
        for k, crown in enumerate(crowns)
    ]
    foil = {
        "number": 1,
        "overall": {"radius_mm": overall, "centre_mm": list(centre)},
        "thickness_mm": thickness,
        "flags": [] if lip else ["no_lip"],
        "bumps": bumps,
    }
    print(json.dumps({"foils": [foil]}, indent=1))
