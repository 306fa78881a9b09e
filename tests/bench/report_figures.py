# SPDX-License-Identifier: GPL-3.0-or-later
"""The figure that matters of each page of reports/, read from the page by the rows of reports/figures.csv, and whether it keeps its goal.

A row's words hold a {} for each value. Values come of the rows of a table whose cells, joined by " | ", match `row`, in the columns named
(several with ;), in the page's part under the heading `section`; or of `pattern` in that part's text where no column is named; a pattern
beside columns picks a part of each cell. Without `take` the first row counts; sum, max, min go over the numbers of all rows that match;
share counts of all those rows the ones whose cell matches the pattern.
"""

import csv
import os
import re

FIELDS = ['page', 'figure', 'goal', 'file', 'section', 'row', 'columns', 'pattern', 'take']
NUMBER = re.compile(r'[-+−]?\d[\d,]*\.?\d*(?:e[-+]?\d+)?')
NONE = ('', '–', '-')  # what a cell says where nothing was measured


class Missing(Exception):
    """A row of figures.csv that finds nothing in its page."""


def number(text):
    """The first number of a text, None where there is none; thousands may be set apart by commas."""
    found = NUMBER.search(text)
    return float(found.group().replace(',', '').replace('−', '-')) if found else None


def cells(line):
    return [cell.strip().replace('\\|', '|') for cell in re.split(r'(?<!\\)\|', line.strip())[1:-1]]


def under(text, heading):
    """A page's part from a heading to the next one of its level, or above."""
    start = re.search(r'^(#+) ' + re.escape(heading) + r'[^\n]*\n', text, re.MULTILINE)
    if not start:
        raise Missing('no heading "%s"' % heading)
    end = re.compile(r'^#{1,%d} ' % len(start.group(1)), re.MULTILINE).search(text, start.end())
    return text[start.end():end.start() if end else len(text)]


def tables(text):
    """Every table of a page: its head and its rows."""
    found, lines = [], text.splitlines()
    for at, line in enumerate(lines):
        if line.startswith('|') and at + 1 < len(lines) and re.match(r'\|[-:| ]+\|$', lines[at + 1]):
            rows = []
            for row in lines[at + 2:]:
                if not row.startswith('|'):
                    break
                rows.append(cells(row))
            found.append((cells(line), rows))
    return found


def rows_of(text, is_csv, wanted, columns):
    """The named columns of every row that matches, of all tables that have them."""
    every = [list(csv.reader(text.splitlines()))] if is_csv else None
    every = [(every[0][0], every[0][1:])] if is_csv else tables(text)
    found = []
    for head, rows in every:
        if all(column in head for column in columns):
            places = [head.index(column) for column in columns]
            found += [[row[place] for place in places] for row in rows
                      if len(row) > max(places) and re.search(wanted, ' | '.join(row))]
    if not found:
        raise Missing('no row "%s" with %s' % (wanted, ', '.join('"%s"' % column for column in columns)))
    return found


def picked(cell, pattern):
    """A cell, or the groups of a pattern in it."""
    if cell in NONE:
        return ['–']
    if not pattern:
        return [cell.rstrip(' %') if number(cell) is not None else cell]
    found = re.search(pattern, cell)
    if not found:
        raise Missing('no "%s" in "%s"' % (pattern, cell))
    return list(found.groups() or [found.group()])


def shown(value):
    return '%d' % value if value == int(value) else '%g' % value


def taken(cell_rows, pattern, take):
    """Values of the rows that match, as texts."""
    if take == '':
        return [value for cell in cell_rows[0] for value in picked(cell, pattern)]
    if take == 'share':
        return [str(sum(1 for row in cell_rows if re.search(pattern, row[0]))), str(len(cell_rows))]
    over = {'sum': sum, 'max': max, 'min': min}[take]
    values = []
    for column in zip(*cell_rows):
        numbers = [number(picked(cell, pattern)[0]) for cell in column if cell not in NONE and not (pattern and not re.search(pattern, cell))]
        values.append(shown(over(one for one in numbers if one is not None)) if numbers else '–')
    return values


def values_of(row, folder):
    """The values that a row of figures.csv asks for."""
    name = row['file'] or row['page']
    with open(os.path.join(folder, name), encoding='utf-8') as stream:
        text = stream.read()
    if row['section']:
        text = under(text, row['section'])
    if row['columns']:
        columns = [column.strip() for column in row['columns'].split(';')]
        return taken(rows_of(text, name.endswith('.csv'), row['row'], columns), row['pattern'], row['take'])
    found = re.search(row['pattern'], text, re.MULTILINE)
    if not found:
        raise Missing('no "%s"' % row['pattern'])
    return [' '.join(group.split()) for group in found.groups()]


def keeps(said, value, goal):
    """Truth of "the value keeps its goal", None where they cannot be compared. A share "a of b" is held against a goal in percent."""
    share = re.search(r'(\d[\d,]*) (?:of|/) (\d[\d,]*)', said)
    if share and '%' in goal and number(share.group(2)):
        value = '%.9g' % (100 * number(share.group(1)) / number(share.group(2)))
    is_, limit = number(value), NUMBER.findall(goal)
    if is_ is None or not limit:
        return None
    limits = [number(one) for one in limit]
    if ' to ' in goal:
        return limits[0] <= is_ <= limits[1]
    return {'≤': is_ <= limits[0], '≥': is_ >= limits[0]}.get(goal[0], is_ == limits[0])


def figure(row, folder):
    """Words of a row, and its goal, with **missed** beside one that is not kept."""
    values = values_of(row, folder)
    if len(values) == 1:
        values *= row['figure'].count('{')
    try:
        said = row['figure'].format(*values)
    except IndexError:
        raise Missing('%d values for "%s"' % (len(values), row['figure'])) from None
    goal = row['goal']
    if goal and keeps(said, values[0], goal) is False:
        goal += ' **missed**'
    return said, goal


def read(folder):
    """Rows of figures.csv by page; nothing where there is no such file."""
    path, by_page = os.path.join(folder, 'figures.csv'), {}
    if os.path.exists(path):
        with open(path, newline='', encoding='utf-8') as stream:
            for row in csv.DictReader(stream):
                by_page.setdefault(row['page'], []).append(row)
    return by_page


def columns(rows, folder):
    """The cells `figure` and `goal` of a page, and what its rows do not find."""
    said, goals, missing = [], [], []
    for row in rows:
        try:
            one, goal = figure(row, folder)
        except (Missing, OSError) as error:
            missing.append('%s: figures.csv: "%s": %s' % (row['page'], row['figure'], error))
            continue
        said.append(one.replace('|', '\\|'))
        goals.append(goal or '–')
    if not any(goal != '–' for goal in goals):
        goals = []
    return '<br>'.join(said), '<br>'.join(goals), missing
