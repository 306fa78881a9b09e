#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every page that the program writes, in a real browser: at 1280 px, printed on A4, and on a phone of 400 px. Ends with an error
for a page that is wider than its window, a table or a plot's words that are clipped, a heading that ends a printed page, a
printed page that is half empty although others follow; on a phone, where tables may be pushed aside, for a table whose second
column is out of sight, and for letters of a plot that are too small to be read.

    tests/browser/pages_browser.py PROGRAM [--renderer PROGRAM] [--only REGEX]
    tests/browser/pages_browser.py PROGRAM --pictures FOLDER [--only REGEX]    keeps each page as HTML, PNG and PDF there

A new page is a row of PAGES; the scans and files that it needs are rows of SCANS and FILES.
Needs Debian's chromium, chromium-driver, python3-selenium and poppler-utils; without them the exit code is 77."""

import argparse
import base64
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections import namedtuple

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    print("skipped: python3-selenium is not on this machine")
    sys.exit(77)

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCREEN_PX = 1280
PHONE_PX = 400
PHONE_LETTERS_PX = 7.4  # of a plot on a phone
PAPER_INCHES = (8.27, 11.69)  # A4
PRINT_PX = 688  # what A4 leaves between margins of 14 mm, at 96 px an inch
LEAST_FILLED = 0.55  # of a printed page that others follow
PICTURE_DPI = 25  # of a printed page that is searched for ink
SLACK_PX = 1.5
CODES = (0, 1, 2, 3)  # a page is written whatever the verdict

Page = namedtuple("Page", "name command file needs", defaults=(None, ()))

SCANNER = {"dpi": 2400, "background": 30, "contrast": 175, "blur_px": 1.3, "noise": 1.2}
FOIL = {"overall_radius_mm": 20.95, "radius_mm": [3.34, 3.41, 3.36, 3.44, 3.38, 3.35, 3.42, 3.37, 3.40]}
PINS = [[1.2, 1.6, 1], [5.0, 2.2, 1.5], [10.1, 2.9, 2], [16.2, 3.2, 2.5], [23.1, 3.6, 3], [29.8, 2.9, 2.25], [2.1, 9.4, 1.25],
        [7.2, 10.1, 2.75], [13.9, 11.3, 3], [20.8, 12.0, 2.5], [26.9, 12.9, 1.75], [6.2, 16.9, 1.5]]
LIMITS = {"radius_error_pct": {"min": -1, "max": 4}, "height_mm": {"min": 0.5, "max": 0.6},
          "overall.radius_mm": {"max": 21.05}}


def scan(seed, rotate, effects=(), dpi=2400, foil=FOIL, **more):
    spec = {"seed": seed, "foils": [dict(foil, rotate_deg=rotate)], "scanner": dict(SCANNER, dpi=dpi), "effects": list(effects)}
    return dict(spec, **more)


def plate(seed, lobe_um=(0,), effects=()):
    discs = [{"centre_mm": pin[:2], "radius_mm": pin[2], "lobes": 2, "lobe_um": lobe_um[i % len(lobe_um)],
              "lobe_phase_deg": 25 * i} for i, pin in enumerate(PINS)]
    return {"seed": seed, "discs": discs, "scanner": SCANNER, "effects": list(effects)}


RIPPLE = {"id": "scan.carriage_ripple", "amplitude_um": 7, "period_mm": 2.7, "phase_deg": 30}
CURVE = {"id": "free.scan.y", "moves": "x", "knots": [[2, 0], [8, 9], [15, -8], [22, 10], [30, -9], [38, 0]]}
BAD = dict(FOIL, radius_mm=[3.34, 3.35, 3.49, 3.34, 3.36, 3.35, 3.42, 3.37, 3.40])
PLACED = dict(FOIL, centre_mm=[20, 22])

# A wave that no effect has, measured twice at every place: text, as it goes into the file.
WAVE = "run,x,y\n" + "".join(f"{i},{i // 2 / 16:.4f},{math.sin(7 * (i // 2 / 16) ** 2) + 0.05 * ((i * 7919) % 13 - 6) / 6:.5f}\n"
                             for i in range(64))

