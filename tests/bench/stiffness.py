# SPDX-License-Identifier: GPL-3.0-or-later
"""reports/thesis/stiffness.md: the thesis's load-displacement tests beside synthetic ones with known truth, and how often
the uncertainties of `foilgauge stiffness` hold the truth.  python3 tests/bench/stiffness.py build/foilgauge [OUT.md]"""
import pathlib
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import load_tests
import other_bearing_coverage
import stiffness_coverage
from other_bearing_kinds import KINDS, PULL_KINDS

SETS = (("as above", {}), ("one cycle", dict(cycles=1)), ("it softens: k = 1500, k3 = -2e4", dict(k=1500.0, k3=-2e4)),
        ("noise is correlated (0.6 to the next sample)", dict(ar=0.6)), ("one cycle, noise of 1 N and 1 µm", dict(cycles=1, noise_n=1.0, noise_um=1.0)),
        ("one cycle, noise of 2 N and 2 µm", dict(cycles=1, noise_n=2.0, noise_um=2.0)),
        ("it softens, noise of 1 N and 1 µm", dict(k=1500.0, k3=-2e4, noise_n=1.0, noise_um=1.0)))
NOISES, STEPS = (0.1, 0.5, 1.0, 2.0), (0, 1, 2)  # N and µm alike, of 120 N and 380 µm; µm
NAMES = (("clearance_mm", "clearance"), ("stiffness_n_mm", "stiffness"), ("loss_factor", "loss factor"), ("radial_hysteresis_n", "radial hysteresis"))
SEEDS_SCALED, SEEDS, SEEDS_GRID = 40, 12, 20
RECORDS = 24  # of every kind of the second generator
SECOND = ("clearance", "gap", "stiffness there", "secant", "loss there", "loss, secant", "loss of the foil", "axis")


def share(found, name):
    z = found[name][:, 0]
    known = np.isfinite(z)
    if not known.any():
        return "– | –"
    errors = found[name][known, 1]
    return f"{100 * np.mean(np.abs(z[known]) <= 2):.0f} % | {100 * np.sqrt(np.mean(errors**2)):.2f} %"


def heading(first):
    return (f"| {first} | " + " | ".join(f"{words}, in U | rms error" for _, words in NAMES) + " |\n" + "|---" * (1 + 2 * len(NAMES)) + "|")


def tests_of(program, changes, seeds, scale):
    """In two at a time, by seed."""
    with ThreadPoolExecutor(2) as pool:
        parts = list(pool.map(lambda seed: stiffness_coverage.coverage(program, [seed], "A", changes, scale), seeds))
    return {name: np.concatenate([part[name] for part in parts if name in part]) for name in {n for part in parts for n in part}}


def row(words, found):
    line = f"| {words} | " + " | ".join(share(found, name) for name, _ in NAMES) + " |"
    print(line, flush=True)
    return line


def table(program, scale):
    azimuths = np.array([0.0, 60.0]) if scale else np.arange(0, 360, 60.0)
    seeds = range(100, 100 + (SEEDS_SCALED if scale else SEEDS))
    return "\n".join([heading("set"), *(row(words, tests_of(program, dict(changes, azimuths=azimuths), seeds, scale)) for words, changes in SETS)])


def grid(program):
    lines = [heading("noise, N and µm; step, µm")]
    for noise in NOISES:
        for step in STEPS:
            changes = dict(noise_n=noise, noise_um=noise, step_um=step, azimuths=np.array([0.0, 60.0]))
            lines.append(row(f"{noise:g}; {step if step else 'none'}", tests_of(program, changes, range(700, 700 + SEEDS_GRID), False)))
    return "\n".join(lines)


def bearings(program):
    rows, truth = load_tests.test_of("ABC", np.random.default_rng(7))
    report = stiffness_coverage.run(program, rows)
    lines = ["| bearing | thesis, mm | smallest, mm | largest, mm | smallest towards (30° is true) | radial hysteresis, N (1.032 is true) |", "|---|---|---|---|---|---|"]
    for b in report["bearings"]:
        low, high = load_tests.KINDS[b["name"]]
        inside = all(abs(b[k] - v) <= 2 * b["u_" + k] for k, v in (("clearance_min_mm", low), ("clearance_max_mm", high)))
        assert inside, b
        lines.append(f"| {b['name']} | {low:.2f} to {high:.2f} | {b['clearance_min_mm']:.4f} ± {2 * b['u_clearance_min_mm']:.4f} | "
                     f"{b['clearance_max_mm']:.4f} ± {2 * b['u_clearance_max_mm']:.4f} | {b['smallest_at_deg']:.1f} ± {2 * b['u_smallest_at_deg']:.1f}° | "
                     f"{b['radial_hysteresis_n']:.3f} ± {2 * b['u_radial_hysteresis_n']:.3f} |")
    return "\n".join(lines), report["options"]["u_stiffness_pct"]


def second(program, judge, kinds, chosen):
    """Cells of the chosen quantities over the records of every kind of the second generator."""
    with ThreadPoolExecutor(2) as pool:
        found = dict(zip(kinds, pool.map(lambda kind: judge(program, kind, RECORDS, 1)[0], kinds)))
    shown = [q for q in chosen or next(iter(found.values())) if any(t[q].present for t in found.values())]
    lines = ["| " + " | ".join(["kind", *shown, "records"]) + " |", "|---" * (2 + len(shown)) + "|"]
    for kind, tallies in found.items():
        lines.append("| " + " | ".join([kind, *(tallies[q].cell() for q in shown), kinds[kind][1]]) + " |")
        print(lines[-1], flush=True)
    if not chosen:  # kinds whose truth cannot be known are among them
        return "\n".join(lines)
    everything = [f"{100 * sum(t[q].within for t in found.values()) / max(1, sum(t[q].comparable for t in found.values())):.1f} %" for q in shown]
    return "\n".join([*lines, "| " + " | ".join(["all, within U", *everything, ""]) + " |"])


