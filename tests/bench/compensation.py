# SPDX-License-Identifier: GPL-3.0-or-later
"""compensation.py PROGRAM [--processes N] [--first K] [--append FILE.csv] [--report FILE.csv ... --thesis FOLDER]: made-up
processes of known springback, die -> lot -> next die, three rounds, by the program itself; reports/compensation.md.

Lots are written as the records that `foilgauge lot` keeps (support/formed_lots.py). Each round of a process has the same
foils' deviations and the same level of lot and coil for every rule, so that rules differ by their dies alone.
"""

import argparse
import csv
import json
import math
import pathlib
import random
import statistics
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
import formed_lots as made  # noqa: E402

BUMPS, ROUNDS, TOLERANCE_PCT = 9, 3, 2.0
TARGET = {**made.DESIGN, "bump_count": BUMPS,
          "tolerances": {"radius_error_pct": {"min": -TOLERANCE_PCT, "max": TOLERANCE_PCT}}}


class Truth:
    """The law of one process, and the levels of its coils, lots and dies by round."""

    def __init__(self, number):
        rng = random.Random(1000 + number)
        self.number, self.foils = number, rng.randint(6, 14)
        self.springback, self.overall = rng.uniform(0.02, 0.08), rng.uniform(0.004, 0.03)
        self.exponent = self.springback * rng.uniform(0, 2)
        self.die_sd, drift_sd = rng.uniform(0.001, 0.004), rng.uniform(0, 0.003)
        self.foil_sd, self.rest_sd = rng.uniform(0.002, 0.005), rng.uniform(0.004, 0.012)
        # Half of the processes have an effect that no law has a term for: more springback towards one end of the die.
        self.end = rng.uniform(0.008, 0.025) if number % 2 else 0.0
        self.wide = rng.choice((3, 4))
        coil, self.coil, self.own, self.own_overall = 0.0, [], [], []
        for _ in range(ROUNDS + 1):
            coil += rng.gauss(0, drift_sd)
            self.coil.append(coil)
            self.own.append(rng.gauss(0, self.die_sd))
            self.own_overall.append(rng.gauss(0, 0.001))

    def bump(self, i):
        return self.end * max(0, i - (BUMPS - 1) + self.wide) / self.wide

    def ratio(self, radius, i):
        return self.springback + self.exponent * math.log(radius / made.DESIGN["bump_radius_mm"]) + self.bump(i)

    def lot(self, die, turn):
        """Foils of a round: (overall, pitch, [(radius, angle)])."""
        rng = random.Random(f"{self.number} {turn}")
        foils, level = [], self.coil[turn] + self.own[turn]
        for _ in range(self.foils):
            own, bumps = rng.gauss(0, self.foil_sd), []
            for i, (radius, angle) in enumerate(die["bumps"]):
                formed = radius * math.exp(self.ratio(radius, i) + level + own + rng.gauss(0, self.rest_sd))
                arc = radius * angle * math.exp(rng.gauss(0, 0.001))
                bumps.append((formed * math.exp(rng.gauss(0, 0.0005)), arc / formed))
            foils.append((die["overall"] * math.exp(self.overall + self.own_overall[turn] + rng.gauss(0, 0.0015)),
                          die["pitch"] * math.exp(rng.gauss(0, 0.0004)), bumps))
        return foils

    def oracle_die(self, turn):
        """By one who knows the law and the coil of the lot before; neither the next coil's step nor the next die's own."""
        r, a = made.DESIGN["bump_radius_mm"], made.DESIGN["bump_angle_deg"]
        bumps = []
        for i in range(BUMPS):
            radius = r * math.exp(-(self.springback + self.bump(i) + self.coil[turn - 1]) / (1 + self.exponent))
            bumps.append((radius, r * a / radius))
        return {"overall": made.DESIGN["overall_radius_mm"] * math.exp(-self.overall), "pitch": made.DESIGN["pitch_deg"],
                "bumps": bumps}


def means(foils):
    return [statistics.fmean(foil[2][i][0] for foil in foils) for i in range(BUMPS)]


def naive_die(die, foils):
    """Every size of the die scaled by the error of its mean."""
    r, a, o = (made.DESIGN[key] for key in ("bump_radius_mm", "bump_angle_deg", "overall_radius_mm"))
    bumps = []
    for i, (radius, angle) in enumerate(die["bumps"]):
        radii, angles = ([foil[2][i][k] for foil in foils] for k in (0, 1))
        bumps.append((radius * r / statistics.fmean(radii), angle * a / statistics.fmean(angles)))
    return {"overall": die["overall"] * o / statistics.fmean(foil[0] for foil in foils), "pitch": die["pitch"], "bumps": bumps}


