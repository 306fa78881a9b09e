# SPDX-License-Identifier: GPL-3.0-or-later
"""Scans of another laboratory's renderer: it has no line in common with src/render, and models of its own for whatever
the two need not agree on. What the loop is worth on data that its makers did not make is judged on these.

Usage: other_scanner.py OUT_DIR --seed S [--name NAME] [--effect ID=VALUE[,MEMBER=VALUE]...]... [--rotate DEG] [--pair DEG]
       [--scanner JSON]

  python3 tests/bench/other_scanner.py out --seed 7 --effect scan.shear=1e-3 --effect scan.carriage_ripple=8,period_mm=3
  python3 tests/bench/other_scanner.py out --seed 7 --scanner '{"unsharp_mask": {"amount_pct": 100, "radius_px": 1}}'

writes out/other_7.png and out/other_7.truth.json; with --pair 90 other_7a and other_7b: the same foil, turned. VALUE
is the effect's ratio, or its amplitude in um; members are those of `foilgauge render`. Foil and scanner follow from
the seed alone, but for members of the scanner that --scanner states.

An outline is covered exactly (other_strip.py): pixels are areas of a polygon whose edges scatter by 0.15 to 0.35 px with
an exponential or a Matern correlation of 5 to 11 px. Then, in this order: the optics' Gaussian and a halo of
exp(-r / L); a sensor that lags behind along the carriage's way, rising light and falling light by different lengths;
shading and columns of unequal gain; grain, correlated and larger where it is bright; the tone; white that clips; 8 bit;
JPEG's quantised blocks. What a driver adds: other_driver.py."""

import argparse
import json
import math
import os
import struct
import zlib

import numpy as np

import other_driver
from loop_cases import GEN2, draw_foil, log_uniform, place
from loop_foil import natural_spline
from other_strip import bump_of, coverage, disc_outline, leaf_outline, outline_of

STEP_PX = 0.25
SIZE_STEP = 24  # px: sizes that resampling divides
BAND = 128  # rows; whole blocks of JPEG
# ITU T.81, annex K.1: luminance.
JPEG_TABLE = np.array([
    16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56,
    14, 17, 22, 29, 51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92,
    49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
]).reshape(8, 8)  # fmt: skip


def draw_other(rng):
    """A scanner as flatbeds are at their best resolution."""
    light = rng.random() < 2 / 3
    scanner = {
        "dpi": 4800, "bits": 8,
        "background": float(rng.uniform(20, 45) if light else rng.uniform(205, 235)),
        "contrast": float(rng.uniform(150, 185) if light else -rng.uniform(140, 180)),
        "scatter_px": float(rng.uniform(0.15, 0.35)), "common": float(rng.uniform(0.2, 0.8)),
        "correlation_px": float(rng.uniform(5, 11)), "form": str(rng.choice(["exponential", "matern"])),
        "blur_px": float(rng.uniform(1.3, 2.5)), "lag_px": [float(v) for v in rng.uniform(0.1, 1.3, 2)],
        "noise": float(rng.uniform(0.8, 2.5)), "grain": float(rng.uniform(0.3, 0.69)),
        "columns": float(rng.uniform(0, 0.003)), "gamma": 1.0,
    }  # fmt: skip
    if rng.random() < 1 / 2:
        scanner["gamma"] = log_uniform(rng, 0.6, 2.2)
    if rng.random() < 2 / 3:
        scanner["halo"] = {"fraction": float(rng.uniform(0.05, 0.2)), "length_px": float(rng.uniform(8, 25))}
    if rng.random() < 1 / 2:
        scanner["shading"] = [float(v) for v in rng.uniform(-0.04, 0.04, 2)]
    if rng.random() < 1 / 2:
        bright = max(scanner["background"], scanner["background"] + scanner["contrast"])
        scanner["clip_white"] = float(bright + rng.uniform(-3, 5))
    if rng.random() < 1 / 4:
        scanner["jpeg_quality"] = int(rng.integers(82, 97))
    return scanner


