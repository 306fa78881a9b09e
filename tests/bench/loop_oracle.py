# SPDX-License-Identifier: GPL-3.0-or-later
"""Detectability of an effect at best: generalised least squares with its form and the noise's
covariance known, every number of the geometry and the pose of each scan left free."""

import math

import numpy as np

from loop_foil import Midline, natural_spline

MM_PER_PX = 25.4 / 4800
STEP_MM = 4 * MM_PER_PX  # rows as the loop has them


def scanner_shift_um(effect, at, middle_mm):
    """Shift of places (mm) by an effect of unit size, um along x and y; `middle_mm` of the picture."""
    d = np.zeros_like(at)
    x, y = at.T
    name = effect["id"]
    if name == "scan.scale_y":
        d[:, 1] = 1000 * effect["value"] * y
    elif name == "scan.shear":
        d[:, 0] = 1000 * effect["value"] * y
    elif name == "scan.carriage_ripple":
        wave = 2 * np.pi * y / effect["period_mm"] + np.radians(effect["phase_deg"])
        d[:, 1] = effect["amplitude_um"] * np.sin(wave)
    elif name == "scan.row_step":
        d[:, 1] = effect["amplitude_um"] * (y > effect["y_mm"])
    elif name == "scan.column_step":
        d[:, 0] = effect["amplitude_um"] * (x > effect["x_mm"])
    elif name == "scan.carriage_start":
        d[:, 1] = effect["amplitude_um"] * np.exp(-y / effect["length_mm"])
    elif name in ("free.scan.x", "free.scan.y"):
        along = x if name.endswith("x") else y
        d[:, 0 if effect["moves"] == "x" else 1] = natural_spline(effect["knots"], along)
    elif name.startswith("scan."):
        axis = 1 if name == "scan.carriage_quadratic" else 0
        power = 3 if name.endswith("cubic") else 2
        middle = effect["centre_mm"] if "centre_mm" in effect else middle_mm[axis]
        d[:, axis] = effect["amplitude_um"] * ((at[:, axis] - middle) / effect["half_width_mm"]) ** power
    return d


def smooth_listed(midline, at, normal):
    """Columns of the table's effects that are smooth, their middles and lengths free as far as columns can: what an unlisted
    curve must stand beside."""
    wide = lambda name, middle: {"id": name, "amplitude_um": 10.0, "half_width_mm": 18.0, "centre_mm": middle}
    glass = [{"id": name, "value": 1e-3} for name in ("scan.scale_y", "scan.shear")]
    glass += [wide(name, m) for name in ("scan.optical_quadratic", "scan.carriage_quadratic") for m in (5.0, 35.0)]
    glass += [wide("scan.optical_cubic", m) for m in (5.0, 20.0, 35.0)]
    glass += [{"id": "scan.carriage_start", "amplitude_um": 10.0, "length_mm": length} for length in (3.0, 8.0)]
    columns = [np.sum(scanner_shift_um(e, at, (0, 0)) * normal, axis=1) for e in glass]
    part = [{"id": "part.ovality", "phase_deg": phase} for phase in (0, 45)]
    part += [{"id": name} for name in ("part.spiral", "part.bump_crown", "part.bump_skew")]
    columns += [midline.part_shift_um([{**e, "amplitude_um": 10.0}]) for e in part]
    return np.array(columns).T


def geometry_columns(midline, normal, first_scan):
    """Derivatives of the residual by R0, each bump's X, beta and R, the pose, and from the second scan on
    the turn. Returns (part's columns, scan's own columns)."""
    n, part = len(midline.xy), [np.where(midline.bump < 0, 1.0, 0.0)]
    for i in range(midline.count):
        on = midline.bump == i
        axis = np.array([math.cos(midline.axis[i]), math.sin(midline.axis[i])])
        across = np.array([-axis[1], axis[0]])
        part.append(np.where(on, 1.0, 0.0))
        part.append(np.where(on, midline.normal @ axis, 0.0))
        part.append(np.where(on, midline.normal @ across, 0.0))
    turned = np.stack([-midline.xy[:, 1], midline.xy[:, 0]], axis=1)
    own = [normal[:, 0], normal[:, 1]]
    if not first_scan:
        own.append(np.sum(turned * midline.normal, axis=1))
    return np.array(part).T, np.array(own).T.reshape(n, -1)


def correlation(apart, length, form):
    if form == "gaussian":
        return np.exp(-((apart / length) ** 2))
    if form == "exponential":
        return np.exp(-apart / length)
    near = 2.1462 * apart / length  # Matern with 3/2: 1/e at the length
    return (1 + near) * np.exp(-near)


