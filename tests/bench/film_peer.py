# SPDX-License-Identifier: GPL-3.0-or-later
"""The gas film of round bearings by the program's finite volumes against a spectral solution of the same equation, which
shares nothing with it: writes reports/film_round.md to standard output.

    /usr/bin/python3 tests/bench/film_peer.py build/foilgauge > reports/film_round.md

Peer: P² on Fourier points around and Chebyshev points along, Newton's method, all derivatives exact; the response to a whirl
is solved in complex numbers. Every coefficient of its series that matters is resolved: twice the points change nothing shown."""
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy as np

D_MM, CLEARANCE_UM, BUMPS = 40.0, 20.0, 24
AMBIENT, VISCOSITY = 101325.0, 18.5e-6
RADIUS, CLEARANCE = D_MM / 2000, CLEARANCE_UM * 1e-6
WORDS = """
# Round gas bearings against a spectral solution

`/usr/bin/python3 tests/bench/film_peer.py build/foilgauge > reports/film_round.md` writes this page. A round bearing without pad edges (`--pads 0`), D 40 mm, C 20 um,
air, rigid and with bumps of compliance 0.67 and loss factor 0.14. `foilgauge film` finds where a load puts the rotor; the peer solves the same equation with the
rotor at that place, and its load, direction of load, power loss, and critical mass are held against the program's. The peer is spectral (Fourier around, Chebyshev along,
{points} points): its own error is below the last digit shown. The published values for plain gas bearings
(Raimondi 1961; Ausman 1961) are charts; no table of them was found to hold against.

"Default mesh": 6 cells a bump, 8 over half the length, 144 around. "Twice as fine": 12, 16. Errors fall to a quarter, as those of a scheme of second order do.
The loads and the places are of moderate to great eccentricity; the limit of small ones is exact and is tested (tests/unit/test_film_linear.c).
"""


def chebyshev(n):
    """Points and the matrix of derivatives on [-1, 1]."""
    k = np.arange(n + 1)
    x = np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    d = np.outer(c, 1 / c) / (x[:, None] - x[None, :] + np.eye(n + 1))
    return x, d - np.diag(d.sum(axis=1))


