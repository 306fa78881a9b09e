# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole beds: see bed.sh. Fails when a bed needs more than its address space or a foil differs."""

import json
import os
import resource
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(ROOT, "build")
REPORTS = os.path.join(ROOT, "reports")
A4 = (39685, 56125)
MIB = 1 << 20
LIMIT_MIB = {8: 256, 16: 512}
ROUNDS = 3
TILE = 64
MARGIN = 7 * TILE  # around a foil that is cut out: its background reaches 4 tiles, its box is rounded
BORDER = 64  # a foil that lies nearer to the scan's border may be measured on the scan's own tiles

# width, height, foils, bits: how it grows with the bed, then with the number of foils.
BY_SIZE = [(9921, 14031, 2, 8), (19843, 28063, 6, 8), (28061, 39686, 12, 8), (*A4, 24, 8)]
BY_COUNT = [(*A4, 1, 8), (*A4, 8, 8), (*A4, 16, 8), (*A4, 24, 8), (*A4, 32, 8)]
DEEP = (*A4, 24, 16)


def program(name):
    return os.path.join(BUILD, name)


def render(folder, bed):
    width, height, foils, bits = bed
    spec = {
        "schema": "foilgauge/render/1",
        "seed": foils,
        "width_px": width,
        "height_px": height,
        "foils": [{"repeat": foils, "rotate_deg": -90, "rotate_step_deg": 15 if foils < 32 else 0,
                   "radius_springback": {"mean": 0.03, "sd": 0.01}}],
        "scanner": {"bits": bits, "noise": 1.5, "shading": {"x": 0.02, "y": -0.01},
                    "dust": {"count": 20 * foils, "radius_px": 4, "contrast": 60}},
    }
    path = os.path.join(folder, "bed.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(spec, file)
    scan = os.path.join(folder, "bed.png")
    subprocess.run([program("foilgauge"), "render", path, "-o", scan], check=True)
    return scan


def limit_memory(mib):
    return lambda: resource.setrlimit(resource.RLIMIT_AS, (mib * MIB, mib * MIB))


def run_timed(folder, command, preexec=None):
    """Wall seconds, CPU seconds, peak MiB."""
    result = os.path.join(folder, "timed")
    subprocess.run([program("bench/run_timed"), result, *command], check=True, preexec_fn=preexec,
                   stdout=subprocess.DEVNULL)
    with open(result, encoding="utf-8") as file:
        wall, user, system, peak, code = file.read().split()
    if code not in ("0", "1"):
        raise SystemExit(f"exit code {code}: {' '.join(command)}")
    return float(wall), float(user) + float(system), int(peak) / 1024


def measure_bed(folder, bed):
    scan = render(folder, bed)
    report = os.path.join(folder, "bed.report.json")
    read, measure = [], []
    for _ in range(ROUNDS):  # turn and turn about, so that a busy machine hurts both
        read.append(run_timed(folder, [program("bench/read_png"), scan]))
        measure.append(run_timed(folder, [program("foilgauge"), "measure", scan, "-o", report],
                                 limit_memory(LIMIT_MIB[bed[3]])))
    with open(report, encoding="utf-8") as file:
        found = json.load(file)
    whole = [f for f in found["foils"] if f["bumps"]]
    if len(whole) != bed[2]:
        raise SystemExit(f"{len(whole)} foils found of {bed[2]}")
    row = {
        "width_px": bed[0], "height_px": bed[1], "foils": bed[2], "bits": bed[3],
        "file_mb": os.path.getsize(scan) / 1e6,
        "read_s": min(r[0] for r in read), "measure_s": min(m[0] for m in measure),
        "read_cpu_s": min(r[1] for r in read), "measure_cpu_s": min(m[1] for m in measure),
        "peak_mib": max(m[2] for m in measure), "limit_mib": LIMIT_MIB[bed[3]],
    }
    row["ratio"] = row["measure_s"] / row["read_s"]
    print(row, flush=True)
    return row, scan, found


def cut_out(folder, scan, report, shift):
    """Every foil with a margin; cut at tiles of the bed, moved by `shift` pixels."""
    size = (report["inputs"][0]["width_px"], report["inputs"][0]["height_px"])
    lines, pieces = [], []
    for foil in report["foils"]:
        box = [int(v) for v in foil["strip"]["box_px"]]
        start = [max(0, (box[k] - MARGIN) // TILE * TILE + (shift[k] if box[k] > 2 * MARGIN else 0))
                 for k in (0, 1)]
        end = [min(size[k], box[k] + box[2 + k] + MARGIN + TILE) for k in (0, 1)]
        path = os.path.join(folder, f"piece{foil['number']}.png")
        lines.append(f"{start[0]} {start[1]} {end[0] - start[0]} {end[1] - start[1]} {path}")
        pieces.append((foil, path))
    subprocess.run([program("bench/crop_png"), scan], input="\n".join(lines).encode(), check=True)
    return pieces


def differences(a, b, path="", out=None):
    """Largest difference of every number that is no position in the scan."""
    out = {} if out is None else out
    if isinstance(a, dict):
        for name in a:
            if name not in ("number", "box_px", "place_mm", "centre_mm"):
                differences(a[name], b[name], f"{path}.{name}", out)
    elif isinstance(a, list):
        if len(a) != len(b):
            out[path] = float("inf")
        for x, y in zip(a, b):
            differences(x, y, path, out)
    elif isinstance(a, (int, float)) and not isinstance(a, bool) and b is not None:
        out[path] = max(out.get(path, 0), abs(a - b))
    elif a != b:
        out[path] = float("inf")
    return out


def border_px(report):
    """Least distance of a foil from the scan's border."""
    size = (report["inputs"][0]["width_px"], report["inputs"][0]["height_px"])
    boxes = [foil["strip"]["box_px"] for foil in report["foils"]]
    return min(min(b[k], size[k] - b[k] - b[2 + k]) for b in boxes for k in (0, 1))


def neighbours_px(report):
    """Distance of each foil's box from the next one's."""
    boxes = [foil["strip"]["box_px"] for foil in report["foils"]]
    return [min(max(max(a[k], b[k]) - min(a[k] + a[2 + k], b[k] + b[2 + k]) for k in (0, 1))
                for b in boxes if b is not a) for a in boxes]


def compare_pieces(folder, scan, report, shift):
    """Foils that came out identical, all foils, the largest difference of each number."""
    same, worst = 0, {}
    pieces = cut_out(folder, scan, report, shift)
    for foil, path in pieces:
        text = subprocess.run([program("foilgauge"), "measure", path], stdout=subprocess.PIPE,
                              check=False).stdout
        # A neighbour's end may lie in the piece: the foil is the one that is most like it.
        found = [f for f in json.loads(text)["foils"] if len(f["bumps"]) == len(foil["bumps"])]
        each = [differences(foil, f) for f in found]
        best = min(each, key=lambda d: d[".overall.radius_mm"])
        same += not any(best.values())
        for name, value in best.items():
            worst[name] = max(worst.get(name, 0), value)
        os.remove(path)
    return same, len(pieces), worst


def table(rows):
    lines = ["| bed, px | bits | foils | file, MB | read, s | measure, s | ratio | CPU: read, measure, s "
             "| peak, MiB | address space allowed, MiB |", "|---|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        lines.append(
            f"| {r['width_px']} × {r['height_px']} | {r['bits']} | {r['foils']} | {r['file_mb']:.0f} "
            f"| {r['read_s']:.2f} | {r['measure_s']:.2f} | {r['ratio']:.2f} "
            f"| {r['read_cpu_s']:.1f}, {r['measure_cpu_s']:.1f} | {r['peak_mib']:.0f} | {r['limit_mib']} |")
    return "\n".join(lines)


def panel(out, left, title, xs, series, unit):
    """One plot: points joined by lines, axes from 0, the largest values written at their ends."""
    top, width, height = 40, 300, 200
    x_max, y_max = max(xs), 1.3 * max(max(values) for _, values, _ in series)
    out.append(f'<text x="{left}" y="24" font-weight="bold">{title}</text>')
    out.append(f'<path d="M{left} {top}V{top + height}H{left + width}" fill="none" stroke="#444"/>')
    out.append(f'<text x="{left + width}" y="{top + height + 18}" text-anchor="end">{x_max:g} {unit}</text>')
    for k, (name, values, colour) in enumerate(series):
        points = [(left + width * x / x_max, top + height * (1 - y / y_max)) for x, y in zip(xs, values)]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in points]
        out.append(f'<text x="{left + 8}" y="{top + 14 + 16 * k}" fill="{colour}">{name}: {values[-1]:.3g} '
                   f'at {xs[-1]:g} {unit}</text>')


def plot(by_size, by_count):
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 560" font-family="sans-serif" '
           'font-size="12">', '<rect width="720" height="560" fill="#fff"/>']
    sizes = [r["width_px"] * r["height_px"] / 1e9 for r in by_size]
    counts = [r["foils"] for r in by_count]
    for row, (key, unit, other) in enumerate([("measure_s", "s", "read_s"), ("peak_mib", "MiB", None)]):
        out.append(f'<g transform="translate(0 {row * 270})">')
        words = "time, s" if key == "measure_s" else "peak memory, MiB"
        for left, title, xs, rows, x_unit in ((30, f"{words}, over the bed", sizes, by_size, "Gpx"),
                                             (390, f"{words}, over the foils on A4", counts, by_count, "foils")):
            series = [("measure", [r[key] for r in rows], "#1f5fa8")]
            if other:
                series.append(("read alone", [r[other] for r in rows], "#b8562b"))
            panel(out, left, title, xs, series, x_unit)
        out.append("</g>")
    out.append("</svg>")
    return "\n".join(out) + "\n"


