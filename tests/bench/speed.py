#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Time, memory and accuracy of foilgauge on all cores and on one, of reading alone and of both peers: one run,
interleaved."""

import argparse
import csv
import glob
import math
import os
import statistics
import subprocess
import sys
import tempfile

import benchlib
import speed_scans

HERE = os.path.dirname(os.path.abspath(__file__))
TOOLS = os.path.join(benchlib.ROOT, "build", "bench")
NAMES = {
    "read": "libpng alone",
    "foilgauge": "foilgauge measure",
    "one_core": "the same with --threads 1",
    "skimage": "scikit-image + SciPy",
    "opencv": "OpenCV + SciPy",
}
PEERS = ("skimage", "opencv")
READERS = {
    "read": "libpng",
    "spng": "libspng",
    "opencv_read": "OpenCV's imread",
    "skimage_read": "scikit-image's imread",
}
PYTHON_READERS = ("opencv_read", "skimage_read")  # the seconds of the call alone: a process would be Python's start
PEER_REPETITIONS = 5  # of a second each: they need no more to be told apart


def commands(scan, design, out):
    python = "/usr/bin/python3"
    read_in_python = [python, os.path.join(HERE, "read_python.py")]
    spng = [os.path.join(TOOLS, "read_spng"), scan]
    return {
        "read": [os.path.join(TOOLS, "read_png"), scan],
        "foilgauge": [benchlib.FOILGAUGE, "measure", scan, "--design", design, "-o", out],
        "one_core": [benchlib.FOILGAUGE, "measure", scan, "--design", design, "-o", out, "--threads", "1"],
        "skimage": [python, os.path.join(HERE, "peer_skimage.py"), scan, "--design", design],
        "opencv": [python, os.path.join(HERE, "peer_opencv.py"), scan, "--design", design],
        **({"spng": spng} if os.path.exists(spng[0]) else {}),
        "opencv_read": read_in_python + ["opencv", scan],
        "skimage_read": read_in_python + ["skimage", scan],
    }


def run_once(command, folder):
    """Wall, CPU (s), peak (MiB), exit code; standard output goes to a file, like the report."""
    result = os.path.join(folder, "cost")
    with open(os.path.join(folder, "stdout"), "wb") as out:
        subprocess.run(
            [os.path.join(TOOLS, "run_timed"), result] + command,
            stdout=out,
            stderr=subprocess.PIPE,
            check=True,
        )
    with open(result, encoding="ascii") as file:
        wall, user, system, peak, code = file.read().split()
    return float(wall), float(user) + float(system), float(peak) / 1024, int(code)


def call_seconds(folder):
    """Of a reader in Python, which prints them."""
    with open(os.path.join(folder, "stdout"), encoding="ascii") as file:
        return float(file.read())


def report_of(name, folder, out):
    path = out if name in ("foilgauge", "one_core") else os.path.join(folder, "stdout")
    try:
        foils = benchlib.load(path)["foils"]
        return foils[0] if len(foils) == 1 else None
    except (OSError, ValueError, KeyError):
        return None


def measure_scan(scan, repetitions, folder):
    """All of them on one scan, in turn, each repetition in the other order. The first round warms the
    page cache and is not counted."""
    truth = benchlib.load_truth(scan[: -len(".png")] + ".truth.json")
    design, out = os.path.join(folder, "design.json"), os.path.join(folder, "report.json")
    benchlib.write_design(truth, design)
    todo = commands(scan, design, out)
    costs = {name: [] for name in todo}
    foils = {}
    for repetition in range(repetitions + 1):
        for name in list(todo)[:: 1 if repetition % 2 else -1]:
            if name in PEERS + PYTHON_READERS and repetition > PEER_REPETITIONS:
                continue
            cost = run_once(todo[name], folder)
            if name in PYTHON_READERS:
                cost = (call_seconds(folder), *cost[1:])
            # 1 of foilgauge says `out of tolerance`: a measurement like any other.
            if cost[3] > (1 if name in ("foilgauge", "one_core") else 0):
                sys.exit(f"speed.py: {NAMES.get(name) or READERS[name]} failed on {scan} (exit code {cost[3]})")
            if repetition:
                costs[name].append(cost)
            elif name not in READERS:
                foils[name] = report_of(name, folder, out)
    wrong = {name: benchlib.errors(foil, truth) if foil else None for name, foil in foils.items()}
    return {"scan": os.path.basename(scan), "costs": costs, "errors": wrong, "effects": truth["effects"]}


def pair_ratios(result, name, base):
    return [a[0] / b[0] for a, b in zip(result["costs"][name], result["costs"][base])]


def spread(values, digits=3):
    middle = statistics.median(values)
    return f"{middle:.{digits}f} ({min(values):.{digits}f}–{max(values):.{digits}f})"


def time_rows(results):
    for result in results:
        for name in NAMES:
            costs = result["costs"][name]
            yield [
                result["scan"],
                NAMES[name],
                spread([c[0] for c in costs]),
                f"{statistics.median(c[1] for c in costs):.3f}",
                f"{max(c[2] for c in costs):.1f}",
                spread(pair_ratios(result, name, "read"), 2),
                "" if name in ("foilgauge", "one_core") else spread(pair_ratios(result, name, "foilgauge"), 1),
            ]


def reader_rows(results):
    for name, words in READERS.items():
        if name not in results[0]["costs"]:
            yield [words, "not installed"] + [""] * 3
            continue
        own = [statistics.median(c[0] for c in result["costs"][name]) for result in results]
        cells = [[r for result in results for r in pair_ratios(result, measure, name)] for measure in ("foilgauge", "one_core")]
        ratio_of_libpng = [r for result in results for r in pair_ratios(result, name, "read")]
        yield [words, f"{min(own):.3f} to {max(own):.3f}", f"{statistics.median(ratio_of_libpng):.2f}"] + [spread(c, 2) for c in cells]


def accuracy_rows(results):
    for result in results:
        for name in ("foilgauge", *PEERS):
            wrong = result["errors"].get(name)
            cells = ["not measured"] * 5
            if wrong:
                cells = [benchlib.number(benchlib.rms(wrong[q])) for q in ("R", "h", "alpha", "theta", "R0")]
            effects = ", ".join(effect["id"] for effect in result["effects"]) or "–"
            yield [result["scan"], effects, NAMES[name]] + cells


def error_ratio(results, name):
    """Geometric mean over the scans without scanner effects of rms error in R, peer / foilgauge."""
    logs = [
        math.log(benchlib.rms(r["errors"][name]["R"]) / benchlib.rms(r["errors"]["foilgauge"]["R"]))
        for r in results
        if r["errors"].get(name)
        and r["errors"].get("foilgauge")
        and not any(effect["id"].startswith("scan.") for effect in r["effects"])
    ]
    return math.exp(sum(logs) / len(logs)) if logs else float("nan")


def write_markdown(path, results, repetitions, command, load):
    ratios = {
        name: [r for result in results for r in pair_ratios(result, name, "foilgauge")]
        for name in PEERS
    }
    reading, one_core = ([r for result in results for r in pair_ratios(result, name, "read")]
                         for name in ("foilgauge", "one_core"))
    peak = max(c[2] for result in results for c in result["costs"]["foilgauge"])
    with open(path, "w", encoding="utf-8") as out:
        out.write(
            "# Speed, memory and accuracy in one run\n\n"
            f"Made by `{command}` with {benchlib.program_version()} on {benchlib.machine()}.\n"
            "Scans that were not given are those of the shared data folder or, where it is not there, renders like them\n"
            "(`tests/bench/speed_scans.py`, which says what they show).\n"
            f"Every scan is measured {repetitions} times by each in turn ({PEER_REPETITIONS} times by the peers), in\n"
            "alternating order, after one round that warms the page cache. Each run is a process of its own, start-up included;\n"
            "foilgauge writes its JSON report, reading alone keeps nothing. Ratios are formed pair by\n"
            f"pair within a repetition. Median (lowest–highest). {load}\n\n"
            f"- foilgauge against reading alone: median {statistics.median(reading):.2f} × the wall time, on one core "
            f"{statistics.median(one_core):.2f} ×; peak memory {peak:.0f} MiB\n"
            + "".join(
                f"- {NAMES[name]}: median {statistics.median(values):.1f} × foilgauge's wall time, "
                f"{error_ratio(results, name):.2f} × its rms error in R (geometric mean over the scans "
                "without scanner effects)\n"
                for name, values in ratios.items()
            )
            + "\n## Beside reading alone\n\n"
            "The readers keep nothing; of those in Python the call alone is timed, without the start of Python and its modules.\n"
            "Medians of the scans, and foilgauge's wall time as a multiple of the reader's.\n\n"
        )
        out.write(
            benchlib.table(
                ["reader", "wall s", "× libpng", "foilgauge, × reader", "on one core, × reader"],
                reader_rows(results),
            )
        )
        out.write("\n## Time and memory\n\n")
        out.write(
            benchlib.table(
                ["scan", "what", "wall s", "CPU s", "peak MiB", "× reading", "× foilgauge"],
                time_rows(results),
            )
        )
        out.write(
            "\n## Accuracy against the truth\n\nRoot mean square error over the bumps of one scan "
            "(R0: one error). A scan with effects\nof the scanner carries them into every answer here: "
            "nobody corrects them in this table.\n\n"
        )
        header = ["scan", "effects", "what", "R µm", "h µm", "alpha deg", "theta deg", "R0 µm"]
        out.write(benchlib.table(header, accuracy_rows(results)))


def write_csv(path, results):
    with open(path, "w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out)
        writer.writerow(["scan", "what", "repetition", "wall_s", "cpu_s", "peak_mib", "exit_code"])
        for result in results:
            for name, costs in result["costs"].items():
                for k, cost in enumerate(costs):
                    writer.writerow([result["scan"], name, k + 1] + [f"{v:.6g}" for v in cost])


def default_scans():
    folder = os.path.join(benchlib.shared_folder(), "scans")
    if not os.path.isdir(folder):
        return speed_scans.render_all(benchlib.FOILGAUGE, os.path.join(benchlib.ROOT, "build", "speed_scans"))
    scans = sorted(glob.glob(os.path.join(folder, "*.png")))
    return [scan for scan in scans if os.path.exists(scan[: -len(".png")] + ".truth.json")]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scans", nargs="*", help="PNGs with *.truth.json beside them")
    parser.add_argument("--repetitions", type=int, default=9)
    parser.add_argument("-o", "--out", default=os.path.join(benchlib.ROOT, "reports"))
    options = parser.parse_args()
    scans = options.scans or default_scans()
    if not scans:
        sys.exit("speed.py: no scan with a *.truth.json beside it")
    os.makedirs(options.out, exist_ok=True)
    results = []
    load = benchlib.MachineLoad()
    with tempfile.TemporaryDirectory() as folder:
        for scan in scans:
            print(f"timing {os.path.basename(scan)}", flush=True)
            results.append(measure_scan(scan, options.repetitions, folder))
    write_markdown(
        os.path.join(options.out, "speed.md"), results, options.repetitions, "tests/bench/speed.sh", load.said()
    )
    write_csv(os.path.join(options.out, "speed.csv"), results)
    print(f"wrote {os.path.relpath(options.out)}/speed.md and speed.csv")


if __name__ == "__main__":
    main()
