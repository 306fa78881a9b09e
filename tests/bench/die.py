# SPDX-License-Identifier: GPL-3.0-or-later
"""The thesis's die (halves +0.09 % and +0.35 %) from traces that die_profiles.py draws: reports/thesis/die.md.

    python3 tests/bench/die.py PROGRAM FOLDER REPORT.md [SEEDS]
"""
import json
import math
import os
import subprocess
import sys

import die_profiles as profiles


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def measure(program, folder, options, arguments=()):
    """The report and the truth of one set of traces."""
    args = profiles.parser().parse_args([folder, *options])
    truth = profiles.make(args)
    files = [os.path.join(folder, f"{h}_{r}.txt") for h in profiles.HALVES for r in range(1, args.repeats + 1)]
    said = ["--first-bump", str(args.first), *arguments]
    run = subprocess.run([program, "die", *said, *files], capture_output=True, text=True, check=True)
    return json.loads(run.stdout), truth


def errors_of(sets):
    """Errors in um (means of halves, bumps), the ratios of errors to u, sd over repeats."""
    out = dict(mean={h: [] for h in profiles.HALVES}, bump=[], z=dict(R=[], X=[], alpha=[], R0=[], mean=[]), sd=[])
    for report, truth in sets:
        for half in report["halves"]:
            of = truth[half["half"]]
            mean = half["mean"]["radius_mm"] - sum(of["radius_mm"].values()) / len(of["radius_mm"])
            out["mean"][half["half"]].append(half["mean"]["radius_error_pct"])
            out["z"]["mean"].append(mean / half["mean"]["u_radius_mm"])
            out["z"]["R0"].append((half["overall"]["radius_mm"] - of["overall_mm"]) / half["overall"]["u_radius_mm"])
            for bump in half["bumps"]:
                out["sd"].append(1000 * (bump["sd_radius_mm"] or 0))
                out["bump"].append(1000 * (bump["radius_mm"] - of["radius_mm"][bump["number"]]))
                for key, name in (("R", "radius_mm"), ("X", "centre_to_centre_mm"), ("alpha", "bump_angle_deg")):
                    out["z"][key].append((bump[name] - of[name][bump["number"]]) / bump["u_" + name])
    return out


def covered(ratios):
    return f"{100 * sum(abs(r) < 2 for r in ratios) / len(ratios):.0f} %"


