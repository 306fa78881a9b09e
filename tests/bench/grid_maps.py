#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of a scanner's bed against known truth, and foils measured through them.

/usr/bin/python3 tests/bench/grid_maps.py build/foilgauge CASES.jsonl [--beds 50] [--first 0] [--out reports/grid_maps.md]

Every bed is a scanner of its own: listed effects, keystone, bow, chips tilted and apart, a smooth random field. It scans a plate of
known pitch once and a printed board twice, turned in between, ideal and rough; then a foil lies on it and is measured through the
plate's model, and on a scanner without errors. Plates and boards are of a second renderer (other_grid.py), every fifth of them and all
foils of the program's own; foils are warped by the bed's field. Cases that CASES.jsonl has are not made again; with --out the page is
written of all of them. Needs numpy, scipy, scikit-image, pillow."""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

import cv2
import numpy as np
from PIL import Image
from scipy import ndimage

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from grid import gauge_free, run, save, write_design  # noqa: E402
from other_grid import Board, Field, render  # noqa: E402

PITCH, DOT_MM = 2.4, 0.6
MAP_DPI, FOIL_DPI = 600, 1200
SIDE_MM, COLUMNS = {MAP_DPI: 42.0, FOIL_DPI: 52.0}, {MAP_DPI: 16, FOIL_DPI: 20}  # a foil is 42 mm wide
U_PITCH = 2e-5  # mm
KINDS = ('plate', 'board')


def bed_of(seed, dpi):
    """The scanner: its field, and the names of its parts."""
    rng = np.random.default_rng([seed, 11])
    field, parts = Field((SIDE_MM[dpi], SIDE_MM[dpi])), []
    field.scale(rng.normal() * .003, rng.normal() * .003).shear(rng.normal() * .002)
    field.smooth(rng.uniform(2, 12), 2.0, seed)
    if seed % 2:
        field.keystone(rng.normal() * 1e-5).bow(rng.normal() * 10)
        parts.append('keystone')
    if seed % 3 == 0:
        field.ripple(rng.uniform(2, 6), rng.uniform(6, 15), rng.uniform(0, 6))
        parts.append('ripple')
    if seed % 4 == 2:
        field.chips(rng.uniform(2, 6), rng.choice([-1, 1]) * rng.uniform(1, 4), rng.uniform(9, 14), rng.uniform(0, 9))
        parts.append('chips')
    if seed % 4 == 3:
        field.step(rng.choice([-1, 1]) * rng.uniform(3, 15), rng.uniform(.25, .75) * SIDE_MM[dpi])
        parts.append('step')
    return field, parts


def board_of(seed, kind, rough, dpi):
    rng = np.random.default_rng([seed, 12, KINDS.index(kind), int(rough)])
    columns = COLUMNS[dpi]
    if kind == 'plate':
        board = Board('dots', PITCH, columns, columns, missing=[(0, 0), (1, 0), (0, 1)])
        stretch = 1 + rng.normal(size=2) * U_PITCH / PITCH
        board.x, board.y = board.x * stretch[0], board.y * stretch[1]
        return board
    bend = Field((columns * PITCH, columns * PITCH)).smooth(3, 1.5, 2 * seed + rough + 500)
    return Board('dots', PITCH, columns, columns, ratio=rng.normal() * .002, shear=rng.normal() * .001, mark_um=1.5, seed=2 * seed + rough,
                 missing=[(0, 0), (1, 0), (0, 1)], bend=bend)


def scan_plate(folder, board, field, seed, number, turn, rough, rng, dpi):
    side = int(SIDE_MM[dpi] * dpi / 25.4)
    picture, _, _ = render(board, field, SIDE_MM[dpi] / 2 + rng.uniform(-1, 1, 2), turn + rng.uniform(-1, 1), (side, side), dpi, size=DOT_MM,
                           seed=100 * seed + number, rough=rough)
    path = os.path.join(folder, 'plate%d.png' % number)
    Image.fromarray(picture).save(path, dpi=(dpi, dpi), compress_level=1)
    return path


def gauge_weighted(points, moves, u, known):
    """Less shift and turn, and scale where no pitch is known, by weights 1 / u²: a place beside a seam has a large u."""
    middle = 0.5 * (points.min(0) + points.max(0))
    x, y = (points - middle).T
    n, zero = np.ones_like(x), np.zeros_like(x)
    columns = [np.r_[n, zero], np.r_[zero, n], np.r_[-y, x]] + ([] if known else [np.r_[x, y]])
    a, v, w = np.stack(columns, 1), np.r_[moves[:, 0], moves[:, 1]], 1 / np.r_[u[:, 0], u[:, 1]]
    v = v - a @ np.linalg.lstsq(a * w[:, None], v * w, rcond=None)[0]
    return np.stack([v[:len(x)], v[len(x):]], 1)


def judge_map(report, field, known):
    points = np.array([[p['x_mm'], p['y_mm']] for p in report['map']])
    told = np.array([[p['dx_um'], p['dy_um']] for p in report['map']])
    u = np.array([[p['u_dx_um'], p['u_dy_um']] for p in report['map']])
    true = 1000 * np.stack(field(points[:, 0], points[:, 1]), 1)
    error = gauge_weighted(points, told - true, u, known)
    found = [c['id'] for c in report['claims'] if c['verdict'] == 'found']
    return {'before_um': np.sqrt((gauge_free(points, true, known) ** 2).mean()), 'after_um': np.sqrt((error ** 2).mean()),
            'u_um': np.sqrt((u ** 2).mean()), 'coverage': (np.abs(error) < 2 * u).mean(), 'found': found}


def turned(points, known, wanted):
    """Shift, turn (and scale where no pitch is known) that lay the points on the wanted ones; the residual."""
    a, b = points - points.mean(0), wanted - wanted.mean(0)
    turn = (a[:, 0] + 1j * a[:, 1]).conj() @ (b[:, 0] + 1j * b[:, 1])
    scale = 1 if known else abs(turn) / (a ** 2).sum()
    c, s = scale * turn.real / abs(turn), scale * turn.imag / abs(turn)
    return a @ np.array([[c, s], [-s, c]]) - b


def opencv_map(report, field, known, dpi):
    """calibrateCamera on the same marks, in its best model: the map's error, um, and its time. The camera stands a metre away."""
    points = np.array([[p['x_mm'], p['y_mm']] for p in report['map']])
    true, mm = points + np.stack(field(points[:, 0], points[:, 1]), 1), 25.4 / dpi
    lattices, places = [], []
    for grid, scan in zip(report['grids'], report['inputs']):
        index = np.array([[m['column'], m['row'], 0] for m in grid['marks']], np.float32)
        lattices.append(index * PITCH)
        places.append(np.array([[m['x_mm'], m['y_mm']] for m in grid['marks']], np.float32)[:, None] / np.float32(mm))
    side = int(2 * places[0].mean())
    camera = np.array([[1000 / mm, 0, side / 2], [0, 1000 / mm, side / 2], [0, 0, 1.]])
    best, start = np.inf, time.time()
    for more in (0, cv2.CALIB_RATIONAL_MODEL, cv2.CALIB_THIN_PRISM_MODEL, cv2.CALIB_RATIONAL_MODEL | cv2.CALIB_THIN_PRISM_MODEL):
        flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_PRINCIPAL_POINT | more
        try:
            _, k, distortion, turns, shifts = cv2.calibrateCamera(lattices, places, (side, side), camera.copy(), None, flags=flags)
        except cv2.error:
            continue
        rays = cv2.undistortPoints(points[:, None] / mm, k, distortion)[:, 0]
        rays, r = np.c_[rays, np.ones(len(rays))], cv2.Rodrigues(turns[0])[0]
        origin, along = -r.T @ shifts[0][:, 0], rays @ r  # of the board's frame, whose plane is z = 0
        board = origin[:2] - origin[2] / along[:, 2:] * along[:, :2]
        best = min(best, 1000 * np.sqrt((turned(board, known, true) ** 2).mean()))
    return {'opencv_um': best, 'opencv_s': (time.time() - start) / 4}