PAGE = """# Load-displacement tests

Section 5.13 of the thesis: a rotor is pushed and pulled in the bearing. `tests/bench/load_tests.py` makes such tests with known truth:
a gap, a spring k d + k3 d³ behind it (500 N/mm, 5e4 N/mm³, contact rounded over 3 µm), friction 1.032 N + 0.03 |F| that turns round over
6 µm, five cycles of 600 unequal samples of which a tenth is lost, noise of 0.2 N and 0.2 µm, drift of 0.1 N and 0.5 µm per cycle, and both
instruments' scales off by 1.0 % (force) and 1.3 % (displacement; sd, one draw per test). It shares no code with the program.
`/usr/bin/python3 tests/bench/stiffness.py build/foilgauge` writes this page.

## The thesis's numbers

| figure | thesis | here | by |
|---|---|---|---|
| instruments together, % | 1.64 | {both:.2f} | load cell 1.0 %, optical probe 1.3 %: sqrt(1.0² + 1.3²), both taken as standard uncertainties: `u_stiffness_pct` of every report |
| preload of a break-away test with 1.032 N without a weight and a slope of 0.03, on 40 × 40 mm, kPa | 6.85 | {preload:.3f} | 1.032 N / 0.03 = 34.4 N over pi · 40 mm · 40 mm; over 40 mm × 40 mm it would be {flat:.1f} |
| clearances of three bearings, mm | 0.16 to 0.20, 0.17 to 0.20, 0.14 to 0.16 | below | synthetic tests with these clearances |

The thesis's own records are not printed, so that they cannot be measured here: its ranges are planted, and found again.

{bearings}

## How often U holds the truth

Bearing A; 95 % is right. The errors of the instruments' scales are drawn anew for each of {scaled} tests of two azimuths, so a share is good to
some 4 points:

{with_scale}

Without them, {alone} tests of six azimuths, against U of the repeats alone (`u_repeat_`), which decides whether azimuths differ:

{without}

Over noise and the steps of the displacement's column, {grid_seeds} tests of two azimuths, again against U of the repeats alone; 1 N is 0.8 % of the
largest force:

{grid}

The stiffness is held against the truth at the place that is reported: a spring that hardens is stiffest where the test ends, which the
report says (`stiffness_at_end`). A window of the regression that is wider than the contact is round biases what is behind it; what
two windows differ by (of a slope two thirds of it) is part of u, which makes U somewhat wide.

How noise of the displacement is met: the variance about a stroke follows its slope squared, which tells the noise of the displacement from
that of the force; the step of a rounded column adds step²/12 at least. Samples that lie within 3 times that noise of a turn are left out, and
no slope is taken within 10 times of it: where samples crowd, their places are off on average. What a stroke turns at is the vertex of a
parabola through the samples there, since the extreme of noisy ones lies beyond. The largest slope is sought with windows that do not follow
the noise from place to place.

## A second generator

`tests/bench/other_bearing.py` shares no line and no law of friction with the program or with `load_tests.py`: foils that harden with play operators
(Prandtl and Ishlinskii), displacement control, load control whose rotor jumps through the gap, dead weights with rests, dropouts, drift and warming,
3 to 12 azimuths, unequal gaps, no gap. {records} records of every kind, gains of both instruments spread over their distribution. A cell says, in %: within U of
the truth / withheld / given with a flag that casts doubt / beyond 2 U without one. `there`: against the true slope where the report has found it
(`stiffness_at_end` says that more travel would find more). Without a gap a clearance must be withheld; of gaps that are alike all around, and of two axes, no
axis can be named.

{second}

Break-away tests of that generator:

{pulls}

Within an unsampled stretch U is that of a rectangular distribution, which never lies beyond 2 u: such cells reach 100 %. The loss factor of the foil is
held against energy lost over 2 pi times the elastic work of the foils alone; it is the same whatever the gap is, while that of the test falls as the gap grows.

Where it falls short: the secant's U holds 82 % with everything at once, where dropouts, steps and drift fall together on the turns, and there the
loss factor of the foil is withheld for 8 %. Loss factors hold 88 to 90 % under noise that is alike over 20 samples. A contact in a dropout may move
the axis: of 24 such bearings, alike all around, one was given an axis. Of one cycle with noise of 2 N and 2 µm the clearance's U is too small; with noise like that record more cycles. Noise
that is alike from one sample to the next hides from neighbours: only what cycles differ by knows of it, and U of the repeats alone is then
too small by a fifth to a third.
"""


def main(program, out):
    names, both = bearings(program)
    text = PAGE.format(both=both, preload=1000 * 1.032 / 0.03 / (np.pi * 40 * 40), flat=1000 * 1.032 / 0.03 / 1600, bearings=names,
                       scaled=SEEDS_SCALED, alone=SEEDS, with_scale=table(program, True), without=table(program, False),
                       grid_seeds=SEEDS_GRID, grid=grid(program), records=RECORDS,
                       second=second(program, other_bearing_coverage.judge_kind, KINDS, SECOND),
                       pulls=second(program, other_bearing_coverage.judge_pulls, PULL_KINDS, ()))
    pathlib.Path(out).write_text(text.rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "reports/thesis/stiffness.md")
