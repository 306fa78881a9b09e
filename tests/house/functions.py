# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules for functions and files: names of static functions, callers, sizes, kinds of foil."""

import fnmatch
import os
import re
from collections import defaultdict

from offence import Offence

STATIC_NAME_FILES = 3
# Verbs that say nothing without their object.
BARE_VERBS = frozenset((
    'accept add append apply ask build check choose collect count do draw fill find get give go handle hold join judge keep list load look '
    'make move note open parse place publish push put read receive report run save say score search see set show start '
    'stop store take tell test try turn walk work write').split())
SHORT_FILE = 40
LONG_FILE = 500
LONG_FUNCTION = 60
# Rows of tables and files that cannot be joined to others.
SHORT_FILES_ALLOWED = (
    ('src/cli/cmd_*.c', 'one command per file'),
    ('src/station/page_*.c', 'one page per file'),
    ('src/quantity/of_*.c', 'one owner of quantities per file'),
    ('src/bearing/*_model.c', 'one model per file'),
    ('src/cli/main.c', 'the program'),
    ('src/manual/main.c', 'the program'),
    ('src/*/embedded*.h', 'made by the build'),
)
# Doors for tests, which nobody else goes through.
TEST_DOORS = {
    'fg_formats': 'every format is tried',
    'fg_png_open_reference': 'libpng alone, to compare the own reader with',
    'fg_scan_loop_run_measured': 'the loop without files',
    'fg_tiles_add_strip': 'tiles of a picture in memory',
}
KIND = re.compile(r'FG_(?:FORM|FOIL|FOIL_KIND)_(?:CLASSICAL|SINUSOIDAL|ARC|CANTILEVER|DISCS)$|'
                  r'fg_(?:form|foil_kind)_has_bumps$')
EXTERNAL_CLONE = re.compile(r'__attribute__\(\(target_clones\([^)]*\)\)\)\s+(?!static\b)')
# A kind of foil is a row of these, or a file of its own.
KIND_TABLES = (
    'include/foilgauge/design.h', 'src/geometry/foil_kind*', 'src/*/foil_kind*', 'src/report/measure/foil_view*',
    'src/report/*/foil_view*', 'src/*/kind_*',
)


def _static_functions(tree):
    named = defaultdict(list)
    for file in tree.c_files('src'):
        for function in file.functions:
            if function.is_static:
                named[function.name].append(function)
    return named


def repeated_static_names(tree):
    for name, functions in _static_functions(tree).items():
        files = len({f.file.path for f in functions})
        if files > STATIC_NAME_FILES:
            for function in functions:
                yield Offence(function.file.path, function.line,
                              '`%s` is static in %d files: say the object too' % (name, files))


def bare_verbs(tree):
    for name, functions in _static_functions(tree).items():
        if name in BARE_VERBS:
            for function in functions:
                yield Offence(function.file.path, function.line, '`%s`: verb and object (`%s_…`)' % (name, name))


class Callers:
    """Functions with external linkage, each with the files that mention it."""

    def __init__(self, tree):
        self.functions = {f.name: f for file in tree.c_files('src') for f in file.functions
                          if not f.is_static and f.name != 'main'}
        self.users = defaultdict(set)
        self.public = {}
        for file in tree.c_files('src', 'include', 'tests'):
            for name in self.functions.keys() & file.identifiers.keys():
                declared = (name in file.prototypes) + (self.functions[name].file is file)
                if len(file.identifiers[name]) > declared:
                    self.users[name].add(file.path)
            if file.path.startswith('include/'):
                self.public.update({name: name in file.documented for name in file.prototypes})


def uncalled_functions(tree):
    callers = tree.once(Callers)
    for name, function in callers.functions.items():
        users = callers.users[name]
        if any(path.startswith(('src/', 'include/')) for path in users) or callers.public.get(name) or \
                name in TEST_DOORS:
            continue
        yield Offence(function.file.path, function.line, '`%s` is called by %s: remove it' % (
            name, 'tests alone' if users else 'nobody'))


def functions_without_caller(tree):
    """Public ones as well."""
    callers = tree.once(Callers)
    return [name for name in callers.functions
            if not any(p.startswith(('src/', 'include/')) for p in callers.users[name])]


def functions_of_one_file(tree):
    callers = tree.once(Callers)
    return [name for name, function in callers.functions.items()
            if len([p for p in callers.users[name] if p.startswith('src/') and p != function.file.path]) == 1]


def _unit_lines(tree, path):
    """Lines of a file and of its header or source beside it."""
    stem = os.path.splitext(path)[0]
    return sum(tree.by_path[stem + end].lines for end in ('.c', '.h', '.cpp') if stem + end in tree.by_path)


def files_under(tree, limit=SHORT_FILE):
    return [file for file in tree.c_files('src') if file.path.endswith(('.c', '.h')) and file.lines < limit]


def short_files(tree):
    for file in tree.c_files('src'):
        if _unit_lines(tree, file.path) >= SHORT_FILE:
            continue
        if any(fnmatch.fnmatch(file.path, pattern) for pattern, _ in SHORT_FILES_ALLOWED):
            continue
        yield Offence(file.path, 1, '%d lines with the file beside it: join it to its neighbour' %
                      _unit_lines(tree, file.path))


def long_files(tree):
    for file in tree.c_files('src', 'include', 'tests'):
        if file.lines > LONG_FILE:
            yield Offence(file.path, 1, '%d lines: cut it' % file.lines)


def external_clones(tree):
    for file in tree.c_files('src'):
        for clone in EXTERNAL_CLONE.finditer(file.text):
            yield Offence(file.path, file.text.count('\n', 0, clone.start()) + 1,
                          'clang does not link it: clone a static function, and call that')


def long_functions(tree):
    for file in tree.c_files('src'):
        for function in file.functions:
            if function.length > LONG_FUNCTION:
                yield Offence(file.path, function.line, '`%s` has %d lines: cut it' % (function.name, function.length))


def function_lengths(tree):
    return sorted(f.length for file in tree.c_files('src') for f in file.functions)


def kind_mentions(tree):
    """One offence for each line that tells kinds of foil apart outside their tables."""
    for file in tree.c_files('src', 'include'):
        if any(fnmatch.fnmatch(file.path, pattern) for pattern in KIND_TABLES):
            continue
        lines = defaultdict(set)
        for name, offsets in file.identifiers.items():
            if KIND.match(name):
                for offset in offsets:
                    if not (name in file.prototypes and offset == file.prototypes[name]):
                        lines[file.line_at(offset)].add(name)
        for line, names in sorted(lines.items()):
            yield Offence(file.path, line, '%s: ask the row of the kind' % ', '.join('`%s`' % n for n in sorted(names)))
