# SPDX-License-Identifier: GPL-3.0-or-later
"""Lots of known foils as the records that `foilgauge lot` keeps, so that the program reports them without scans; and
formed_lots.py PROGRAM FOLDER [options]: one lot of a made-up process.

A template, one small scan that was measured with the same design, gives the names of the values and the sum of the
settings; every foil is a record of its own.
"""

import argparse
import hashlib
import json
import math
import pathlib
import random
import subprocess

SCHEMA = "foilgauge/design/1"
DESIGN = {"bump_radius_mm": 3.32, "bump_angle_deg": 63.15, "overall_radius_mm": 20.73, "thickness_mm": 0.1, "pitch_deg": 40 / 3}


def run(*words, codes=(0, 1, 2, 3)):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode not in codes:
        raise RuntimeError(f"{' '.join(map(str, words))}: {done.returncode}: {done.stderr[:600]}")
    return done


def seal(record):
    """A line of results.jsonl with its checksum, which is of all bytes before it."""
    body = json.dumps(record)[:-1]
    return f'{body}, "checksum": "{hashlib.sha256(body.encode()).hexdigest()[:16]}"}}\n'


class Template:
    """Names and sums of the records of lots of a design; `recipe` has its members beside the design."""

    def __init__(self, program, folder, design, recipe=None, renderer=None):
        self.program, self.folder = str(program), pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.design = {"schema": SCHEMA, "calibration": "not needed: the scan is rendered", **design}
        self.recipe = {"schema": "foilgauge/recipe/1", "assembly": {"bearings": 0}, "resamples": 100,
                       "design": self.design, **(recipe or {})}
        spec = {"schema": "foilgauge/render/1", "foils": [{"design": {"bump_count": 3}, "rotate_deg": -90}],
                "scanner": {"dpi": 600}}
        (self.folder / "spec.json").write_text(json.dumps(spec))
        (self.folder / "recipe.json").write_text(json.dumps(self.recipe))
        if not (self.folder / "lot" / "results.jsonl").exists():
            run(renderer or program, "render", self.folder / "spec.json", "-o", self.folder / "scan.png")
            run(program, "lot", self.folder / "scan.png", "-o", self.folder / "lot", "--recipe", self.folder / "recipe.json",
                "--pages", "none")
        lines = (self.folder / "lot" / "results.jsonl").read_text().splitlines()
        self.head, self.record = json.loads(lines[0]), json.loads(lines[1])

    def values(self, names, known):
        return [known.get(name) for name in self.head[names]]

    def bump(self, number, radius, angle, overall, place_deg):
        half = math.radians(angle / 2)
        chord = radius * math.sin(half)
        x = radius * math.cos(half) + math.sqrt(overall**2 - chord**2)
        psi, sleeve = math.radians(place_deg), self.design.get("sleeve_radius_mm", self.design["overall_radius_mm"])
        fitted = radius * (1 - math.cos(half)) + sleeve - math.sqrt(sleeve**2 - chord**2)
        room = sleeve - self.design.get("rotor_diameter_mm", 40) / 2 - self.design["thickness_mm"]
        known = {
            "radius_mm": radius, "u_radius_mm": 0.0004, "centre_mm[0]": x * math.cos(psi), "centre_mm[1]": x * math.sin(psi),
            "centre_to_centre_mm": x, "bump_angle_deg": angle, "u_bump_angle_deg": 0.006, "height_mm": overall - x + radius,
            "u_height_mm": 5e-5, "height_fitted_mm": fitted, "u_height_fitted_mm": 5e-5,
            "clearance_mm": room - (overall - x + radius), "clearance_fitted_mm": room - fitted, "u_clearance_fitted_mm": 0.001,
            "radius_error_pct": 100 * (radius / self.design["bump_radius_mm"] - 1), "u_radius_error_pct": 0.01,
            "bump_angle_error_pct": 100 * (angle / self.design["bump_angle_deg"] - 1), "u_bump_angle_error_pct": 0.01,
            "points": 400, "position_deg": place_deg,
        }
        return {"number": number, "flags": [], "values": self.values("bump_values", known)}

    def foil(self, overall, pitch, bumps):
        """bumps: (radius, angle) of each."""
        known = {"thickness_mm": self.design["thickness_mm"], "u_thickness_mm": 0.001, "overall.radius_mm": overall,
                 "u_overall.radius_mm": 5e-5, "overall.centre_mm[0]": 0.0, "overall.centre_mm[1]": 0.0,
                 "overall.springback_error_pct": 100 * (1 - overall / self.design["overall_radius_mm"]), "overall.points": 470,
                 "u_overall.springback_error_pct": 2e-4}
        return {"number": 1, "flags": [], "error": None, "values": self.values("foil_values", known),
                "bumps": [self.bump(i + 1, r, a, overall, i * pitch) for i, (r, a) in enumerate(bumps)]}

    def write(self, folder, foils, columns=None, name=None, options=(), jobs=1):
        """A lot of foils (as of self.foil), with columns of its manifest (name: list of cells); returns the program's words."""
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        columns = {"scan": [str(folder.absolute().with_name(f"{folder.name}-{i + 1}.png")) for i in range(len(foils))], **(columns or {})}
        rows = [",".join(columns)] + [",".join(str(cell) for cell in row) for row in zip(*columns.values())]
        manifest = folder.with_name(folder.name + ".csv")
        manifest.write_text("\n".join(rows) + "\n")
        lines = [seal({key: value for key, value in self.head.items() if key != "checksum"})]
        for scan, foil in zip(columns["scan"], foils):
            record = {"scan": scan, "sha256": hashlib.sha256(scan.encode()).hexdigest(), "date": "2026-01-01",
                      "measured_with": self.record["measured_with"], "error": None, "foils": [foil]}
            lines.append(seal(record))
        (folder / "results.jsonl").write_text("".join(lines))
        return run(self.program, "lot", manifest, "-o", folder, "--recipe", self.folder / "recipe.json",
                   "--resume", "--pages", "none", "--jobs", jobs, *(("--name", name) if name else ()), *options)