def field_mm(effects, at):
    """Shift that smooth effects of the scanner add to a place of the picture (mm) to give the true one."""
    d, (x, y) = np.zeros_like(at), at.T
    for e in effects:
        name, mm = e["id"], e.get("amplitude_um", 0) / 1000
        if name == "scan.scale_y":
            d[:, 1] += e["value"] * y
        elif name == "scan.shear":
            d[:, 0] += e["value"] * y
        elif name == "scan.carriage_ripple":
            d[:, 1] += mm * np.sin(2 * np.pi * y / e["period_mm"] + math.radians(e.get("phase_deg", 0)))
        elif name == "scan.carriage_start":
            d[:, 1] += mm * np.exp(-y / e["length_mm"])
        elif name in ("free.scan.x", "free.scan.y"):
            own = name[-1]
            d[:, "xy".index(e.get("moves", own))] += natural_spline(e["knots"], x if own == "x" else y) / 1000
        elif name.startswith("scan.") and name.endswith(("quadratic", "cubic")):
            axis = 1 if "carriage" in name else 0
            power = 3 if name.endswith("cubic") else 2
            d[:, axis] += mm * ((at[:, axis] - e["centre_mm"]) / e.get("half_width_mm", 18)) ** power
    return d


def picture_mm(effects, true):
    """The place in the picture of a true place: at + d(at) = true. A ripple of 30 um over 0.8 mm contracts by 4 a turn."""
    at = true.copy()
    for _ in range(14):
        at = true - field_mm(effects, at)
    return at


def with_middles(spec):
    """Distortions without a centre are about the middle of the picture."""
    size = [spec[side] / 2 * 25.4 / spec["scanner"]["dpi"] for side in ("width_px", "height_px")]
    return [{"centre_mm": size["carriage" in e["id"]], **e} for e in spec["effects"]]


def strips_between(effects, name, member, end, dpi):
    """Strips between the jumps of the picture along one axis: [(from px, to px, shift mm)]."""
    steps = sorted((e[member], e["amplitude_um"] / 1000) for e in effects if e["id"] == name)
    starts = [0] + [min(end, max(0, int(math.floor(at / 25.4 * dpi)) + 1)) for at, _ in steps] + [end]
    shifts = np.concatenate([[0], np.cumsum([a for _, a in steps])])
    return list(zip(starts[:-1], starts[1:], shifts))


def cover(spec, outlines_mm):
    """Rows and columns that are lost or doubled: every part of the picture is covered for itself."""
    width, height, effects = spec["width_px"], spec["height_px"], with_middles(spec)
    dpi = spec["scanner"]["dpi"]
    result = np.zeros((height, width), np.float32)
    for top, bottom, dy in strips_between(effects, "scan.row_step", "y_mm", height, dpi):
        for left, right, dx in strips_between(effects, "scan.column_step", "x_mm", width, dpi):
            shown = [picture_mm(effects, o - [dx, dy]) / 25.4 * dpi for o in outlines_mm]
            if bottom > top and right > left:
                result[top:bottom, left:right] = coverage(shown, width, height)[top:bottom, left:right]
    return result


def outlines_of(spec, rng):
    """On the glass, mm; edges that move by where they look to are moved here."""
    scanner, mm_per_px = spec["scanner"], 25.4 / spec["scanner"]["dpi"]
    scatter, common = scanner["scatter_px"] * mm_per_px, scanner["common"]
    edges = {"common_mm": scatter * common, "own_mm": scatter * math.sqrt(1 - common**2),
             "correlation_mm": scanner["correlation_px"] * mm_per_px, "form": scanner["form"]}  # fmt: skip
    for foil in spec["foils"]:
        outline, normal = outline_of(rng, foil, spec["effects"], edges, STEP_PX * mm_per_px)
        for e in spec["effects"]:
            if e["id"] == "free.edge.normal":
                inner = np.degrees(np.arctan2(-normal[:, 1], -normal[:, 0]))
                outline = outline - natural_spline(e["knots"], inner, 360.0)[:, None] / 1000 * normal
        yield outline + np.array(foil["centre_mm"])
    for disc in spec.get("discs", []):
        yield disc_outline(rng, disc, edges, STEP_PX * mm_per_px)
    for leaf in spec.get("leaves", []):
        yield leaf_outline(leaf)


