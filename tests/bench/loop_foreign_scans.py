# SPDX-License-Identifier: GPL-3.0-or-later
"""Scans of foils with causes that no list of effects names, by a rasteriser that shares no code with the program's.

A foil is a chain of arcs and lines in its own frame (mm, the bearing's centre at 0). A cause of the part moves its
points there; a pose lays it on the glass; a cause of the scanner moves the glass points: true = nominal + d(nominal).
The outline's polygon is rasterised by its exact area in every pixel, then blurred, and given noise and gray levels.
"""

import cv2
import numpy as np
from scipy.linalg import cho_solve, cholesky, toeplitz
from scipy.ndimage import gaussian_filter

DPI = 2400
PX_MM = 25.4 / DPI
STEP_MM = 0.004
# Lengths of the Gen II foil in mm, angles in rad.
OVERALL, BUMP, ANGLE, PITCH = 20.73, 3.32, np.radians(63.15), np.radians(120 / 9)
THICKNESS, FILLET, BEND, LIP, FIRST_LAND, LAST_LAND, BUMPS = 0.1, 0.35, 0.4, 2.0, 1.8, 1.3, 9
# Smooth fields have their amplitude this far from the middle of the glass.
REACH_MM = 18.0
# Larger shifts than this are no longer plausible of any scanner or foil.
CAP_UM = 150.0


