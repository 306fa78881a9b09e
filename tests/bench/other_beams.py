# SPDX-License-Identifier: GPL-3.0-or-later
"""Scans of flat cantilever foils with known truth, of another renderer than the program's: outlines as polygons, exact
area coverage of every pixel, Gaussian blur, edges that scatter, noise."""

import math
import struct
import zlib

import numpy as np
from scipy.ndimage import gaussian_filter

UM = 25400.0


def coverage(polygons, width, height):
    """Share of every pixel inside closed polygons (outer ones and holes: the sum of their signed areas).
    Pixel (i, j) is the square of side 1 about (i, j)."""
    cover = np.zeros((height, width + 2))
    area = np.zeros((height, width + 2))
    for polygon in polygons:
        p = np.asarray(polygon, float) + 0.5
        add_edges(p, np.roll(p, -1, axis=0), cover, area)
    return (np.cumsum(cover, axis=1) - cover + area)[:, :width]


def add_edges(a, b, cover, area):
    """Every edge is cut at whole x and y; each piece covers, to its right, its height of its row."""
    height, width = cover.shape
    steps = np.maximum(1, np.ceil(np.abs(b - a).max(axis=1) * 1.0)).astype(int)
    cuts = []
    for i in range(len(a)):
        d = b[i] - a[i]
        t = [np.array([0.0, 1.0])]
        for k in range(2):
            if d[k]:
                low, high = sorted((a[i][k], b[i][k]))
                t.append((np.arange(math.ceil(low), math.floor(high) + 1) - a[i][k]) / d[k])
        t = np.unique(np.clip(np.concatenate(t), 0, 1))
        cuts.append((a[i] + t[:-1, None] * d, a[i] + t[1:, None] * d))
    p = np.concatenate([c[0] for c in cuts])
    q = np.concatenate([c[1] for c in cuts])
    del steps
    middle, dy = (p + q) / 2, (q - p)[:, 1]
    row, column = np.floor(middle[:, 1]).astype(int), np.floor(middle[:, 0]).astype(int)
    keep = (row >= 0) & (row < height) & (column < width)
    column = np.maximum(column, 0)
    share = np.clip(1 - (middle[:, 0] - column), 0, 1)
    np.add.at(cover, (row[keep], column[keep]), dy[keep])
    np.add.at(area, (row[keep], column[keep]), (dy * share)[keep])


def arc(centre, radius, start, end, step=0.02):
    n = max(3, int(abs(end - start) / step))
    t = np.linspace(start, end, n)
    return [(centre[0] + radius * math.cos(x), centre[1] + radius * math.sin(x)) for x in t]


def rounded(points):
    """A closed outline of (x, y, corner radius) with its corners rounded."""
    out = []
    n = len(points)
    for i in range(n):
        p, before, after = (np.array(points[k % n][:2], float) for k in (i, i - 1, i + 1))
        r = points[i][2]
        if not r:
            out.append(tuple(p))
            continue
        u, v = (before - p) / np.linalg.norm(before - p), (after - p) / np.linalg.norm(after - p)
        half = math.acos(np.clip(u @ v, -1, 1)) / 2
        centre = p + (u + v) / np.linalg.norm(u + v) * r / math.sin(half)
        start, end = p + u * r / math.tan(half) - centre, p + v * r / math.tan(half) - centre
        a0 = math.atan2(start[1], start[0])
        turn = math.atan2(start[0] * end[1] - start[1] * end[0], start @ end)
        out += arc(centre, r, a0, a0 + turn)
    return out


def comb(beams, gap, base, tip_radius=0.0, fillet=0.0, shoulder=0.0):
    """beams: (length, width at the root, width at the tip) each; the base lies below y = 0, tips up (y < 0)."""
    x, points = 0.0, []
    if shoulder:
        points += [(-shoulder, base, 0), (-shoulder, 0, 0), (0, 0, fillet)]
    else:
        points += [(0, base, 0)]
    for i, (length, w0, w1) in enumerate(beams):
        inset = (w0 - w1) / 2
        if i or shoulder:
            if i:
                points.append((x, 0, fillet))
        points += [(x + inset, -length, tip_radius), (x + w0 - inset, -length, tip_radius)]
        x += w0
        if i + 1 < len(beams) or shoulder:
            points.append((x, 0, fillet))
        x += gap
    x -= gap
    points += [(x + shoulder, 0, 0), (x + shoulder, base, 0)] if shoulder else [(x, base, 0)]
    return [rounded(points)]


