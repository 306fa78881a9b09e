# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop on a real scan of round holes, and a check of its claims by the rest of the picture. Writes
reports/real/loop.json, loop.html and loop.md; every number comes from the run.

    tests/bench/real_loop.py SCAN.png --dpi 1200

The loop sees the edges of the round features alone. Its findings are then held against edges and
texture of the same picture that it never saw, with numpy alone."""

import argparse
import csv
import json
import os
import subprocess

import numpy as np

import benchlib as lib
from seam import find_tracks, lost_along, read_png, texture, texture_summary, track_rest

FOLDER = os.path.join(lib.ROOT, "reports", "real")


# ---- the loop ----

def run_loop(scan, dpi):
    folder, name = os.path.split(os.path.abspath(scan))
    report, points = os.path.join(FOLDER, "loop.json"), os.path.join(FOLDER, "points.csv")
    common = ["--form", "discs", name, "--dpi", str(dpi)]
    subprocess.run([lib.FOILGAUGE, "loop", *common, "-o", report, "--html", os.path.join(FOLDER, "loop.html")], check=True, cwd=folder)
    subprocess.run([lib.FOILGAUGE, "measure", *common, "--points", points, "-o", os.devnull], check=True, cwd=folder)
    with open(points, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    os.remove(points)
    edges = {}
    for row in rows:
        edges.setdefault(int(row["disc"]), []).append((float(row["x_mm"]), float(row["y_mm"])))
    return lib.load(report), {number: np.array(xy) for number, xy in edges.items()}


# ---- rival explanations ----

def circle_fit(xy):
    x, y = xy[:, 0], xy[:, 1]
    cx, cy, radius = x.mean(), y.mean(), np.hypot(x - x.mean(), y - y.mean()).mean()
    for _ in range(20):
        d = np.hypot(x - cx, y - cy)
        step = np.linalg.lstsq(np.array([(x - cx) / d, (y - cy) / d, np.ones_like(d)]).T, d - radius, rcond=None)[0]
        cx, cy, radius = cx + step[0], cy + step[1], radius + step[2]
    return cx, cy, radius


class Hole:
    def __init__(self, number, xy):
        cx, cy, _ = circle_fit(xy)
        angle = np.arctan2(xy[:, 1] - cy, xy[:, 0] - cx)
        order = np.argsort(angle)
        self.number, self.xy, self.angle = number, xy[order], angle[order]
        self.circle = np.array([np.cos(self.angle), np.sin(self.angle), np.ones(len(order))]).T
        d = np.hypot(self.xy[:, 0] - cx, self.xy[:, 1] - cy)
        self.residual = self.beside_circle(1000 * d)
        self.correlation = 1.0

    def beside_circle(self, values):
        return values - self.circle @ np.linalg.lstsq(self.circle, values, rcond=None)[0]

    def of_field(self, dx, dy):
        """Trace of a displacement d of the picture in the residual."""
        return self.beside_circle(-(dx * np.cos(self.angle) + dy * np.sin(self.angle)))


def fit_columns(holes, shared, own):
    """Residuals that shared columns (one coefficient for all holes) and own ones leave."""
    count = len(shared[0]) if shared else 0
    blocks, values = [], []
    for i, hole in enumerate(holes):
        weight = 1 / hole.noise
        row = [shared[i][k] * weight for k in range(count)]
        for j, other in enumerate(holes):
            row += [column * weight if i == j else np.zeros(len(hole.angle)) for column in own(other)] if i == j else \
                   [np.zeros(len(hole.angle)) for _ in own(other)]
        blocks.append(np.array(row).T if row else np.zeros((len(hole.angle), 0)))
        values.append(hole.residual * weight)
    design, target = np.vstack(blocks), np.concatenate(values)
    if design.shape[1]:
        target = target - design @ np.linalg.lstsq(design, target, rcond=None)[0]
    left, at = [], 0
    for hole in holes:
        left.append(target[at:at + len(hole.angle)] * hole.noise)
        at += len(hole.angle)
    return left, design.shape[1]


def correlation_integral(values):
    v, total = values - values.mean(), 1.0
    power = (v * v).mean()
    for lag in range(1, len(v) // 4):
        rho = (v * np.roll(v, lag)).mean() / power
        if rho < 2 / np.sqrt(len(v)):
            break
        total += 2 * rho
    return total


def score(holes, left, parameters):
    """Schwarz's criterion with as many points as are independent."""
    total = sum(len(h.angle) / h.correlation for h in holes)
    fit = sum(len(h.angle) / h.correlation * np.log(np.mean(r**2)) for h, r in zip(holes, left))
    return fit + parameters * np.log(total)


