#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids against known truth: tests/bench/grid.py build/foilgauge reports/grid.md writes the page.
Maps of a bed: grid_maps.py.

Pictures are of a second renderer (other_grid.py), which shares no code with the program. Needs numpy, scipy, opencv, pillow."""
import json
import os
import subprocess
import sys
import tempfile
import time

import cv2
import numpy as np
from PIL import Image

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from other_grid import Board, Field, render, _mark, _phi  # noqa: E402

NOISE, LIGHT, DARK, BLUR = 2., 220., 45., 1.2


def run(program, *arguments):
    start = time.time()
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    return done, time.time() - start


def write_design(folder, **members):
    path = os.path.join(folder, 'design.json')
    with open(path, 'w') as out:
        json.dump(dict({'schema': 'foilgauge/design/1', 'form': 'grid'}, **members), out)
    return path


def save(picture, path, dpi):
    Image.fromarray(picture).save(path, dpi=(dpi, dpi))


def bound_px(kind, size, pitch, mm):
    """Cramer-Rao bound of a mark's place along x by its pixels; of a corner in a disc of 48 px or 0.4 squares."""
    s, e = BLUR * mm, 1e-3 * mm
    half = int(0.5 * pitch / mm)
    x, y = np.meshgrid(np.arange(-half, half + 1) * mm, np.arange(-half, half + 1) * mm)

    def share(dx):
        if kind == 'chessboard':
            return 0.5 + 2 * (_phi((x - dx) / s) - 0.5) * (_phi(y / s) - 0.5)
        return _mark(kind, x - dx, y, size, s)
    slope = (LIGHT - DARK) * (share(e) - share(-e)) / (2 * e / mm)
    if kind == 'chessboard':
        slope = slope[np.hypot(x, y) <= min(48 * mm, 0.4 * pitch)]
    return NOISE / np.sqrt((slope ** 2).sum())


def match(found, truth):
    distance = np.linalg.norm(found[:, None] - truth[None], axis=2)
    return found - truth[distance.argmin(1)]


def rms_about_mean(error):
    return np.sqrt(((error - error.mean(0)) ** 2).mean())


def peers_of(kind, picture, truth, rng):
    if kind == 'chessboard':
        start = (truth + rng.normal(size=truth.shape)).astype(np.float32)[:, None]
        best = {}
        for window in (5, 11, 21):
            end = cv2.cornerSubPix(picture, start.copy(), (window, window), (-1, -1), (3, 100, 1e-4))[:, 0]
            best[window] = rms_about_mean(end - truth)
        window = min(best, key=best.get)
        return 'cornerSubPix, best of three windows (%d)' % window, best[window]
    if kind == 'dots':
        parameters = cv2.SimpleBlobDetector_Params()
        parameters.minArea, parameters.maxArea = 50, 1e6
        points = np.array([k.pt for k in cv2.SimpleBlobDetector_create(parameters).detect(picture)])
        if len(points):
            return "findCirclesGrid's blobs", rms_about_mean(match(points, truth))
    return 'none', np.nan


def marks(program, folder):
    """Every kind of mark, ideal and rough."""
    dpi, rows = 1200, []
    mm = 25.4 / dpi
    for kind, size, pitch in (('dots', 0.6, 2.5), ('dots', 0.25, 1.0), ('chessboard', None, 3.0), ('crosses', (0.8, 0.1), 2.5)):
        for rough in (False, True):
            board = Board(kind, pitch, 12, 14, missing=[(0, 0), (1, 0)])
            picture, mx, my = render(board, Field((45, 45)), (21, 21), 3.0, (2000, 2000), dpi, size=size, seed=len(rows), rough=rough)
            path = os.path.join(folder, 'marks.png')
            save(picture, path, dpi)
            done, _ = run(program, 'measure', path, '--design', write_design(folder, marks=kind), '-o', os.path.join(folder, 'o.json'))
            if done.returncode:
                raise SystemExit(done.stderr)
            grid = json.load(open(os.path.join(folder, 'o.json')))['grid']
            found = np.array([[m['x_mm'], m['y_mm']] for m in grid['marks']]) / mm
            truth = np.stack([mx, my], 1)
            error = match(found, truth)
            error -= error.mean(0)  # a one-sided blur moves all marks alike
            u = np.array([m['u_um'] for m in grid['marks']]) / 1000 / mm
            peer, peer_rms = peers_of(kind, picture, truth, np.random.default_rng(1))
            rows.append((kind, pitch, 'rough' if rough else 'ideal', len(found), len(truth), np.sqrt((error ** 2).mean()),
                         np.nan if rough else bound_px(kind, size, pitch, mm), 100 * (np.abs(error) < 2 * u[:, None]).mean(), peer, peer_rms))
    return rows