# A lot: two dies in turn, a foil of a wide bump, one that lacks a bump, one with a crushed bump.
LOT_ODD = {4: {"radius_mm": [3.34, 3.41, 3.52, 3.44, 3.38, 3.35, 3.42, 3.37, 3.40]}, 9: {"missing": [3]},
           14: {"crushed": [{"bump": 6, "height_factor": 0.5}]}}
LOT = {f"lot_{i}.png": scan(20 + i, -90, dpi=1200, foil=dict(
    {"overall_radius_mm": 20.9, "radius_springback": {"mean": 0.03 if i % 2 else 0.015, "sd": 0.004}}, **LOT_ODD.get(i, {})))
    for i in range(18)}

# Runs of a second-degree surface, and of oven loads.
SURFACE = "run,temperature_C,duration_h,springback_error_pct\n" + "".join(
    f"{n},{500 + 50 * i},{3 + k},{4 + (i - 1.2) ** 2 + 0.8 * (k - 1.1) ** 2 + 0.03 * ((n * 7) % 5):.3f}\n"
    for n, (i, k) in enumerate(((i, k) for i in range(3) for k in range(3)), 1))
SPLIT = "load,temperature_C,duration_h,springback_error_pct\n" + "".join(
    f"{load},{500 + 100 * (load % 2)},{3 + 2 * (n % 2)},{9 - 3 * (load % 2) - 0.5 * (n % 2) + 0.2 * (load % 3) + 0.05 * n:.2f}\n"
    for load in range(1, 7) for n in range(4))

# Specs that `render` draws: the scan's name is that of its file.
SCANS = {
    **LOT,
    "good.png": scan(1, -70), "bad.png": scan(2, -80, foil=BAD), "next.png": scan(5, -100),
    "crushed.png": scan(3, -85, foil=dict(FOIL, crushed=[{"bump": 4, "height_factor": 0.5}])),
    "missing.png": scan(4, -85, foil=dict(FOIL, missing=[3])),
    "sinusoidal.png": {"seed": 6, "foils": [{"design": {"form": "sinusoidal"}, "rotate_deg": -90}], "scanner": SCANNER},
    "strip.png": {"seed": 7, "foils": [{"design": {"form": "arc", "overall_radius_mm": 20.48, "subtended_angle_deg": 110},
                                        "rotate_deg": -90}], "scanner": SCANNER},
    "discs.png": plate(8, (1, 3, 12)), "gauges.png": plate(9, effects=[RIPPLE, {"id": "scan.scale_y", "value": 0.001}]),
    "clean.png": scan(1, -70), "ripple.png": scan(2, -60, [RIPPLE]), "faint.png":
        scan(6, -75, [{"id": "scan.scale_y", "value": 0.0001}], dpi=4800),
    "a.png": scan(3, -75, [{"id": "scan.scale_y", "value": 0.001}]), "b.png": scan(4, 15, [{"id": "scan.scale_y", "value": 0.001}]),
    "curve.png": scan(11, -75, [CURVE], foil=PLACED, width_px=4200, height_px=4200),
    "residue.png": scan(12, -75, [CURVE, RIPPLE], foil=PLACED, width_px=4200, height_px=4200),
    "board.png": {"seed": 5, "scanner": {"dpi": 1200}, "grids": [{"marks": "dots", "centre_mm": [15, 15], "pitch_mm": 2.5, "columns": 10,
                                                                  "rows": 10, "mark_mm": 1}], "effects": [{"id": "scan.shear", "value": 0.001}]},
    "decay.png": scan(9, -70, foil=dict(FOIL, radius_mm=[3.60, 3.50, 3.45, 3.43, 3.42, 3.415, 3.41, 3.41, 3.41])),
}