def noise_spectrum(w, scanner):
    """Of pixel noise along x or y, over that of white noise: a pixel is rho times the one before it and something new; the second
    renderer's, `noise_form` moving, a mean over three."""
    rho = scanner.get("noise_correlation", 0)
    if scanner.get("noise_form") == "moving" and rho:
        side = (1 - math.sqrt(1 - 2 * rho**2)) / (2 * rho)
        return (1 + 2 * side * np.cos(w)) ** 2 / (1 + 2 * side**2)
    return (1 - rho**2) / (1 - 2 * rho * np.cos(w) + rho**2)


def row_um(scanner):
    """The bound for a row of the midline: for one crossing of one edge and white noise (n / A) sqrt(2 s sqrt(pi)) px. Noise that is
    correlated across the edge tells 1 / spectrum over the line spread's power, exp(-w² s²); along it rows are long beside a pixel."""
    s, w = scanner["blur_px"], np.linspace(0, math.pi, 400)
    power = np.exp(-((w * s) ** 2))
    told = np.sum(power / noise_spectrum(w, scanner)) / np.sum(power)
    white = scanner["noise"] / abs(scanner["contrast"]) * math.sqrt(2 * s * math.sqrt(math.pi))
    rows = 2 * STEP_MM / MM_PER_PX  # crossings of both edges
    return white * math.sqrt(float(noise_spectrum(0.0, scanner)) / told / rows) * MM_PER_PX * 1000


def whiten(midline, scanner, columns):
    """Columns through the inverse root of the covariance of a row of the midline, arc by arc."""
    rough = scanner.get("rough", {})
    smooth = math.hypot(rough.get("edge_common_um", 0), rough.get("edge_roughness_um", 0) / math.sqrt(2))
    length = rough.get("correlation_um", 50) / 1000
    white = row_um(scanner)
    out = np.empty_like(columns)
    for piece in midline.pieces:
        along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(midline.xy[piece], axis=0).T))])
        apart = along[:, None] - along[None]
        covariance = smooth**2 * correlation(apart, length, rough.get("correlation_form", "gaussian"))
        covariance += (white**2 + 1e-6) * np.eye(len(along))
        out[piece] = np.linalg.solve(np.linalg.cholesky(covariance), columns[piece])
    return out


def pieces_of(midline):
    """Arcs and lands: where the next row is far away, or of another bump, a new one begins."""
    far = np.hypot(*np.diff(midline.xy, axis=0).T) > 3 * STEP_MM
    cut = np.flatnonzero(far | (np.diff(midline.bump) != 0)) + 1
    return np.split(np.arange(len(midline.bump)), cut)


def shift_um(midline, at, normal, middle_mm, effects):
    """Along the normal, what effects move together."""
    shape = midline.part_shift_um(effects)
    for effect in effects:
        shape = shape + np.sum(scanner_shift_um(effect, at, middle_mm) * normal, axis=1)
        if effect["id"] == "free.edge.normal":  # both edges, which face opposite ways
            degrees = np.degrees(np.arctan2(normal[:, 1], normal[:, 0]))
            faces = [natural_spline(effect["knots"], degrees + turn, 360.0) for turn in (0, 180)]
            shape = shape + (faces[0] - faces[1]) / 2
    return shape


def seen(case, sets, unlisted=False):
    """A column for each set of effects: what geometry and poses leave of it, in standard errors of a row."""
    parts, blocks, scans = {}, [], 0
    for k, spec in enumerate(case["specs"]):
        for f, foil in enumerate(spec["foils"]):
            midline = Midline(foil, case["design"], STEP_MM)
            midline.pieces = pieces_of(midline)
            normal = midline.to_scan(midline.normal)
            at = midline.to_scan(midline.xy) + np.array(foil["centre_mm"])
            middle = [0.5 * MM_PER_PX * spec[side] for side in ("width_px", "height_px")]
            key = f if case["same_foil"] else (k, f)
            first = key not in parts
            parts.setdefault(key, len(parts))
            shapes = [shift_um(midline, at, normal, middle, effects) for effects in sets]
            part, own = geometry_columns(midline, normal, first)
            if unlisted:
                own = np.column_stack([own, smooth_listed(midline, at, normal)])
            white = whiten(midline, spec["scanner"], np.column_stack([*shapes, part, own]))
            blocks.append((parts[key], part.shape[1], white))
            scans += own.shape[1]
    width, count = max(p for _, p, _ in blocks), len(sets)
    geometry = np.zeros((sum(len(w) for *_, w in blocks), width * len(parts) + scans))
    signal, row, column = np.empty((len(geometry), count)), 0, width * len(parts)
    for part, numbers, white in blocks:
        rows = slice(row, row + len(white))
        signal[rows] = white[:, :count]
        geometry[rows, part * width : part * width + numbers] = white[:, count : count + numbers]
        own = white.shape[1] - count - numbers
        geometry[rows, column : column + own] = white[:, count + numbers :]
        row, column = row + len(white), column + own
    return signal - geometry @ np.linalg.lstsq(geometry, signal, rcond=None)[0]