def warp(picture, field, mm):
    """A pixel shows its place on the glass plus the field there."""
    rows, columns = np.arange(picture.shape[0], dtype=float)[:, None], np.arange(picture.shape[1], dtype=float)[None, :]
    dx, dy = field(columns * mm, rows * mm)
    at = [(rows + dy / mm).ravel(), (columns + dx / mm).ravel()]
    out = ndimage.map_coordinates(picture.astype(np.float32), at, order=3, mode='nearest').reshape(picture.shape)
    return np.clip(np.rint(out), 0, 255).astype(np.uint8)


def draw_foil(program, folder, seed, rough):
    rng = np.random.default_rng([seed, 13])
    foil = {'overall_radius_mm': 20.73 * (1 + rng.uniform(.002, .01)), 'rotate_deg': float(rng.uniform(-180, 180)),
            'radius_mm': [float(3.32 * (1.015 + .01 * rng.standard_normal())) for _ in range(9)]}
    scanner = {'dpi': FOIL_DPI, 'blur_px': 1.2, 'noise': 2.0}
    if rough:
        scanner['rough'] = {'edge_roughness_um': 1.5, 'edge_common_um': 0.8, 'correlation_um': 60}
    size = SIDE_MM[FOIL_DPI]
    foil['centre_mm'], side = [size / 2, size / 2], int(size * FOIL_DPI / 25.4)
    spec = {'schema': 'foilgauge/render/1', 'seed': seed, 'width_px': side, 'height_px': side, 'foils': [foil], 'scanner': scanner}
    path = os.path.join(folder, 'foil')
    with open(path + '.json', 'w') as out:
        json.dump(spec, out)
    done, _ = run(program, 'render', path + '.json', '-o', path + '.png', '--truth', path + '.truth')
    if done.returncode:
        raise SystemExit(done.stderr)
    truth = json.load(open(path + '.truth'))  # no form: its circles are the measurand
    return path + '.png', truth