NAMES = [(".bumps.radius_mm", "R", 1e6), (".bumps.height_mm", "h", 1e6), (".overall.radius_mm", "R0", 1e6),
         (".thickness_mm", "thickness", 1e6)]


def piece_lines(results):
    lines = ["| cut | foils | identical in every number | R | h | R0 | thickness |", "|---|---|---|---|---|---|---|"]
    for words, (same, count, worst) in results:
        values = " | ".join(f"{worst[name] * scale:.3g} nm" for name, _, scale in NAMES)
        lines.append(f"| {words} | {count} | {same} | {values} |")
    return "\n".join(lines)


def write(path, text):
    with open(os.path.join(REPORTS, path), "w", encoding="utf-8") as file:
        file.write(text)


def write_report(by_size, by_count, deep, bed_report, pieces):
    rows = by_size + [r for r in by_count if r not in by_size] + [deep]
    keys = list(rows[0])
    neighbours = neighbours_px(bed_report)
    write("bed.csv", ",".join(keys) + "\n" + "".join(
        ",".join(f"{r[k]:.6g}" if isinstance(r[k], float) else str(r[k]) for k in keys) + "\n" for r in rows))
    write("bed.svg", plot(by_size, by_count))
    write("bed.md", f"""# Whole beds

Made by `tests/bench/bed.sh`: beds rendered with `foilgauge render` (shading, noise 1.5, 20 specks of dust per foil,
foils at every angle), measured with `foilgauge measure`, beside libpng reading the same file row by row and keeping
nothing. Times are the least of {ROUNDS} runs taken turn and turn about on {os.cpu_count()} cores; memory is the largest. Every
measurement ran with its address space limited (RLIMIT_AS) to the last column, threads, stacks and libraries included.

{table(rows)}

![Time and memory over bed size and number of foils](bed.svg)

The work beside reading is the reduction to blocks, the file's SHA-256 and the foils themselves; reading, reducing and
measuring run at the same time. Memory is eight strips of 64 rows and the foils under way: it grows with the width of
the bed, hardly with its length or with the foils.


## On the bed and one by one

Every foil of the A4 bed with {len(neighbours)} was cut out of the PNG with a margin of {MARGIN} px and measured alone; {sum(n < MARGIN for n in neighbours)} of the
pieces hold a neighbour or a part of one, the nearest {min(neighbours)} px away. Largest difference to the same foil on the bed:

{piece_lines(pieces)}

A foil's tiles have their corner at the foil, and what lies further away than some 50 px plays no part: wherever it is cut, its
numbers are the same to the last digit, or this bench fails. It leaves two cases open. Foils nearer to each other than four
widths of the strip (here 80 px) are measured on the same tiles, because a strip may have a gap as long as this. A foil nearer
than {BORDER} px to the scan's border may be measured on the scan's own tiles; on this bed all lie {border_px(bed_report)} px from it or more.

Wall times are of a machine that other jobs may have shared; the CPU times are steadier.
""")


def main():
    with tempfile.TemporaryDirectory(prefix="foilgauge-bed-") as folder:
        done = {}
        for bed in BY_SIZE + BY_COUNT:
            if bed in done:
                continue
            done[bed], scan, report = measure_bed(folder, bed)
            if bed == BY_SIZE[-1]:
                pieces_of = report
                pieces = [(f"at tiles ({x}, {y} px beside)", compare_pieces(folder, scan, report, (x, y)))
                          for x, y in ((0, 0), (5, 3), (37, 50))]
        deep = measure_bed(folder, DEEP)[0]
    write_report([done[b] for b in BY_SIZE], [done[b] for b in BY_COUNT], deep, pieces_of, pieces)
    if border_px(pieces_of) < BORDER:
        raise SystemExit("a foil lies too near to the bed's border to be the same when it is cut out")
    if any(same < count for _, (same, count, _) in pieces):
        raise SystemExit("a foil that is cut out differs from itself on the bed")
    print("reports/bed.md, bed.csv, bed.svg")


if __name__ == "__main__":
    sys.exit(main())