# Other files: JSON of a value that is no text, text of more than one line as it is, else a file of the repository.
FILES = {
    "limits.json": {"schema": "foilgauge/design/1", "name": "gen2", "bump_count": 9, "tolerances": LIMITS},
    "board.json": {"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "pitch_mm": 2.5, "u_pitch_mm": 0.0025},
    "sinusoidal.json": {"schema": "foilgauge/design/1", "name": "sinus", "form": "sinusoidal"},
    "strip.json": "samples/top_foil_design.json",
    "plate.json": {"schema": "foilgauge/design/1", "name": "pins", "form": "discs",
                   "tolerances": {"roundness_um": {"max": 8}}},
    "sample.png": "samples/gen2_foil.png",
    "factorial.csv": "samples/doe/springback_factorial.csv", "composite.csv": "samples/doe/springback_composite.csv",
    "concave_1.txt": "samples/die/concave_1.txt", "concave_2.txt": "samples/die/concave_2.txt",
    "convex_1.txt": "samples/die/convex_1.txt", "convex_2.txt": "samples/die/convex_2.txt",
    "die.json": {"schema": "foilgauge/design/1", "name": "gen2", "tolerances": {"radius_mm": {"min": 3.31, "max": 3.325},
                                                                              "height_mm": {"min": 0.5, "max": 0.6}}},
    "load_cell.csv": "tests/data/measured/load_cell.csv", "impact.csv": "tests/data/measured/impact_energy.csv",
    "line_width.csv": "tests/data/measured/line_width.csv", "pipeline.csv": "tests/data/measured/pipeline_defects.csv",
    "check.csv": "tests/data/measured/check_standard.csv",
    "bearings.csv": "samples/stiffness/bearings.csv",
    "wave.csv": WAVE,
    "lot_list.csv": "scan,foil,die,bearing,pad\n" + "".join(
        f"lot_{i}.png,F{i:03d},{'AB'[i % 2]},J{i // 3 + 1},{i % 3 + 1}\n" for i in range(18)) + "text.png,F099,A,,\n",
    "text.png": "no scan\nbut a text\n",
    "recipe.json": {"schema": "foilgauge/recipe/1", "name": "Lot 2026-17, two dies", "resamples": 2000,
                    "group_column": "die", "assembly": {"bearings": 200, "seed": 1},
                    "design": {"schema": "foilgauge/design/1", "name": "Gen II", "tolerances": dict(
                        LIMITS, radius_mm={"min": 3.3, "max": 3.45}, circularity_mm={"max": 0.1})}},
    "plain.json": {"schema": "foilgauge/recipe/1", "name": "Lot without tolerances", "resamples": 2000},
    "surface.csv": SURFACE, "split.csv": SPLIT,
}

# The page is NAME.html, unless its file says else; a word that is a row of SCANS or FILES is made first.
PAGES = [
    Page("measure_good", "measure good.png"),
    Page("measure_sample", "measure sample.png --design limits.json"),
    Page("measure_bad_bump", "measure bad.png --design limits.json"),
    Page("measure_crushed", "measure crushed.png --design limits.json"),
    Page("measure_missing", "measure missing.png --design limits.json"),
    Page("measure_several", "measure good.png bad.png missing.png next.png --design limits.json"),
    Page("measure_sinusoidal", "measure sinusoidal.png --design sinusoidal.json"),
    Page("measure_strip", "measure strip.png --design strip.json"),
    Page("measure_discs", "measure discs.png --design plate.json"),
    Page("measure_grid", "measure board.png --design board.json"),
    Page("loop_grid", "loop board.png --design board.json"),
    Page("loop_clean", "loop clean.png"),
    Page("loop_explained", "loop ripple.png"),
    Page("loop_pair", "loop --same-foil a.png b.png"),
    Page("loop_tied", "loop faint.png"),
    Page("loop_unexplained", "loop curve.png"),
    Page("loop_residue", "loop residue.png"),
    Page("loop_bumps", "loop decay.png"),
    Page("loop_discs", "loop gauges.png --form discs"),
    Page("table_clean", "loop --table check.csv --response resistivity --model 1"),
    Page("table_explained", "loop --table impact.csv --response energy_J --model 1"),
    Page("table_tied", "loop --table load_cell.csv --response reading --model '1 + load' --order order"),
    Page("table_many", "loop --table line_width.csv --response width_um --model 1 --order sequence"),
    Page("table_spread", "loop --table pipeline.csv --response field_depth --model '1 + lab_depth'"),
    Page("table_unexplained", "loop --table wave.csv --response y --model '1 + x'"),
    Page("die", "die concave_1.txt concave_2.txt convex_1.txt convex_2.txt"),
    Page("die_limits", "die concave_1.txt concave_2.txt convex_1.txt convex_2.txt --design die.json"),
    Page("design", "design limits.json"),
    Page("form", "forming --temperature 650 --time 5"),
    Page("form_fit", "form --fit composite.csv"),
    Page("stiffness", "stiffness bearings.csv --limit clearance_mm=0.1:0.3"),
    Page("lot", "lot lot_list.csv --recipe recipe.json -o lot", "lot/index.html", tuple(LOT) + ("text.png",)),
    Page("lot_plain", "lot lot_0.png lot_1.png lot_2.png lot_3.png --recipe plain.json -o plain", "plain/index.html"),
    Page("lot_index", "lot --index lots.html lot plain", "lots.html"),
    Page("doe_screening", "doe factorial.csv --response springback_error_pct --model pressure_bar*temperature_C*duration_h"),
    Page("doe_composite", "doe composite.csv --response springback_error_pct "
         "--model 'temperature_C*duration_h + temperature_C^2 + duration_h^2'"),
    Page("doe_surface", "doe surface.csv --response springback_error_pct "
         "--model 'temperature_C*duration_h + temperature_C^2 + duration_h^2' --round temperature_C=5 --round duration_h=0.25"),
    Page("doe_split", "doe split.csv --response springback_error_pct --model temperature_C*duration_h --whole-plot load"),
    Page("doe_sheet", "doe plan --factor temperature_C=500:600 --factor duration_h=3:5 --factor pressure_bar=2:6 "
         "--kind composite --centre 3 --round temperature_C=5 --round duration_h=0.25 --round pressure_bar=0.1"),
]


def expect(true, words):
    if not true:
        raise AssertionError(words)


class Work:
    """A folder in which commands run; files that they need are made when they are needed."""

    def __init__(self, folder, program, renderer):
        self.folder, self.program, self.renderer = folder, program, renderer

    def path(self, name):
        return os.path.join(self.folder, name)

    def make(self, name):
        path = self.path(name)
        if os.path.exists(path):
            return
        if name in SCANS:
            with open(path + ".json", "w", encoding="utf-8") as file:
                json.dump(dict(SCANS[name], schema="foilgauge/render/1"), file)
            subprocess.run([self.renderer, "render", path + ".json", "-o", path], check=True)
        elif isinstance(FILES[name], str) and "\n" not in FILES[name]:
            shutil.copy(os.path.join(ROOT, FILES[name]), path)
        else:
            with open(path, "w", encoding="utf-8") as file:
                file.write(FILES[name] if isinstance(FILES[name], str) else json.dumps(FILES[name]))

    def write(self, page):
        """The page's file, written by the program."""
        words = shlex.split(page.command)
        for word in [*words, *page.needs]:
            if word in SCANS or word in FILES:
                self.make(word)
        file = self.path(page.file or page.name + ".html")
        html = [] if page.file else ["--html", file]
        run = subprocess.run([self.program, *words, *html], cwd=self.folder, capture_output=True, text=True, check=False)
        expect(run.returncode in CODES and os.path.exists(file), f"exit code {run.returncode}: {run.stderr}")
        return file


# Clipped elements, in words for the person who must mend the page.
CLIPPED = """
const slack = %s, width = document.documentElement.clientWidth, found = [];
const name = e => e.tagName.toLowerCase() + (e.className.baseVal ?? e.className ? '.' + (e.className.baseVal ?? e.className) : '');
const shown = e => { const box = e.getBoundingClientRect(); return box.width > 0 && box.height > 0; };
if (document.documentElement.scrollWidth > width + slack)
  found.push('the page is ' + document.documentElement.scrollWidth + ' px wide in ' + width);
for (const e of document.querySelectorAll('*')) {
  const style = getComputedStyle(e);
  if (style.overflowX !== 'visible' && e.scrollWidth > e.clientWidth + slack && e.clientWidth && style.textOverflow !== 'ellipsis')
    found.push(name(e) + ' shows ' + e.clientWidth + ' of ' + e.scrollWidth + ' px: ' + e.textContent.trim().slice(0, 40));
}
for (const e of document.querySelectorAll('dd, dt, td, th, h1, h2, h3, p, figcaption, .verdict'))
  if (shown(e) && getComputedStyle(e).display !== 'inline' && e.scrollWidth > e.clientWidth + slack)
    found.push(name(e) + ' holds ' + e.scrollWidth + ' px in ' + e.clientWidth + ': ' + e.textContent.trim().slice(0, 40));
for (const e of document.querySelectorAll('table, p, figure, dl, pre, ul, h1, h2')) {
  const box = e.getBoundingClientRect();
  if (shown(e) && (box.right > width + slack || box.left < -slack))
    found.push(name(e) + ' reaches from ' + box.left + ' to ' + box.right + ' px: ' + e.textContent.trim().slice(0, 40));
}
const inked = e => { const box = e.getBoundingClientRect(), air = box.height / 6;
  return {left: box.left, right: box.right, top: box.top + air, bottom: box.bottom - air}; };
for (const svg of document.querySelectorAll('svg')) {
  const words = [...svg.querySelectorAll('text')].filter(e => shown(e) && e.textContent.trim()).map(e => [e.textContent, inked(e)]);
  for (let i = 0; i < words.length; i++) for (let k = i + 1; k < words.length; k++) {
    const [a, b] = [words[i][1], words[k][1]];
    if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1)
      found.push('the words "' + words[i][0] + '" and "' + words[k][0] + '" of a plot lie over each other');
  }
  const outer = svg.getBoundingClientRect();
  if (shown(svg)) for (const text of svg.querySelectorAll('text')) {
    const box = text.getBoundingClientRect();
    const outside = box.left > outer.right || box.right < outer.left || box.top > outer.bottom || box.bottom < outer.top;
    if (shown(text) && !outside && (box.right > outer.right + slack || box.left < outer.left - slack ||
        box.top < outer.top - slack || box.bottom > outer.bottom + slack))
      found.push('the words "' + text.textContent + '" of a plot reach beyond it');
  }
}
return found;
""" % SLACK_PX

# Hidden on a phone: columns and tiles out of sight, letters that are too small.
HIDDEN = """
const width = document.documentElement.clientWidth, found = [];
if (document.documentElement.scrollWidth > width + %s)
  found.push('the page is ' + document.documentElement.scrollWidth + ' px wide in ' + width);
for (const table of document.querySelectorAll('table')) for (const row of table.rows) {
  const cell = row.cells[1], box = cell && cell.colSpan === 1 && cell.textContent.trim() ? cell.getBoundingClientRect() : null;
  if (!box || !box.width || box.right <= width) continue;
  found.push('the second column of a table is out of sight: ' + row.textContent.trim().slice(0, 60));
  break;
}
for (const e of document.querySelectorAll('.tiles > div')) if (e.getBoundingClientRect().right > width)
  found.push('a tile is out of sight: ' + e.textContent.trim().slice(0, 40));
for (const svg of document.querySelectorAll('svg.plot')) {
  const sizes = [...svg.querySelectorAll('text')].filter(e => e.getBoundingClientRect().width && e.textContent.trim())
    .filter(e => !e.closest('[style*=font-size]'))  // ticks that their many digits make smaller
    .map(e => parseFloat(getComputedStyle(e).fontSize) * Math.hypot(e.getScreenCTM().a, e.getScreenCTM().b));
  if (sizes.length && Math.min(...sizes) < %s)
    found.push('letters of ' + Math.min(...sizes).toFixed(1) + ' px: ' + svg.getAttribute('aria-label'));
}
return found;
""" % (SLACK_PX, PHONE_LETTERS_PX)

HEADINGS = "return [...document.querySelectorAll('h1, h2, h3, summary')].map(e => e.innerText)"


def squeezed(text):
    return re.sub(r"\W+", "", text).lower()


class Reader:
    """A browser that looks at pages."""

    def __init__(self):
        options = webdriver.ChromeOptions()
        for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                         f"--window-size={SCREEN_PX},1000"):
            options.add_argument(argument)
        self.browser = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)

    def set_width(self, width, media=""):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False})
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media})

    def clipped(self, where):
        return [f"{where}: {words}" for words in self.browser.execute_script(CLIPPED)]

    def open(self, file):
        self.set_width(SCREEN_PX)
        self.browser.get("file://" + file)

    def look(self, file):
        """Defects of a page, on the screen, on a phone and printed."""
        self.open(file)
        wrong = self.clipped(f"at {SCREEN_PX} px")
        headings = {squeezed(text) for text in self.browser.execute_script(HEADINGS)} - {""}
        self.set_width(PRINT_PX, "print")
        wrong += self.clipped("printed on A4")
        self.set_width(PHONE_PX)
        wrong += [f"at {PHONE_PX} px: {words}" for words in self.browser.execute_script(HIDDEN)]
        self.set_width(SCREEN_PX)
        with tempfile.NamedTemporaryFile(suffix=".pdf") as pdf:
            self.print(pdf.name)
            return wrong + printed_wrong(pdf.name, headings)

    def print(self, path):
        printed = self.browser.execute_cdp_cmd("Page.printToPDF", {
            "paperWidth": PAPER_INCHES[0], "paperHeight": PAPER_INCHES[1], "printBackground": True, "preferCSSPageSize": True})
        with open(path, "wb") as file:
            file.write(base64.b64decode(printed["data"]))

    def picture(self, path):
        """The whole page as it is on the screen."""
        height = self.browser.execute_script("return document.documentElement.scrollHeight")
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": SCREEN_PX, "height": height, "deviceScaleFactor": 1, "mobile": False})
        self.browser.save_screenshot(path)
        self.set_width(SCREEN_PX)

    def quit(self):
        self.browser.quit()


