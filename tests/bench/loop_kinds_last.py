# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds for loop_unlisted.py that were invented from how scanners are built and foils are formed, by one who had not
read the program."""

import numpy as np
from scipy.interpolate import CubicSpline

# The bench's foil: nine bumps a pitch apart, lands between them, and where its ends lie.
PITCH = np.radians(40 / 3)
RADIUS_MM, HALF_LAND_MM, HALF_SPAN = 20.9, 0.46, np.radians(62.5)


def walk_over(rng, length, step_mm, keep):
    """A smooth random walk that is drawn back to zero, of the largest size 1. keep: share of it that is left after a step."""
    at = np.arange(-2 * step_mm, length + 8, step_mm)
    value = rng.standard_normal(len(at))
    for i in range(1, len(at)):
        value[i] += keep * value[i - 1]
    walk = CubicSpline(at, value)
    size = np.max(np.abs(walk(np.linspace(0, length, 1000))))
    return lambda x: walk(x) / size


def draw_worn_rail(rng, width, height, a):
    sign, first, base, length = rng.choice([-1, 1]), rng.uniform(0.1, 0.35) * height, rng.uniform(8, 14), rng.uniform(1.5, 3)
    rail = rng.choice([-8, width + 8])
    hollow = lambda y: np.exp(-(((y - first) / length) ** 2) / 2)
    size = a * sign * base / (0.75 * width + 8)  # the line moves by `a` at three quarters of its length from the rail

    def worn_rail(x, y):
        front, rear = hollow(y), hollow(y - base)
        return size * (front + rear) / 2, size * (x - rail) / base * (front - rear)

    return worn_rail


def draw_dust(rng, width, height, a):
    thirds = np.stack(np.meshgrid(range(3), range(3)), axis=2).reshape(9, 2)  # a grain in each, so that a foil meets some
    places, heights = (thirds + rng.uniform(0, 1, (9, 2))) / 3 * (width, height), rng.uniform(0.3, 1, 9)
    sign, reach, axis = rng.choice([-1, 1]), rng.uniform(8, 14), rng.choice([rng.uniform(-60, -10), width + rng.uniform(10, 60)])

    def dust(x, y):
        tents = [top - np.hypot(x - at[0], y - at[1]) / reach for top, at in zip(heights, places)]
        stands_off = np.clip(np.max(tents, axis=0), 0, None)
        return 1.3 * a * sign * stands_off * (x - axis) / abs(width / 2 - axis), 0 * y

    return dust


def last_fields(rng, width, height, a):
    """Kinds of fields, mm, of an amplitude `a` in mm: (x, y) to (dx, dy)."""
    across, along = (walk_over(rng, width, rng.uniform(0.5, 1.0), 0.7) for _ in range(2))
    sign, vertex = rng.choice([-1, 1]), rng.uniform(0.4, 0.6) * width
    tooth, phase = rng.uniform(0.8, 1.4), rng.uniform(0, 1)
    turn = tooth * rng.integers(7, 10)

    def cracked_tooth(x, y):
        behind = turn * (np.mod(y / turn + phase, 1) - 0.5)
        return 0 * x, a * sign * np.where(np.abs(behind) < tooth / 2, np.cos(np.pi * behind / tooth) ** 2, 0)

    return {
        # A contact sensor's rod lenses stand a little askew, each its own way; a few of them share every place of the line.
        "rod_lenses": lambda x, y: (a * across(x), a * along(x)),
        # A mirror that bends in its clamps images the line as a bow: its ends lie before or behind its middle.
        "bow": lambda x, y: (0 * x, 2 * a * sign * (2 * (x - vertex) / width) ** 2),
        # A hollow of the guide rail passes one shoe of the carriage, then the other: it moves aside and turns about the rail.
        "worn_rail": draw_worn_rail(rng, width, height, a),
        # A gear's cracked tooth yields once in every turn: the carriage lags by it until the next tooth bears.
        "cracked_tooth": cracked_tooth,
        # The foil lies on grains of dust and stands off the glass about them: a lens beside it looks there aslant.
        "dust": draw_dust(rng, width, height, a),
    }


def best_circle(radial, t):
    """Constant, cosine and sine of the best circle through radial deviations over directions `t`, about a centre of its own."""
    circle = np.stack([np.ones_like(t), np.cos(t), np.sin(t)], axis=1)
    return np.linalg.lstsq(circle, radial, rcond=None)[0]


def draw_two_passes(rng, a):
    sign, side, meet = rng.choice([-1, 1]), rng.choice([-1, 1]), rng.uniform(-0.5, 0.5)
    second = lambda t: 1 - np.cos(np.clip(side * t - meet, 0, None))
    grid = np.linspace(-HALF_SPAN, HALF_SPAN, 501)
    taken = best_circle(second(grid), grid)
    beside = lambda t: second(t) - (taken[0] + taken[1] * np.cos(t) + taken[2] * np.sin(t))
    size = a * sign / np.max(np.abs(beside(grid)))
    return lambda r, t: size * beside(np.angle(np.exp(1j * t)))


def last_deviations(rng, a):
    """Kinds of radial deviations, mm: (radius, direction about O in the part's frame) to mm outwards."""
    sign, side, fade, period = rng.choice([-1, 1]), rng.choice([-1, 1]), rng.uniform(4, 8), rng.uniform(3, 6)
    shares = rng.uniform(0.5, 1, 8)
    about = lambda t: np.angle(np.exp(1j * t))

    def end_wrinkle(r, t):
        from_end = RADIUS_MM * np.clip(HALF_SPAN - side * about(t), 0, None)
        return a * sign * np.exp(-from_end / fade) * np.cos(2 * np.pi * from_end / period)

    def straight_lands(r, t):
        number = np.clip(np.floor(about(t) / PITCH), -4, 3).astype(int)
        across = RADIUS_MM * (about(t) - (number + 0.5) * PITCH) / HALF_LAND_MM
        return -a * shares[number + 4] * np.clip(1 - across**2, 0, None)

    return {
        # The shear pushes the free end together, and it buckles: a wave that fades into the foil.
        "end_wrinkle": end_wrinkle,
        # Springback takes more or less of the curvature out of the lands between bumps: near chords, whose middles lie further inside.
        "straight_lands": straight_lands,
        # The foil is rolled in two passes, the second to another radius: its curvature steps where they meet.
        "two_passes": draw_two_passes(rng, a),
    }