def sheet(beams, pitch, kerf, margin, tip_radius=0.0, round_ends=True):
    """Beams cut free inside a sheet by U-shaped slits; the roots lie at y = 0, the slits' ends (apex) too."""
    outlines, longest = [], max(b[0] for b in beams)
    x = 0.0
    end = kerf * 0.49999 if round_ends else 0.0
    for length, w0, w1 in beams:
        inset = (w0 - w1) / 2
        inner = [(x, 0, end), (x + inset, -length, tip_radius), (x + w0 - inset, -length, tip_radius), (x + w0, 0, end)]
        grown = tip_radius + kerf if tip_radius else 0.0
        outer = [(x + w0 + kerf, 0, end), (x + w0 + kerf - inset, -length - kerf, grown),
                 (x - kerf + inset, -length - kerf, grown), (x - kerf, 0, end)]
        outlines.append(rounded(inner + outer))
        x += pitch
    right = x - pitch + beams[-1][1] + margin
    outer = rounded([(-margin, margin, 0), (-margin, -longest - margin, 0), (right, -longest - margin, 0), (right, margin, 0)])
    return [outer] + outlines


def signed_area(p):
    p = np.asarray(p)
    q = np.roll(p, -1, axis=0)
    return 0.5 * float((p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]).sum())


def roughen(polygon, rng, sd, length):
    """The outline in steps of about a pixel, moved across by scatter of sd and correlation length in px."""
    p = np.asarray(polygon, float)
    q = np.roll(p, -1, axis=0)
    size = np.hypot(*(q - p).T)
    along = np.concatenate([[0], np.cumsum(size)])
    n = int(along[-1])
    s = np.linspace(0, along[-1], n, endpoint=False)
    ring = np.vstack([p, p[:1]])
    points = np.stack([np.interp(s, along, ring[:, k]) for k in range(2)], axis=1)
    tangent = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    tangent /= np.maximum(np.hypot(*tangent.T), 1e-9)[:, None]
    white = rng.normal(size=n)
    rho = math.exp(-1 / length)
    # exponential correlation, around the ring
    f = np.fft.rfft(white)
    k = 2 * np.pi * np.fft.rfftfreq(n)
    power = (1 - rho**2) / (1 - 2 * rho * np.cos(k) + rho**2)
    move = sd * np.fft.irfft(f * np.sqrt(power), n)
    return points + move[:, None] * np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)


def render(outlines_mm, rng, dpi=4800.0, turn_deg=0.0, blur_px=1.2, noise=2.0, light_on_dark=True, bits=8, rough_px=0.0,
           rough_length_px=8.0, border_px=60, contrast=175.0, one_sided_px=0.0, bed=None):
    """The picture, and where its millimetres lie."""
    px = dpi / 25.4
    t = math.radians(turn_deg)
    turn = np.array([[math.cos(t), -math.sin(t)], [math.sin(t), math.cos(t)]])
    polygons = [np.asarray(o) @ turn.T * px for o in outlines_mm]
    low = np.min([p.min(axis=0) for p in polygons], axis=0)
    shift = border_px - low + rng.uniform(0, 1, 2)
    high = np.max([p.max(axis=0) for p in polygons], axis=0)
    size = np.ceil(high - low + 2 * border_px).astype(int)
    moved = []
    for i, p in enumerate(polygons):
        p = p + shift
        if rough_px:
            p = roughen(p, rng, rough_px, rough_length_px)
        if (signed_area(p) > 0) != (i == 0):
            p = p[::-1]
        moved.append(p)
    share = coverage(moved, size[0], size[1])
    if share.sum() < 0:
        share = -share
    light = gaussian_filter(share, math.sqrt(max(0, blur_px**2 - 1 / 12)), mode="nearest")
    if one_sided_px:
        tail = np.exp(-np.arange(0, 8 * one_sided_px) / one_sided_px)
        tail /= tail.sum()
        light = np.apply_along_axis(lambda c: np.convolve(c, tail)[:len(c)], 0, light)
    background, step = (30.0, contrast) if light_on_dark else (215.0, -contrast)
    picture = background + step * light + rng.normal(0, noise, light.shape)
    if bits == 16:
        return np.clip(np.round(picture * 257), 0, 65535).astype(np.uint16)
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)


def write_png(path, picture, dpi):
    height, width = picture.shape
    bits = 16 if picture.dtype == np.uint16 else 8
    rows = picture.astype(">u2" if bits == 16 else np.uint8).tobytes()
    stride = width * bits // 8
    raw = b"".join(b"\0" + rows[i * stride:(i + 1) * stride] for i in range(height))
    per_metre = round(dpi / 0.0254)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0))
                   + chunk(b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1))
                   + chunk(b"IDAT", zlib.compress(raw, 1)) + chunk(b"IEND", b""))