def filled(pdf, page):
    """Lowest ink of a printed page, as a share of the height between its margins."""
    picture = subprocess.run(["pdftoppm", "-gray", "-r", str(PICTURE_DPI), "-f", str(page), "-l", str(page), pdf],
                             capture_output=True, check=True).stdout
    width, height = (int(word) for word in picture.split(maxsplit=4)[1:3])
    pixels = picture[-width * height:]
    inked = [row for row in range(height) if min(pixels[row * width:(row + 1) * width]) < 230]
    margin = 14 / 25.4 * PICTURE_DPI
    return (inked[-1] + 1 - margin) / (height - 2 * margin) if inked else 0


def printed_wrong(pdf, headings):
    pages = subprocess.run(["pdftotext", "-layout", pdf, "-"], capture_output=True, text=True, check=True).stdout.split("\f")[:-1]
    wrong = []
    for number, text in enumerate(pages, 1):
        lines = [line for line in (squeezed(line) for line in text.splitlines()) if line]
        if not lines:
            wrong.append(f"printed page {number} of {len(pages)} is empty")
        elif lines[-1] in headings:
            wrong.append(f"printed page {number} of {len(pages)} ends with a heading: {text.strip().splitlines()[-1].strip()}")
        if number < len(pages) and filled(pdf, number) < LEAST_FILLED:
            wrong.append(f"printed page {number} of {len(pages)} is filled to {filled(pdf, number):.0%}, and others follow")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--renderer", help="the program that draws scans; default PROGRAM")
    parser.add_argument("--only", metavar="REGEX", default="", help="the pages whose name it is found in")
    parser.add_argument("--pictures", metavar="FOLDER", help="keep the pages there")
    arguments = parser.parse_args()
    for tool in ("chromium", "chromedriver", "pdftotext", "pdftoppm"):
        if not shutil.which(tool):
            print(f"skipped: {tool} is not on this machine")
            sys.exit(77)
    program = os.path.abspath(arguments.program)
    wrong, reader = 0, Reader()
    try:
        with tempfile.TemporaryDirectory() as folder:
            work = Work(folder, program, os.path.abspath(arguments.renderer or program))
            for page in PAGES:
                if not re.search(arguments.only, page.name):
                    continue
                file = work.write(page)
                found = reader.look(file)
                wrong += len(found)
                print(f"{page.name}: {'as it should be' if not found else ''}", *found, sep="\n  " if found else "", flush=True)
                if arguments.pictures:
                    kept = os.path.join(arguments.pictures, page.name)
                    shutil.copy(file, kept + ".html")
                    reader.picture(kept + ".png")
                    reader.print(kept + ".pdf")
    finally:
        reader.quit()
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