def measure_foil(program, path, truth, *options):
    out = path + '.report'
    done, _ = run(program, 'measure', path, '-o', out, *options)
    if done.returncode in (64, 65, 74):
        return {'error': done.stderr.strip()[-200:]}
    foil = json.load(open(out))['foils'][0]
    errors = {'R0': [(1000 * (foil['overall']['radius_mm'] - truth['overall_radius_mm']), 1000 * foil['overall']['u_radius_mm'])],
              'R': [], 'h': []}
    for bump, r, h in [(b, t['radius_mm'], t['height_mm']) for b, t in zip(foil['bumps'], truth['bumps'])]:
        errors['R'].append((1000 * (bump['radius_mm'] - r), 1000 * bump['u_radius_mm']))
        errors['h'].append((1000 * (bump['height_mm'] - h), 1000 * bump['u_height_mm']))
    return errors


def foil_case(program, folder, field, seed, rough, model):
    path, truth = draw_foil(program, folder, seed, rough)
    warped = os.path.join(folder, 'warped.png')
    save(warp(np.asarray(Image.open(path)), field, 25.4 / FOIL_DPI), warped, FOIL_DPI)
    return {'perfect': measure_foil(program, path, truth), 'plain': measure_foil(program, warped, truth),
            'map': measure_foil(program, warped, truth, '--model', model)}


def one_case(program, seed, kind, rough, with_foil, peer):
    dpi = FOIL_DPI if with_foil else MAP_DPI
    field, parts = bed_of(seed, dpi)
    rng = np.random.default_rng([seed, 14, KINDS.index(kind), int(rough)])
    case = {'seed': seed, 'kind': kind, 'rough': rough, 'parts': parts, 'dpi': dpi}
    with tempfile.TemporaryDirectory() as folder:
        board, known = board_of(seed, kind, rough, dpi), kind == 'plate'
        paths = [scan_plate(folder, board, field, seed, i, turn, rough, rng, dpi) for i, turn in enumerate([0] if known else [0, 90])]
        stated = {'marks': 'dots', 'pitch_mm': PITCH}
        if known:
            stated['u_pitch_mm'] = U_PITCH
        model = os.path.join(folder, 'model.json')
        done, seconds = run(program, 'loop', *([] if known else ['--same-part', '--turned', '0,90']), *paths, '--design',
                            write_design(folder, **stated), '-o', os.path.join(folder, 'o.json'), '--model-out', model)
        if done.returncode or not os.path.exists(model):
            case['error'] = done.stderr.strip()[-200:]
            return case
        case.update(judge_map(json.load(open(os.path.join(folder, 'o.json'))), field, known), seconds=seconds)
        if peer:
            case['peer'] = opencv_map(json.load(open(os.path.join(folder, 'o.json'))), field, known, dpi)
        if with_foil:
            case['foil'] = foil_case(program, folder, field, seed, rough, model)
    return case


