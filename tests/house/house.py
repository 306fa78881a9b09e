#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds the tree against the rules of the house that a program can check.

Without options: every rule, or those that are named, against its limit in limits.json; exit 1 where a count is above
it, with file, line and advice. A limit may only fall: --lower writes the counts that stand where they are below. --room lists all that a room
(vision, lot/run) or a folder (include, tests/unit) has, whatever the limits. --counts prints the report of counts."""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter, namedtuple

import functions
import languages
import rooms
import words
import writers
from source import Tree

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.dirname(os.path.dirname(HERE))
LIMITS = os.path.join(HERE, 'limits.json')
REPORT = 'reports/house.md'
SHOWN = 40

Rule = namedtuple('Rule', 'name title find')
RULES = (
    Rule('comment-opening', 'comments that begin with What, Who, Whether, Where, How, So many, The same of, As many, Which',
         words.comment_openings),
    Rule('comment-clause', 'comments that hang on a clause ("what is", "what it", "is what")', words.comment_clauses),
    Rule('private-word', 'identifiers with a private word, in each file that has them', words.private_words),
    Rule('static-name', 'static functions whose name stands in more than three files', functions.repeated_static_names),
    Rule('bare-verb', 'static functions named by a verb alone', functions.bare_verbs),
    Rule('no-caller', 'external functions that only tests or nobody calls (public ones with a comment left out)',
         functions.uncalled_functions),
    Rule('short-file', 'files under 40 lines, together with the header or source beside them', functions.short_files),
    Rule('long-file', 'files above 500 lines', functions.long_files),
    Rule('long-function', 'functions above 60 lines', functions.long_functions),
    Rule('external-clone', 'clones of a function for several processors that are not static', functions.external_clones),
    Rule('foil-kind', 'lines that tell kinds of foil apart outside their tables', functions.kind_mentions),
    Rule('literal-member', 'JSON members written by a call of their own, outside the rows of members', writers.literal_members),
    Rule('hand-table', 'tables of a page written by hand', writers.hand_tables),
    Rule('layers', 'includes against the floors of src/README.md', rooms.layers),
    Rule('circles', 'circles of files', rooms.circles),
    Rule('missing-words', 'sentences of the station\'s pages that a language of src/language has no words for', languages.missing_words),
    Rule('document-name', 'files and functions that README, src/README.md or CONTRIBUTING.md name and that do not exist',
         words.document_names),
)


def _share(part, whole):
    return '{:,} of {:,}'.format(part, whole)


def _openings(tree):
    begun = Counter(words.OPENING.match(c.text)[0] for f in tree.files for c in f.comments
                    if words.OPENING.match(c.text))
    return ', '.join('%s %d' % pair for pair in begun.most_common())


def _kinds(tree):
    found = list(functions.kind_mentions(tree))
    return '{:,} lines in {:,} files'.format(len(found), len({o.path for o in found}))


def _statics(tree):
    names = Counter(o.text.split('`')[1] for o in functions.repeated_static_names(tree))
    return '{:,} names; {}'.format(len(names), ', '.join('%s %d' % pair for pair in names.most_common(5)))


def _lengths(tree):
    lengths = functions.function_lengths(tree)
    return '{:,} functions: median {}, 95th percentile {}, longest {}'.format(
        len(lengths), lengths[len(lengths) // 2], lengths[int(0.95 * len(lengths))], lengths[-1])


# Figures are reported and have no limit.
FIGURES = (
    ('comments', lambda tree: '{:,}'.format(sum(len(f.comments) for f in tree.files))),
    ('their openings', _openings),
    ('static names in more than three files', _statics),
    ('.c and .h files of src under 40 lines', lambda tree: _share(
        len(functions.files_under(tree)), len(functions.files_under(tree, float('inf'))))),
    ('external functions that src does not call', lambda tree: _share(
        len(functions.functions_without_caller(tree)), len(tree.once(functions.Callers).functions))),
    ('external functions that one other file uses', lambda tree: _share(
        len(functions.functions_of_one_file(tree)), len(tree.once(functions.Callers).functions))),
    ('kinds of foil outside their tables', _kinds),
    ('lengths', _lengths),
)


def read_limits():
    with open(LIMITS, encoding='utf-8') as stream:
        return json.load(stream)


def lower_limits(limits, counts):
    lowered = {name: min(limits.get(name, count), count) for name, count in counts.items()}
    with open(LIMITS, 'w', encoding='utf-8') as stream:
        json.dump({**limits, **lowered}, stream, indent=2)
        stream.write('\n')


def print_offences(offences, shown=None):
    for offence in offences[:shown]:
        print('%s:%d: %s' % offence)
    if shown and len(offences) > shown:
        print('… and %d more (all: --rule NAME)' % (len(offences) - shown))


def check(found, limits):
    failed = False
    for rule in RULES:
        if rule.name not in found:
            continue
        offences, limit = found[rule.name], limits.get(rule.name, 0)
        if len(offences) > limit:
            failed = True
            print('FAILED %s: %d, limit %d: %s' % (rule.name, len(offences), limit, rule.title))
            print_offences(offences, SHOWN)
    return failed


def is_in(path, place):
    """A room's name stands for its folder in src/."""
    folders = [place.rstrip('/'), 'src/' + place.rstrip('/')]
    return any(path == folder or path.startswith(folder + '/') for folder in folders)


