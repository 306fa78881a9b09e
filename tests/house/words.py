# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules for words: how comments begin, private words in names, names that no document may invent."""

import os
import re

from offence import Offence, excerpt

OPENINGS = ('What', 'Who', 'Whose', 'Whether', 'Where', 'How', 'So many', 'So much', 'The same of', 'As many', 'As much', 'Which')
OPENING = re.compile(r'(%s)\b' % '|'.join(OPENINGS))
CLAUSE = re.compile(r'\b([Ww]hat (?:is|are|was|were|it|they)|(?:is|are|was|were) what)\b')
QUOTED = re.compile(r'"[^"]*"|`[^`]*`|“[^”]*”')

# Snake parts of identifiers, with the field's word.
PRIVATE_WORDS = {
    'doubt': 'uncertainty (u)', 'doubts': 'uncertainties', 'freedom': 'dof', 'least': 'min', 'most': 'max',
    'lone': 'outlier', 'twin': 'collinear', 'twins': 'collinear', 'bench': 'workspace', 'battery': 'residual_tests',
    'yardstick': 'baseline', 'settle': 'iterate', 'settles': 'iterates', 'settled': 'converged',
    'manner': 'strategy', 'manners': 'strategies', 'eager': 'seeds_placed', 'pay': 'benefit', 'pays': 'benefits',
    'witness': 'channel_check', 'witnesses': 'channel_checks', 'course': 'profile', 'courses': 'profiles',
    'aside': 'held_out', 'patience': 'timeout', 'trouble': 'recovery or defect',
    'form': 'kind, forming, html_form, form_error or noise model', 'forms': 'kinds, bases, html_forms',
}
# A phrase of the field or of English in which the word is right.
ALLOWED_PHRASES = re.compile(
    r'(?:^|_)(least_squares|at_least|at_most|most_likely|most_overlapped|most_commas|most_of|option_form|html_forms?|form_errors?|closed_form|'
    r'canonical_form|form_data|form_urlencoded)(?=_|$)')
# Names of tests are sentences; in them `least`, `most` and `course` are English.
SENTENCE_WORDS = frozenset(('least', 'most', 'course', 'settles', 'pays', 'settle', 'pay'))

DOCUMENTS = ('README.md', 'src/README.md', 'CONTRIBUTING.md', '.github/CONTRIBUTING.md', 'reports/README.md')
CODED = re.compile(r'`([^`\n]+)`')
FILE_NAME = re.compile(r'(?<![\w/.*{-])(?:\./)?((?:[\w-][\w.-]*/)*[\w*-]+\.(?:c|h|cpp|py|sh|cmake|css|js|in))(?![\w/])')
FUNCTION_NAME = re.compile(r'\b(fg_\w+)(?:\(\))?(?!\w|\*)')
TOP_FOLDERS = ('src/', 'tests/', 'include/', 'reports/', 'samples/', 'scripts/')


def comment_openings(tree):
    for file in tree.files:
        for comment in file.comments:
            found = OPENING.match(comment.text)
            if found:
                yield Offence(file.path, comment.line, '"%s": begin with the subject, not with "%s"' % (
                    excerpt(comment.text), found[0]))


def comment_clauses(tree):
    for file in tree.files:
        for comment in file.comments:
            found = CLAUSE.search(QUOTED.sub('', comment.text))
            if found:
                start = max(0, comment.text.find(found[0]) - 20)
                yield Offence(file.path, comment.line, '"%s": name the thing instead of "%s …"' % (
                    excerpt(comment.text[start:]), found[0]))


def private_word(name):
    """The word of PRIVATE_WORDS in an identifier, or None."""
    rest = ALLOWED_PHRASES.sub('', name.lower())
    return next((part for part in rest.split('_') if part in PRIVATE_WORDS), None)


def private_words(tree):
    for file in tree.c_files('include', 'src', 'tests'):
        is_test = file.path.startswith('tests/')
        for name, offsets in file.identifiers.items():
            word = private_word(name)
            if not word or (is_test and word in SENTENCE_WORDS and name.count('_') >= 3):
                continue
            yield Offence(file.path, file.line_at(offsets[0]), '`%s`: %s instead of "%s"%s' % (
                name, PRIVATE_WORDS[word], word, ' (%d times here)' % len(offsets) if len(offsets) > 1 else ''))
        stem = os.path.splitext(os.path.basename(file.path))[0]
        word = private_word(stem)
        if word and not is_test:
            yield Offence(file.path, 1, 'the file\'s name: %s instead of "%s"' % (PRIVATE_WORDS[word], word))


def document_names(tree):
    """Files and functions that a document names and nobody finds."""
    names = _Names(tree)
    for path in DOCUMENTS:
        if tree.exists(path):
            room = ''
            for number, line in enumerate(tree.text_of(path).split('\n'), 1):
                row = re.match(r'\| `?([\w/]+)/`? \|', line)
                room = 'src/' + row[1] + '/' if row and path == 'src/README.md' else ''
                for missing in names.missing(line, room):
                    yield Offence(path, number, '`%s` does not exist%s' % (missing, ' in ' + room if room else ''))


class _Names:
    def __init__(self, tree):
        self.tree = tree
        self.paths = tree.all_paths()
        self.ends = {}
        for path in self.paths:
            parts = path.split('/')
            for first in range(len(parts)):
                self.ends.setdefault('/'.join(parts[first:]), []).append(path)
        self.identifiers = set()
        for file in tree.c_files('src', 'include', 'tests'):
            self.identifiers.update(file.identifiers)

    def missing(self, line, room):
        for name in FILE_NAME.findall(line):
            if name[0].isupper() and name.isupper():
                continue
            if not self._is_file(name, room):
                yield name
        for coded in CODED.findall(line):
            if re.fullmatch(r'(%s)[\w/.-]+' % '|'.join(TOP_FOLDERS), coded) and '.' in os.path.basename(coded) \
                    and not FILE_NAME.search(coded) and coded not in self.paths:
                yield coded
        for name in FUNCTION_NAME.findall(line):
            if name not in self.identifiers and not any(i.startswith(name) for i in self.identifiers if name.endswith('_')):
                yield name

    def _is_file(self, name, room):
        if '*' in name:
            pattern = re.compile('(.*/)?' + re.escape(name).replace(r'\*', '[^/]*') + '$')
            return any(pattern.match(path) for path in self.paths if path.startswith(room))
        if name.endswith('.in') and name + '' not in self.ends:
            return True
        found = self.ends.get(name, ())
        # A row of the map's table names its room's files, or another room's with the room before it.
        return any(path.startswith(room) for path in found) or ('/' in name and bool(found))