def errors(foils):
    """Of a lot, percent: mean, rms over the bumps; share of foils within the tolerance."""
    r = made.DESIGN["bump_radius_mm"]
    error = [100 * (mean / r - 1) for mean in means(foils)]
    within = [all(abs(100 * (bump[0] / r - 1)) <= TOLERANCE_PCT for bump in foil[2]) for foil in foils]
    return statistics.fmean(error), math.sqrt(statistics.fmean(e * e for e in error)), statistics.fmean(within)


def row_of(truth, rule, turn, foils, **more):
    mean, rms, within = errors(foils)
    return {"process": truth.number, "foils": truth.foils, "end": truth.end, "rule": rule, "round": turn, "mean_pct": mean,
            "rms_pct": rms, "within": within, **more}


def count_inside(expected):
    """Values inside their intervals by quantity; radii at the end of the die by themselves."""
    radii = [bump["radius_mm"]["inside"] for bump in expected["bumps"]]
    return {"radius_inside": sum(radii), "end_inside": sum(radii[-3:]),
            "angle_inside": sum(bump["bump_angle_deg"]["inside"] for bump in expected["bumps"]),
            "height_inside": sum(bump["height_mm"]["inside"] for bump in expected["bumps"]),
            "overall_inside": int(expected["overall_radius_mm"]["inside"]), "p_value": expected["p_value"]}


def by_program(program, truth, template, folder):
    die, prior, rows = made.die_of_design(made.DESIGN, BUMPS), None, []
    target = folder / "target.json"
    target.write_text(json.dumps({"schema": made.SCHEMA, **TARGET}))
    for turn in range(ROUNDS + 1):
        foils, lot = truth.lot(die, turn), folder / f"lot{truth.number}-{turn}"
        next_die = folder / f"next{truth.number}-{turn}.json"
        expect = ("--expected", prior) if prior else ()
        template.write(lot, [template.foil(*foil) for foil in foils], name=lot.name, options=expect)
        row = row_of(truth, "program", turn, foils)
        if prior:
            expected = json.loads((lot / "expected.json").read_text())
            predicted = json.loads(prior.read_text())["expected"]
            low, high = predicted["share_within_of_lots"]
            row |= count_inside(expected)
            row |= {"verdict": expected["loop"]["verdict"], "claim": expected["loop"]["name"],
                    "share_predicted": predicted["share_within"], "share_inside": int(low - 1e-9 <= row["within"] <= high + 1e-9)}
        rows.append(row)
        if turn < ROUNDS:
            source = ("--prior", lot / "expected.json") if prior else ("--lot", lot)
            made.run(program, "die", "--target", target, *source, "--foils", truth.foils, "-o", next_die)
            prior, die = next_die, made.die_of_report(next_die)
    return rows


def by_rule(truth, rule):
    die, rows = made.die_of_design(made.DESIGN, BUMPS), []
    for turn in range(ROUNDS + 1):
        foils = truth.lot(die, turn)
        rows.append(row_of(truth, rule, turn, foils))
        if turn < ROUNDS:
            die = naive_die(die, foils) if rule == "naive" else truth.oracle_die(turn + 1)
    return rows


FIELDS = ("process", "foils", "end", "rule", "round", "mean_pct", "rms_pct", "within", "radius_inside", "end_inside",
          "angle_inside", "height_inside", "overall_inside", "p_value", "verdict", "claim", "share_predicted", "share_inside")


def simulate(program, first, count, path):
    with tempfile.TemporaryDirectory() as work, open(path, "a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, FIELDS, restval="", lineterminator="\n")
        if file.tell() == 0:
            writer.writeheader()
        folder = pathlib.Path(work)
        template = made.Template(program, folder / "template", TARGET)
        for number in range(first, first + count):
            truth = Truth(number)
            rows = by_program(program, truth, template, folder) + by_rule(truth, "naive") + by_rule(truth, "oracle")
            writer.writerows({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()}
                             for row in rows)
            file.flush()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--processes", type=int, default=100)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--csv", default="reports/compensation.csv")
    o = parser.parse_args()
    simulate(str(pathlib.Path(o.program).resolve()), o.first, o.processes, o.csv)


if __name__ == "__main__":
    main()