def read_cases(path):
    if not os.path.exists(path):
        return []
    with open(path) as text:
        return [json.loads(line) for line in text]


def work(options):
    there = {(c['seed'], c['kind'], c['rough'], c['dpi']) for c in read_cases(options.cases)}
    for seed in range(options.first, options.first + options.beds):
        wanted = [('plate', rough, True) for rough in (False, True)] if options.foils else [(k, r, False) for k in KINDS for r in (False, True)]
        for kind, rough, with_foil in wanted:
            if (seed, kind, rough, FOIL_DPI if with_foil else MAP_DPI) in there:
                continue
            case = one_case(options.program, seed, kind, rough, with_foil, options.peer)
            with open(options.cases, 'a') as out:
                out.write(json.dumps(case) + '\n')


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


def write_maps(cases, out):
    print('## Maps\n\n| scans | picture | beds | refused | before, µm | after, µm | u, µm | coverage of 2 u, % | s, median |\n'
          '|---|---|---:|---:|---:|---:|---:|---:|---:|', file=out)
    words = {'plate': 'plate of known pitch, one scan', 'board': 'printed board, two scans, turned by 90°'}
    for kind in KINDS:
        for rough in (False, True):
            every = [c for c in cases if c['kind'] == kind and c['rough'] == rough and c['dpi'] == MAP_DPI and 'peer' not in c]
            good = [c for c in every if 'error' not in c]
            if good:
                print('| %s | %s | %d | %d | %.1f | %.3f | %.3f | %.1f | %.1f |' % (
                    words[kind], 'rough' if rough else 'ideal', len(every), len(every) - len(good), rms([c['before_um'] for c in good]),
                    rms([c['after_um'] for c in good]), rms([c['u_um'] for c in good]), 100 * np.mean([c['coverage'] for c in good]),
                    np.median([c['seconds'] for c in good])), file=out)


def write_parts(cases, out):
    names = {'ripple': ('scan.carriage_ripple', 'scan.ripple_growth'), 'step': ('scan.row_step',), 'chips': ('scan.chip_tilt', 'scan.chip_gap')}
    good = [c for c in cases if 'error' not in c and c['dpi'] == MAP_DPI and 'peer' not in c]
    print('\n| beds with | maps | named | named on beds without | after, µm | coverage, % |\n|---|---:|---:|---:|---:|---:|', file=out)
    for part, ids in names.items():
        there = [c for c in good if part in c['parts']]
        other = [c for c in good if part not in c['parts']]
        if there:
            print('| %s | %d | %d | %d of %d | %.3f | %.1f |' % (
                part, len(there), sum(any(i in c['found'] for i in ids) for c in there), sum(any(i in c['found'] for i in ids) for c in other),
                len(other), rms([c['after_um'] for c in there]), 100 * np.mean([c['coverage'] for c in there])), file=out)
    smooth = [c for c in good if not c['parts'] or c['parts'] == ['keystone']]
    print('| smooth fields alone | %d | – | – | %.3f | %.1f |' % (
        len(smooth), rms([c['after_um'] for c in smooth]), 100 * np.mean([c['coverage'] for c in smooth])), file=out)


def write_peer(cases, out):
    good = [c for c in cases if 'peer' in c and np.isfinite(c['peer']['opencv_um'])]
    if not good:
        return
    print("\n## OpenCV on the same marks\n\n`calibrateCamera` gets the marks that the program found, and its best distortion model of four "
          '(5 numbers, rational, thin prism, both).\nIt is made for lenses; a scanner has a carriage.\n\n'
          '| scans | picture | maps | before, µm | program, µm | OpenCV, µm | times larger | OpenCV, s |\n|---|---|---:|---:|---:|---:|---:|---:|',
          file=out)
    for kind in KINDS:
        for rough in (False, True):
            own = [c for c in good if c['kind'] == kind and c['rough'] == rough]
            if own:
                after, peer = rms([c['after_um'] for c in own]), rms([c['peer']['opencv_um'] for c in own])
                print('| %s | %s | %d | %.1f | %.3f | %.2f | %.0f | %.2f |' % (
                    kind, 'rough' if rough else 'ideal', len(own), rms([c['before_um'] for c in own]), after, peer, peer / after,
                    np.median([c['peer']['opencv_s'] for c in own])), file=out)