def main(program, folder, report, seeds):
    lines = []
    say = lines.append
    seeds = range(1, seeds + 1)

    def run(options, arguments=()):
        return errors_of(measure(program, folder, ["--seed", str(s), *options], arguments) for s in seeds)

    ideal = ["--form-um", "0", "--rough-um", "0", "--noise-um", "0"]
    thesis = run(["--repeats", "5"])
    say("# The thesis's die by stylus\n")
    say("The thesis measured both halves of its die: bump radii of 3.32299 mm (+0.09 %, concave) and 3.33162 mm (+0.35 %, convex)")
    say("against 3.32 mm, repeats within 1 µm. `tests/bench/die_profiles.py` draws traces of such a die: a surface with form (0.15 µm over")
    say("0.5 mm) and roughness (0.05 µm over 20 µm), the upper envelope of a tip of 2 µm that goes over it, noise of 30 nm, each repeat set down")
    say(f"anew. It shares no code with the program. {len(seeds)} dies, 5 bumps, 5 repeats of each half; `tests/bench/die.sh` writes this page.\n")
    say("| half | thesis, % | found, mean over the dies, % | sd over the dies, % | largest error, % |")
    say("|---|---|---|---|---|")
    for half in profiles.HALVES:
        found, true = thesis["mean"][half], profiles.THESIS_ERROR_PCT[half]
        mean = sum(found) / len(found)
        sd = math.sqrt(sum((f - mean) ** 2 for f in found) / (len(found) - 1))
        say(f"| {half} | {true:+.2f} | {mean:+.4f} | {sd:.4f} | {max(abs(f - true) for f in found):.4f} |")
    say(f"\nRepeats of one bump's radius: sd {rms(thesis['sd']):.2f} µm (rms), {max(thesis['sd']):.2f} µm at most; the thesis has below 1 µm.")
    say("What repeats do not show is the surface's form: it moves the radius of a bump by")
    say(f"{rms(thesis['bump']):.2f} µm (rms over {len(thesis['bump'])} bumps), and u says so (below).\n")

    say("## Tips\n")
    say("Error of the halves' mean radius, µm; tip's radius taken off by the program. Ideal: neither form, roughness nor noise, so what is")
    say("left is the method's. A tip rides on the peaks of a rough surface: that moves a ridge's radius out, a groove's in.\n")
    say("| tip, µm | ideal, concave | ideal, convex | rough, concave | rough, convex |")
    say("|---|---|---|---|---|")
    for tip in ("0", "2", "5", "25", "100", "500"):
        row = []
        for options in (ideal, ["--form-um", "0", "--rough-um", "0.1"]):
            sets = errors_of([measure(program, folder, ["--repeats", "2", "--tip-um", tip, *options])])
            for half in profiles.HALVES:
                row.append(3.32 * 10 * (sets["mean"][half][0] - profiles.THESIS_ERROR_PCT[half]))
        say(f"| {tip} | " + " | ".join(f"{r:+.3f}" for r in row) + " |")

    say("\n## Uncertainties\n")
    say("Share of the truth within U = 2 u (95 % is right), over the same dies. Form that is as smooth as this one makes u larger than it need")
    said, overall = len(lines), []
    say("| set | R of a bump | X | alpha | R0 | mean R of a half | rms error of R, µm |")
    say("|---|---|---|---|---|---|---|")
    for name, options in (
        ("as above, 5 repeats", None),
        ("1 repeat", ["--repeats", "1"]),
        ("3 bumps", ["--repeats", "2", "--bumps", "3", "--first", "4"]),
        ("9 bumps, the outer flanks too steep", ["--repeats", "2", "--bumps", "9", "--first", "1"]),
        ("form over 0.2 mm", ["--repeats", "2", "--form-mm", "0.2"]),
        ("form over 1 mm", ["--repeats", "2", "--form-mm", "1"]),
        ("no form, noise of 0.2 µm", ["--repeats", "2", "--form-um", "0", "--noise-um", "0.2"]),
        ("tip of 100 µm", ["--repeats", "2", "--tip-um", "100"]),
        ("tip follows 60° at most", ["--repeats", "2", "--cone-deg", "60"]),
    ):
        sets = thesis if options is None else run(options)
        z = sets["z"]
        if "--form-um" not in (options or ()):
            overall.append(covered(z["R0"]))
        say(f"| {name} | " + " | ".join(covered(z[k]) for k in ("R", "X", "alpha", "R0", "mean")) + f" | {rms(sets['bump']):.2f} |")

    overall.sort(key=lambda text: float(text.split()[0]))
    lines.insert(said, "be. The overall circle rests on few lands, whose form is not counted as that of the bumps is: where the surface has form, u of R0 is mostly\n"
                 f"too small, for any number of bumps: U holds the truth in {overall[0]} (fewest) to {overall[-1]} (most) of the halves.\n")
    say("\n## Texts\n")
    say("One die, written in the ways that profilometers write; the largest difference of a bump's radius from the first, nm.\n")
    say("| text | difference, nm |")
    say("|---|---|")
    first = None
    for name, options, arguments in (
        ("mm, tabs, header", [], ()),
        ("µm, semicolons, decimal comma, µ in Latin-1", ["--unit", "um", "--separator", "semicolon", "--decimal-comma", "--micro"], ()),
        ("x in mm, z in µm, tabs", ["--unit", "mm,um"], ()),
        ("mm, commas between the columns", ["--separator", "comma"], ()),
        ("mm, blanks, decimal comma, no header", ["--separator", "space", "--decimal-comma", "--no-header"], ("--unit", "mm", "--tip-um", "2")),
    ):
        found, _ = measure(program, folder, ["--repeats", "1", *options], arguments)
        radii = [b["radius_mm"] for h in found["halves"] for b in h["bumps"]]
        first = first or radii
        say(f"| {name} | {1e6 * max(abs(a - b) for a, b in zip(radii, first)):.2f} |")
    with open(report, "w", encoding="utf-8") as out:
        out.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4]) if len(sys.argv) > 4 else 16)
