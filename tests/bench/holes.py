# SPDX-License-Identifier: GPL-3.0-or-later
"""The round features of a real scan: `measure --form discs` on it, and the residual of the largest
complete one against direction. Writes reports/real/holes.json, holes.csv, holes.svg and the tables
of holes.md (what stands below its line "## What is seen" is kept).

    tests/bench/holes.py SCAN.png --dpi 1200
"""

import argparse
import csv
import os
import subprocess

import numpy as np

import benchlib as lib

FOLDER = os.path.join(lib.ROOT, "reports", "real")
SEEN = "## What is seen"


def measure(scan, dpi):
    """Runs in the scan's folder, so that the reports name the file and not where it lay."""
    folder, name = os.path.split(os.path.abspath(scan))
    points = os.path.join(FOLDER, "points.csv")
    command = [lib.FOILGAUGE, "measure", "--form", "discs", name, "--points", points,
               "-o", os.path.join(FOLDER, "holes.json"), "--csv", os.path.join(FOLDER, "holes.csv")]
    if dpi:
        command += ["--dpi", str(dpi)]
    subprocess.run(command, check=True, cwd=folder)
    with open(points, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    os.remove(points)
    return lib.load(os.path.join(FOLDER, "holes.json"))["discs"], rows


def circle_rms(x, y):
    """Orthogonal-distance circle by Gauss-Newton: radius and rms."""
    cx, cy, radius = x.mean(), y.mean(), np.hypot(x - x.mean(), y - y.mean()).mean()
    for _ in range(20):
        d = np.hypot(x - cx, y - cy)
        jacobian = np.array([(x - cx) / d, (y - cy) / d, np.ones_like(d)]).T
        step = np.linalg.lstsq(jacobian, d - radius, rcond=None)[0]
        cx, cy, radius = cx + step[0], cy + step[1], radius + step[2]
    return radius, np.sqrt(np.mean((np.hypot(x - cx, y - cy) - radius) ** 2))


def best_row_step(disc, rows, pitch_mm):
    """The whole number of rows that, put in below some y, makes the feature roundest."""
    own = [row for row in rows if int(row["disc"]) == disc["number"]]
    x, y = (np.array([float(row[name]) for row in own]) for name in ("x_mm", "y_mm"))
    best = None
    for at in np.arange(y.min() + 0.1, y.max() - 0.1, 0.02):
        for count in range(-5, 6):
            radius, rms = circle_rms(x, y + np.where(y > at, count * pitch_mm, 0))
            if best is None or rms < best[3]:
                best = (count, at, radius, rms)
    return best


def residual(disc, rows):
    """Direction (degrees, from x to y, that is clockwise as seen) and residual, sorted."""
    own = [row for row in rows if int(row["disc"]) == disc["number"]]
    x = np.array([float(row["x_mm"]) for row in own]) - disc["centre_mm"][0]
    y = np.array([float(row["y_mm"]) for row in own]) - disc["centre_mm"][1]
    angle = np.degrees(np.arctan2(y, x)) % 360
    order = np.argsort(angle)
    return angle[order], np.array([float(row["residual_um"]) for row in own])[order]


def harmonics(angle, values, count):
    """Amplitude and direction of the first lobe of harmonics 2 to `count`, by least squares."""
    phi = np.radians(angle)
    columns = [np.ones_like(phi)]
    for k in range(1, count + 1):
        columns += [np.cos(k * phi), np.sin(k * phi)]
    x = np.linalg.lstsq(np.array(columns).T, values, rcond=None)[0]
    result = []
    for k in range(2, count + 1):
        a, b = x[2 * k - 1], x[2 * k]
        result.append((k, np.hypot(a, b), np.degrees(np.arctan2(b, a)) / k % (360 / k)))
    return result


def smooth(angle, values, width_deg):
    grid = np.arange(0, 360, 1.0)
    off = (grid[:, None] - angle[None, :] + 180) % 360 - 180
    weight = np.exp(-0.5 * (off / width_deg) ** 2)
    return grid, (weight * values).sum(axis=1) / weight.sum(axis=1)


def plot(path, angle, values, title):
    width, height, left, top = 900, 360, 70, 40
    limit = 10 * np.ceil(np.abs(values).max() / 10)

    def at(a, v):
        return left + (width - left - 20) * a / 360, top + (height - top - 50) * (0.5 - v / limit / 2)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">',
           f'<rect width="{width}" height="{height}" fill="#fff"/><text x="{left}" y="22">{title}</text>']
    for a in range(0, 361, 45):
        x, y = at(a, -limit)
        out.append(f'<path d="M{x:.1f} {top}V{y:.1f}" stroke="#ddd"/><text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">{a}°</text>')
    for v in np.linspace(-limit, limit, 5):
        x, y = at(0, v)
        out.append(f'<path d="M{x:.1f} {y:.1f}H{width - 20}" stroke="#ddd"/><text x="{x - 8:.1f}" y="{y + 4:.1f}" text-anchor="end">{v:+.0f} µm</text>')
    out += ['<circle cx="%.1f" cy="%.1f" r="1.6" fill="#8aa4c8"/>' % at(a, v) for a, v in zip(angle, values)]
    line = " ".join("%.1f,%.1f" % at(a, v) for a, v in zip(*smooth(angle, values, 4)))
    out.append(f'<polyline points="{line}" fill="none" stroke="#b03020" stroke-width="1.8"/>')
    out.append(f'<text x="{width / 2}" y="{height - 8}" text-anchor="middle">direction from the centre (0° right, 90° down as the scan is seen)</text></svg>')
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n")


