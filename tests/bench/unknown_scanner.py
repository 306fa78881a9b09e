#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scans of a scanner of which nothing is known, through measure, lot and station: no PASS may be printed without its
basis. Writes reports/unknown_scanner.md.

/usr/bin/python3 tests/bench/unknown_scanner.py build/foilgauge [--out reports/unknown_scanner.md] [--scans 40]
Every scan is judged against limits that it keeps by far, under designs that say nothing of the scanner, that state a calibration,
that take the default of a flatbed, or that need none for a reason."""
import argparse
import glob
import json
import os
import re
import sqlite3
import subprocess
import tempfile

BASES = {
    'nothing is stated': (None, ()),
    '"calibration": "flatbed"': ('flatbed', ('stated',)),
    'a stated scale': ({'scale': {'u_rel': 1e-5}}, ('stated',)),
    'not needed, with a reason': ('not needed: the scan is rendered', ('the scan is rendered', 'not needed')),
}
FORMS = ({}, {'bump_count': 4}, {'form': 'sinusoidal'},
         {'form': 'arc', 'overall_radius_mm': 20.73, 'subtended_angle_deg': 110, 'thickness_mm': 0.1},
         {'form': 'cantilever', 'beam_length_mm': 9, 'beam_width_mm': 3, 'thickness_mm': 0.1})
LIMITS = {'cantilever': {'length_mm': {'min': 0.01, 'max': 90}}, 'arc': {'overall.radius_mm': {'min': 1, 'max': 90}}}
# A count of no PASS, and the sentence that defines the word, are none.
NO_PASS = re.compile(r'\b0 pass\b|"pass": 0\b|[Ff]oils pass\s+0\b|[^.]*passes when[^.]*\.')
PASS = re.compile(r'\bPASS(?:ED)?\b|\bpass(?:es|ed)?\b|within tolerance|conforming', re.I)


def run(*arguments):
    return subprocess.run(arguments, capture_output=True, text=True)


def render(program, folder, count):
    paths = []
    for i in range(count):
        form = FORMS[i % len(FORMS)]
        spec = {'schema': 'foilgauge/render/1', 'seed': i, 'scanner': {'dpi': 1200, 'noise': 1.5, 'background': 30},
                'foils': [{'design': form, 'rotate_deg': -90 if form.get('form') != 'cantilever' else 0}]}
        path = os.path.join(folder, 'scan_%02d' % i)
        with open(path + '.json', 'w') as out:
            json.dump(spec, out)
        done = run(program, 'render', path + '.json', '-o', path + '.png')
        if done.returncode:
            raise SystemExit(done.stderr)
        paths.append((path + '.png', form))
    return paths


def design_of(form, calibration):
    design = dict({'schema': 'foilgauge/design/1'}, **form)
    design['tolerances'] = LIMITS.get(form.get('form'), {'radius_mm': {'min': 0.1, 'max': 90}})
    if calibration is not None:
        design['calibration'] = calibration
    return design


def verdicts_of(report):
    """All verdicts in a JSON report."""
    found = []

    def walk(value):
        if isinstance(value, dict):
            found.extend([v for k, v in value.items() if k == 'verdict' and isinstance(v, str)])
            for v in value.values():
                walk(v)
        elif isinstance(value, list):
            for v in value:
                walk(v)
    walk(report)
    return found


def text_of(path):
    text = open(path, encoding='utf-8', errors='replace').read()
    if path.endswith('.html'):
        text = re.sub(r'<style.*?</style>|<script.*?</script>', ' ', text, flags=re.S)
        text = re.sub(r'<[^>]*>', ' ', text)
    return text


def judge(files, basis):
    """Outputs with a PASS, and those of them without its basis."""
    passes = [f for f in files if PASS.search(NO_PASS.sub(' ', f[1]))]
    return len(passes), [f[0] for f in passes if not any(b in f[1] for b in basis)]


def through_measure(program, folder, scans, calibration):
    files, codes, verdicts = [], {}, {}
    for path, form in scans:
        design = os.path.join(folder, 'design.json')
        with open(design, 'w') as out:
            json.dump(design_of(form, calibration), out)
        names = {k: os.path.join(folder, 'm.' + k) for k in ('json', 'csv', 'html')}
        for name in names.values():
            if os.path.exists(name):
                os.remove(name)
        done = run('script', '-qec', ' '.join([program, 'measure', path, '--design', design, '-o', names['json'], '--csv', names['csv'], '--html',
                                               names['html']]), '/dev/null')
        codes[done.returncode] = codes.get(done.returncode, 0) + 1
        for verdict in verdicts_of(json.load(open(names['json']))):
            verdicts[verdict] = verdicts.get(verdict, 0) + 1
        files.append(('terminal of ' + os.path.basename(path), done.stdout))
        files += [(k + ' of ' + os.path.basename(path), text_of(n)) for k, n in names.items()]
    return files, codes, verdicts


def through_lot(program, folder, scans, calibration):
    files, codes, verdicts = [], {}, {}
    for k, form in enumerate(FORMS):
        own = [p for p, f in scans if f == form]
        recipe, out_folder = os.path.join(folder, 'recipe.json'), os.path.join(folder, 'lot%d' % k)
        with open(recipe, 'w') as out:
            json.dump({'schema': 'foilgauge/recipe/1', 'design': design_of(form, calibration)}, out)
        done = run(program, 'lot', *own, '--recipe', recipe, '-o', out_folder)
        codes[done.returncode] = codes.get(done.returncode, 0) + 1
        files.append(('terminal of the lot', done.stdout + done.stderr))
        for path in glob.glob(out_folder + '*') + glob.glob(out_folder + '/**', recursive=True):
            if path.endswith(('.html', '.json', '.csv', '.qif', '.dfq', '.txt')):
                files.append((os.path.relpath(path, folder), text_of(path)))
            if path.endswith('lot.json'):
                for verdict in verdicts_of(json.load(open(path))):
                    verdicts[verdict] = verdicts.get(verdict, 0) + 1
    return files, codes, verdicts


def through_station(program, folder, scans, calibration):
    watched, recipe = os.path.join(folder, 'in'), os.path.join(folder, 'station.json')
    os.makedirs(watched)
    form = FORMS[0]
    for path, own in scans:
        if own == form:
            os.link(path, os.path.join(watched, os.path.basename(path)))
    with open(recipe, 'w') as out:
        json.dump({'schema': 'foilgauge/recipe/1', 'station': {'file_name': '{serial}'}, 'design': design_of(form, calibration)}, out)
    done = run(program, 'station', watched, '--recipe', recipe, '--once')
    rows = sqlite3.connect(os.path.join(watched, 'foilgauge.sqlite')).execute('SELECT path, withheld FROM scans').fetchall()
    withheld = sum(r[1] is not None for r in rows)
    return [('terminal of the station', done.stdout + done.stderr)], {done.returncode: 1}, {'withheld': withheld, 'judged': len(rows) - withheld}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program')
    parser.add_argument('--out', default='reports/unknown_scanner.md')
    parser.add_argument('--scans', type=int, default=40)
    options = parser.parse_args()
    program, rows, unfounded = os.path.abspath(options.program), [], []
    with tempfile.TemporaryDirectory() as folder:
        scans = render(program, folder, options.scans)
        for words, (calibration, basis) in BASES.items():
            for name, through in (('measure', through_measure), ('lot', through_lot), ('station', through_station)):
                inner = os.path.join(folder, name + str(len(rows)))
                os.makedirs(inner)
                files, codes, verdicts = through(program, inner, scans, calibration)
                passes, wrong = judge(files, basis)
                unfounded += ['%s, %s: %s' % (words, name, w) for w in wrong]
                rows.append((words, name, ', '.join('%d × %d' % (n, c) for c, n in sorted(codes.items())),
                             ', '.join('%s %d' % v for v in sorted(verdicts.items())), len(files), passes, len(wrong)))
    with open(options.out, 'w') as out:
        print('# Scans of an unknown scanner\n\n`/usr/bin/python3 tests/bench/unknown_scanner.py build/foilgauge` makes this page: %d rendered '
              'scans of five kinds of foil, each far within its limits,\nthrough `measure` (terminal, JSON, CSV, page), `lot` (all its files, '
              'QIF, DFQ) and `station` (those of the first kind). An output with a PASS must say what it\nrests on: the traceability `stated`, '
              'or the reason why no calibration is needed. Exit codes are number × code.\n' % options.scans, file=out)
        print('| the design says | through | exit codes | verdicts | outputs | with a PASS | of them without a basis |\n|---|---|---|---|---:|---:|---:|',
              file=out)
        for row in rows:
            print('| %s | %s | %s | %s | %d | %d | %d |' % row, file=out)
    for line in unfounded:
        print(line)
    raise SystemExit(bool(unfounded))


if __name__ == '__main__':
    main()
