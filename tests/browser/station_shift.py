#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A shift at the inspection station in a real browser: an order by its barcode; twenty foils come (3 fail, 1 is crushed, of 1 nobody
can tell, 1 file is a photo, 1 scan came before); what did not pass gets its disposition; a second browser mends a wrong serial
number; the lot and the order are closed; the lot's files are those that `foilgauge lot` makes of the same scans.

    tests/browser/station_shift.py PROGRAM [--renderer PROGRAM]

Needs what station_browser.py needs."""

import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile

from station_browser import ActionChains, By, Day, Keys, Station, expect, open_browser, wait

GOOD_MM, BAD_MM, EDGE_MM = 3.32, 3.4, 3.3402
LIMITS = {"radius_mm": {"min": 3.3, "max": 3.34}}
ORDER, LOT = "4711", "L7"
FATES = {"F14": "scrap", "F15": "rework", "F16": "concession", "F17": "scrap", "F18": "scrap"}


class Shift(Day):
    """The operator's browser."""

    def scan(self, name, radius_mm=GOOD_MM, crushed=None):
        self.seed += 1
        foil = {"rotate_deg": -90, "design": {"bump_count": 3, "bump_radius_mm": radius_mm}}
        if crushed:
            foil["crushed"] = [{"bump": crushed, "height_factor": 0.4}]
        spec = os.path.join(self.work, "spec.json")
        with open(spec, "w", encoding="utf-8") as file:
            json.dump({"schema": "foilgauge/render/1", "seed": self.seed, "scanner": {"dpi": 1200}, "foils": [foil]}, file)
        drawn = os.path.join(self.work, "drawn.png")
        subprocess.run([self.renderer, "render", spec, "-o", drawn], check=True)
        self.put(drawn, name)

    def put(self, path, name):
        shutil.copy(path, os.path.join(self.folder, "." + name))
        os.rename(os.path.join(self.folder, "." + name), os.path.join(self.folder, name))

    def open_order(self):
        """A barcode reader types the number where the focus is, and Enter."""
        self.go("/orders")
        expect(self.browser.switch_to.active_element.get_attribute("name") == "number", "the order has no focus")
        ActionChains(self.browser).send_keys(ORDER, Keys.ENTER).perform()
        wait(lambda: f"Order {ORDER}" in self.text(".order"))
        expect("0 of 20, 0 failed" in self.text(".order"), self.text(".order"))

    def foils(self):
        """Scans one foil after the other; what the page says of each."""
        for i in range(1, 14):
            self.scan(f"F{i:02d}.png")
            self.card(f"F{i:02d}.png", "PASS")
        for i in range(14, 17):
            self.scan(f"F{i}.png", BAD_MM)
            self.card(f"F{i}.png", "FAIL", "Put the foil aside")
        self.scan("F17.png", crushed=2)
        self.card("F17.png", "FAIL", "Bump 2 is crushed")
        self.scan("F18.png", EDGE_MM)
        self.card("F18.png", "SCAN AGAIN", "A limit lies within the uncertainty")
        with open(os.path.join(self.work, "photo.jpg"), "wb") as file:
            file.write(PHOTO)
        self.put(os.path.join(self.work, "photo.jpg"), "holiday.jpg")
        self.card("holiday.jpg", "SCAN AGAIN")
        self.put(os.path.join(self.folder, "F01.png"), "F20.png")
        self.card("F20.png", "SAME SCAN", "F01")
        expect("18 of 20, 4 failed" in self.text(".order"), "the order's progress: " + self.text(".order"))
        expect("5 without disposition" in self.text(), "open dispositions: " + self.text())

    def dispose(self, serial, kind, by="Ada"):
        self.go("/history?verdict=open")
        self.follow(serial)
        self.one("#fate input[name=reason]").send_keys("S1 scratch")
        self.one("#fate input[name=by]").send_keys(by)
        self.press(lambda: self.browser.find_elements(By.CSS_SELECTOR, f"#fate button[value={kind}]"))
        wait(lambda: "Disposition:" in self.text() and "S1 scratch" in self.text() and by in self.text())

    def dispositions(self):
        for serial, kind in FATES.items():
            self.dispose(serial, kind)
        self.go("/")
        expect("without disposition" not in self.text(), "a disposition is open: " + self.text())

    def mend_serial(self):
        """In the second browser: the foil's page, its new serial, who says so."""
        self.go("/history?serial=F13")
        self.follow("F13")
        self.fill("serial", "F13-B")
        self.fill("by", "Bea")
        self.keep()
        wait(lambda: "F13-B" in self.text(".call") and "Bea" in self.text(".left table"))

    def close(self):
        self.go(f"/lots?close=1&lot={LOT}")
        self.one("input[name=by]").send_keys("Ada", Keys.ENTER)
        wait(lambda: "by Ada" in self.text() and "18 foils of 18 scans" in self.text())
        self.go("/orders")
        self.one("form[action='/order-close'] input[name=by]").send_keys("Ada", Keys.ENTER)
        wait(lambda: "closed" in self.text() and "18 of 20" in self.text())


