# SPDX-License-Identifier: GPL-3.0-or-later
"""Each rule finds its offences and nothing beside them, in a small tree with known ones."""

import os
import tempfile
import unittest

import functions
import rooms
import words
import writers
from source import Tree

MAP = '''# Map

The floors:

    core
    scan (core), stats
    report (nothing)
'''
ROOM = {
    'src/README.md': MAP,
    'README.md': 'Read `src/core/add.c`, `core/gone.c`, fg_add and fg_gone, ./tests/run.sh.\n',
    'tests/run.sh': '#!/bin/sh\n# Whether it runs.\necho "# What"  # Where it ends\n',
    'include/foilgauge/add.h': '/* Sum. */\nint fg_add(int a, int b);\nint fg_plain(void);\n\n/* Both. */\nint fg_grouped(void);\nint fg_other(void);\n\nint fg_bare(void);\nint fg_noted(void); /* 1 */\n',
    'src/core/add.h': '#include "core/take.h"\n',
    'src/core/add.c': '// SPDX-License-Identifier: GPL-3.0-or-later\n// What is\n// added.\n#include "core/add.h"\n'
                      'int fg_add(int a, int b) {\n  /* The sum says what it was. */\n  return a + b; // "what is" is text\n}\n'
                      '#define LEAST(x) ((x) + least_squares)\nstatic int take(void) {\n  return 0;\n}\n',
    'src/core/take.h': '#include "core/add.h"\n#include "scan/scan.h"\nint fg_never(void);\n',
    'src/core/take.c': 'struct most {\n  int kind;\n};\nint fg_never(void) {\n  return FG_FOIL_ARC == 1;\n}\n',
    'src/scan/scan.h': '#include "core/add.h"\n#include "stats/stats.h"\n',
    'src/stats/stats.h': 'int fg_plain(void);\n',
    'src/stats/stats.c': 'extern "C" {\nint fg_plain(void) {\n  return fg_add(1, (int)sizeof "{");\n}\n}\n' + '\n' * 40,
    'src/report/page.c': '#include "core/add.h"\n#include "foilgauge/add.h"\n' + '\n' * 500,
    'src/core/public.c': ''.join('int %s(void) {\n  return 1;\n}\n' % name for name in (
        'fg_grouped', 'fg_other', 'fg_bare', 'fg_noted')) + '\n' * 40,
    'src/report/writer.c': 'static const char page[] = "<table>";\n/* fg_json_number(json, "said", 1); */\n'
                           '#define NUMBER\\\n  fg_json_number(json, "a_mm",\\\n                 a);\\\n  fg_json_string(&json, NULL, b);\\\n'
                           '  fg_json_object(json_of(x), "part");\n' + '\n' * 40,
    'src/report/clones.c': '__attribute__((target_clones("avx2", "default"))) static void scale(void);\n'
                           '__attribute__((target_clones("avx2", "default")))\nvoid fg_scale(void);\n' + '\n' * 40,
    'src/report/long.c': 'static const int rows[] = {1, 2};\nvoid fg_long(void) {\n' + '  fg_plain();\n' * 60 + '}\n'
                         '#define USE fg_long()\n',
}


class Rules(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        for path, text in ROOM.items():
            full = os.path.join(cls.folder.name, path)
            os.makedirs(os.path.dirname(full), exist_ok=True)
            with open(full, 'w', encoding='utf-8') as stream:
                stream.write(text)
        cls.tree = Tree(cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def places(self, find):
        return sorted('%s:%d' % offence[:2] for offence in find(self.tree))

    def test_comments_are_told_by_their_opening_and_clauses(self):
        self.assertEqual(self.places(words.comment_openings), ['src/core/add.c:1', 'tests/run.sh:2', 'tests/run.sh:3'])
        self.assertEqual(self.places(words.comment_clauses), ['src/core/add.c:1', 'src/core/add.c:6'])

    def test_private_words_are_found_in_names_and_not_in_phrases(self):
        self.assertEqual(self.places(words.private_words), ['src/core/add.c:9', 'src/core/take.c:1'])

    def test_documents_name_what_exists(self):
        self.assertEqual([o.text for o in sorted(words.document_names(self.tree))],
                         ['`core/gone.c` does not exist', '`fg_gone` does not exist'])

    def test_functions_are_measured_and_their_callers_counted(self):
        self.assertEqual(self.places(functions.uncalled_functions), ['src/core/public.c:7', 'src/core/take.c:4'])
        self.assertEqual(self.places(functions.bare_verbs), ['src/core/add.c:10'])
        self.assertEqual(self.places(functions.long_functions), ['src/report/long.c:2'])
        self.assertEqual(functions.function_lengths(self.tree), [3, 3, 3, 3, 3, 3, 3, 4, 62])
        self.assertEqual(self.places(functions.repeated_static_names), [])

    def test_files_are_counted_with_the_file_beside_them(self):
        self.assertEqual(self.places(functions.short_files), [
            'src/core/add.c:1', 'src/core/add.h:1', 'src/core/take.c:1', 'src/core/take.h:1', 'src/scan/scan.h:1'])
        self.assertEqual(self.places(functions.long_files), ['src/report/page.c:1'])

    def test_clones_that_clang_does_not_link_are_found(self):
        self.assertEqual(self.places(functions.external_clones), ['src/report/clones.c:2'])

    def test_a_kind_of_foil_is_found_outside_its_tables(self):
        self.assertEqual(self.places(functions.kind_mentions), ['src/core/take.c:5'])

    def test_includes_are_held_against_the_floors(self):
        self.assertEqual(self.places(rooms.layers), ['src/core/take.h:2', 'src/report/page.c:1', 'src/scan/scan.h:2'])

    def test_members_and_tables_by_hand_are_found(self):
        self.assertEqual(self.places(writers.literal_members), ['src/report/writer.c:4'])
        self.assertEqual(self.places(writers.hand_tables), ['src/report/writer.c:1'])

    def test_circles_of_files_are_found(self):
        found = list(rooms.circles(self.tree))
        self.assertEqual(len(found), 1)
        self.assertIn('core/add, core/take, scan/scan', found[0].text)

    def test_a_room_that_names_one_below_it_is_refused(self):
        with self.assertRaises(ValueError):
            rooms.Floors('The floors:\n\n    core (scan)\n    scan\n')


if __name__ == '__main__':
    unittest.main()