def write_foils(cases, out):
    foils = [c for c in cases if 'foil' in c and all('error' not in c['foil'][k] for k in c['foil'])]
    if not foils:
        return
    print('\n## Foils through the map\n\nrms errors, µm, of the foil on a scanner without errors, on the bed without a model, and through '
          'the model of one scan of the\nplate; coverage of 2 u. The ratio is that of the map to the scanner without errors.\n'
          'R0 has the plate\'s own pitch, here uncertain by 8 ppm,\n'
          'which is 0.17 µm of it: no map is better than its plate. A seam between chips is known to the gap between two marks: a bump that '
          'lies across\none is moved by the part of it that is on the wrong side, and its u says so.\n\n'
          '| edges | beds | value | foils | no errors | coverage, % | bed, no model | coverage, % | through the map | coverage, % | ratio |\n'
          '|---|---|---|---:|---:|---:|---:|---:|---:|---:|---:|', file=out)
    for rough, chips in ((False, False), (False, True), (True, False), (True, True)):
        own = [c['foil'] for c in foils if c['rough'] == rough and ('chips' in c['parts']) == chips]
        for value in ('R0', 'R', 'h') if own else ():
            cells, last = [], {}
            for how in ('perfect', 'plain', 'map'):
                pairs = np.array([e for f in own for e in f[how][value]])
                last[how] = rms(pairs[:, 0])
                cells += ['%.3f' % last[how], '%.1f' % (100 * (np.abs(pairs[:, 0]) < 2 * pairs[:, 1]).mean())]
            print('| %s | %s | %s | %d | %s | %.2f |' % ('rough' if rough else 'ideal', 'with chips' if chips else 'without', value, len(own), ' | '.join(cells),
                                                   last['map'] / last['perfect']), file=out)


def write_page(cases, path):
    with open(path, 'w') as out:
        print('# Maps of a bed, and foils through them\n\n`/usr/bin/python3 tests/bench/grid_maps.py build/foilgauge maps.jsonl --beds 30`, '
              'the same with `foils.jsonl --beds 10 --first 100 --foils`\nand with `peers.jsonl --beds 8 --first 200 --peer`, then `cat maps.jsonl foils.jsonl peers.jsonl >all.jsonl` and\n'
              '`tests/bench/grid_maps.py build/foilgauge all.jsonl --beds 0 --out reports/grid_maps.md` make this page.\nBeds are %g mm wide '
              '(%g with a foil, at %d dpi), dots lie %g mm apart, %d dpi. Every bed has a wrong scale of each axis, a shear and\nsmooth '
              'random waves of 2 to 12 µm; half of them a keystone and a bow, a third a ripple, a quarter tilted chips with gaps, a '
              'quarter\na step of rows. A plate has the error of its stated pitch; a printed board a ratio, a shear, a bend of 3 µm and '
              'marks of 1.5 µm.\nErrors are those of `map`, less shift and turn (and scale where no pitch is known; by weights 1 / u²), along '
              'one axis, rms over all beds.\n' % (SIDE_MM[MAP_DPI], SIDE_MM[FOIL_DPI], FOIL_DPI, PITCH, MAP_DPI), file=out)
        write_maps(cases, out)
        write_parts(cases, out)
        write_foils(cases, out)
        write_peer(cases, out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program')
    parser.add_argument('cases')
    parser.add_argument('--beds', type=int, default=50)
    parser.add_argument('--first', type=int, default=0)
    parser.add_argument('--foils', action='store_true', help='plates at the resolution of foils, and a foil each')
    parser.add_argument('--peer', action='store_true', help="OpenCV's calibrateCamera on the same marks")
    parser.add_argument('--out')
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    work(options)
    if options.out:
        write_page(read_cases(options.cases), options.out)


if __name__ == '__main__':
    main()