# A gray JPEG of 8 x 8 pixels.
PHOTO = bytes.fromhex(
    "ffd8ffe000104a46494600010101004800480000ffdb004300ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff"
    "ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffc0000b080008000801011100ffc4001f0000010501010101"
    "010100000000000000000102030405060708090a0bffc400b5100002010303020403050504040000017d01020300041105122131410613516107"
    "227114328191a1082342b1c11552d1f02433627282090a161718191a25262728292a3435363738393a434445464748494a535455565758595a63"
    "6465666768696a737475767778797a838485868788898a92939495969798999aa2a3a4a5a6a7a8a9aab2b3b4b5b6b7b8b9bac2c3c4c5c6c7c8c9"
    "cad2d3d4d5d6d7d8d9dae1e2e3e4e5e6e7e8e9eaf1f2f3f4f5f6f7f8f9faffda0008010100003f00fbffd9")


def read_rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def compare_files(program, folder, recipe, work):
    """`lot` measures the scans of the station's manifest again, in another folder: same verdicts, same numbers."""
    closed, again = os.path.join(folder, "lots", LOT), os.path.join(work, "again")
    done = subprocess.run([program, "lot", os.path.join(closed, "manifest.csv"), "--recipe", recipe, "-o", again],
                          capture_output=True, text=True)
    expect(done.returncode in (0, 1, 3), "lot: " + done.stderr)
    with open(os.path.join(closed, "lot.json"), encoding="utf-8") as file:
        station = json.load(file)
    with open(os.path.join(again, "lot.json"), encoding="utf-8") as file:
        lot = json.load(file)
    expect(len(station["foils"]) == 18, f"foils of the lot: {len(station['foils'])}")
    expect(station["verdict"] == lot["verdict"] == "fail", f"verdicts: {station['verdict']}, {lot['verdict']}")
    for name in ("foils.csv", "bumps.csv"):
        ours, theirs = (read_rows(os.path.join(each, name)) for each in (closed, again))
        expect(len(ours) == len(theirs) and ours, f"{name}: {len(ours)} and {len(theirs)} rows")
        for one, other in zip(ours, theirs):
            differ = [key for key in one if key in other and key not in ("page", "scan", "path") and one[key] != other[key]]
            expect(not differ, f"{name}: {[(key, one[key], other[key]) for key in differ]}")
    for member in ("counts", "quantities", "process", "thickness", "stiffness"):
        expect(station[member] == lot[member], f"lot.json: {member} differs")
    named = {row["foil"]: row for row in read_rows(os.path.join(closed, "foils.csv"))}
    expect("F13-B" in named and "F13" not in named, f"the mended serial is not in the lot: {sorted(named)}")
    fates = {serial: row["disposition"] for serial, row in named.items() if row["disposition"]}
    expect(fates == FATES, f"dispositions in the lot: {fates}")


def run(program, renderer, work):
    folder, downloads = os.path.join(work, "scans"), os.path.join(work, "downloads")
    os.mkdir(folder)
    os.mkdir(downloads)
    recipe, orders = os.path.join(work, "recipe.json"), os.path.join(work, "orders.csv")
    with open(recipe, "w", encoding="utf-8") as file:
        json.dump({"schema": "foilgauge/recipe/1", "station": {"file_name": "{serial}", "receive_s": 1, "reasons": "S1 scratch, B2 burr"},
                   "design": {"schema": "foilgauge/design/1", "bump_count": 3, "tolerances": LIMITS,
                              "calibration": "not needed: the scans are rendered"}}, file)
    with open(orders, "w", encoding="utf-8") as file:
        file.write(f"order,part,lot,die,coil,pieces\n{ORDER},foil,{LOT},B,K7,20\n")
    with open(os.path.join(work, "errors"), "w", encoding="utf-8") as errors:
        station, browsers = Station(program, folder, recipe, errors, "--orders", orders), []
        try:
            browsers = [open_browser(downloads), open_browser(downloads)]
            operator, second = (Shift(browser, station, folder, work, renderer) for browser in browsers)
            operator.open_order()
            operator.foils()
            operator.dispositions()
            second.mend_serial()
            operator.close()
            operator.quiet()
        finally:
            for browser in browsers:
                browser.quit()
            station.end()
    compare_files(program, folder, recipe, work)
    print("browser: a shift of twenty foils: order by barcode, verdicts, dispositions, a mended serial, lot and order closed, "
          "files as `lot` makes them")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--renderer", help="the program that draws scans; default PROGRAM")
    arguments = parser.parse_args()
    if not shutil.which("chromium") or not shutil.which("chromedriver"):
        print("skipped: chromium and chromium-driver are not on this machine")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as work:
        run(arguments.program, arguments.renderer or arguments.program, work)


if __name__ == "__main__":
    main()
