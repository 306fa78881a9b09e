# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds for loop_unlisted.py that were invented when every limit of the program stood."""

import numpy as np


def late_fields(rng, width, height, a):
    """Kinds of fields, mm, of an amplitude `a` in mm: (x, y) to (dx, dy)."""
    cx, cy, sign, stop = width / 2, height / 2, rng.choice([-1, 1]), rng.uniform(0.2, 0.8) * height
    drop, size = rng.uniform(0.25, 0.75, 2) * (width, height), rng.uniform(0.12, 0.3) * width
    period, phase = float(np.exp(rng.uniform(np.log(2), np.log(6)))), rng.uniform(0, 6.28)

    def lens_drop(x, y):
        u, v = (x - drop[0]) / size, (y - drop[1]) / size
        near = 1.6 * a * sign * np.exp(-(u * u + v * v) / 2)
        return near * u, near * v

    return {
        "hiccup": lambda x, y: (0 * x, 2 * a * sign * np.where(y > stop, np.exp(-np.abs(y - stop) / 2.5), 0)),
        "lens_drop": lens_drop,
        "jitter": lambda x, y: (a * np.sin(2 * np.pi * y / period + phase) * np.sin(np.pi * y / height) ** 2, 0 * y),
        "rolling_skew": lambda x, y: (0 * x, 1.5 * a * sign * (x - cx) / cx * np.sin(np.pi * (y / height - 0.1 * phase)) ** 2),
    }


def late_deviations(rng, a):
    """Kinds of radial deviations, mm: (radius, direction about O in the part's frame) to mm outwards."""
    sign, fold, pitch = rng.choice([-1, 1]), rng.uniform(-0.7, 0.7), np.radians(40 / 3)
    inner = lambda r: np.clip((20.85 - r) / 0.2, 0, 1)
    about = lambda t: np.angle(np.exp(1j * t))

    def twist(r, t):
        """Bumps lean more and more along the foil."""
        k = np.clip(np.rint(about(t) / pitch), -4, 4)
        u = np.clip((about(t) - k * pitch) / (0.35 * pitch), -1, 1)
        return a * sign * (k + 5) / 5 * (u - u**3) * 2.6 * inner(r)

    return {"twist": twist, "kink": lambda r, t: 2 * a * sign * np.abs(about(t) - fold)}
