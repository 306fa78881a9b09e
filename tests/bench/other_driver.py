# SPDX-License-Identifier: GPL-3.0-or-later
"""A scanner's driver for other_scanner.py: what light and software do to a picture between the glass and the file.

Members of the scanner, beside those of other_scanner.py; without any of them a picture stays as it was:

  blur_px [x, y], blur_angle_deg   the optics' Gaussian as an ellipse, its axes turned clockwise as the picture is seen
  shadow                           {"amplitude", "direction_deg", "length_px", "gap_px"}: the part stands above the
                                   glass; the shaded strip lies from gap to gap + length towards the direction. The
                                   amplitude is a share of the contrast; above 0 a lit wall, below 0 a shadow
  stitch [[share, rows], ...]      at that share of the height so many rows are lost (below 0: come twice)
  resampled_from_dpi               the sensor's dpi; `interpolation`: "nearest", "linear" or "cubic" makes the file's
  tone_curve [[in, out], ...]      counts of 0 to 255; a monotone cubic runs through the points; `lut_bits` [8] is the
                                   resolution of the numbers that it is looked up by
  median [n]                       median of 3 x 3, n times
  unsharp_mask                     {"amount_pct", "radius_px", "threshold"}: against a binomial mean
  levels, threshold                gray values that are left; of 2 levels, where black ends
  magnification_ppm [r, g, b]      an RGB picture; about the picture's middle, along x; `channel_contrast`: shares
  bits                             8 or 16

Order: shadow, optics, sensor and its noise; rows, resampling, tone, median, unsharp mask, levels, JPEG."""

import math

import numpy as np

MEMBERS = ("stitch", "resampled_from_dpi", "tone_curve", "median", "unsharp_mask", "levels")


def is_wanted(scanner):
    return any(name in scanner for name in MEMBERS)


# --- light ----------------------------------------------------------------------------------


def moved(picture, dx, dy):
    """The picture moved right and down by whole pixels; the border repeats."""
    height, width = picture.shape
    y = np.clip(np.arange(height) - dy, 0, height - 1)
    x = np.clip(np.arange(width) - dx, 0, width - 1)
    return picture[y][:, x]


def cast_shadow(covered, shadow):
    """Light beside a part that stands off the glass: the share of a short way towards the part that it covers."""
    angle = math.radians(shadow["direction_deg"])
    steps = shadow.get("gap_px", 0) + np.linspace(0, shadow["length_px"], int(2 * shadow["length_px"]) + 2)
    offsets = [(round(t * math.cos(angle)), round(t * math.sin(angle))) for t in steps]
    shade = np.zeros_like(covered)
    for offset in sorted(set(offsets)):
        shade += np.float32(offsets.count(offset) / len(offsets)) * moved(covered, *offset)
    return covered + np.float32(shadow["amplitude"]) * shade * (1 - covered)


def blur_ellipse(light, blur_px, angle_deg):
    """Gaussian by its transform, exp(-2 pi² k'Ck); the border repeats."""
    margin = int(4.5 * max(blur_px)) + 2
    wide = np.pad(light, margin, "edge")
    ky, kx = np.fft.fftfreq(wide.shape[0])[:, None], np.fft.rfftfreq(wide.shape[1])[None]
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    power = (blur_px[0] * (c * kx + s * ky)) ** 2 + (blur_px[1] * (c * ky - s * kx)) ** 2
    wide = np.fft.irfft2(np.fft.rfft2(wide) * np.exp(-2 * np.pi**2 * power), wide.shape)
    return wide[margin:-margin, margin:-margin].astype(np.float32)


# --- software -------------------------------------------------------------------------------


def stitch(numbers, jumps):
    """Parts of a scan put together with rows lost or doubled; places are of the picture as it was."""
    height, keep = len(numbers), []
    start = 0
    for share, rows in sorted(jumps):
        at = int(share * height)
        keep.append(np.arange(start, at))
        start = at + rows
    keep.append(np.arange(start, height))
    return numbers[np.concatenate(keep)]


def weights_of(kind, t):
    """Of the pixels -1, 0, 1, 2 about a place t behind pixel 0."""
    if kind == "nearest":
        return np.stack([0 * t, t < 0.5, t >= 0.5, 0 * t])
    if kind == "linear":
        return np.stack([0 * t, 1 - t, t, 0 * t])
    return np.stack([  # Catmull and Rom
        (-t + 2 * t**2 - t**3) / 2, (2 - 5 * t**2 + 3 * t**3) / 2, (t + 4 * t**2 - 3 * t**3) / 2, (t**3 - t**2) / 2,
    ])  # fmt: skip