def rivals(holes, centre):
    none = lambda hole: []

    def lobes(orders):
        return lambda hole: [hole.beside_circle(f(k * hole.angle)) for k in orders for f in (np.cos, np.sin)]

    def field(*functions):
        out = []
        for hole in holes:
            x, y = (hole.xy - centre).T / 18
            out.append([hole.of_field(*f(x, y, hole.xy[:, 0], hole.xy[:, 1])) for f in functions])
        return out

    zero = lambda v: np.zeros_like(v)
    scale_y = lambda x, y, X, Y: (zero(x), y)
    shear = lambda x, y, X, Y: (y, zero(x))
    quadratic = lambda x, y, X, Y: (x**2, zero(x))
    cubic = lambda x, y, X, Y: (x**3, zero(x))
    carriage = lambda x, y, X, Y: (zero(x), y**2)
    yield "a circle each, nothing else", "", [], none, 0
    yield "every hole is oval", "", [], lobes([2]), 0
    yield "every hole has 3 lobes", "", [], lobes([3]), 0
    yield "every hole has 4 lobes", "", [], lobes([4]), 0
    yield "every hole has 5 lobes", "", [], lobes([5]), 0
    yield "every hole has 2 to 5 lobes", "", [], lobes([2, 3, 4, 5]), 0
    yield "scan.scale_y", "", field(scale_y), none, 0
    yield "scan.shear", "", field(shear), none, 0
    yield "scan.optical_quadratic", "", field(quadratic), none, 0
    yield "scan.optical_cubic", "", field(cubic), none, 0
    yield "scan.carriage_quadratic", "", field(carriage), none, 0
    yield "all five smooth scanner effects", "", field(scale_y, shear, quadratic, cubic, carriage), none, 0

    def best(candidates, make):
        found = None
        for c in candidates:
            columns = make(c)
            left, _ = fit_columns(holes, columns, none)
            total = sum(np.sum((r / h.noise)**2) for r, h in zip(left, holes))
            if found is None or total < found[0]:
                found = (total, c, columns)
        return found[1], found[2]

    low, high = holes[0].xy.min(0), holes[0].xy.max(0)
    wave = lambda p: field(lambda x, y, X, Y: (zero(x), np.sin(2 * np.pi * Y / p)),
                           lambda x, y, X, Y: (zero(x), np.cos(2 * np.pi * Y / p)))
    at, columns = best(1 / np.linspace(0.05, 2.5, 400), wave)
    yield "scan.carriage_ripple", f"period {at:.2f} mm", columns, none, 1
    xs, ys = np.arange(low[0] + 0.1, high[0] - 0.1, 0.02), np.arange(low[1] + 0.1, high[1] - 0.1, 0.01)
    at, columns = best(xs, lambda p: field(lambda x, y, X, Y: (1.0 * (X > p), zero(x))))
    yield "two pictures stitched at an x, shifted along x", f"x {at:.2f} mm", columns, none, 1
    at, columns = best(xs, lambda p: field(lambda x, y, X, Y: (zero(x), 1.0 * (X > p))))
    yield "two pictures stitched at an x, shifted along y", f"x {at:.2f} mm", columns, none, 1
    at, columns = best(ys, lambda p: field(lambda x, y, X, Y: (1.0 * (Y > p), zero(x))))
    yield "the carriage jumps sideways at a y", f"y {at:.2f} mm", columns, none, 1
    at, columns = best(ys, lambda p: field(lambda x, y, X, Y: (zero(x), 1.0 * (Y > p))))
    yield "scan.row_step", f"y {at:.2f} mm", columns, none, 1
    yield "scan.row_step and every hole oval", f"y {at:.2f} mm", columns, lobes([2]), 1
    both = [a + b for a, b in zip(columns, field(scale_y))]
    yield "scan.row_step and scan.scale_y", f"y {at:.2f} mm", both, none, 1


