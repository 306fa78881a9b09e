# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules for rooms: who may include whom, as the floors in src/README.md say, and no circle of files."""

import os
import re
from collections import defaultdict

from offence import Offence

MAP = 'src/README.md'
ROOM = re.compile(r'([\w/]+)(?: \(([^)]*)\))?')
PUBLIC = 'foilgauge/'


class Floors:
    """The block of floors in the map: a line a floor, `room` or `room (the only rooms it uses)`."""

    def __init__(self, text):
        self.allowed, self.floor = {}, {}
        above = []
        for number, line in _block(text):
            rooms = ROOM.findall(line)
            for name, only in rooms:
                self.floor[name] = number
                named = [part.strip() for part in only.split(',') if part.strip()]
                has_list = '(' in line and re.search(re.escape(name) + r' \(', line)
                self.allowed[name] = set(named) - {'nothing'} if has_list else set(above)
                unknown = [room for room in self.allowed[name] if room not in above]
                if unknown:
                    raise ValueError('%s:%d: %s uses %s, which is on no floor above it' % (
                        MAP, number, name, ', '.join(unknown)))
            above += [name for name, _ in rooms]

    def reason(self, room, other):
        if other not in self.floor:
            return 'no room of %s' % MAP
        if self.floor[other] < self.floor[room]:
            return '%s uses %s alone' % (room, ', '.join(sorted(self.allowed[room])) or 'public headers')
        return '%s stands %s' % (other, 'on the same floor' if self.floor[other] == self.floor[room] else 'on a floor below')

    def room_of(self, path):
        """The listed room with the longest name that holds a path below src/."""
        folder = os.path.dirname(path)
        while folder and folder not in self.allowed:
            folder = os.path.dirname(folder)
        return folder or None


def _block(text):
    """The indented lines after the line that ends in `floors:`."""
    lines = text.split('\n')
    starts = [n for n, line in enumerate(lines) if line.rstrip().endswith('loors:')]
    if not starts:
        return
    for number, line in enumerate(lines[starts[0] + 1:], starts[0] + 2):
        if line.startswith('    '):
            yield number, line.strip()
        elif line.strip():
            return


def layers(tree):
    if not tree.exists(MAP):
        return
    floors = Floors(tree.text_of(MAP))
    if not floors.allowed:
        yield Offence(MAP, 1, 'no floors: the rooms in order, a line a floor, after a line that ends in "floors:"')
        return
    for file in tree.c_files('src', 'include'):
        folder, below = file.path.split('/', 1)
        room = floors.room_of(below) if folder == 'src' else None
        if folder == 'src' and not room:
            yield Offence(file.path, 1, 'a room that stands on no floor of %s' % MAP)
            continue
        for path, offset in file.includes:
            line = file.line_at(offset)
            if path.startswith(PUBLIC):
                continue
            if folder == 'include':
                yield Offence(file.path, line, 'a public header includes "%s": public headers alone' % path)
            elif not tree.exists('src/' + path):
                continue
            else:
                other = floors.room_of(path)
                if other != room and other not in floors.allowed[room]:
                    yield Offence(file.path, line, '%s includes "%s": %s' % (room, path, floors.reason(room, other)))


def _units(tree):
    """Units (a file and its header) and the units that each includes, with the line."""
    edges = defaultdict(dict)
    for file in tree.c_files('src'):
        unit = os.path.splitext(file.path)[0]
        for path, offset in file.includes:
            other = os.path.splitext('src/' + path)[0]
            if 'src/' + path in tree.by_path and other != unit:
                edges[unit].setdefault(other, (file.path, file.line_at(offset), path))
    return edges


def circles_of(edges):
    """Strongly connected sets of more than one unit."""
    order, low, stack, found = {}, {}, [], []

    def visit(unit):
        order[unit] = low[unit] = len(order)
        stack.append(unit)
        for other in edges.get(unit, ()):
            if other not in order:
                visit(other)
                low[unit] = min(low[unit], low[other])
            elif other in stack:
                low[unit] = min(low[unit], order[other])
        if low[unit] == order[unit]:
            at = stack.index(unit)
            if len(stack) - at > 1:
                found.append(sorted(stack[at:]))
            del stack[at:]

    for unit in sorted(edges):
        if unit not in order:
            visit(unit)
    return found


def circles(tree):
    edges = _units(tree)
    for members in sorted(circles_of(edges)):
        inner = [edges[a][b] for a in members for b in members if b in edges.get(a, ())]
        path, line, _ = inner[0]
        yield Offence(path, line, 'circle of %d files: %s (%s)' % (
            len(members), ', '.join(m[4:] for m in members),
            '; '.join('%s:%d includes "%s"' % (p[4:], n, i) for p, n, i in inner)))
