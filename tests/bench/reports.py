#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pages of reports/, each by its command in reports/README.md, and says there of which commit each page is.

usage: reports.py [--again] [NAME...] | --list | --check

NAME is a part of a page's name; without one, every page is made. A page that stands in reports/made.csv with the present commit is not
made again (--again: it is): an interrupted run goes on where it ended. So do benchmarks that keep a row for each input (those with an
option --fresh), where the run that was interrupted had the same commit; else they forget the rows of the program before. Commands of a
section whose numbers are times run alone, the others in pairs. What a command says goes to build/reports/. --list writes the columns
`made`, `figure` and `goal` anew; --check ends with 1 where a page is old by its sources and the column does not say so, where a row of
reports/figures.csv finds nothing in its page, and where the figure in the list is not the page's.
"""

import concurrent.futures
import csv
import datetime
import os
import re
import subprocess
import sys
import time

import report_figures

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
REPORTS = os.path.join(ROOT, 'reports')
LIST = os.path.join(REPORTS, 'README.md')
MADE = os.path.join(REPORTS, 'made.csv')
LOGS = os.path.join(ROOT, 'build', 'reports')
OLD = 0.10  # share of the lines of a page's rooms that have changed since it was made
INPUT = re.compile(r'\b([A-Z][A-Z_]{2,}(\.[a-z]+)?|[A-Z]\.png)\b')  # SCAN.png, FOLDER: what the caller has to bring


def git(*arguments):
    answer = subprocess.run(['git', '-C', ROOT, *arguments], capture_output=True, text=True, check=False)
    return answer.stdout if answer.returncode == 0 else None


class Page:
    """A row of the list: name, commands, the rooms of its section, whether it is made alone."""

    def __init__(self, name, commands, rooms, alone):
        self.name, self.commands, self.rooms, self.alone = name, commands, rooms, alone

    def needs(self):
        """Inputs of its commands that stand as words in capitals."""
        return sorted({found.group() for command in self.commands for found in INPUT.finditer(command)})

    def changed(self, commit):
        """Share of its rooms' lines that have changed since a commit; None where the commit is not known here."""
        paths = ['src/' + room for room in self.rooms]
        difference = git('diff', '--numstat', commit, '--', *paths)
        if difference is None:
            return None
        lines = sum(max(int(row.split()[0]), int(row.split()[1])) for row in difference.splitlines() if row[0] != '-')
        files = git('ls-files', '--', *paths).split()
        total = 0
        for path in files:
            with open(os.path.join(ROOT, path), 'rb') as stream:
                total += stream.read().count(b'\n')
        return lines / max(total, 1)


def cells(line):
    return [cell.strip() for cell in re.split(r'(?<!\\)\|', line.strip())[1:-1]]


def pages(text):
    """Every row that names a page and a command, in order."""
    rooms, alone, found = [], False, []
    for line in text.splitlines():
        if line.startswith('## '):
            rooms, alone = [], False
        sources = re.match(r'Rooms: ([a-z_, /]+)\.(.*)', line)
        if sources:
            rooms, alone = sources.group(1).split(', '), 'Made alone' in sources.group(2)
        row = cells(line) if line.startswith('| ') else []
        name = re.search(r'\]\(([^)]+)\)|^`([^`]+)`', row[0]) if len(row) > 2 else None
        if name and rooms:
            commands = re.findall(r'`([^`]+)`', row[2].replace('\\|', '|'))
            found.append(Page(name.group(1) or name.group(2), commands, rooms, alone))
    return found


def read_made():
    if not os.path.exists(MADE):
        return {}
    with open(MADE, newline='', encoding='utf-8') as stream:
        return {row['page']: row for row in csv.DictReader(stream)}


def write_made(made):
    with open(MADE + '.tmp', 'w', newline='', encoding='utf-8') as stream:
        writer = csv.DictWriter(stream, ['page', 'commit', 'date', 'minutes'], lineterminator='\n')
        writer.writeheader()
        writer.writerows(made[name] for name in sorted(made))
    os.replace(MADE + '.tmp', MADE)


def said_of(page, made):
    """Text of the column `made`."""
    row = made.get(page.name)
    if not row or not page.commands:
        return ''
    said = '%s, `%s`' % (row['date'], row['commit'])
    if row['minutes']:
        said += ', %s min' % row['minutes']
    changed = page.changed(row['commit'])
    return said + (', **old**' if changed is not None and changed > OLD else '')


def row_of(page, text):
    return next(line for line in text.splitlines() if '](%s)' % page.name in line or line.startswith('| `%s`' % page.name))


def listed(text, made, figures):
    """The list with the columns `made`, `figure` and `goal` as they should be."""
    by_name = {page.name: page for page in pages(text)}
    lines, inside = [], False
    for line in text.splitlines():
        row = cells(line) if line.startswith('|') else []
        if row[:1] == ['page'] and 'command' in row:
            inside = True
            line = '| page | what it shows | command | made | figure | goal |'
        elif inside and row and set(row[0]) <= set('-:'):
            line = '|---|---|---|---|---|---|'
        elif inside and row:
            name = re.search(r'\]\(([^)]+)\)|^`([^`]+)`', row[0])
            page = by_name.get(name.group(1) or name.group(2)) if name else None
            said, goals, _ = report_figures.columns(figures.get(page.name, []) if page else [], REPORTS)
            line = '| %s |' % ' | '.join(row[:3] + [said_of(page, made) if page else '', said, goals])
            line = line.replace('|  |', '| |').replace('|  |', '| |')
        else:
            inside = inside and not line.startswith('## ')
        lines.append(line)
    return '\n'.join(lines) + '\n'


