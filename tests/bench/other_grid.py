# SPDX-License-Identifier: GPL-3.0-or-later
"""A second renderer of plates and boards, which shares no code with the program: numpy alone.

A board is a set of marks with true places; a scanner shows place t at m with t = m + d(m), pixel by pixel: a mark is bent as the
scanner bends it, and no mark moves as a point. Pixels are the mark's blurred shape at the true place of their centre, with noise; `rough` adds what real scanners do: correlated noise, shading, one-sided blur."""
import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.special import erf


class Field:
    """A displacement d(x, y) in mm: listed effects, and a smooth random field."""

    def __init__(self, size_mm):
        self.size = np.asarray(size_mm, float)
        self.parts = []

    def add(self, function):
        self.parts.append(function)
        return self

    def scale(self, qx, qy):
        c = self.size / 2
        return self.add(lambda x, y: (qx * (x - c[0]), qy * (y - c[1])))

    def shear(self, q):
        c = self.size / 2
        return self.add(lambda x, y: (q * (y - c[1]), 0 * x))

    def ripple(self, a_um, period, phase):
        return self.add(lambda x, y: (0 * x, a_um / 1e3 * np.sin(2 * np.pi * y / period + phase)))

    def step(self, a_um, y0):
        return self.add(lambda x, y: (0 * x, a_um / 1e3 * (y > y0)))

    def keystone(self, q):
        c = self.size / 2
        return self.add(lambda x, y: (q * (x - c[0]) * (y - c[1]), 0 * x))

    def bow(self, a_um):
        c = self.size / 2
        return self.add(lambda x, y: (0 * x, a_um / 1e3 * ((x - c[0]) / c[0]) ** 2))

    def chips(self, tilt_um, gap_um, pitch, first):
        """A contact image sensor: chips along x that are tilted alike, and a gap behind each."""
        chip = lambda x: (x - first) / pitch
        return self.add(lambda x, y: (gap_um / 1e3 * np.floor(chip(x)), tilt_um / 1e3 * (chip(x) - np.floor(chip(x)) - 0.5)))

    def smooth(self, rms_um, waves, seed):
        """Random waves, none shorter than the longer side over `waves`."""
        rng = np.random.default_rng(seed)
        n = 40
        k = rng.uniform(-1, 1, (n, 2)) * waves * 2 * np.pi / self.size.max()
        phase = rng.uniform(0, 2 * np.pi, (n, 2))
        a = rng.normal(size=(n, 2)) * rms_um / 1e3 * np.sqrt(2 / n)

        def both(x, y):
            # Sines of sums as products: of a row of x and a column of y none is taken pixel by pixel.
            total = [0., 0.]
            for i in range(n):
                sin_y, cos_y = np.sin(k[i, 1] * y), np.cos(k[i, 1] * y)
                for c in range(2):
                    angle = k[i, 0] * x + phase[i, c]
                    total[c] = total[c] + a[i, c] * np.sin(angle) * cos_y + a[i, c] * np.cos(angle) * sin_y
            return total[0], total[1]
        return self.add(both)

    def __call__(self, x, y):
        dx = dy = np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y)))
        for part in self.parts:
            a, b = part(x, y)
            dx, dy = dx + a, dy + b
        return dx, dy

    def inverse(self, x, y):
        """Measured place of a true one."""
        mx, my = x, y
        for _ in range(12):
            dx, dy = self(mx, my)
            mx, my = x - dx, y - dy
        return mx, my


class Board:
    """Marks of a lattice, as made: nominal places (columns, rows) x pitch, with the board's own errors."""

    def __init__(self, kind, pitch, columns, rows, ratio=0., shear=0., bend=None, mark_um=0., missing=(), seed=0):
        self.kind, self.pitch, self.columns, self.rows = kind, pitch, columns, rows
        rng = np.random.default_rng(seed)
        c, r = np.meshgrid(np.arange(columns), np.arange(rows))
        self.index = np.stack([c.ravel(), r.ravel()], 1)
        keep = np.array([tuple(i) not in set(missing) for i in self.index])
        self.index = self.index[keep]
        x, y = pitch * self.index[:, 0], pitch * self.index[:, 1]
        cx, cy = pitch * (columns - 1) / 2, pitch * (rows - 1) / 2
        px = x + ratio / 2 * (x - cx) + shear / 2 * (y - cy)
        py = y - ratio / 2 * (y - cy) + shear / 2 * (x - cx)
        if bend is not None:
            dx, dy = bend(x, y)
            px, py = px + dx, py + dy
        self.x = px + rng.normal(size=len(px)) * mark_um / 1e3
        self.y = py + rng.normal(size=len(py)) * mark_um / 1e3

    def placed(self, origin, turn_deg):
        t = np.radians(turn_deg)
        cx, cy = self.pitch * (self.columns - 1) / 2, self.pitch * (self.rows - 1) / 2
        x, y = self.x - cx, self.y - cy
        return origin[0] + x * np.cos(t) - y * np.sin(t), origin[1] + x * np.sin(t) + y * np.cos(t)