def smooth_noise(values):
    """Robust sd against the neighbours."""
    second = values - 0.5 * (np.roll(values, 3) + np.roll(values, -3))
    return 1.4826 * np.median(np.abs(second)) / np.sqrt(1.5)


def rival_table(edges, clean, centre):
    holes = [Hole(n, edges[n]) for n in clean]
    for hole in holes:
        hole.noise = smooth_noise(hole.residual)
    tried = [(name, at, *fit_columns(holes, shared, own), extra) for name, at, shared, own, extra in rivals(holes, centre)]
    step = next(t for t in tried if t[0] == "scan.row_step")
    for hole, left in zip(holes, step[2]):
        hole.correlation = correlation_integral(left)
    scores = [score(holes, t[2], t[3] + t[4]) for t in tried]
    best = min(scores)
    rows = [[name, at, parameters + extra, *[f"{np.sqrt(np.mean(r**2)):.1f}" for r in left], f"{s - best:.0f}"]
            for (name, at, left, parameters, extra), s in zip(tried, scores)]
    head = ["explanation", "where", "parameters", *[f"hole {h.number}: rms left µm" for h in holes], "BIC above the best"]
    return head, rows


def whole_rows(xy, y0, pitch):
    """A circle through the hole with whole numbers of rows put in."""
    rows = []
    for count in range(0, 7):
        moved = xy + np.array([0, 1]) * (count * pitch * (xy[:, 1:] > y0))
        cx, cy, radius = circle_fit(moved)
        off = np.hypot(moved[:, 0] - cx, moved[:, 1] - cy) - radius
        rows.append([count, f"{1000 * np.sqrt(np.mean(off**2)):.2f}", f"{radius:.4f}"])
    return rows


def side_amplitudes(xy, y0):
    """Step along y from the left and the right half of the hole, each with the circle of the whole."""
    hole = Hole(0, xy)
    column = hole.of_field(np.zeros(len(hole.angle)), 1.0 * (hole.xy[:, 1] > y0))
    out = []
    for side in (np.cos(hole.angle) < 0, np.cos(hole.angle) >= 0):
        c, r = column[side], hole.residual[side]
        amount = c @ r / (c @ c)
        integral = correlation_integral(r - amount * c)
        out.append((amount, np.sqrt(np.mean((r - amount * c)**2) * integral / (c @ c))))
    return out


# ---- the page ----

def disc_table(report):
    rows = []
    for before, after in zip(report["before"]["discs"], report["after"]["discs"]):
        rows.append([before["number"], " ".join(before["flags"]) or "–",
                     f"{before['radius_mm']:.4f} ± {before['u_radius_mm']:.4f}",
                     f"{after['radius_mm']:.4f} ± {after['u_radius_mm']:.4f}",
                     f"{before['rms_um']:.1f} → {after['rms_um']:.1f}",
                     f"{before['roundness_um']:.0f} → {after['roundness_um']:.0f}"])
    return lib.table(["hole", "flags", "R before mm (± u)", "R after mm (± u)", "rms µm", "RONt µm"], rows)


def find_step(report):
    steps = [c for c in report["claims"] if c["id"] == "scan.row_step"]
    if not steps:
        raise SystemExit("the loop found no step of the rows in this scan")
    return steps[0]


def outside_tables(image, seam, used, put_in):
    tracks, half = find_tracks(image, seam, used)
    found = []
    for track in tracks:
        count, u = lost_along(track, half)
        if u < 3:
            slope = np.polyfit(track[:, 0], track[:, 1], 1)[0]
            found.append((np.interp(half, track[:, 0], track[:, 1]), slope, len(track), count, u,
                          np.std(track_rest(track, half, 0)), np.std(track_rest(track, half, put_in))))
    weights = np.array([1 / f[4]**2 for f in found])
    mean = float(weights @ [f[3] for f in found] / weights.sum()) if found else np.nan
    u = float(weights.sum()**-0.5) if found else np.nan
    blocks = texture(image, seam - 1, used)
    return found, (mean, u), blocks