def standard_errors(case, effects, unlisted=False):
    """The effects as they stand in the case, together: in standard errors of their common size. Unlisted ones are seen by
    what smooth listed effects cannot take up (of one scan)."""
    return float(np.linalg.norm(seen(case, [effects], unlisted)))


# --- effects against each other -----------------------------------------------------------------


def listed(size_mm):
    """(name, effects of any size) for every listed effect of the midline, over places, middles, lengths and periods."""
    bent = lambda name, middle: {"id": name, "amplitude_um": 10.0, "half_width_mm": 18.0, "centre_mm": float(middle)}
    for name in ("scan.scale_y", "scan.shear"):
        yield name, [{"id": name, "value": 1e-3}]
    for name in ("scan.optical_quadratic", "scan.optical_cubic", "scan.carriage_quadratic"):
        yield from ((name, [bent(name, middle)]) for middle in np.arange(0, size_mm, 2))
    for length in (1.5, 3, 6, 10):
        yield "scan.carriage_start", [{"id": "scan.carriage_start", "amplitude_um": 10.0, "length_mm": length}]
    for place in np.arange(2, size_mm, 0.7):
        for name, axis in (("scan.row_step", "y_mm"), ("scan.column_step", "x_mm")):
            yield name, [{"id": name, "amplitude_um": 10.0, axis: float(place)}]
    for period in np.geomspace(1.2, 40, 24):
        yield "scan.carriage_ripple", [{"id": "scan.carriage_ripple", "amplitude_um": 10.0, "period_mm": float(period),
                                        "phase_deg": phase} for phase in (0.0, 90.0)]  # fmt: skip
    yield "part.ovality", [{"id": "part.ovality", "amplitude_um": 10.0, "phase_deg": phase} for phase in (0, 45)]
    for name in ("part.spiral", "part.bump_crown", "part.bump_skew"):
        yield name, [{"id": name, "amplitude_um": 10.0}]


def against_listed(case):
    """The case's effect and every listed one, as `seen`: (columns, {name: [the columns of one place, middle, length or period]})."""
    size = MM_PER_PX * max(case["specs"][0][side] for side in ("width_px", "height_px"))
    others = list(listed(size))
    columns = seen(case, [case["effects"], *([e] for _, effects in others for e in effects)])
    groups, at, least = {}, 1, 1e-8 * np.linalg.norm(columns, axis=0).max()
    for name, effects in others:
        own = [k for k in range(at, at + len(effects)) if np.linalg.norm(columns[:, k]) > least]
        at += len(effects)
        if own:
            groups.setdefault(name, []).append(own)
    return columns, groups


def standard_errors_apart(case):
    """(how many, which, share): standard errors that lie between the case's effect and the nearest other listed one, and how
    often an oracle names it."""
    wanted = [e["id"] for e in case["effects"]]
    columns, groups = against_listed(case)
    signal, best = columns[:, 0], (math.inf, "")
    for name, each in groups.items():
        for own in each if name not in wanted else ():
            other = columns[:, own]
            left = signal - other @ np.linalg.lstsq(other, signal, rcond=None)[0]
            best = min(best, (float(np.linalg.norm(left)), name))
    return *best, share_named(columns, groups, wanted[0])


# Amplitudes that the oracle takes for possible, evenly, in standard errors. Draws of the noise.
REACH, TRIALS = 10.0, 400


def share_named(columns, groups, wanted, seed=1):
    """Share in which the first column's effect is likeliest by Bayes' rule: every listed one of any size and at any place
    of its grid alike, the grid holding the true place, and geometry, form and covariance known. None can do better."""
    q, _ = np.linalg.qr(columns)
    noise = np.random.default_rng(seed).standard_normal((q.shape[1], TRIALS))
    data = (q.T @ columns[:, 0])[:, None] + noise
    groups = {**groups, wanted: [[0], *groups.get(wanted, [])]}
    evidence = {}
    for name, each in groups.items():
        logs = []
        for own in each:
            basis, _ = np.linalg.qr(q.T @ columns[:, own])
            width = len(own) * math.log(math.sqrt(2 * math.pi) / (2 * REACH))
            logs.append(0.5 * np.sum((basis.T @ data) ** 2, axis=0) + width - math.log(len(each)))
        evidence[name] = np.logaddexp.reduce(logs, axis=0)
    names = list(evidence)
    likeliest = np.argmax([evidence[n] for n in names], axis=0)
    return float(np.mean(likeliest == names.index(wanted)))