def gauge_free(points, moves, known):
    """Less shift and turn, and scale where no pitch is known."""
    middle = 0.5 * (points.min(0) + points.max(0))
    x, y = (points - middle).T
    n, zero = np.ones_like(x), np.zeros_like(x)
    columns = [np.r_[n, zero], np.r_[zero, n], np.r_[-y, x]] + ([] if known else [np.r_[x, y]])
    a, v = np.stack(columns, 1), np.r_[moves[:, 0], moves[:, 1]]
    v = v - a @ np.linalg.lstsq(a, v, rcond=None)[0]
    return np.stack([v[:len(x)], v[len(x):]], 1)


def a4_time(program, folder):
    dpi = 1200
    board = Board('dots', 5.0, 40, 57)
    picture, _, _ = render(board, Field((210, 297)), (105, 148.5), 0.3, (9921, 14031), dpi, size=1.0)
    path = os.path.join(folder, 'a4.png')
    Image.fromarray(picture).save(path, dpi=(dpi, dpi), compress_level=1)
    design = write_design(folder, marks='dots', pitch_mm=5)
    times = []
    for _ in range(3):
        start = os.times()
        done, wall = run(program, 'measure', path, '--design', design, '-o', os.path.join(folder, 'o.json'))
        end = os.times()
        times.append((wall, end.children_user + end.children_system - start.children_user - start.children_system))
    grid = json.load(open(os.path.join(folder, 'o.json')))['grid'] if done.returncode == 0 else {'mark_count': 0}
    return min(t[0] for t in times), min(t[1] for t in times), grid['mark_count'], len(board.x)


def main():
    program, page = os.path.abspath(sys.argv[1]), sys.argv[2]
    with tempfile.TemporaryDirectory() as folder, open(page + '.part', 'w', buffering=1) as out:
        print('# Grids\n\n`/usr/bin/python3 tests/bench/grid.py build/foilgauge reports/grid.md` writes this page. Pictures are of a '
              'second renderer\n(`tests/bench/other_grid.py`), which shares no code with the program: 8 bit, noise 2 of 175 counts of '
              'contrast, blur 1.2 px;\nrough ones have correlated noise of twice the size, shading and a one-sided blur. Maps of a bed, '
              'and foils through them: [grid_maps.md](grid_maps.md).\n', file=out)
        print('## Marks\n\nrms error of a mark along one axis, px at 1200 dpi, less the mean over the marks; the bound is that of '
              'Cramér and Rao for\nthe pixels of the mark (of a corner within 48 px); coverage of 2 u. A peer whose error is less than three '
              'bounds cannot\nbe beaten by three: the dots are at their bound.\n', file=out)
        print('| marks | pitch, mm | picture | found | error, px | bound, px | error / bound | coverage, % | peer | its error, px | times '
              'larger |\n|---|---:|---|---:|---:|---:|---:|---:|---|---:|---:|', file=out)
        for k, pitch, how, found, there, rms, bound, cover, peer, peer_rms in marks(program, folder):
            print('| %s | %.1f | %s | %d of %d | %.5f | %s | %s | %.1f | %s | %s | %s |' % (
                k, pitch, how, found, there, rms, '%.5f' % bound if bound == bound else '–',
                '%.2f' % (rms / bound) if bound == bound else '–', cover, peer, '%.5f' % peer_rms if peer_rms == peer_rms else '–',
                '%.1f' % (peer_rms / rms) if peer_rms == peer_rms else '–'), file=out, flush=True)
        wall, cpu, found, there = a4_time(program, folder)
        print('\n## Time\n\n`measure` of an A4 bed at 1200 dpi (139 Mpx, %d dots of 5 mm pitch, %d found): %.1f s of wall time, %.1f s '
              'of processor time, best of\nthree, on a machine of two cores that was busy with other work.' % (there, found, wall, cpu), file=out)
    os.rename(page + '.part', page)


if __name__ == '__main__':
    main()
