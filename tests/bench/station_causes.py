#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A year of a simulated shop in a station's database, and what a search for causes finds in it.

The program measures one scan, which makes the database; its rows are multiplied as the station writes them. 5,000 foils
on 250 working days: 12 lots, 3 dies that are changed every few weeks, 5 coils, 2 scanners in turn, 3 operators by shift,
2 ovens, and a temperature with seasons and hours that a logger writes every hour into temperature.csv. The radius
varies by foil, by bump, by day and by lot. Planted are the causes of CAUSES, and in a second kind of year one that no
column has. Every year is searched by `foilgauge station FOLDER --context temperature.csv --digest`.

    tests/bench/station_causes.py [--years N] [--clean N] [--foils 5000] [--seed 1] -o reports/station_causes.md
"""

import argparse
import datetime
import hashlib
import json
import math
import os
import random
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time
import urllib.parse
import urllib.request

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FOILGAUGE = os.path.join(ROOT, "build", "foilgauge")
DAYS, LOTS, COILS = 250, 12, 5
FOIL, BUMP, DAY, LOT = 0.0025, 0.004, 0.0010, 0.0005  # standard deviations, as shares of the radius
# Planted causes, as shares of the radius: at level, and with numbers per unit.
CAUSES = {
    "coil": {"K7": 0.0041},
    "die": {"B": 0.0030},
    "scanner": {"S2": 0.0015},
    "operator": {"Cem": 0.0020},
    "temperature_C": 0.00030,
}
UNDECLARED = 0.0040  # a step that no column has, for two months


class Shop:
    """Columns of a year's foils; `rng` decides everything."""

    def __init__(self, rng, foils, collinear):
        per_day = foils // DAYS
        start = datetime.datetime(2025, 1, 6)
        weather = [rng.gauss(0, 1.2) for _ in range(DAYS)]
        first_die = rng.randrange(3)
        change, dies = 0, []
        while len(dies) < DAYS:
            dies += ["ABC"[(first_die + change) % 3]] * rng.randrange(8, 22)
            change += 1
        self.rows = []
        order = [rng.sample(("Ada", "Ben", "Cem"), 3) for _ in range(DAYS // 5 + 1)]
        coil_ends = sorted(rng.sample(range(foils // 20, foils), COILS - 1))
        for i in range(per_day * DAYS):
            day, place = divmod(i, per_day)
            hour = 6 + 16 * (place + rng.random()) / per_day
            at = start + datetime.timedelta(days=day // 5 * 7 + day % 5, hours=hour)
            coil = sum(i >= end for end in coil_ends)
            lot = i * LOTS // (per_day * DAYS)
            self.rows.append({
                "at": at, "lot": f"L{lot + 1:02d}", "lot_index": lot, "day": day, "hour": hour,
                "die": ("B" if coil == 3 else "A") if collinear else dies[day], "coil": f"K{coil + 4}",
                "operator": order[day // 5][0 if hour < 14 else 1], "scanner": "S1" if i % 2 else "S2",
                "oven": "O1" if (day + lot) % 3 else "O2",
                "temperature_C": self.temperature(at, weather[day])})
        self.start, self.weather = start, weather

    @staticmethod
    def temperature(at, weather):
        year = at.timetuple().tm_yday / 365
        return 20 - 5 * math.cos(2 * math.pi * (year - 0.05)) + 2 * math.sin(2 * math.pi * (at.hour + at.minute / 60 - 9) / 24) + weather

    def write_logger(self, path):
        """As a logger in the shop writes it, every hour of working days."""
        with open(path, "w", encoding="utf-8") as file:
            file.write("time,temperature_C\n")
            for day, weather in enumerate(self.weather):
                for hour in range(5, 24):
                    at = self.start + datetime.timedelta(days=day // 5 * 7 + day % 5, hours=hour)
                    file.write(f"{at:%Y-%m-%d %H:%M},{self.temperature(at, weather):.2f}\n")


def shifts(shop, rng, causes, undeclared):
    """Each foil's share of the radius by causes and by chance."""
    days = [rng.gauss(0, DAY) for _ in range(DAYS)]
    lots = [rng.gauss(0, LOT) for _ in range(LOTS)]
    out = []
    for row in shop.rows:
        shift = days[row["day"]] + lots[row["lot_index"]] + rng.gauss(0, FOIL)
        for column, effect in causes.items():
            shift += effect.get(row[column], 0) if isinstance(effect, dict) else effect * (row[column] - 20)
        if undeclared and 150 <= row["day"] < 190:
            shift += UNDECLARED
        out.append(shift)
    return out


def insert(database, table, rows):
    if rows:
        database.executemany(f"INSERT INTO {table} VALUES ({','.join('?' * len(rows[0]))})", rows)


def write_year(path, shop, rng, shift, whole):
    """The station's rows; `whole`: every quantity, else the radius of the bumps alone."""
    database = sqlite3.connect(path)
    database.execute("PRAGMA synchronous = OFF")
    names = [row[1] for row in database.execute("PRAGMA table_info(scans)")]
    scan = database.execute("SELECT * FROM scans ORDER BY id LIMIT 1").fetchone()
    at = {name: i for i, name in enumerate(names)}
    radius = database.execute("SELECT id FROM quantities WHERE owner = 'bump' AND name = 'radius_mm'").fetchone()[0]
    template = database.execute("SELECT quantity, bump, value, u FROM measured WHERE foil = 1").fetchall()
    if not whole:
        template = [row for row in template if row[0] == radius]
    bumps = [row[0] for row in database.execute("SELECT number FROM bumps WHERE foil = 1")]
    for table in ("measured", "deciding", "bumps", "pictures", "files", "arrivals", "foils", "scans"):
        database.execute(f"DELETE FROM {table}")
    out = {table: [] for table in ("scans", "foils", "bumps", "measured")}
    for i, (row, moved) in enumerate(zip(shop.rows, shift)):
        line = list(scan)
        line[at["id"]], line[at["sha256"]] = i + 1, hashlib.sha256(f"{path} {i}".encode()).hexdigest()
        line[at["path"]], line[at["at"]] = f"{i + 1:06d}.png", int(row["at"].timestamp() * 1000)
        if not whole:
            line[at["record"]] = None
        out["scans"].append(line)
        out["foils"].append((i + 1, i + 1, 1, f"{i + 1:06d}", row["lot"], row["die"], row["operator"], "pass", "",
                             row["coil"], row["oven"], row["scanner"], 0))
        of_bump = {bump: rng.gauss(0, BUMP) for bump in bumps}
        out["bumps"] += [(i + 1, bump, "pass", "") for bump in bumps]
        out["measured"] += [(quantity, i + 1, bump, value if value is None else value * (1 + moved + of_bump.get(bump, 0)), u)
                            for quantity, bump, value, u in template]
    out["measured"].sort(key=lambda row: row[:3])
    for table, rows in out.items():
        insert(database, table, rows)
    database.commit()
    database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    database.close()


def make_template(folder, recipe):
    os.makedirs(folder)
    shutil.copy(os.path.join(ROOT, "samples", "gen2_foil.png"), os.path.join(folder, "000000.png"))
    subprocess.run([FOILGAUGE, "station", folder, "--recipe", recipe, "--once"], check=False, stderr=subprocess.DEVNULL)
    os.remove(os.path.join(folder, "000000.png"))


def digest(folder, recipe):
    begin = time.monotonic()
    text = subprocess.run([FOILGAUGE, "station", folder, "--recipe", recipe, "--context",
                           os.path.join(folder, "temperature.csv"), "--digest"],
                          check=True, capture_output=True, text=True).stdout
    return text, time.monotonic() - begin


def read_findings(text):
    """(column, tied, words) of every found cause, and the other lines."""
    found, rest = [], {}
    for line in text.splitlines():
        words = line.strip()
        if words.startswith("Found: ") and "no column explains" not in words:
            since = re.match(r"Found: (?:since|with) (\S+) ", words)
            name = since.group(1) if since else "time"
            if re.match(r"\d{4}-", name):
                name = "time"
            found.append((name.rstrip(":"), "; tied with " in words, words[7:]))
        for label in ("Suspected:", "Not explained:", "Scatter"):
            if words.startswith(label):
                rest[label] = words
    return found, rest


class Bench:
    def __init__(self, work, foils):
        self.work, self.foils = work, foils
        self.recipe = os.path.join(work, "recipe.json")
        with open(self.recipe, "w", encoding="utf-8") as file:
            json.dump({"schema": "foilgauge/recipe/1", "station": {"file_name": "{serial}"},
                       "design": {"schema": "foilgauge/design/1", "tolerances": {"radius_mm": {"min": 1, "max": 9}}}}, file)
        self.template = os.path.join(work, "template")
        make_template(self.template, self.recipe)

    def year(self, seed, causes, undeclared=False, collinear=False, whole=False, keep=None):
        rng = random.Random(seed)
        folder = keep or os.path.join(self.work, f"year_{seed}_{undeclared}_{len(causes)}_{collinear}")
        shutil.copytree(self.template, folder)
        shop = Shop(rng, self.foils, collinear)
        shop.write_logger(os.path.join(folder, "temperature.csv"))
        write_year(os.path.join(folder, "foilgauge.sqlite"), shop, rng, shifts(shop, rng, causes, undeclared), whole)
        text, seconds = digest(folder, self.recipe)
        if not keep:
            shutil.rmtree(folder)
        return text, seconds


def score_year(text, causes):
    """Each cause as found, tied or missed; and the columns that were named without being a cause."""
    found, rest = read_findings(text)
    marks = {}
    for column in causes:
        own = [tied for name, tied, _ in found if name == column]
        beside = any(tied and re.search(rf"\b{column}\b", words.split("; tied with ")[1]) for _, tied, words in found)
        marks[column] = "found" if own and not own[0] else "tied" if own or beside else "missed"
    wrong = [(name, tied) for name, tied, _ in found if name not in causes]
    return marks, wrong, found, rest


def years_until(years, seconds):
    """Numbers of years, one at least, until the time is used up."""
    begin = time.monotonic()
    for year in range(years):
        if year and time.monotonic() - begin > seconds:
            return
        yield year


def kind_rows(bench, years, seed, causes, undeclared):
    done = 0
    counts = {column: {"found": 0, "tied": 0, "missed": 0} for column in causes}
    told, wrong, tied_wrong = 0, [], 0
    for year in years:
        done += 1
        text, _ = bench.year(seed + year, causes, undeclared)
        marks, others, found, rest = score_year(text, causes)
        for column, mark in marks.items():
            counts[column][mark] += 1
        times = [name for name, _, _ in found if name == "time"]
        told += bool(times) or "over time" in rest.get("Not explained:", "")
        for name, tied in others:
            if name == "time" and undeclared:
                continue
            tied_wrong += tied
            if not tied:
                wrong.append(name)
    return counts, told, wrong, tied_wrong, done


def collinear_row(bench, years, seed):
    """Coil K7 moves the radius, and die B is on the press with it and never else."""
    marks = {"tied": 0, "named alone": 0, "missed": 0}
    for year in years:
        found, _ = read_findings(bench.year(seed + year, {"coil": CAUSES["coil"]}, collinear=True)[0])
        of_pair = [tied for name, tied, _ in found if name in ("coil", "die")]
        marks["missed" if not of_pair else "tied" if of_pair[0] else "named alone"] += 1
    return marks


def clean_rows(bench, years, seed):
    claims, done = [], 0
    for year in years:
        done += 1
        found, _ = read_findings(bench.year(seed + year, {})[0])
        if found:
            claims.append((seed + year, [words for _, _, words in found]))
    return claims, done


def ask(base, path, fields=None):
    data = urllib.parse.urlencode(fields).encode() if fields else None
    with urllib.request.urlopen(urllib.request.Request(base + path.lstrip("/"), data)) as answer:
        return answer.read().decode()


def time_intake(bench, seed):
    """A station with a year in it: how long "Why?" takes, and scans that come meanwhile and without it."""
    folder = os.path.join(bench.work, "running")
    bench.year(seed, CAUSES, whole=True, keep=folder)
    spec = os.path.join(bench.work, "spec.json")
    scans = []
    for i in range(8):
        with open(spec, "w", encoding="utf-8") as file:
            json.dump({"schema": "foilgauge/render/1", "seed": i + 1, "scanner": {"dpi": 600}, "foils": [{"rotate_deg": -90}]}, file)
        scans.append(os.path.join(bench.work, f"scan{i}.png"))
        subprocess.run([FOILGAUGE, "render", spec, "-o", scans[-1]], check=True)
    station = subprocess.Popen([FOILGAUGE, "station", folder, "--recipe", bench.recipe, "--context",
                                os.path.join(folder, "temperature.csv"), "--port", "0"], stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, text=True)
    try:
        base = station.stdout.readline().strip()
        token = re.search('name="form" value="([0-9a-f]+)"', ask(base, "/trends")).group(1)

        def arrive(i):
            hidden = os.path.join(folder, f".new{i}.png")
            shutil.copy(scans[i], hidden)
            begin = time.monotonic()
            os.rename(hidden, os.path.join(folder, f"new{i}.png"))
            while f"new{i}.png" not in ask(base, "/"):
                time.sleep(0.005)
            return time.monotonic() - begin

        alone = [arrive(i) for i in range(3)]
        begin = time.monotonic()
        ask(base, "/why", {"form": token, "q": "bump:radius_mm"})
        meanwhile, i = [], 3
        while "Searching for causes" in ask(base, "/why?q=bump:radius_mm"):
            if i < len(scans):
                meanwhile.append(arrive(i))
                i += 1
            time.sleep(0.02)
        return alone, meanwhile, time.monotonic() - begin
    finally:
        station.terminate()
        station.wait()


def load_average():
    return os.getloadavg()[0]


def write_report(arguments, bench, out):
    out.write(f"""# Causes at the station

`{" ".join(["tests/bench/station_causes.py"] + sys.argv[1:])}` writes this page. {arguments.foils} foils a year: 250 days, 12 lots, 3 dies, 5 coils, 2 scanners, 3 operators,
2 ovens, hourly temperature with seasons in a CSV. Standard deviations of the radius: foils {100 * FOIL:.2f} %, bumps {100 * BUMP:.2f} %, days {100 * DAY:.2f} %, lots {100 * LOT:.2f} %.
Planted: coil K7 +0.41 %, die B +0.30 %, scanner S2 +0.15 %, operator Cem +0.20 %, temperature +0.030 %/K; in the second table also +{100 * UNDECLARED:.2f} % for 40 days that no column has.
Rows are written into the database as the station writes them; `--digest` searches it.

""")
    minute = 60 * arguments.minutes
    alone, meanwhile, seconds = time_intake(bench, arguments.seed + 5000)
    out.write(f"""## Time

"Why?" with {arguments.foils} foils and scans that arrive meanwhile: {seconds:.1f} s. Scans of 600 dpi from the end of their file to the page Now:
longest {max(alone):.2f} s of {len(alone)} without a search, longest {max(meanwhile, default=float('nan')):.2f} s of {len(meanwhile)} beside it.
Load average {load_average():.1f} on 2 cores: above 1 others were at work and times are longer than they need be.

""")
    for undeclared in (False, True):
        counts, told, wrong, tied_wrong, done = kind_rows(bench, years_until(arguments.years, 0.2 * minute), arguments.seed, CAUSES,
                                                          undeclared)
        out.write(f"## {done} years with five causes{' and one that no column has' if undeclared else ''}\n\n"
                  "| cause | found | tied | missed |\n|---|---|---|---|\n")
        for column, marks in counts.items():
            out.write(f"| {column} | {marks['found']} | {marks['tied']} | {marks['missed']} |\n")
        if undeclared:
            out.write(f"| none has it (told over time) | {told} | | {done - told} |\n")
        out.write(f"\nOther columns named as causes: {len(wrong)} alone{' (' + ', '.join(sorted(set(wrong))) + ')' if wrong else ''}, "
                  f"{tied_wrong} in a tie.\n\n")
        out.flush()
    marks = collinear_row(bench, years_until(arguments.years, 0.1 * minute), arguments.seed + 1000)
    out.write(f"## {sum(marks.values())} years in which coil K7 and die B are on the same foils\n\nThe coil alone moves the radius: "
              + ", ".join(f"{count} {mark}" for mark, count in marks.items()) + ".\n\n")
    out.flush()
    claims, done = clean_rows(bench, years_until(arguments.clean, 0.4 * minute), arguments.seed + 2000)
    out.write(f"## {done} years without a cause\n\nYears with a claim: {len(claims)} ({100 * len(claims) / done:.1f} %).\n")
    for seed, words in claims:
        out.write(f"\n- seed {seed}: {'; '.join(words)}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--years", type=int, default=20, help="of each kind with causes")
    parser.add_argument("--clean", type=int, default=100)
    parser.add_argument("--foils", type=int, default=5000)
    parser.add_argument("--minutes", type=float, default=60, help="fewer years where they take longer")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", action="store_true", help="print what was found, and write no page")
    parser.add_argument("-o", "--output", default=os.path.join(ROOT, "reports", "station_causes.md"))
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        bench = Bench(work, arguments.foils)
        kinds = (dict(causes=CAUSES), dict(causes=CAUSES, undeclared=True),
                 dict(causes={"coil": CAUSES["coil"]}, collinear=True), dict(causes={}))
        for kind in kinds if arguments.show else ():
            text, seconds = bench.year(arguments.seed, **kind)
            print(kind, f"{seconds:.1f} s\n", text)
        if arguments.show:
            return
        page = os.path.join(work, "page.md")
        with open(page, "w", encoding="utf-8") as out:
            write_report(arguments, bench, out)
        shutil.copy(page, arguments.output)


if __name__ == "__main__":
    main()
