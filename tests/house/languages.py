# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences of pages that a language has no words for: texts between tags in the C files that write the station's pages,
held against the msgid of src/language/*.po. `unit.test_language` and `cli.test_station_language` ask for words in tables and
on pages as they are served; this rule finds a new sentence where it is written."""

import re

from offence import Offence, excerpt

WRITERS = re.compile(
    r'src/(station/(\w+/)?(page_\w+|values|disposition|orders|check|check_page|check_fit|check_state|frame|answer|cause_words|cause_keep|digest|'
    r'close|correct|lot_files|lot_content|intake|recovery|scan_command|why|trend|trend_choice|export|stored_foil)|'
    r'report/(words|value_words|provenance)|report/measure/(page|page_\w+|cures|picture_words|thickness_budget|foil_view\w*)|'
    r'report/lot/(page\w*|assembly_words|foil_table))\.c$')
# Functions whose text is not for a page: queries, and their purpose.
NOT_SHOWN = re.compile(r'\b(fg_query_end|fg_query_begin|fg_sql_run|static_assert)\([^;]*$')
SQL = re.compile(r'\b(SELECT|INSERT|UPDATE|WHERE|FROM|CREATE|ORDER BY|LIMIT|JOIN|GROUP BY|PRAGMA|DELETE|COLLATE|AND|IS NOT NULL)\b')
LITERALS = re.compile(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+')
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
PLACE = re.compile(r'\{(?:number|time|name|words)\d*\}')
FORMAT = re.compile(r'%[-+ #0]*(?:\*|\d+)?(?:\.(?:\*|\d+))?(?:hh|h|ll|l|z|j|t)?[diouxXeEfFgGcs]')
TAG = re.compile(r'<[^>]*>|<[^>]*$|^[^<>]*">')
WORDS = re.compile(r'[A-Za-z]{2,} [A-Za-z]{2,}')
SENTENCE = re.compile(r'(?<=[.!?]) (?=[A-Z±])')
PO_LINE = re.compile(r'(msgid|msgstr|msgctxt)? ?"(.*)"$')
COMMENT = re.compile(r'/\*.*?\*/', re.S)


def unescape(text):
    return text.replace('\\n', '\n').replace('\\"', '"').replace('\\\\', '\\')


def read_list(text):
    """The msgid of a list of words, joined, with each place as one character."""
    ids, filled = [], None
    for line in text.splitlines():
        found = PO_LINE.match(line)
        if not found:
            continue
        filled = found[1] or filled
        if found[1] == 'msgid':
            ids.append('')
        if filled == 'msgid':
            ids[-1] += unescape(found[2])
    return '\n'.join(PLACE.sub('\x01', one) for one in ids)


def literals(text):
    """(line, text before it, text) of each literal, neighbours joined."""
    code = COMMENT.sub(lambda found: re.sub(r'[^\n]', ' ', found[0]), text)
    for found in LITERALS.finditer(code):
        yield code.count('\n', 0, found.start()) + 1, code[max(0, found.start() - 200):found.start()], unescape(
            ''.join(LITERAL.findall(found[0])))


def sentences(text):
    """The words of a literal between tags and values."""
    text = TAG.sub('\x02', text)
    for entity, character in (('&amp;', '&'), ('&lt;', '<'), ('&#39;', "'"), ('&nbsp;', ' ')):
        text = text.replace(entity, character)
    for part in re.split('[\x01\x02]', FORMAT.sub('\x01', text).replace('%%', '%')):
        for one in SENTENCE.split(re.sub(r'\s+', ' ', part)):
            one = one.strip(' ,;:.()')
            if WORDS.search(one) and not one.startswith('out of memory'):
                yield one


def missing_words(tree):
    lists = [(path, read_list(tree.text_of(path))) for path in sorted(tree.all_paths()) if path.endswith('.po')]
    for file in tree.files:
        if not WRITERS.match(file.path):
            continue
        for line, before, text in literals(file.text):
            if SQL.search(text) or NOT_SHOWN.search(before):
                continue
            for part in sentences(text):
                for path, ids in lists:
                    if part not in ids:
                        yield Offence(file.path, line, '"%s" has no words in %s' % (excerpt(part), path))