def filter_along(picture, kernel, axis):
    """Symmetric kernel, its first weight that of the middle; the border repeats."""
    reach, size = len(kernel) - 1, picture.shape[axis]
    pad = [(0, 0), (0, 0)]
    pad[axis] = (reach, reach)
    wide = np.pad(picture, pad, "edge")
    part = lambda k: wide[reach + k : reach + k + size] if axis == 0 else wide[:, reach + k : reach + k + size]
    out = kernel[0] * picture
    for k, weight in enumerate(kernel[1:], 1):
        both = part(k) + part(-k)
        both *= weight
        out += both
    return out


def gaussian(picture, sd):
    kernel = np.exp(-((np.arange(int(4.5 * sd) + 1) / sd) ** 2) / 2)
    kernel = (kernel / (2 * kernel.sum() - kernel[0])).astype(np.float32)
    return filter_along(filter_along(picture, kernel, 1), kernel, 0)


class Halo:
    """exp(-r / L) in two dimensions, on a picture of an eighth the size: it is wide, and a share of the light."""

    def __init__(self, light, length):
        height, width = light.shape
        small = np.full((height // 8 + 2, width // 8 + 2), light[0, 0], float)
        for k in range(height // 8):
            rows = light[8 * k : 8 * k + 8, : width // 8 * 8]
            small[k, : width // 8] = rows.mean(axis=0, dtype=np.float64).reshape(-1, 8).mean(axis=1)
        reach = int(length) + 1  # of 8 px each: 8 lengths
        small = np.pad(small, reach, "edge")
        y, x = (8 * n * np.fft.fftfreq(n) for n in small.shape)
        kernel = np.exp(-np.hypot(y[:, None], x[None]) / length)
        spread = np.fft.irfft2(np.fft.rfft2(small) * np.fft.rfft2(kernel / kernel.sum()), small.shape)
        self.small, self.width = spread[reach - 1 : 1 - reach, reach - 1 : 1 - reach].astype(np.float32), width

    def rows(self, top, bottom):
        """Linear between the middles of the blocks, which lie at 8 k + 3.5; one block stands before the first."""
        along = lambda at: ((at + 4.5) // 8, ((at + 4.5) / 8 % 1).astype(np.float32))
        (i, p), (j, q) = along(np.arange(top, bottom)), along(np.arange(self.width))
        i, j = i.astype(int), j.astype(int)
        rows = self.small[i] * (1 - p)[:, None] + self.small[i + 1] * p[:, None]
        return rows[:, j] * (1 - q) + rows[:, j + 1] * q


def lag(light, last, rise_px, fall_px):
    """Every row takes up what the last one left: more slowly the longer the lag, and not alike up and down."""
    keep = [np.float32(math.exp(-1 / v)) for v in (rise_px, fall_px)]
    for row in light:
        behind = last - row
        last = row + np.where(behind < 0, keep[0], keep[1]) * behind
        row[:] = last
    return last


class Grain:
    """Unit variance; `share`: correlation to the next pixel along x and along y. Rows come in order."""

    def __init__(self, rng, width, share):
        side = (1 - math.sqrt(1 - 2 * share**2)) / (2 * share)
        self.kernel = np.array([1, side], np.float32) / np.float32(math.sqrt(1 + 2 * side**2))
        self.rng, self.last = rng, rng.standard_normal((2, width), dtype=np.float32)

    def rows(self, count):
        white = self.rng.standard_normal((count, self.last.shape[1]), dtype=np.float32)
        white = np.concatenate([self.last, white])
        self.last = white[-2:]
        return filter_along(filter_along(white, self.kernel, 0)[1:-1], self.kernel, 1)


def jpeg(picture, quality):
    """The picture with its blocks of 8 x 8 quantised."""
    scale = 5000 / quality if quality < 50 else 200 - 2 * quality
    table = np.clip((JPEG_TABLE * scale + 50) // 100, 1, 255).astype(np.float32)
    k = np.arange(8)
    cosine = np.cos(np.pi * (2 * k[None] + 1) * k[:, None] / 16) / 2
    cosine[0] /= math.sqrt(2)
    cosine = cosine.astype(np.float32)
    height, width = picture.shape
    wide = np.pad(picture, ((0, -height % 8), (0, -width % 8)), "edge") - 128
    blocks = wide.reshape(wide.shape[0] // 8, 8, -1, 8).swapaxes(1, 2)
    blocks = np.round((cosine @ blocks @ cosine.T) / table) * table
    wide = (cosine.T @ blocks @ cosine).swapaxes(1, 2).reshape(wide.shape) + 128
    return wide[:height, :width]


def tone(light, scanner):
    """Light, 0 for the background and 1 for the strip, as numbers of the picture."""
    power = scanner["gamma"]
    low, high = ((v / 255) ** power for v in (scanner["background"], scanner["background"] + scanner["contrast"]))
    linear = np.clip(low + (high - low) * light, 0, None)
    return 255 * (linear if power == 1 else linear ** np.float32(1 / power))


def blurred_where(covered, margin, sd):
    """Most of a scan is empty: only the columns that the strip comes near."""
    light, columns = np.zeros_like(covered), np.flatnonzero(covered.any(axis=0))
    if len(columns):
        near = slice(max(columns[0] - margin, 0), columns[-1] + margin + 1)
        light[:, near] = gaussian(covered[:, near], sd)
    return light


def blurred(covered, blur_px):
    """Blurred rows, BAND at a time: (first row, light)."""
    margin = int(4.5 * blur_px) + 1
    for top in range(0, len(covered), BAND):
        bottom, low = min(top + BAND, len(covered)), max(top - margin, 0)
        yield top, blurred_where(covered[low : bottom + margin], margin, blur_px)[top - low : bottom - low]


def optics(covered, halo, scanner):
    """Blurred rows with their halo, BAND at a time: (first row, light)."""
    if "oversampling" in scanner:  # was blurred before pixels were made of it
        bands = ((top, covered[top : top + BAND].copy()) for top in range(0, len(covered), BAND))
    elif isinstance(scanner["blur_px"], list):
        whole = other_driver.blur_ellipse(covered, scanner["blur_px"], scanner.get("blur_angle_deg", 0))
        bands = ((top, whole[top : top + BAND]) for top in range(0, len(whole), BAND))
    else:
        bands = blurred(covered, scanner["blur_px"])
    for top, light in bands:
        if halo:
            light += np.float32(scanner["halo"]["fraction"]) * (halo.rows(top, top + len(light)) - light)
        yield top, light


def finish(numbers, scanner):
    """Rounded to the file's bits; JPEG goes last."""
    if "clip_white" in scanner:
        np.minimum(numbers, scanner["clip_white"], out=numbers)
    if scanner.get("bits", 8) == 16:
        return np.rint(np.clip(numbers, 0, 255) * 257).astype(np.uint16)
    numbers = np.clip(np.rint(numbers), 0, 255)
    if "jpeg_quality" in scanner:
        numbers = np.clip(np.rint(jpeg(numbers, scanner["jpeg_quality"])), 0, 255)
    return numbers.astype(np.uint8)


def sensed(covered, scanner, rng):
    """The sensor's numbers, BAND rows at a time: (rows, numbers of 0 to 255)."""
    height, width = covered.shape
    if "shadow" in scanner and "oversampling" not in scanner:
        covered = other_driver.cast_shadow(covered, scanner["shadow"])
    shading = scanner.get("shading", [0, 0])
    gain = 1 + shading[0] * np.linspace(-1, 1, width) + scanner["columns"] * rng.standard_normal(width)
    down = 1 + shading[1] * np.linspace(-1, 1, height)
    grain = Grain(rng, width, scanner["grain"])
    halo = Halo(covered, scanner["halo"]["length_px"]) if "halo" in scanner else None
    last = covered[0]
    for top, light in optics(covered, halo, scanner):
        last, rows = lag(light, last, *scanner["lag_px"]), slice(top, top + len(light))
        bright = light if scanner["contrast"] > 0 else 1 - light
        noise = np.float32(scanner["noise"]) * np.sqrt(np.maximum(0.6 + 0.4 * bright, 0)) * grain.rows(len(light))
        factor = (down[rows, None] * gain).astype(np.float32)
        yield rows, tone(light, scanner) * factor + noise


def finely_blurred(spec, outlines):
    """Optics before pixels, as light has it: on a grid that is finer by `oversampling`, whose means are the pixels. A blur
    under 1.3 px asks for it: pixels that are covered exactly and blurred afterwards have aliases."""
    scanner, fine = spec["scanner"], spec["scanner"]["oversampling"]
    grid = {**spec, "width_px": fine * spec["width_px"], "height_px": fine * spec["height_px"],
            "scanner": {**scanner, "dpi": fine * scanner["dpi"]}}  # fmt: skip
    light = cover(grid, outlines)
    if "shadow" in scanner:
        lengths = {name: fine * scanner["shadow"].get(name, 0) for name in ("length_px", "gap_px")}
        light = other_driver.cast_shadow(light, {**scanner["shadow"], **lengths})
    if isinstance(scanner["blur_px"], list):
        blur = [fine * v for v in scanner["blur_px"]]
        light = other_driver.blur_ellipse(light, blur, scanner.get("blur_angle_deg", 0))
    else:
        light = gaussian(light, fine * scanner["blur_px"])
    return light.reshape(spec["height_px"], fine, spec["width_px"], fine).mean(axis=(1, 3), dtype=np.float32)


def channel_of(spec, outlines, rng, magnification=0.0):
    """One channel of the file: its magnification is about the picture's middle, along x."""
    scanner, size = spec["scanner"], (spec["height_px"], spec["width_px"])
    if "resampled_from_dpi" in scanner:
        share = scanner["resampled_from_dpi"] / scanner["dpi"]
        spec = {**spec, "width_px": round(size[1] * share), "height_px": round(size[0] * share)}
        spec["scanner"] = scanner = {**scanner, "dpi": spec["width_px"] / size[1] * scanner["dpi"]}
    middle = np.array([spec["width_px"] / 2 * 25.4 / scanner["dpi"], 0])
    shown = [o + (o - middle) * [magnification, 0] for o in outlines]
    covered = finely_blurred(spec, shown) if "oversampling" in scanner else cover(spec, shown)
    if not other_driver.is_wanted(scanner):
        result = np.empty(size, np.uint16 if scanner.get("bits", 8) == 16 else np.uint8)
        for rows, numbers in sensed(covered, scanner, rng):
            result[rows] = finish(numbers, scanner)
        return result
    numbers = np.concatenate([numbers for _, numbers in sensed(covered, scanner, rng)])
    return finish(other_driver.drive(numbers, scanner, size), scanner)


def picture_of(spec):
    """As the scanner of the spec gives it: rows, columns and, of a colour scan, channels."""
    scanner, rng = spec["scanner"], np.random.default_rng([spec["seed"], 81])
    outlines = list(outlines_of(spec, rng))
    if "magnification_ppm" not in scanner:
        return channel_of(spec, outlines, rng)
    channels = []
    for ppm, share in zip(scanner["magnification_ppm"], scanner.get("channel_contrast", [1, 1, 1])):
        own = {**spec, "scanner": {**scanner, "contrast": scanner["contrast"] * share}}
        channels.append(channel_of(own, outlines, rng, ppm * 1e-6))
    return np.stack(channels, axis=2)


def write_png(path, picture, dpi):
    height, width = picture.shape[:2]
    channels, bits = (3 if picture.ndim == 3 else 1), 8 * picture.itemsize
    pixels = picture.astype(picture.dtype.newbyteorder(">")).reshape(height, -1).view(np.uint8)
    lines = np.zeros((height, pixels.shape[1] + 1), np.uint8)  # no filter: grain hardly gains by one
    lines[:, 1:] = pixels
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    per_metre = round(dpi / 0.0254)
    head = struct.pack(">IIBBBBB", width, height, bits, 2 if channels == 3 else 0, 0, 0, 0)
    with open(path + ".part", "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head))
        file.write(chunk(b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1)))
        file.write(chunk(b"IDAT", zlib.compress(lines.tobytes(), 1)) + chunk(b"IEND", b""))
    os.replace(path + ".part", path)


def write_truth(path, name, spec):
    foil, scanner = spec["foils"][0], spec["scanner"]
    design = foil["design"]
    nominal = bump_of({**foil, "overall_radius_mm": design["overall_radius_mm"],
                       "radius_mm": [design["bump_radius_mm"]]}, 0)  # fmt: skip
    nominal = {k: nominal[k] for k in ("centre_to_centre_mm", "height_mm")}
    truth = {
        "name": name, "overall_radius_mm": foil["overall_radius_mm"],
        "overall_centre_px": [v / 25.4 * scanner["dpi"] for v in foil["centre_mm"]],
        "thickness_mm": design["thickness_mm"], "design": design, "nominal": nominal,
        "bumps": [bump_of(foil, i) for i in range(design["bump_count"])],
        "scan": {"width": spec["width_px"], "height": spec["height_px"], "rotate_deg": foil["rotate_deg"], **scanner},
        "effects": spec["effects"], "spec": spec,
    }  # fmt: skip
    with open(path, "w", encoding="utf-8") as file:
        json.dump(truth, file, indent=1)


def render_other(spec, path):
    write_png(path, picture_of(spec), spec["scanner"]["dpi"])


def specs_of(seed, effects, rotate_deg=None, pair_deg=None, members=None):
    rng = np.random.default_rng([seed, 80])
    scanner, foil = {**draw_other(rng), **(members or {})}, draw_foil(rng, GEN2)
    if rotate_deg is not None:
        foil["rotate_deg"] = rotate_deg
    scans = [[foil]] if pair_deg is None else [[foil], [{**foil, "rotate_deg": foil["rotate_deg"] + pair_deg}]]
    step = SIZE_STEP if "resampled_from_dpi" in scanner else 1
    width, height = (int(v / 25.4 * scanner["dpi"]) // step * step for v in place(rng, scans))
    return [{"seed": 1000 * seed + k, "width_px": width, "height_px": height, "foils": foils, "scanner": scanner,
             "effects": effects} for k, foils in enumerate(scans)]  # fmt: skip


def parse_effect(text):
    name, _, rest = text.partition("=")
    first, *members = rest.split(",")
    main = {"scan.scale_y": "value", "scan.shear": "value", "part.thickness_taper": "thickness_change_um"}
    effect = {"id": name, main.get(name, "amplitude_um"): float(first)}
    for member in members:
        key, _, value = member.partition("=")
        effect[key] = value if key in ("along", "moves") else float(value)
    return effect


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--name")
    parser.add_argument("--effect", type=parse_effect, action="append", default=[])
    parser.add_argument("--rotate", type=float, help="direction of the foil's middle, degrees")
    parser.add_argument("--pair", type=float, metavar="DEG", help="a second scan of the same foil, turned")
    parser.add_argument("--scanner", type=json.loads, metavar="JSON", help="members instead of those drawn")
    options = parser.parse_args()
    os.makedirs(options.folder, exist_ok=True)
    specs = specs_of(options.seed, options.effect, options.rotate, options.pair, options.scanner)
    for k, spec in enumerate(specs):
        name = (options.name or f"other_{options.seed}") + ("ab"[k] if len(specs) > 1 else "")
        base = os.path.join(options.folder, name)
        render_other(spec, base + ".png")
        write_truth(base + ".truth.json", name, spec)
        print(base + ".png")


if __name__ == "__main__":
    main()