def clenshaw_curtis(n):
    theta = np.pi * np.arange(n + 1) / n
    w = np.zeros(n + 1)
    inner = np.ones(n - 1)
    for k in range(1, n // 2):
        inner -= 2 * np.cos(2 * k * theta[1:-1]) / (4 * k * k - 1)
    inner -= np.cos(n * theta[1:-1]) / (n * n - 1)
    w[1:-1] = 2 * inner / n
    w[0] = w[-1] = 1 / (n * n - 1)
    return w


class Peer:
    """The film about a rotor that is held at a place; half of the length, which is symmetric."""

    def __init__(self, compressibility, half, compliance, loss, around=64, along=24):
        self.lam, self.g, self.loss = compressibility, compliance, loss
        k = np.fft.fftfreq(around, 1 / around)
        k[around // 2] = 0
        f = np.fft.fft(np.eye(around), axis=0)
        self.theta = 2 * np.pi * np.arange(around) / around
        self.dt = np.real(np.fft.ifft(1j * k[:, None] * f, axis=0))
        x, d = chebyshev(along)
        d2, n = (d @ d) / half**2, along // 2
        fold = np.zeros((along + 1, n + 1))
        for i in range(along + 1):
            fold[i, min(i, along - i)] = 1
        self.dzz = (d2 @ fold)[1:n + 1, 1:]  # without the end, where P = 1
        self.to_end = (d2 @ fold)[1:n + 1, 0]
        w = clenshaw_curtis(along) @ fold * half
        self.w, self.w_end, self.half = w[1:], w[0], half
        self.around, self.n = around, n
        self.shape = (around, n)

    def thickness(self, place, w):
        return 1 - place[0] * np.cos(self.theta) - place[1] * np.sin(self.theta) + w

    def mean(self, values, at_end):
        """Over the length, of every angle."""
        return (values @ self.w + self.w_end * at_end) / (2 * self.half)

    def whole(self, by_angle):
        """A matrix around as one of all unknowns."""
        return np.kron(by_angle, np.eye(self.n))

    def rows(self, values):
        """Of every angle, for all its points."""
        return np.repeat(values, self.n)

    def residual(self, q, w, place):
        h = self.thickness(place, w)[:, None]
        p = np.sqrt(q)
        r = 0.5 * self.dt @ (h**3 * (self.dt @ q)) + 0.5 * h**3 * (q @ self.dzz.T + self.to_end)
        return (r - self.lam * self.dt @ (p * h)).ravel(), w - self.g * (self.mean(p, 1) - 1)

    def jacobian(self, q, w, place, s=0.0, loss=0.0):
        """By Q and w, of a response as exp(s tau)."""
        h = self.thickness(place, w)
        p, qt = np.sqrt(q), self.dt @ q
        h3, wide = self.rows(h**3), self.whole(self.dt)
        by_q = 0.5 * wide @ (h3[:, None] * wide) + 0.5 * h3[:, None] * np.kron(np.eye(self.around), self.dzz)
        carried = self.rows(h) / (2 * p.ravel())
        by_q = by_q - self.lam * wide * carried[None, :] - np.diag(2 * self.lam * s * carried)
        by_h = np.zeros((q.size, self.around), dtype=complex if s else float)
        diffused = 0.5 * q @ self.dzz.T + 0.5 * self.to_end
        for i in range(self.around):
            part = np.zeros(self.shape, dtype=by_h.dtype)
            part[i] = 1
            column = self.dt @ (1.5 * (h**2)[:, None] * qt * part) + 3 * (h**2)[:, None] * diffused * part
            column = column - self.lam * self.dt @ (p * part) - 2 * self.lam * s * p * part
            by_h[:, i] = column.ravel()
        lower = np.zeros((self.around, q.size))
        for i in range(self.around):
            lower[i, i * self.n:(i + 1) * self.n] = -self.g * self.w / (2 * self.half) / (2 * p[i])
        stiff = np.eye(self.around) * (1 + 1j * loss if loss else 1)
        return by_q, by_h, lower, stiff

    def solve(self, place):
        q, w = np.ones(self.shape), np.zeros(self.around)
        for share in np.linspace(0.25, 1, 4):
            at = share * np.asarray(place)
            for _ in range(30):
                r, foil = self.residual(q, w, at)
                by_q, by_h, lower, stiff = self.jacobian(q, w, at)
                step = np.linalg.solve(np.block([[by_q, by_h], [lower, stiff]]), -np.concatenate([r, foil]))
                q, w = np.maximum(q + step[:q.size].reshape(self.shape), 0.05), w + step[q.size:]
                if np.abs(step).max() < 1e-11:
                    break
        return q, w

    def force(self, over):
        """Integral of pressures over ambient, by angle already along the length."""
        step = 2 * np.pi / self.around
        return np.array([step * np.sum(over * np.cos(self.theta)), step * np.sum(over * np.sin(self.theta))])

    def load(self, q):
        return self.force(2 * self.half * (self.mean(np.sqrt(q), 1) - 1))

    def torque(self, q, w, place):
        h = self.thickness(place, w)
        push = self.mean(self.dt @ np.sqrt(q), 0) * h * 3 / self.lam
        return 2 * self.half * 2 * np.pi / self.around * np.sum(1 / h + push)

    def impedance(self, q, w, place, s):
        by_q, by_h, lower, stiff = self.jacobian(q, w, place, s, self.loss)
        matrix = np.block([[by_q, by_h], [lower, stiff]])
        z = np.zeros((2, 2), dtype=complex)
        for axis, shape in enumerate((-np.cos(self.theta), -np.sin(self.theta))):
            right = np.concatenate([-(by_h @ shape), np.zeros(self.around)])
            dq = np.linalg.solve(matrix, right)[:q.size].reshape(self.shape)
            z[:, axis] = self.force(2 * self.half * self.mean(dq / (2 * np.sqrt(q)), 0))
        return z

    def critical_mass(self, q, w, place, start):
        """Mass M and ratio nu with M nu² an eigenvalue of Z(i nu), real: by secants near `start`."""
        def root(nu):
            values = np.linalg.eigvals(self.impedance(q, w, place, 1j * nu))
            return min(values, key=lambda v: abs(v.imag))
        a, b = start, start * 1.002
        fa, fb = root(a), root(b)
        for _ in range(12):
            if fb.imag == fa.imag:
                break
            a, b, fa = b, b - fb.imag * (b - a) / (fb.imag - fa.imag), fb
            fb = root(b)
            if abs(b - a) < 1e-10:
                break
        return fb.real / b**2, b


def film(program, load, speed, compliance, length, mesh):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "film.json")
        subprocess.run([program, "film", "--clearance", str(CLEARANCE_UM), "--compliance", str(compliance), "--loss-factor", "0.14", "--pads", "0",
                        "--bumps", str(BUMPS), "--load", str(load), "--speed", str(speed), "--speeds", f"{speed}:{speed * 1.01}:2", "--length",
                        str(length), "--mesh", mesh, "--jobs", "1", "-o", path], check=False, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        with open(path) as file:
            return json.load(file)["perfect"]


def hold(found, load, speed, compliance, length, sizes):
    """The peer's load, its direction, power and critical mass at the program's place, against the program's: in percent and degrees."""
    omega = speed * math.pi / 30
    lam = 6 * VISCOSITY * omega * (RADIUS / CLEARANCE)**2 / AMBIENT
    peer = Peer(lam, length / D_MM, compliance, 0.14, *sizes)
    place = np.array(found["rotor_um"]) / CLEARANCE_UM
    q, w = peer.solve(place)
    force = peer.load(q) * AMBIENT * RADIUS**2  # along the load, which is upon the rotor
    size, angle = np.hypot(*force), math.degrees(math.atan2(force[1], force[0]))
    power = peer.torque(q, w, place) * VISCOSITY * omega**2 * RADIUS**4 / CLEARANCE
    mass, ratio = peer.critical_mass(q, w, place, found["whirl_ratio"])
    mass *= AMBIENT * RADIUS**2 / CLEARANCE / omega**2
    return lam, [100 * (load / size - 1), math.remainder(270 - angle, 360), 100 * (found["power_loss_w"] / power - 1),
                 100 * (found["critical_mass_kg"] / mass - 1), found["whirl_ratio"] - ratio], mass


CASES = ((20, 10000, 10, 0), (20, 60000, 40, 0), (40, 5000, 20, 0), (40, 20000, 60, 0), (40, 60000, 200, 0), (80, 60000, 300, 0),
         (20, 60000, 40, 0.67), (40, 5000, 20, 0.67), (40, 60000, 200, 0.67), (80, 60000, 300, 0.67))
SIZES = (48, 20)


def main():
    program = sys.argv[1]
    print(WORDS.strip().format(points=f"{SIZES[0]} by {SIZES[1]}"))
    print("\n| L/D | compressibility number | load, N | compliance | e / C | attitude, deg | critical mass, g | mesh | load, % | its direction, deg | power, % | critical mass, % | whirl ratio |\n"
          "|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    worst = {}
    for length, speed, load, compliance in CASES:
        for mesh, words in (("6,8", "default"), ("12,16", "twice as fine")):
            found = film(program, load, speed, compliance, length, mesh)
            lam, errors, mass = hold(found, load, speed, compliance, length, SIZES)
            worst[words] = [max(a, abs(b)) for a, b in zip(worst.get(words, [0] * 5), errors)]
            print(f"| {length / D_MM:g} | {lam:.3g} | {load} | {compliance} | {found['eccentricity_ratio']:.4f} | {found['attitude_deg']:.2f} | {1000 * mass:.4g} | {words} | "
                  f"{errors[0]:+.3f} | {errors[1]:+.3f} | {errors[2]:+.3f} | {errors[3]:+.3f} | {errors[4]:+.5f} |", flush=True)
    print("\nThe largest of each:\n\n| mesh | load, % | its direction, deg | power, % | critical mass, % | whirl ratio |\n|---|---|---|---|---|---|")
    for words, errors in worst.items():
        print(f"| {words} | {errors[0]:.3f} | {errors[1]:.3f} | {errors[2]:.3f} | {errors[3]:.3f} | {errors[4]:.5f} |")


if __name__ == "__main__":
    main()