def feature_table(discs):
    header = ["feature", "radius mm", "u mm", "centre mm", "RONt µm", "u µm", "rms µm", "seen over", "blur µm", "flags"]
    rows = [[d["number"], f"{d['radius_mm']:.4f}", f"{d['u_radius_mm']:.4f}",
             "{:.3f}, {:.3f}".format(*d["centre_mm"]), f"{d['roundness_um']:.0f}",
             f"{d['u_roundness_um']:.1f}", f"{d['rms_um']:.1f}", f"{d['coverage_deg']:.0f}°",
             f"{d['blur_um']:.0f}", " ".join(d["flags"]) or "–"] for d in discs]
    return lib.table(header, rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scan")
    parser.add_argument("--dpi", type=float)
    arguments = parser.parse_args()
    os.makedirs(FOLDER, exist_ok=True)
    discs, rows = measure(arguments.scan, arguments.dpi)
    disc = max((d for d in discs if "poor_fit" not in d["flags"]), key=lambda d: d["radius_mm"])
    angle, values = residual(disc, rows)
    plot(os.path.join(FOLDER, "holes.svg"), angle, values,
         f"Feature {disc['number']}: radial residual of the edge, outwards positive")
    waves = harmonics(angle, values, 8)
    page = os.path.join(FOLDER, "holes.md")
    text = ""
    if os.path.exists(page):
        with open(page, encoding="utf-8") as file:
            text = file.read()
    seen = text[text.index(SEEN):] if SEEN in text else SEEN + "\n"
    name = os.path.basename(arguments.scan)
    with open(page, "w", encoding="utf-8") as file:
        file.write(f"# Round features of {name}\n\n`tests/bench/holes.sh {name} --dpi {arguments.dpi or 1200:g}` "
                   f"writes the tables, holes.csv, holes.json and the plot. {lib.program_version()}.\n\n")
        file.write(feature_table(discs))
        file.write(f"\n## Residual of feature {disc['number']}\n\n![Residual against direction](holes.svg)\n\n")
        file.write(lib.table(["undulations per turn", "amplitude µm", "first lobe at"],
                             [[k, f"{a:.1f}", f"{p:.0f}°"] for k, a, p in waves]))
        count, at, radius, rms = best_row_step(disc, rows, lib.MM_PER_INCH / (arguments.dpi or 1200))
        file.write(f"\nThe feature is roundest with {count} rows put in below y = {at:.2f} mm: "
                   f"rms {rms * 1000:.1f} µm, R {radius:.4f} mm.\n\n" + seen)
    print(feature_table(discs))
    print(waves)


if __name__ == "__main__":
    main()