class Process:
    """Springback of a made-up process: curvature is lost by a share that depends on the radius; `bump` adds by the number."""

    def __init__(self, rng, springback=0.05, exponent=0.05, overall=0.01, bump=None, lot_sd=0.002, drift_sd=0.0, foil_sd=0.003,
                 rest_sd=0.006, noise=0.0005):
        self.rng, self.springback, self.exponent, self.overall = rng, springback, exponent, overall
        self.bump = bump or (lambda i: 0.0)
        self.lot_sd, self.drift_sd, self.foil_sd, self.rest_sd, self.noise = lot_sd, drift_sd, foil_sd, rest_sd, noise
        self.coil = 0.0

    def set_level(self):
        self.coil += self.rng.gauss(0, self.drift_sd)
        return self.coil + self.rng.gauss(0, self.lot_sd)

    def ratio(self, die_radius, i):
        """ln(formed / die) of a bump, without what lots and foils differ by."""
        return self.springback + self.exponent * math.log(die_radius / DESIGN["bump_radius_mm"]) + self.bump(i)

    def lot(self, die, foils):
        """die: {"overall", "pitch", "bumps": [(radius, angle)]}. Returns the foils' dimensions."""
        level, made = self.set_level(), []
        whole = self.overall + self.rng.gauss(0, self.lot_sd / 3)
        for _ in range(foils):
            own, bumps = self.rng.gauss(0, self.foil_sd), []
            for i, (radius, angle) in enumerate(die["bumps"]):
                formed = radius * math.exp(self.ratio(radius, i) + level + own + self.rng.gauss(0, self.rest_sd))
                arc = radius * angle * math.exp(self.rng.gauss(0, 0.001))
                bumps.append((formed * math.exp(self.rng.gauss(0, self.noise)), arc / formed))
            made.append((die["overall"] * math.exp(whole + self.rng.gauss(0, 0.0015)),
                         die["pitch"] * math.exp(self.rng.gauss(0, 0.0004)), bumps))
        return made


def die_of_design(design, bumps):
    return {"overall": design["overall_radius_mm"], "pitch": design["pitch_deg"],
            "bumps": [(design["bump_radius_mm"], design["bump_angle_deg"])] * bumps}


def die_of_report(path):
    die = json.loads(pathlib.Path(path).read_text())["die"]
    return {"overall": die["overall_radius_mm"], "pitch": die["pitch_deg"],
            "bumps": [(bump["radius_mm"], bump["bump_angle_deg"]) for bump in die["bumps"]]}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--foils", type=int, default=12)
    parser.add_argument("--bumps", type=int, default=9)
    parser.add_argument("--die", help="a next die; without it the die is as designed")
    parser.add_argument("--springback", type=float, default=0.05)
    parser.add_argument("--end", type=float, default=0.0, help="springback that grows over the last bumps by this")
    parser.add_argument("--lot-sd", type=float, default=0.002)
    parser.add_argument("--tolerance", type=float, help="of the bump radius, percent")
    parser.add_argument("--template", default="template")
    parser.add_argument("--renderer")
    parser.add_argument("--expected")
    parser.add_argument("--columns", default="", help="die,coil: cells alternate between A and B")
    o = parser.parse_args()
    tolerances = {"tolerances": {"radius_error_pct": {"min": -o.tolerance, "max": o.tolerance}}} if o.tolerance else {}
    template = Template(o.program, o.template, {**DESIGN, "bump_count": o.bumps, **tolerances}, renderer=o.renderer)
    last = o.bumps - 1
    process = Process(random.Random(o.seed), o.springback, lot_sd=o.lot_sd,
                      bump=lambda i: o.end * max(0, i - last + 3) / 3)
    die = die_of_report(o.die) if o.die else die_of_design(DESIGN, o.bumps)
    foils = [template.foil(*foil) for foil in process.lot(die, o.foils)]
    columns = {name: ["AB"[i % 2] for i in range(o.foils)] for name in o.columns.split(",") if name}
    done = template.write(o.folder, foils, columns, name=pathlib.Path(o.folder).name,
                          options=("--expected", o.expected) if o.expected else ())
    print(done.stderr, end="")


if __name__ == "__main__":
    main()
