#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A station's database with many scans, in seconds: one scan is measured by the program, which makes
the database, and its rows are multiplied with values that vary as those of a press do (from foil to
foil, from bump to bump, from lot to lot, two dies, a shift, a slow wear), judged by the recipe's
tolerances. Seeded.

    tests/bench/station_fill.py FOLDER [--scans 5000] [--checks 120] [--recipe FILE]

The multiplied scans have no files; their records are copies, with checksums that are not theirs."""

import argparse
import hashlib
import json
import os
import random
import shutil
import sqlite3
import subprocess
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FOILGAUGE = os.path.join(ROOT, "build", "foilgauge")
MINUTE_MS = 60_000
FOILS_OF_LOT = 60
CHUNK = 5000  # scans that are held in memory
DRAWN = 200  # scans with values of their own; those beyond are copies of them, which SQLite makes
# Spread of foils, and of bumps within a foil, as a share of the value (or absolute where it is about 0).
SPREAD = {
    "radius_mm": (0.004, 0.006), "height_mm": (0.004, 0.006), "height_fitted_mm": (0.004, 0.006),
    "clearance_mm": (0.02, 0.03), "clearance_fitted_mm": (0.02, 0.03), "bump_angle_deg": (0.004, 0.006),
    "overall.radius_mm": (0.002, 0), "thickness_mm": (0.004, 0),
}
OTHERS = (0.01, 0.01)


def columns(database, table):
    return [row[1] for row in database.execute(f"PRAGMA table_info({table})")]


def insert(database, table, rows):
    if rows:
        database.executemany(f"INSERT INTO {table} VALUES ({','.join('?' * len(rows[0]))})", rows)


def shift(index, total):
    """Slow changes of the process: wear, and a step that nobody announced."""
    return 0.004 * index / total + (0.004 if 0.62 < index / total < 0.65 else 0)


def judge(value, u, limit):
    low, high, reach = limit.get("min", float("-inf")), limit.get("max", float("inf")), 2 * (u or 0)
    if value - reach > high or value + reach < low:
        return "fail"
    return "pass" if low <= value - reach and value + reach <= high else "cannot_tell"


def worst(verdicts):
    for word in ("fail", "not_measured", "cannot_tell", "pass"):
        if word in verdicts:
            return word
    return "no_tolerance"


def foil_values(rng, template, quantities, index, total, die):
    """(quantity, bump, value, u) of one foil; a level of the foil moves all of its bumps together."""
    level = rng.gauss(0, 1)
    bump_level = {}
    rows = []
    for quantity, bump, value, u in template:
        of_foil, of_bump = SPREAD.get(quantities[quantity][1], OTHERS)
        if value is not None:
            moved = of_foil * level + shift(index, total) + (0.002 if die == "B" else 0)
            moved += of_bump * bump_level.setdefault(bump, rng.gauss(0, 1)) if bump else 0
            value += value * moved
        rows.append((quantity, bump, value, u))
    return rows


def deciding(rows, quantities, limits):
    """The three values that are nearest to their limits, or farthest beyond."""
    judged = []
    for quantity, bump, value, u in rows:
        limit = limits.get(quantities[quantity][1])
        if limit is None or value is None:
            continue
        low, high = limit.get("min"), limit.get("max")
        beyond = max(value - high if high is not None else -1, low - value if low is not None else -1)
        judged.append((judge(value, u, limit), beyond, quantity, bump, value, u, low, high))
    order = {"fail": 0, "cannot_tell": 1, "pass": 2}
    judged.sort(key=lambda j: (order[j[0]], -j[1]))
    return judged


def empty(database, out):
    """Writes the rows of all tables."""
    out["measured"].sort(key=lambda row: row[:3])
    for table, rows in out.items():
        insert(database, table, rows)
        rows.clear()


def copy_scans(database, count, drawn, first_scan, first_foil):
    """Copies the drawn scans, in their order, until there are `count`: later ones, with serial numbers of their own."""
    marks = {"scan": first_scan, "foil": first_foil}
    for done in range(drawn, count, drawn):
        marks.update(shift=done, last=min(drawn, count - done), ms=done * MINUTE_MS)
        for table, owner, values in (
                ("scans", "scan", {"id": "id + :shift", "sha256": "lower(hex(randomblob(32)))", "at": "at + :ms",
                                   "path": "printf('L000_C_%06d.png', id + :shift)"}),
                ("foils", "foil", {"id": "id + :shift", "scan": "scan + :shift", "serial": "printf('%06d', serial + :shift)",
                                   "lot": "printf('L%04d', substr(lot, 2) + :shift / 60)"}),
                ("bumps", "foil", {"foil": "foil + :shift"}), ("measured", "foil", {"foil": "foil + :shift"}),
                ("deciding", "foil", {"foil": "foil + :shift"})):
            names = columns(database, table)
            key = "id" if "id" in values else "foil"
            database.execute(f"INSERT INTO {table} SELECT {', '.join(values.get(n, n) for n in names)} FROM {table} "
                             f"WHERE {key} BETWEEN :{owner} AND :{owner} + :last - 1", marks)


def fill(path, scans, checks, limits, seed):
    rng = random.Random(seed)
    database = sqlite3.connect(path)
    for pragma in "synchronous = OFF", "journal_mode = OFF", "cache_size = -1000000":
        database.execute("PRAGMA " + pragma)
    scan = database.execute("SELECT * FROM scans ORDER BY id LIMIT 1").fetchone()
    at = {name: i for i, name in enumerate(columns(database, "scans"))}
    quantities = {row[0]: (row[1], row[2]) for row in database.execute("SELECT id, owner, name FROM quantities")}
    template = database.execute("SELECT quantity, bump, value, u FROM measured WHERE foil = 1").fetchall()
    bumps = [row[0] for row in database.execute("SELECT number FROM bumps WHERE foil = 1")]
    first_id = database.execute("SELECT max(id) FROM scans").fetchone()[0] + 1
    first_foil = database.execute("SELECT max(id) FROM foils").fetchone()[0] + 1
    first_card = database.execute("SELECT max(id) FROM arrivals").fetchone()[0] + 1
    begin = int(time.time() * 1000) - scans * MINUTE_MS
    out = {table: [] for table in ("scans", "foils", "bumps", "measured", "deciding", "arrivals", "files")}
    total, scans = scans, min(scans, DRAWN)
    for i in range(scans):
        die, lot, serial = "AB"[i % 2], f"L{i // FOILS_OF_LOT + 1:03d}", f"{i + 1:06d}"
        name = f"{lot}_{die}_{serial}.png"
        values = foil_values(rng, template, quantities, i, scans, die)
        judged = deciding(values, quantities, limits)
        verdict = worst([j[0] for j in judged])
        row = list(scan)
        row[at["id"]] = first_id + i
        row[at["sha256"]] = hashlib.sha256(name.encode()).hexdigest()
        row[at["withheld"]] = None  # the checks that are filled in are in time
        row[at["path"]], row[at["at"]], row[at["verdict"]] = name, begin + i * MINUTE_MS, verdict
        out["scans"].append(row)
        foil = first_foil + i
        out["foils"].append((foil, first_id + i, 1, serial, lot, die, "filler", verdict, "", "", "", "", 0))
        of_bump = {bump: worst([j[0] for j in judged if j[3] == bump]) for bump in bumps}
        out["bumps"] += [(foil, bump, of_bump[bump], "") for bump in bumps]
        out["measured"] += [(quantity, foil, bump, value, u) for quantity, bump, value, u in values]
        out["deciding"] += [(foil, rank, j[2], j[3], j[4], j[5], j[6], j[7], j[0]) for rank, j in enumerate(judged[:3])]
        out["arrivals"].append((first_card + i, begin + i * MINUTE_MS, name, "measured", "", first_id + i, 0))
        out["files"].append((name, 1, 1, first_card + i))
        if len(out["scans"]) == CHUNK:
            empty(database, out)
    empty(database, out)
    copy_scans(database, total, scans, first_id, first_foil)
    fill_checks(database, rng, checks, begin, scans * MINUTE_MS)
    database.commit()
    database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    database.close()


def fill_checks(database, rng, checks, begin, span):
    names = ("at, path, sha256, discs, scale_x, u_scale_x, scale_y, u_scale_y, shear, u_shear, verdict, words")
    rows = []
    for i in range(checks):
        x, y = 40e-6 + rng.gauss(0, 8e-6), -60e-6 + 260e-6 * i / max(checks, 1) + rng.gauss(0, 12e-6)
        shear = 25e-6 + rng.gauss(0, 10e-6)
        passes = abs(y) + 20e-6 < 300e-6
        words = (f"scanner {'in order' if passes else 'out of order'}: 4 discs, x {x * 1e6:+.0f} ± 16 ppm, "
                 f"y {y * 1e6:+.0f} ± 24 ppm, shear {shear * 1e6:+.0f} ± 20 µrad; allowed 300")
        rows.append((begin + span * (i + 1) // checks, f"check_{i + 1}.png", hashlib.sha256(f"check {i}".encode()).hexdigest(),
                     4, x, 8e-6, y, 12e-6, shear, 10e-6, "pass" if passes else "fail", words))
    if rows:
        database.executemany(f"INSERT INTO checks ({names}) VALUES ({','.join('?' * 12)})", rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="is made; must not hold a database")
    parser.add_argument("--scans", type=int, default=5000)
    parser.add_argument("--checks", type=int, default=120)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scan", default=os.path.join(ROOT, "samples", "gen2_foil.png"))
    parser.add_argument("--recipe", default=os.path.join(ROOT, "samples", "station", "recipe.json"))
    arguments = parser.parse_args()
    os.makedirs(arguments.folder, exist_ok=True)
    path = os.path.join(arguments.folder, "foilgauge.sqlite")
    if os.path.exists(path):
        parser.error(f"{path} exists")
    shutil.copy(arguments.scan, os.path.join(arguments.folder, "L000_A_000000.png"))
    code = subprocess.run([FOILGAUGE, "station", arguments.folder, "--recipe", arguments.recipe, "--once"],
                          check=False).returncode
    if code > 3:
        parser.error(f"the program ended with {code}")
    with open(arguments.recipe, encoding="utf-8") as file:
        design = json.load(file)["design"]
    if isinstance(design, str):
        with open(os.path.join(os.path.dirname(arguments.recipe), design), encoding="utf-8") as file:
            design = json.load(file)
    fill(path, arguments.scans, arguments.checks, design.get("tolerances", {}), arguments.seed)


if __name__ == "__main__":
    main()