def write_page(path, name, dpi, report, edges, image):
    pitch = lib.MM_PER_INCH / dpi
    step = find_step(report)
    amplitude, u = step["parameters"]["amplitude_um"], step["uncertainty"]["amplitude_um"]
    y0, u_y0 = step["parameters"]["y_mm"], step["uncertainty"]["y_mm"]
    seam = int(round(y0 / pitch + 0.5))
    crossing = [d for d in report["before"]["discs"] if abs(d["centre_mm"][1] - y0) < d["radius_mm"]]
    clean = [d["number"] for d in report["before"]["discs"] if "poor_fit" not in d["flags"]]
    used = [((d["centre_mm"][0] - d["radius_mm"]) / pitch - 8, (d["centre_mm"][0] + d["radius_mm"]) / pitch + 8) for d in crossing]
    hole = crossing[0]["number"]
    put_in = int(round(amplitude / 1000 / pitch))
    head, table = rival_table(edges, clean, np.array(image.shape[::-1]) * pitch / 2)
    found, (mean, u_mean), blocks = outside_tables(image, seam, used, put_in)
    sides = side_amplitudes(edges[hole], y0)
    middle, interval = texture_summary(blocks, 0)
    others = {dy: texture_summary(blocks, dy)[0] for dy in blocks[0][1] if abs(dy) > 8}
    before = next(d for d in report["before"]["discs"] if d["number"] == hole)
    after = next(d for d in report["after"]["discs"] if d["number"] == hole)
    p = []
    p.append(f"# The loop on {name}\n\n`tests/bench/real_loop.sh {name} --dpi {dpi:g}` writes this page, loop.json and loop.html. "
             f"{lib.program_version()}.\n")
    p.append("## What the loop found\n")
    p.append(f"Verdict: {report['verdict']}. Found: `{step['id']}`, {amplitude:.1f} ± {u:.1f} µm (standard uncertainty) at "
             f"y = {y0:.3f} ± {u_y0:.3f} mm: everything below row {seam} of the picture lies too high. In rows of "
             f"{1000 * pitch:.2f} µm that is {amplitude / 1000 / pitch:.2f} ± {u / 1000 / pitch:.2f}: "
             + ", ".join(f"{k} rows are {abs(amplitude / 1000 / pitch - k) * 1000 * pitch / u:.1f} standard uncertainties off"
                         for k in range(max(1, put_in - 1), put_in + 2)) + ".\n")
    p.append(disc_table(report))
    p.append(f"\nThe error of the edges, each weighted by the roughness of its own hole: {report['before']['rms']:.1f} µm before, "
             f"{report['after']['rms']:.1f} µm after. "
             + ("Only hole " if len(crossing) == 1 else "Holes ") + ", ".join(str(d["number"]) for d in crossing)
             + " crossed that height; the others lie below it as wholes, and being moved as wholes changes neither their radius "
             "nor their form. So they cannot confirm the step, and the table shows that they do not suffer from it.\n")
    p.append(f"## Whole rows put in below y = {y0:.2f} mm: the circle of hole {hole}\n")
    p.append(lib.table(["rows", "rms left µm", "R mm"], whole_rows(edges[hole], y0, pitch)))
    p.append(f"\nThe two sides of the hole on their own: {sides[0][0]:.1f} ± {sides[0][1]:.1f} µm on the left, "
             f"{sides[1][0]:.1f} ± {sides[1][1]:.1f} µm on the right.\n")
    p.append("## Other explanations, and what each leaves\n")
    p.append(f"Fitted to the clean holes ({', '.join(map(str, clean))}) with a circle for each. BIC counts as many points as are "
             "independent along the edge; 10 more is decisive.\n")
    p.append(lib.table(head, table))
    rejected = [r for r in report["rejected"]]
    if rejected:
        p.append("\nThe loop's own list of what it did not take: "
                 + "; ".join(f"`{r['id']}` {r['verdict']}" for r in rejected)
                 + ". Those that only one hole asks for are not confirmed by the others, and are not taken.\n")
    p.append("## What was not used to find it\n")
    p.append(f"Rows are lost for the whole width of a picture; a hole that is not round ends at its rim. The edges and the texture "
             f"below are those of the part's outline, pockets and bosses, {', '.join(f'{a:.0f} to {b:.0f} px' for a, b in used)} "
             f"(hole {hole}) left out.\n\n**Edges that cross row {seam}**: sub-pixel position in every row, a smooth curve of degree 4, "
             "and how many rows have to be put in at that row for it to pass.\n")
    p.append(lib.table(["x mm", "slope dx/dy", "rows seen", "rows lost ± u", "rms px as scanned", f"rms px with {put_in} put in"],
                       [[f"{x * pitch:.1f}", f"{s:+.2f}", n, f"{c:.1f} ± {du:.1f}", f"{b:.3f}", f"{a:.3f}"]
                        for x, s, n, c, du, b, a in found]))
    p.append(f"\nTogether {mean:.1f} ± {u_mean:.1f} rows; none lost is {abs(mean) / u_mean:.1f} standard uncertainties off.\n")
    p.append(f"**Texture**: rows L apart across a place where n rows are missing differ as rows L + n apart do elsewhere. In "
             f"{len(blocks)} blocks of 200 columns from x = {blocks[0][0] * pitch:.0f} to {(blocks[-1][0] + 200) * pitch:.0f} mm the "
             f"median says {middle:.1f} rows lost between rows {seam - 1} and {seam} (95 % bootstrap interval {interval[0]:.1f} to "
             f"{interval[1]:.1f}). The same at {len(others)} other heights of the same blocks gives medians of "
             f"{min(others.values()):.1f} to {max(others.values()):.1f}.\n")
    thirds = np.array_split(np.array([profile[0] for _, profile in blocks]), 3)
    p.append(lib.table(["part of the width", "blocks", "median of rows lost"],
                       [[word, len(t), f"{np.median(t):.1f}"] for word, t in zip(("left third", "middle", "right third"), thirds)]))
    best = min((t for t in table if "row_step" not in t[0]), key=lambda t: float(t[-1]))
    p.append(f"\n## In short\n\nHole {hole} misses a circle by {before['rms_um']:.1f} µm rms while its neighbouring edge points scatter by "
             f"{smooth_noise(Hole(hole, edges[hole]).residual):.1f} µm. Of the explanations tried, one that moves everything below "
             f"y = {y0:.2f} mm up by {amplitude:.0f} ± {u:.0f} µm leaves {after['rms_um']:.1f} µm; the best without it ({best[0]}, "
             f"{best[2]} parameters) leaves {best[3]} µm and is worse by {best[-1]} in BIC. The amplitude agrees with {put_in} rows of the "
             f"scanner, and each side of the hole asks for it on its own. A hole that was cut that way would not do the same to other "
             f"edges: the part's outline and texture, up to {max([abs(f[0] * pitch - before['centre_mm'][0]) for f in found], default=0):.0f} mm away from it, "
             f"were not used and say {mean:.1f} ± {u_mean:.1f} and {middle:.1f} rows at the same height, and none at others. "
             f"So {put_in} rows of the picture are missing. With them put in, R of hole {hole} is {after['radius_mm']:.4f} mm instead of "
             f"{before['radius_mm']:.4f} mm, {1000 * (after['radius_mm'] - before['radius_mm']):.0f} µm more. What this does not say: what is left "
             f"({after['rms_um']:.1f} µm, smooth) may be the hole's form or the scanner's; two clean holes cannot tell, and the loop takes "
             "neither. Nobody documented a true dimension, so the absolute scale is not checked either.\n")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(p))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scan")
    parser.add_argument("--dpi", type=float, default=1200)
    arguments = parser.parse_args()
    os.makedirs(FOLDER, exist_ok=True)
    report, edges = run_loop(arguments.scan, arguments.dpi)
    path = os.path.join(FOLDER, "loop.md")
    write_page(path, os.path.basename(arguments.scan), arguments.dpi, report, edges, read_png(arguments.scan))
    print(open(path, encoding="utf-8").read())


if __name__ == "__main__":
    main()