def resample_rows(numbers, count, kind):
    at = (np.arange(count) + 0.5) * len(numbers) / count - 0.5
    first = np.floor(at).astype(int)
    weights = weights_of(kind, at - first).astype(np.float32)
    pick = lambda k: numbers[np.clip(first + k, 0, len(numbers) - 1)]
    return sum(w[:, None] * pick(k) for k, w in zip((-1, 0, 1, 2), weights))


def resample(numbers, height, width, kind):
    return resample_rows(resample_rows(numbers, height, kind).T, width, kind).T


def monotone_cubic(points, at):
    """Fritsch and Carlson 1980: harmonic means of neighbouring slopes, 0 where they change sign."""
    x, y = np.array(points, float).T
    step = np.diff(x)
    slope = np.diff(y) / step
    tangent = np.zeros(len(x))
    tangent[0], tangent[-1] = slope[0], slope[-1]
    same = slope[:-1] * slope[1:] > 0
    harmonic = 2 * slope[:-1] * slope[1:] / np.where(same, slope[:-1] + slope[1:], 1)
    tangent[1:-1] = np.where(same, harmonic, 0)
    k = np.clip(np.searchsorted(x, at, "right") - 1, 0, len(step) - 1)
    t = np.clip((at - x[k]) / step[k], 0, 1)
    return (y[k] * (1 + 2 * t) * (1 - t) ** 2 + tangent[k] * step[k] * t * (1 - t) ** 2 + y[k + 1] * t**2 * (3 - 2 * t)
            + tangent[k + 1] * step[k] * t**2 * (t - 1))  # fmt: skip


def tone(numbers, scanner):
    """A table of so many entries, as drivers have one; 8 bit in and out leaves gaps and combs."""
    last = 2 ** scanner.get("lut_bits", 8) - 1
    table = monotone_cubic(scanner["tone_curve"], np.arange(last + 1) * 255 / last).astype(np.float32)
    if last == 255:
        table = np.rint(table)
    return table[np.clip(np.rint(numbers * (last / 255)), 0, last).astype(np.int64)]


def middle_of_three(a, b, c):
    return np.maximum(np.minimum(a, b), np.minimum(np.maximum(a, b), c))


def median_3x3(numbers):
    """Of sorted columns: the median of the greatest low, the middle middle and the least high (Smith 1996)."""
    wide = np.pad(numbers, 1, "edge")
    a, b, c = wide[:-2], wide[1:-1], wide[2:]
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    middle = middle_of_three(a, b, c)
    across = lambda v: (v[:, :-2], v[:, 1:-1], v[:, 2:])
    greatest_low = np.maximum.reduce(across(low))
    least_high = np.minimum.reduce(across(high))
    return middle_of_three(greatest_low, middle_of_three(*across(middle)), least_high)


def binomial_rows(numbers):
    wide = np.pad(numbers, ((1, 1), (0, 0)), "edge")
    return (wide[:-2] + 2 * wide[1:-1] + wide[2:]) / np.float32(4)


def sharpen(numbers, mask):
    """Adds a share of what differs from a binomial mean of variance radius², where that is above the threshold."""
    mean = numbers
    for _ in range(max(1, round(2 * mask["radius_px"] ** 2))):
        mean = binomial_rows(binomial_rows(mean).T).T
    detail = numbers - mean
    detail[np.abs(detail) < mask.get("threshold", 0)] = 0
    return numbers + np.float32(mask["amount_pct"] / 100) * detail


def quantise(numbers, scanner):
    steps = scanner["levels"] - 1
    if steps == 1:
        return np.where(numbers >= scanner.get("threshold", 127.5), np.float32(255), np.float32(0))
    return np.rint(np.clip(numbers, 0, 255) * (steps / 255)) * np.float32(255 / steps)


def drive(numbers, scanner, size):
    """From the sensor's numbers to the file's, but for rounding and JPEG. size: rows and columns of the file."""
    if "stitch" in scanner:
        numbers = stitch(numbers, scanner["stitch"])
    if "resampled_from_dpi" in scanner:
        numbers = resample(numbers, *size, scanner.get("interpolation", "cubic"))
    numbers = np.clip(numbers, 0, 255)
    if "tone_curve" in scanner:
        numbers = tone(numbers, scanner)
    for _ in range(scanner.get("median", 0)):
        numbers = median_3x3(numbers)
    if "unsharp_mask" in scanner:
        numbers = sharpen(numbers, scanner["unsharp_mask"])
    if "levels" in scanner:
        numbers = quantise(numbers, scanner)
    return numbers