def list_places(found, places):
    total = 0
    for rule in RULES:
        if rule.name not in found:
            continue
        offences = [o for o in found[rule.name] if not places or any(is_in(o.path, place) for place in places)]
        total += len(offences)
        if offences:
            print('%s: %d %s' % (rule.name, len(offences), rule.title))
            print_offences(offences)
    return total


def find_all(tree, names=()):
    return {rule.name: sorted(rule.find(tree)) for rule in RULES if not names or rule.name in names}


def print_counts(before, before_name):
    trees = ([before] if before else []) + [Tree(TOP)]
    columns = ([before_name] if before else []) + ['now']
    print('# The rules of the house, counted\n')
    print('What a program can check of the rules for words, functions, files and rooms '
          '(`tests/house`). The limits may only fall.\n')
    print('    python3 tests/house/house.py --counts%s >%s\n' % (
        ' --before ' + before_name if before else '', REPORT))
    print('| rule | ' + ' | '.join(columns) + ' | limit |')
    print('|---|' + '---:|' * (len(columns) + 1))
    limits, found = read_limits(), [find_all(tree) for tree in trees]
    for rule in RULES:
        print('| %s: %s | %s | %d |' % (rule.name, rule.title, ' | '.join(
            '{:,}'.format(len(each[rule.name])) for each in found), limits.get(rule.name, 0)))
    print('\n| figure | ' + ' | '.join(columns) + ' |')
    print('|---|' + '---|' * len(columns))
    for title, figure in FIGURES:
        print('| %s | %s |' % (title, ' | '.join(figure(tree) for tree in trees)))


def tree_of_commit(commit):
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.run(['git', '-C', TOP, 'archive', commit], check=True, stdout=subprocess.PIPE)
        subprocess.run(['tar', 'x', '-C', folder], input=archive.stdout, check=True)
        return Tree(folder).read_documents()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = [rule.name for rule in RULES]
    parser.add_argument('checked', nargs='*', metavar='RULE', help='check these rules alone: ' + ', '.join(names))
    parser.add_argument('--tree', default=TOP, metavar='FOLDER', help='the tree to look at')
    parser.add_argument('--room', action='append', default=[], metavar='NAME', help='list what a room or folder has')
    parser.add_argument('--rule', action='append', default=[], metavar='NAME', choices=names,
                        help='list all that this rule finds')
    parser.add_argument('--counts', action='store_true', help='print %s' % REPORT)
    parser.add_argument('--before', metavar='COMMIT', help='with --counts: a commit to put beside')
    parser.add_argument('--lower', action='store_true', help='lower the limits to the counts that stand')
    options = parser.parse_args()
    if options.counts:
        print_counts(tree_of_commit(options.before) if options.before else None, options.before)
        return 0
    if not set(options.checked) <= set(names):
        parser.error('no such rule: ' + ', '.join(sorted(set(options.checked) - set(names))))
    found = find_all(Tree(options.tree), options.checked or options.rule)
    if options.lower:
        lower_limits(read_limits() if os.path.exists(LIMITS) else {}, {name: len(o) for name, o in found.items()})
        return 0
    if options.room or options.rule:
        return 1 if list_places(found, options.room) else 0
    return 1 if check(found, read_limits()) else 0


if __name__ == '__main__':
    sys.exit(main())