def unit(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


# ---- the foil


def draw_foil(rng):
    """Radii scatter, arc lengths stay the design's up to 0.3 %, the pitch is uneven."""
    spread = rng.uniform(0.005, 0.02)
    overall = OVERALL * (1 + rng.uniform(0, 0.015))
    radius = BUMP * (1 + rng.uniform(0, 0.03) + spread * rng.standard_normal(BUMPS))
    half = 0.5 * ANGLE * BUMP / radius * (1 + 0.003 * rng.standard_normal(BUMPS))
    distance = radius * np.cos(half) + np.sqrt(overall**2 - (radius * np.sin(half)) ** 2)
    place = PITCH * (np.arange(BUMPS) - (BUMPS - 1) / 2) + np.radians(0.2) * rng.standard_normal(BUMPS)
    return {"overall": overall, "radius": radius, "distance": distance, "place": place, "spread": spread}


def arc_points(centre, radius, start, end, inward):
    count = max(8, int(radius * abs(end - start) / STEP_MM) + 2)
    normal = unit(np.linspace(start, end, count))
    return centre + radius * normal, -normal if inward else normal


def join(foil, k):
    """Half-angle at O of bump k with its fillets, and the half-angle of its arc at C."""
    x, r, inner = foil["distance"][k], foil["radius"][k], foil["overall"] - FILLET
    at_o = np.arccos((x**2 + inner**2 - (r + FILLET) ** 2) / (2 * x * inner))
    at_c = np.arccos((x**2 + (r + FILLET) ** 2 - inner**2) / (2 * x * (r + FILLET)))
    return at_o, at_c


def lip_points(foil, angle):
    radial, along = unit(angle), unit(angle + np.pi / 2)
    bend = (foil["overall"] + BEND) * radial
    heights = np.arange(LIP, 0, -STEP_MM)[:, None]
    line = bend - BEND * along + heights * radial
    towards = np.arctan2(-along[1], -along[0])
    points, normals = arc_points(bend, BEND, towards, towards - np.pi / 2, True)
    return np.vstack([line, points]), np.vstack([np.broadcast_to(along, line.shape), normals])


def bump_pieces(foil, k):
    r, x, psi = foil["radius"][k], foil["distance"][k], foil["place"][k]
    at_o, at_c = join(foil, k)
    centre = x * unit(psi)
    first, last = ((foil["overall"] - FILLET) * unit(psi + sign * at_o) for sign in (-1, 1))
    to_first, to_last = (np.arctan2(*(centre - f)[::-1]) for f in (first, last))

    def near(angle, base):
        return base + (angle - base + np.pi) % (2 * np.pi) - np.pi

    yield "fillet", arc_points(first, FILLET, psi - at_o, near(to_first, psi - at_o), False)
    yield "bump", arc_points(centre, r, psi + np.pi + at_c, psi + np.pi - at_c, True)
    yield "fillet", arc_points(last, FILLET, near(to_last, psi + at_o), psi + at_o, False)


def midline(foil):
    """Points, normals (outwards from O on lands), label, number of bump or land, u from -1 to 1 along each piece."""
    pieces = []
    starts = [foil["place"][k] - join(foil, k)[0] for k in range(BUMPS)]
    ends = [foil["place"][k] + join(foil, k)[0] for k in range(BUMPS)]
    begin, stop = starts[0] - FIRST_LAND / foil["overall"], ends[-1] + LAST_LAND / foil["overall"]
    pieces.append(("lip", 0, lip_points(foil, begin)))
    for k in range(BUMPS + 1):
        a, b = ([begin] + ends)[k], (starts + [stop])[k]
        pieces.append(("land", k, arc_points(np.zeros(2), foil["overall"], a, b, False)))
        pieces += [(label, k, made) for label, made in (bump_pieces(foil, k) if k < BUMPS else [])]
    line = {"points": np.vstack([p[2][0] for p in pieces]), "normals": np.vstack([p[2][1] for p in pieces])}
    sizes = [len(p[2][0]) for p in pieces]
    line["label"] = np.repeat([p[0] for p in pieces], sizes)
    line["number"] = np.repeat([p[1] for p in pieces], sizes)
    line["u"] = np.concatenate([np.linspace(-1, 1, n) for n in sizes])
    line["psi"] = np.arctan2(line["points"][:, 1], line["points"][:, 0])
    line["s"] = foil["overall"] * (line["psi"] - begin)
    return line


def fit_circle(points):
    """Orthogonal least squares: centre and radius."""
    middle = points.mean(axis=0)
    x = points - middle
    a, *_ = np.linalg.lstsq(np.column_stack([2 * x, np.ones(len(x))]), (x**2).sum(axis=1), rcond=None)
    centre, radius = a[:2], np.sqrt(a[2] + a[:2] @ a[:2])
    for _ in range(20):
        away = x - centre
        distance = np.hypot(*away.T)
        jacobian = np.column_stack([away / distance[:, None], np.ones(len(x))])
        step, *_ = np.linalg.lstsq(jacobian, distance - radius, rcond=None)
        centre, radius = centre + step[:2], radius + step[2]
    return centre + middle, radius


def measurand(line, points):
    """R0, R and h of the least-squares circles through lands and arcs of a part with its form, in mm."""
    centre, overall = fit_circle(points[line["label"] == "land"])
    radius, height = [], []
    for k in range(BUMPS):
        c, r = fit_circle(points[(line["label"] == "bump") & (line["number"] == k)])
        radius.append(r)
        height.append(overall - (np.hypot(*(c - centre)) - r))
    return overall, np.array(radius), np.array(height)


# ---- causes: a draw of parameters gives a field of unit amplitude


def speed_kink(rng):
    """The carriage's speed changes once, as where its belt's tension does: d_y bends at y0."""
    y0 = rng.uniform(-4, 4)
    return lambda x, y: (0 * x, np.maximum(0, y - y0) / REACH_MM)


def glass_sag(rng):
    """Glass on two rails sags; off the axis the lens sees height as a shift: d_x = x times y squared."""
    yc = rng.uniform(-3, 3)
    return lambda x, y: (x / REACH_MM * ((y - yc) / REACH_MM) ** 2, 0 * y)


def carriage_crab(rng):
    """The carriage turns to and fro about the vertical on worn rails: d_y = x times a slow wave of y."""
    period, phase = rng.uniform(9, 22), rng.uniform(0, 2 * np.pi)
    return lambda x, y: (0 * x, x / REACH_MM * np.sin(2 * np.pi * y / period + phase))


def glass_lens(rng):
    """A drop or a blister between foil and glass is a weak lens: points move away from its middle."""
    x0, y0, width = rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(3, 6)

    def shift(x, y):
        u, v = (x - x0) / width, (y - y0) / width
        fade = np.exp(0.5 - 0.5 * (u**2 + v**2))
        return u * fade, v * fade

    return shift


def sensor_bow(rng):
    """The sensor's line is bent: d_y = x squared."""
    xc = rng.uniform(-3, 3)
    return lambda x, y: (0 * x, ((x - xc) / REACH_MM) ** 2)


def head_settle(rng):
    """The head comes to rest sideways after the start: d_x decays over y."""
    length = rng.uniform(4, 9)
    return lambda x, y: (np.exp(-(y + REACH_MM) / length), 0 * y)


def hinge(rng):
    """A fold at one land: what lies behind it has turned about it."""
    k = rng.integers(3, 7)

    def move(line):
        at = np.flatnonzero((line["label"] == "land") & (line["number"] == k))
        start = at[len(at) // 2]
        away = (line["points"] - line["points"][start]) / REACH_MM
        return np.where(np.arange(len(away))[:, None] > start, np.column_stack([-away[:, 1], away[:, 0]]), 0.0)

    return move


def land_bow(rng):
    """Every land bows between its bumps, as lands spring back that the die did not press."""
    outwards = rng.choice([-1, 1])

    def move(line):
        height = outwards * (line["label"] == "land") * (1 - line["u"] ** 2) ** 2
        return height[:, None] * line["normals"]

    return move


def flat_spots(rng):
    """Two neighbours have a flat on their crowns, as where the foil was pinched."""
    k, width = rng.integers(0, BUMPS - 1), rng.uniform(0.2, 0.4)

    def move(line):
        on = (line["label"] == "bump") & ((line["number"] == k) | (line["number"] == k + 1))
        return (on * np.exp(-((line["u"] / width) ** 2)))[:, None] * line["normals"]

    return move


def lip_ringing(rng):
    """Bending the lip leaves a wave that fades along the foil."""
    length, period, phase = rng.uniform(8, 18), rng.uniform(6, 12), rng.uniform(0, 2 * np.pi)

    def move(line):
        wave = np.exp(-line["s"] / length) * np.cos(2 * np.pi * line["s"] / period + phase)
        return (wave * (line["label"] != "lip"))[:, None] * unit(line["psi"])

    return move


SCANNER = {f.__name__: f for f in (speed_kink, glass_sag, carriage_crab, glass_lens, sensor_bow, head_settle)}
PART = {f.__name__: f for f in (hinge, land_bow, flat_spots, lip_ringing)}


# ---- poses, edges, pictures


def draw_pose(rng, line, turn, mirror, side_mm):
    """Glass coordinates have 0 in the middle of the picture; y runs down."""
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.array([[c, -s], [s, c]]) @ np.diag([-1.0 if mirror else 1.0, 1.0])
    laid = line["points"] @ matrix.T
    middle = 0.5 * (laid.min(axis=0) + laid.max(axis=0))
    shift = -middle + (rng.uniform(-1.5, 1.5, 2) if side_mm else rng.uniform(-0.2, 0.2, 2))
    size = np.full(2, side_mm) if side_mm else np.ptp(laid, axis=0) + 3.0
    return {"matrix": matrix, "shift": shift, "size_px": np.ceil(size / PX_MM).astype(int)}


def edge_model(rng, edge):
    """Self-affine roughness with one-sided burrs, halved between the part and the scan; a halo; correlated noise."""
    rough = edge == "rough"
    return {
        "noise": rng.uniform(1.5, 2.5), "blur_px": rng.uniform(1.5, 2.0) if rough else rng.uniform(0.9, 1.4),
        "contrast": rng.uniform(150, 185), "background": rng.uniform(20, 40), "dark": bool(rng.integers(0, 2)),
        "rough_um": rng.uniform(1.0, 1.8) if rough else 0.0, "range_mm": rng.uniform(0.03, 0.07),
        "hurst": rng.uniform(0.6, 0.9), "burr_um": 2.0 if rough else 0.0, "halo": 0.08 if rough else 0.0,
        "noise_px": 0.45 if rough else 0.0,
    }  # fmt: skip


def roughness(rng, model, count):
    """One edge's deviation in um at steps of STEP_MM, outwards positive."""
    if not model["rough_um"]:
        return np.zeros(count)
    size = 1 << int(np.ceil(np.log2(count + 1000)))
    wave = 2 * np.pi * np.fft.rfftfreq(size, STEP_MM)
    power = (1 + (wave * model["range_mm"]) ** 2) ** -(model["hurst"] + 0.5)
    power[0] = 0
    rows = np.fft.irfft(np.fft.rfft(rng.standard_normal(size)) * np.sqrt(power), size)
    rows = model["rough_um"] * rows / np.sqrt(power.mean())
    for at in rng.integers(0, size, rng.poisson(0.1 * size * STEP_MM)):
        length = int(rng.uniform(0.03, 0.08) / STEP_MM)
        part = rows[at : at + 4 * length]
        part += model["burr_um"] * rng.exponential() * np.exp(-np.arange(len(part)) / length)
    return rows[:count]


def to_picture(pose, points, field, amplitude_mm):
    """Pixels that true points show at: nominal + d(nominal) = true, solved by iteration."""
    true = points @ pose["matrix"].T + pose["shift"]
    nominal = true
    for _ in range(8 if field else 0):
        nominal = true - amplitude_mm * np.stack(field(*nominal.T), axis=-1)
    return nominal / PX_MM + 0.5 * pose["size_px"] - 0.5


def coverage(polygon, size_px):
    """The polygon's exact area in every pixel. Edges must be shorter than a pixel: each crosses a column and a row at
    most, and is cut there; a piece covers its own pixel in part and everything to its right."""
    start = polygon + 0.5
    end = np.roll(start, -1, axis=0)
    way = end - start
    line = np.maximum(np.floor(start), np.floor(end))
    with np.errstate(divide="ignore", invalid="ignore"):
        cut = np.where(np.floor(start) != np.floor(end), (line - start) / way, 1.0)
    t = np.sort(np.column_stack([np.zeros(len(cut)), np.clip(cut, 0, 1), np.ones(len(cut))]), axis=1)
    width, height = size_px
    total = np.zeros((height, width + 2))
    for piece in range(3):
        a, b = start + way * t[:, [piece]], start + way * t[:, [piece + 1]]
        middle = 0.5 * (a + b)
        column, row = np.floor(middle).astype(int).T
        share, rise = middle[:, 0] - column, b[:, 1] - a[:, 1]
        np.add.at(total, (row, column), rise * (1 - share))
        np.add.at(total, (row, column + 1), rise * share)
    return np.abs(np.cumsum(total, axis=1)[:, :width])


def closed(outer, inner):
    """Outline with its two ends filled in steps shorter than a pixel."""
    share = np.linspace(0, 1, 40)[1:-1, None]
    last = outer[-1] + share * (inner[-1] - outer[-1])
    first = inner[0] + share * (outer[0] - inner[0])
    return np.vstack([outer, last, inner[::-1], first])


def draw_scan(rng, model, line, points, of_part, pose, field, amplitude_mm):
    """Gray levels of one scan. Half the roughness's variance, of_part, comes again in every scan of the part."""
    share = np.sqrt(0.5)
    sides = []
    for sign, own in zip((1, -1), of_part):
        rough = 1e-3 * share * (own + roughness(rng, model, len(points)))
        sides.append(points + sign * (0.5 * THICKNESS + rough)[:, None] * line["normals"])
    polygon = to_picture(pose, closed(*sides), field, amplitude_mm)
    light = coverage(polygon, pose["size_px"])
    sharp = gaussian_filter(light, model["blur_px"], truncate=6)
    if model["halo"]:
        sharp = (1 - model["halo"]) * sharp + model["halo"] * gaussian_filter(light, 8.0)
    noise = rng.standard_normal(light.shape)
    if model["noise_px"]:
        noise = gaussian_filter(noise, model["noise_px"])
        noise /= noise.std()
    level = 1 - sharp if model["dark"] else sharp
    gray = model["background"] + model["contrast"] * level + model["noise"] * noise
    return np.clip(np.rint(gray), 0, 255).astype(np.uint8)


def write_scan(path, gray):
    cv2.imwrite(path, gray, [cv2.IMWRITE_PNG_COMPRESSION, 1])


# ---- the oracle


def midline_covariance(model, lags):
    """Covariance in um^2 of the midline's rows, a pixel apart: white noise of the picture, roughness of both sides."""
    white = model["noise"] / model["contrast"] * np.sqrt(2 * model["blur_px"] * np.sqrt(np.pi)) * 1e3 * PX_MM
    rows = np.zeros(lags)
    rows[0] = 0.5 * white**2
    if model["rough_um"]:
        long = roughness(np.random.default_rng(1), model, 1 << 20)
        long -= long.mean()
        power = np.abs(np.fft.rfft(long)) ** 2 / len(long)
        lag = np.rint(np.arange(lags) * PX_MM / STEP_MM).astype(int)
        rows += 0.5 * np.fft.irfft(power)[lag] * np.exp(-((np.arange(lags) * PX_MM / 1.0) ** 2))
        rows[0] *= 1.001
    return rows


def factor_of(covariance):
    """Cholesky factor. Lags rounded to STEP_MM can make a covariance indefinite: white noise is added until it is not."""
    white = 0.0
    while True:
        try:
            return cholesky(toeplitz(covariance) + white * covariance[0] * np.eye(len(covariance)), lower=True)
        except np.linalg.LinAlgError:
            white = 2 * white + 1e-3


def oracle_error(model, line, poses, field, move):
    """Standard error in um of an amplitude whose shape is known, beside free circles and a pose for each scan."""
    chosen = np.arange(0, len(line["points"]), int(round(PX_MM / STEP_MM)))
    p, n = line["points"][chosen], line["normals"][chosen]
    label, number = line["label"][chosen], line["number"][chosen]
    covariance = midline_covariance(model, 2000)
    width = 3 * (BUMPS + 1) + 3 * len(poses) + 1
    normal_matrix = np.zeros((width, width))
    for scan, pose in enumerate(poses):
        if field:
            shift = np.stack(field(*(p @ pose["matrix"].T + pose["shift"]).T), axis=-1) @ pose["matrix"]
        else:
            shift = move(line)[chosen]
        for kind, count in (("bump", BUMPS), ("land", BUMPS + 1)):
            for k in range(count):
                at = (label == kind) & (number == k)
                design = np.zeros((at.sum(), width))
                circle = 3 * (k + 1) if kind == "bump" else 0
                design[:, circle : circle + 2] = n[at]
                design[:, circle + 2] = 1
                if scan:
                    place = 3 * (BUMPS + 1) + 3 * scan
                    design[:, place : place + 2] = n[at]
                    design[:, place + 2] = (n[at] * np.column_stack([-p[at][:, 1], p[at][:, 0]])).sum(axis=1)
                design[:, -1] = (n[at] * shift[at]).sum(axis=1)
                root = factor_of(covariance[: at.sum()])
                normal_matrix += design.T @ cho_solve((root, True), design)
    geometry, cross = normal_matrix[:-1, :-1], normal_matrix[:-1, -1]
    # Columns that no scan fills have zeros: the pseudo-inverse leaves them out.
    left = normal_matrix[-1, -1] - cross @ np.linalg.pinv(geometry, rcond=1e-12, hermitian=True) @ cross
    return 1 / np.sqrt(max(left, 1e-12))
