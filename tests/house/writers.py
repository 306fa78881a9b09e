# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules for writers: members of JSON and tables of pages come from rows of members (core/member.h)."""

import re

from offence import Offence

# The walkers themselves, and the writer beneath them.
WALKERS = ('src/core/member_json.c', 'src/core/json_writer.c', 'src/core/json_writer.h', 'src/manual/schema.c')
MEMBER = re.compile(r'\bfg_json_(?:number|integer|bool|string|numbers|strings|file|of)\(\s*[^,();]*(?:\([^()]*\))?\s*,\s*"[^"]*"')
COMMENT = re.compile(r'/\*[^\n]*?\*/')
TABLE = re.compile(r'<table')
TABLES = ('src/page/table.c',)


def _sources(tree, left_out):
    return (f for f in tree.files if f.path.startswith('src/') and f.path.endswith('.c') and f.path not in left_out)


def literal_members(tree):
    """Calls that write a member under a name of their own, outside the rows."""
    for file in _sources(tree, WALKERS):
        for found in MEMBER.finditer(COMMENT.sub(lambda c: ' ' * len(c[0]), file.text)):
            yield Offence(file.path, file.line_at(found.start()), 'a row of members has its name (core/member.h)')


def hand_tables(tree):
    """Tables of a page written by hand."""
    for file in _sources(tree, TABLES):
        for found in TABLE.finditer(file.text):
            yield Offence(file.path, file.line_at(found.start()), 'fg_html_table takes its columns from members')