def keeps_rows(command):
    """True where its benchmark keeps the rows of a run before, unless it is told not to."""
    script = next((word for word in command.split() if word.endswith('.py')), None)
    if not script or '--fresh' in command:
        return False
    told = subprocess.run(['python3', script, '--help'], cwd=ROOT, capture_output=True, text=True, check=False)
    return '--fresh' in told.stdout


def begins_anew(log, commit):
    """True where no run of this commit was interrupted; from here on there is one."""
    mark = log + '.begun'
    if os.path.exists(mark):
        with open(mark, encoding='utf-8') as stream:
            if stream.read() == commit:
                return False
    with open(mark, 'w', encoding='utf-8') as stream:
        stream.write(commit)
    return True


def make(page, commit):
    """Runs a page's commands; minutes, or None where one failed."""
    log = os.path.join(LOGS, page.name.replace('/', '_') + '.log')
    start, anew = time.monotonic(), begins_anew(log, commit)
    with open(log, 'w', encoding='utf-8') as stream:
        for command in page.commands:
            if command.split()[0].endswith('.py'):
                command = 'python3 ' + command
            if anew and keeps_rows(command):
                command += ' --fresh'
            if subprocess.run(['bash', '-c', command], cwd=ROOT, stdout=stream, stderr=subprocess.STDOUT, check=False).returncode:
                print('%s: failed, see %s' % (page.name, os.path.relpath(log, ROOT)), flush=True)
                return None
    os.remove(log + '.begun')
    minutes = (time.monotonic() - start) / 60
    print('%s: made in %.1f min' % (page.name, minutes), flush=True)
    return minutes


def make_all(wanted, made, again):
    commit = git('rev-parse', '--short=8', 'HEAD').strip()
    if git('status', '--porcelain', '--', 'src', 'include').strip():
        commit += '+'
    date = datetime.date.today().isoformat()
    os.makedirs(LOGS, exist_ok=True)
    todo, failed = {}, 0
    for page in wanted:
        if page.needs():
            print('%s: left out, its command needs %s' % (page.name, ', '.join(page.needs())))
        elif not again and made.get(page.name, {}).get('commit') == commit and made[page.name]['minutes']:
            print('%s: is of %s' % (page.name, commit))
        elif page.commands:
            todo.setdefault(tuple(page.commands), []).append(page)
    for alone in (False, True):
        groups = [group for group in todo.values() if group[0].alone == alone]
        with concurrent.futures.ThreadPoolExecutor(1 if alone else 2) as pool:
            work = {pool.submit(make, group[0], commit): group for group in groups}
            for done in concurrent.futures.as_completed(work):
                minutes = done.result()
                failed += minutes is None
                for page in work[done] if minutes is not None else []:
                    made[page.name] = {'page': page.name, 'commit': commit, 'date': date, 'minutes': '%.1f' % minutes}
                write_made(made)
    return failed


def figures_wrong(text, figures):
    """Faults of the figures in the list: rows of figures.csv without a page or that find nothing, cells that the page does not say."""
    wrong, by_name = [], {page.name: page for page in pages(text)}
    for name, rows in figures.items():
        if name not in by_name:
            wrong.append('reports/figures.csv: %s is no page of reports/README.md' % name)
            continue
        said, goals, missing = report_figures.columns(rows, REPORTS)
        wrong += ['reports/' + one for one in missing]
        if not missing and cells(row_of(by_name[name], text))[4:6] != [said, goals]:
            wrong.append('reports/%s says "%s", and its row in reports/README.md does not: tests/reports.sh --list' % (name, said))
    return wrong


def check(text, made, figures):
    """Faults of the list, printed: 1 where there are some, 77 where there is no history to compare with."""
    wrong = figures_wrong(text, figures)
    known = git('rev-parse', 'HEAD') is not None
    for page in pages(text) if known else []:
        if '**old**' in said_of(page, made) and '**old**' not in row_of(page, text):
            wrong.append('reports/%s: its sources have changed, and its row does not say **old**: tests/reports.sh %s, or --list' %
                         (page.name, page.name))
    for one in wrong:
        print(one)
    return 1 if wrong else 0 if known else 77


def main():
    with open(LIST, encoding='utf-8') as stream:
        text = stream.read()
    made, figures, arguments = read_made(), report_figures.read(REPORTS), sys.argv[1:]
    if arguments == ['--check']:
        return check(text, made, figures)
    failed = 0
    if arguments != ['--list']:
        names = [word for word in arguments if word != '--again']
        wanted = [page for page in pages(text) if not names or any(name in page.name for name in names)]
        if not wanted:
            print('no page of reports/README.md is named so', file=sys.stderr)
            return 64
        failed = make_all(wanted, made, '--again' in arguments)
    with open(LIST + '.tmp', 'w', encoding='utf-8') as stream:
        text = listed(text, made, figures)
        stream.write(text)
    os.replace(LIST + '.tmp', LIST)
    wrong = figures_wrong(text, figures)
    for one in wrong:
        print(one)
    return 1 if failed or wrong else 0


if __name__ == '__main__':
    sys.exit(main())
