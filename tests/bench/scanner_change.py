#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The share of unchanged scanners that `foilgauge scanner` calls changed, and the changes that it sees.

/usr/bin/python3 tests/bench/scanner_change.py build/foilgauge CASES.jsonl [--beds 24] [--first 0] [--out reports/scanner_change.md]

Beds are those of grid_maps.py. Every bed scans one plate of known pitch twice, laid anew, for two models; then it changes, in one of
CHANGES, and scans it again. Odd beds have rough pictures. Cases that CASES.jsonl has are not made again; with --out the page is written
of all of them. Needs numpy, scipy, scikit-image, pillow, cv2."""
import argparse
import json
import os
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from grid import run  # noqa: E402
from grid_maps import MAP_DPI, PITCH, SIDE_MM, U_PITCH, bed_of, board_of, scan_plate  # noqa: E402

CHANGES = {
    'none': lambda field, seed: field,
    'scale of y by 50 ppm': lambda field, seed: field.scale(0, 5e-5),
    'scale of y by 200 ppm': lambda field, seed: field.scale(0, 2e-4),
    'shear of 200 µrad': lambda field, seed: field.shear(2e-4),
    'smooth, 1 µm rms': lambda field, seed: field.smooth(1, 2.0, 9000 + seed),
    'smooth, 3 µm rms': lambda field, seed: field.smooth(3, 2.0, 9000 + seed),
    'ripple of 3 µm': lambda field, seed: field.ripple(3, 9.0, 1.0),
    'rows lost, 10 µm': lambda field, seed: field.step(10, 0.6 * SIDE_MM[MAP_DPI]),
}


def model_of(program, folder, field, board, seed, number, rough):
    rng = np.random.default_rng([seed, 77, number])
    picture = scan_plate(folder, board, field, seed, number, rng.uniform(-3, 3), rough, rng, MAP_DPI)
    path = os.path.join(folder, 'model%d.json' % number)
    done, _ = run(program, 'loop', picture, '--design', os.path.join(folder, 'plate.json'), '-o', path + '.loop', '--model-out', path)
    if done.returncode:
        raise SystemExit(done.stderr)
    return path


def cases_of(program, folder, seed):
    rough = bool(seed % 2)
    board = board_of(seed, 'plate', rough, MAP_DPI)
    write = {'form': 'grid', 'marks': 'dots', 'pitch_mm': PITCH, 'u_pitch_mm': U_PITCH}
    with open(os.path.join(folder, 'plate.json'), 'w') as out:
        json.dump({'schema': 'foilgauge/design/1', **write}, out)
    older = model_of(program, folder, bed_of(seed, MAP_DPI)[0], board, seed, 0, rough)
    for number, (name, change) in enumerate(CHANGES.items(), 1):
        newer = model_of(program, folder, change(bed_of(seed, MAP_DPI)[0], seed), board, seed, number, rough)
        out = os.path.join(folder, 'change.json')
        done, seconds = run(program, 'scanner', older, newer, '-o', out)
        if done.returncode not in (0, 1, 3):
            raise SystemExit(done.stderr)
        report = json.load(open(out))
        yield {'bed': seed, 'rough': rough, 'change': name, 's': seconds,
               **{k: report[k] for k in ('verdict', 'p_value', 'largest_um', 'u_largest_um', 'would_show_um')}}


def write_page(cases, path):
    with open(path, 'w') as out:
        out.write("""# Has a scanner changed?

`/usr/bin/python3 tests/bench/scanner_change.py build/foilgauge cases.jsonl --out reports/scanner_change.md` makes this page. Beds, plate and
pictures are those of [grid_maps.md](grid_maps.md): 42 mm, 600 dpi, dots 2.4 mm apart. Each bed scans the plate for a model; then the plate
is laid anew, on the same bed or on one that has changed, and `foilgauge scanner` compares the two models, of one scan each.

| change | edges | beds | changed, % | suspected, % | largest difference, µm | an rms difference that would have shown, µm |
|---|---|---:|---:|---:|---:|---:|
""")
        for name in CHANGES:
            for rough in (False, True):
                own = [c for c in cases if c['change'] == name and c['rough'] == rough]
                if not own:
                    continue
                share = [100 * np.mean([c['verdict'] == v for c in own]) for v in ('changed', 'suspected')]
                out.write('| %s | %s | %d | %.0f | %.0f | %.2f | %.2f |\n' % (
                    name, 'rough' if rough else 'ideal', len(own), *share, np.median([c['largest_um'] for c in own]),
                    np.median([c['would_show_um'] for c in own])))
        clean = [c for c in cases if c['change'] == 'none']
        out.write("""
Medians over the beds. Of unchanged scanners at most 1 %% are called changed and 9 %% suspected, fewer in truth: the whole u of both models counts; of the %d here it was %d and %d.
A comparison takes %.2f s.
""" % (len(clean), sum(c['verdict'] == 'changed' for c in clean), sum(c['verdict'] == 'suspected' for c in clean),
            np.median([c['s'] for c in cases])))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('program')
    parser.add_argument('cases')
    parser.add_argument('--beds', type=int, default=24)
    parser.add_argument('--first', type=int, default=0)
    parser.add_argument('--out')
    a = parser.parse_args()
    cases = [json.loads(line) for line in open(a.cases)] if os.path.exists(a.cases) else []
    done = {c['bed'] for c in cases}
    for seed in range(a.first, a.first + a.beds):
        if seed in done:
            continue
        with tempfile.TemporaryDirectory() as folder:
            own = list(cases_of(os.path.abspath(a.program), folder, seed))
        with open(a.cases, 'a') as out:
            out.writelines(json.dumps(c) + '\n' for c in own)
        cases += own
    if a.out:
        write_page(cases, a.out)


if __name__ == '__main__':
    main()
