# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows that are missing in a picture, from its edges and its texture alone: numpy, and nothing of
foilgauge. Used by real_loop.py to confirm, or not, what the loop found on holes."""

import struct
import zlib

import numpy as np


# ---- the picture, without the program's own reader ----

def unfilter(kind, line, before):
    if kind == 0:
        return line
    if kind == 1:
        return np.cumsum(line, dtype=np.uint64).astype(np.uint8)
    if kind == 2:
        return line + before
    out, left, corner = [0] * len(line), 0, 0
    for i, (value, up) in enumerate(zip(line.tolist(), before.tolist())):
        if kind == 3:
            guess = (left + up) >> 1
        else:
            near = left + up - corner
            a, b, c = abs(near - left), abs(near - up), abs(near - corner)
            guess = left if a <= b and a <= c else up if b <= c else corner
        left, corner = (value + guess) & 255, up
        out[i] = left
    return np.array(out, np.uint8)


def read_png(path):
    with open(path, "rb") as file:
        data = file.read()
    at, packed = 8, []
    while at < len(data):
        size, = struct.unpack(">I", data[at:at + 4])
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed.append(body)
        at += 12 + size
    if (depth, colour, interlace) != (8, 0, 0):
        raise SystemExit(f"{path}: 8-bit gray without interlace is needed here")
    raw = np.frombuffer(zlib.decompress(b"".join(packed)), np.uint8).reshape(height, width + 1)
    image, before = np.zeros((height, width), np.uint8), np.zeros(width, np.uint8)
    for y in range(height):
        image[y] = before = unfilter(raw[y, 0], raw[y, 1:], before)
    return image.astype(float)


# ---- edges and texture that the loop has not seen ----

def gradient_rows(image, first, last):
    kernel = np.exp(-0.5 * (np.arange(-5, 6) / 1.5)**2)
    smooth = np.array([np.convolve(image[y], kernel / kernel.sum(), "same") for y in range(first, last)])
    return np.gradient(smooth, axis=1)


def peak(line, x, reach, sign):
    a, b = max(2, int(round(x - reach))), min(len(line) - 3, int(round(x + reach)))
    i = a + int(np.argmax(sign * line[a:b + 1])) if b > a else a
    left, top, right = sign * line[i - 1:i + 2]
    if top < 2 or top < left or top < right or left + right >= 2 * top:
        return None
    return i + 0.5 * (left - right) / (left - 2 * top + right)


def follow(gradient, seam, start, x, sign, step):
    track, row = [(start, x)], start
    while 0 <= row + step < len(gradient):
        row += step
        recent = np.array(track[-8:])
        line = np.polyfit(recent[:, 0], recent[:, 1], 1) if len(track) > 3 else (0.0, track[-1][1])
        guess = np.polyval(line, row) if len(track) > 3 else track[-1][1]
        reach = 2.5 + abs(line[0]) * (4 if abs(row - seam) < 3 else 0.3)
        at = peak(gradient[row], guess, reach, sign)
        if at is None:
            break
        track.append((row, at))
    return track[1:]


def find_tracks(image, seam, used, half=45, least=15):
    """Edges that are crossed by rows on both sides of row `seam`; x ranges in `used` are left out."""
    gradient = gradient_rows(image, seam - half, seam + half)
    tracks = []
    for start in (half - 6, half + 6):
        line = gradient[start]
        for i in range(5, len(line) - 5):
            if abs(line[i]) < 3 or abs(line[i]) < abs(line[i - 1]) or abs(line[i]) <= abs(line[i + 1]):
                continue
            sign = np.sign(line[i])
            x = peak(line, i, 1, sign)
            if x is None:
                continue
            track = np.array(sorted(follow(gradient, half, start, x, sign, -1) + [(start, x)] +
                                    follow(gradient, half, start, x, sign, 1)))
            sides = (track[:, 0] < half).sum(), (track[:, 0] >= half).sum()
            middle = np.interp(half, track[:, 0], track[:, 1])
            if min(sides) < least or any(a <= middle <= b for a, b in used):
                continue
            if all(abs(middle - np.interp(half, t[:, 0], t[:, 1])) > 6 for t in tracks):
                tracks.append(track)
    return tracks, half


def track_rest(track, half, rows):
    """Residuals of an edge from a smooth curve, with `rows` rows put in below the seam."""
    y = track[:, 0] - half
    basis = np.polynomial.legendre.legvander((y + rows * (y >= 0)) / half, 4)
    return track[:, 1] - basis @ np.linalg.lstsq(basis, track[:, 1], rcond=None)[0]


def lost_along(track, half):
    counts = np.arange(-6, 12.01, 0.1)
    squares = np.array([np.sum(track_rest(track, half, n)**2) for n in counts])
    rest = track_rest(track, half, counts[squares.argmin()])
    rho = min(0.95, max(0.0, np.mean(rest[1:] * rest[:-1]) / np.mean(rest**2)))
    unit = squares.min() / (len(track) - 6) * (1 + rho) / (1 - rho)
    inside = counts[squares < squares.min() + unit]
    return counts[squares.argmin()], max((inside.max() - inside.min()) / 2, 0.1)


LAGS, USED_LAGS = 12, (2, 3, 4, 5)


def structure(image, seam, x0, x1, reach=110):
    """Mean square difference of rows `lag` apart at every row around the seam, beside slow shading."""
    part = image[seam - reach:seam + reach + 2, x0:x1]
    part = part[:, ((part > 40) & (part < 170)).all(0)]
    if part.shape[1] < 60:
        return None
    kernel = np.exp(-0.5 * (np.arange(-30, 31) / 10)**2)
    norm = np.convolve(np.ones(len(part)), kernel, "same")
    part = part - np.apply_along_axis(lambda v: np.convolve(v, kernel, "same"), 0, part) / norm[:, None]
    table = np.full((LAGS + 1, len(part)), np.nan)
    for lag in range(1, LAGS + 1):
        squares = np.sort((part[lag:] - part[:-lag])**2, axis=1)
        table[lag, :len(part) - lag] = squares[:, :int(0.9 * squares.shape[1])].mean(1)
    return table


def lost_in_texture(table, at):
    """By how many rows the texture jumps between rows `at` and `at` + 1 of the table: rows L apart
    across a place where n are missing differ as rows L + n apart do elsewhere."""
    index, usual = np.arange(at - 45, at + 46), []
    for lag in range(1, LAGS + 1):
        values = table[lag, at - 45:at + 46].copy()
        values[(index <= at + 2) & (index + lag > at - 2)] = np.nan
        usual.append(np.nanmedian(values))
    usual = np.maximum.accumulate(usual)
    return np.median([np.interp(np.mean(table[lag, at - lag + 1:at + 1]), usual, np.arange(1, LAGS + 1)) - lag
                      for lag in USED_LAGS])


def texture(image, seam, used, width=200, reach=110):
    blocks = []
    for x0 in range(100, image.shape[1] - width, width):
        if any(x0 < b and x0 + width > a for a, b in used):
            continue
        table = structure(image, seam, x0, x0 + width, reach)
        if table is not None:
            profile = {dy: lost_in_texture(table, reach + dy) for dy in range(-48, 49, 3)}
            blocks.append((x0, profile))
    return blocks


def texture_summary(blocks, dy):
    values = np.array([profile[dy] for _, profile in blocks])
    rng = np.random.default_rng(1)
    medians = [np.median(rng.choice(values, len(values))) for _ in range(2000)]
    return np.median(values), np.percentile(medians, [2.5, 97.5])