def _phi(t):
    return 0.5 * (1 + erf(t / np.sqrt(2)))


def _mark(kind, u, v, size, s):
    """Share of a mark at (u, v) from it along its own axes, mm; `size`: radius, or half length and half width."""
    if kind == 'dots':
        return _phi((size - np.hypot(u, v)) / s)
    half, width = size
    a = (_phi((width - u) / s) - _phi((-width - u) / s)) * _phi((half - np.abs(v)) / s)
    b = (_phi((width - v) / s) - _phi((-width - v) / s)) * _phi((half - np.abs(u)) / s)
    return a + b - a * b if kind == 'crosses' else a


def render(board, field, origin, turn_deg, size_px, dpi, blur_px=1.2, noise=2., light=220., dark=45., size=None, seed=0, rough=False,
           cover=None):
    """Returns the picture and the measured (scan) places of all marks, px. A chessboard's marks are its inner corners."""
    mm = 25.4 / dpi
    w, h = size_px
    share = np.zeros((h, w), np.float32)
    tx, ty = board.placed(origin, turn_deg)
    mx, my = field.inverse(tx, ty)
    t, s, pitch = np.radians(turn_deg), blur_px * mm, board.pitch
    if board.kind == 'chessboard':
        # Every pixel belongs to its nearest corner: signs of both distances from it, blurred.
        reach = int(np.ceil(0.5 * pitch / mm)) + 2
    else:
        extent = size if board.kind == 'dots' else size[0]
        reach = int(np.ceil((extent + 6 * s) / mm)) + 2
    for k in range(len(tx)):
        i0, j0 = int(round(mx[k] / mm)), int(round(my[k] / mm))
        i1, i2, j1, j2 = max(0, i0 - reach), min(w, i0 + reach + 1), max(0, j0 - reach), min(h, j0 + reach + 1)
        if i1 >= i2 or j1 >= j2:
            continue
        x, y = np.arange(i1, i2)[None, :] * mm, np.arange(j1, j2)[:, None] * mm
        dx, dy = field(x, y)
        ux, uy = x + dx - tx[k], y + dy - ty[k]
        u, v = ux * np.cos(t) + uy * np.sin(t), uy * np.cos(t) - ux * np.sin(t)
        if board.kind == 'chessboard':
            a, b = _phi(u / s), _phi(v / s)
            sign = -1 if board.index[k].sum() % 2 else 1
            own = 0.5 + sign * 2 * (a - 0.5) * (b - 0.5)
            mine = (np.abs(u) <= pitch / 2) & (np.abs(v) <= pitch / 2)
            share[j1:j2, i1:i2][mine] = own[mine]
        else:
            part = share[j1:j2, i1:i2]
            part += (1 - part) * _mark(board.kind, u, v, size, s)
    rng = np.random.default_rng(seed + 1000)
    if cover is not None:
        yy, xx = np.mgrid[0:h, 0:w]
        share[np.hypot(xx - cover[0], yy - cover[1]) < cover[2]] = 0.45
    picture = light + (dark - light) * share
    if rough:
        white = rng.normal(size=(h, w)).astype(np.float32)
        grain = gaussian_filter(rng.normal(size=(h, w)).astype(np.float32), 0.8)
        picture = picture * (1 + 0.03 * np.linspace(-1, 1, w))[None, :]
        picture = 0.85 * picture + 0.15 * np.roll(picture, 1, axis=0)  # one-sided
        picture = picture + noise * (white + 1.5 * grain / grain.std())
    else:
        picture = picture + noise * rng.normal(size=(h, w)).astype(np.float32)
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8), mx / mm, my / mm
