# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of a tree as the rules see them: comments, identifiers, functions and includes with their lines."""

import bisect
import fnmatch
import os
import re

C_ENDINGS = ('.c', '.h', '.cpp')
# Only a hash at the start of a word opens a comment of these.
HASH_ENDINGS = ('.py', '.sh', '.cmake', 'CMakeLists.txt')
BLOCK_ENDINGS = C_ENDINGS + ('.css', '.js')
FOLDERS = ('include', 'src', 'tests', 'scripts')
# Not written by hand, or data of tests.
LEFT_OUT = ('tests/data/*', 'tests/fuzz/corpus/*')

TOKEN = re.compile(
    r'(?P<comment>//(?:\\\n|[^\n])*|/\*.*?\*/)'
    r'|(?P<string>"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\')'
    r'|(?P<directive>^[ \t]*\#[ \t]*(?:include[ \t]*(?:"(?P<path>[^"\n]*)"|<[^>\n]*>)|\w*))'
    r'|(?P<name>[A-Za-z_]\w*)'
    r'|(?P<joined>\\\n)|(?P<newline>\n)'
    r'|(?P<mark>[{}();=\[\],])', re.S | re.M)
HASH_COMMENT = re.compile(r'^(?P<code>(?:[^#"\']|"(?:\\.|[^"\\])*"|\'[^\']*\'|(?<=[^\s])#)*?)(?<!\S)#(?!!)(?P<text>.*)$')
DOCSTRING = re.compile(r'^[ \t]*"""(.*?)"""', re.S | re.M)
SPDX = re.compile(r'\s*(SPDX-[A-Za-z-]+:[^\n]*|Copyright\b[^\n]*)')
LICENCE_LINE = re.compile(r'^[^\w\n]*SPDX-License-Identifier.*\n', re.M)
WORDS_BEFORE_PARENTHESIS = frozenset(('if', 'for', 'while', 'switch', 'return', 'sizeof', 'defined',
                                      '__attribute__', '_Static_assert', 'static_assert', 'alignas',
                                      '_Alignas', 'typeof'))


class Comment:
    def __init__(self, line, text):
        self.line = line
        self.text = text


class Function:
    def __init__(self, file, name, line, last_line, is_static):
        self.file, self.name, self.line, self.last_line, self.is_static = file, name, line, last_line, is_static

    @property
    def length(self):
        return self.last_line - self.line + 1


class File:
    """One file; C files have identifiers, functions, prototypes and includes as well."""

    def __init__(self, path, text):
        self.path, self.text = path, text
        self.is_c = path.endswith(C_ENDINGS)
        self.comments, self.functions, self.includes = [], [], []
        self.identifiers = {}  # name: lines, of all that is no comment, string or include
        self.prototypes = {}   # name: line, of functions that are declared and not defined here
        self.documented = set()
        self._starts = [0] + [m.end() for m in re.finditer('\n', text)]
        self.lines = text.count('\n') - len(LICENCE_LINE.findall(text, 0, 400))
        if path.endswith(BLOCK_ENDINGS):
            self._read_blocks()
        elif path.endswith(HASH_ENDINGS):
            self._read_hashes()
            if path.endswith('.py'):
                for found in DOCSTRING.finditer(text):
                    self._add_comment(self.line_at(found.start(1)), found[1])

    def line_at(self, offset):
        return bisect.bisect_right(self._starts, offset)

    def _add_comment(self, line, text):
        text = SPDX.sub('', text).strip()
        if text:
            self.comments.append(Comment(line, ' '.join(text.split())))

    def _read_hashes(self):
        """Neighbouring lines of comment alone are one comment."""
        block, first = [], 0
        for number, line in enumerate(self.text.split('\n') + [''], 1):
            found = HASH_COMMENT.match(line)
            alone = bool(found) and not found['code'].strip()
            if alone:
                first = first if block else number
                block.append(found['text'].strip())
                continue
            if block:
                self._add_comment(first, '\n'.join(block))
                block = []
            if found:
                self._add_comment(number, found['text'])

    def _read_blocks(self):
        parser = _CParser(self) if self.is_c else None
        lines_joined = None  # (line, column, texts) of a block of // comments
        for token in TOKEN.finditer(self.text):
            kind = token.lastgroup if token.lastgroup != 'path' else 'directive'
            if kind == 'comment':
                lines_joined = self._read_comment(token, lines_joined)
                if parser:
                    parser.comment()
            elif parser:
                parser.token(kind, token)
        self._close_joined(lines_joined)

    def _close_joined(self, joined):
        if joined:
            self._add_comment(joined[0], '\n'.join(joined[3]))

    def _read_comment(self, token, joined):
        """Lines of // that follow each other in one column are one comment; returns the one that is still open."""
        text = token.group()
        line = self.line_at(token.start())
        column = token.start() - self._starts[line - 1]
        if text.startswith('//'):
            content = text[2:].lstrip('/!<').strip()
            if joined and joined[1] == line - 1 and joined[2] == column:
                joined[3].append(content)
                return (joined[0], line, column, joined[3])
            self._close_joined(joined)
            return (line, line, column, [content])
        self._close_joined(joined)
        content = re.sub(r'\n[ \t]*\*', '\n', text[2:-2]).lstrip('*!<')
        self._add_comment(line, content)
        return None


class _CParser:
    """Functions, prototypes, identifiers and includes of one C file; a preprocessor's line counts for its identifiers only."""

    def __init__(self, file):
        self.file = file
        self.depth = 0
        self.parentheses = 0
        self.in_directive = self.in_define = False
        self.statement = []  # (text, offset) of what stands at file scope since the last statement
        self.open_function = None
        self.transparent = []  # depths at which extern "C" { was opened
        self.has_comment = self.statement_has_comment = False

    def comment(self):
        self.has_comment = True

    def token(self, kind, token):
        if kind == 'newline':
            self.in_directive = self.in_define = False
            return
        if kind == 'joined':
            return
        if kind == 'directive':
            self._read_directive(token)
            return
        text = token.group()
        if kind == 'name':
            self.file.identifiers.setdefault(text, []).append(token.start())
        if self.in_directive:
            return
        if kind == 'mark':
            self._read_mark(text, token.start())
        elif self.depth == 0:
            self._extend(text, token.start())

    def _extend(self, text, offset):
        if not self.statement:
            self.statement_has_comment, self.has_comment = self.has_comment, False
        self.statement.append((text, offset))

    def _read_directive(self, token):
        self.in_directive = True
        if token['path']:
            self.file.includes.append((token['path'], token.start()))

    def _read_mark(self, text, offset):
        if text == '{':
            if self.depth == 0 and [t for t, _ in self.statement] == ['extern', '"C"']:
                self.statement = []
                self.transparent.append(True)
                return
            if self.depth == 0:
                self.open_function = self._function_of_statement()
                self._extend(text, offset)
            self.depth += 1
        elif text == '}':
            if self.depth == 0:
                if self.transparent:
                    self.transparent.pop()
                return
            self.depth -= 1
            if self.depth == 0 and self.open_function:
                name, start, is_static = self.open_function
                self.file.functions.append(Function(self.file, name, self.file.line_at(start),
                                                    self.file.line_at(offset), is_static))
                self._end_statement()
        elif self.depth == 0:
            self._extend(text, offset)
            if text == ';':
                self._note_prototype()
                self._end_statement()

    def _end_statement(self):
        self.open_function = None
        self.statement = []
        self.has_comment = False

    def _called_name(self):
        """The name before the first parenthesis that no attribute opens, or None."""
        depth = 0
        previous = None
        skip_from = None
        for text, offset in self.statement:
            if text == '(':
                if depth == 0 and previous and previous[0].isidentifier() and skip_from is None:
                    if previous[0] in WORDS_BEFORE_PARENTHESIS or previous[0].isupper():
                        skip_from = depth
                    else:
                        return previous
                depth += 1
            elif text == ')':
                depth -= 1
                if skip_from == depth:
                    skip_from = None
            elif text == '=' and depth == 0:
                return None
            previous = (text, offset)
        return None

    def _function_of_statement(self):
        texts = [t for t, _ in self.statement]
        if not texts or '(' not in texts or '=' in texts or texts[0] == 'typedef':
            return None
        name = self._called_name()
        return (name[0], self.statement[0][1], 'static' in texts) if name else None

    def _stands_in_commented_paragraph(self, offset):
        """A comment above a group of prototypes is of all of them; one behind a prototype is its own."""
        text = self.file.text
        above = text[text.rfind('\n\n', 0, offset) + 1:offset]
        return '/*' in above or '/*' in text[offset:text.find('\n', text.find(';', offset))]

    def _note_prototype(self):
        texts = [t for t, _ in self.statement]
        if '(' not in texts or '{' in texts or texts[0] == 'typedef':
            return
        name = self._called_name()
        if name:
            self.file.prototypes.setdefault(name[0], name[1])
            if self.statement_has_comment or self._stands_in_commented_paragraph(name[1]):
                self.file.documented.add(name[0])


class Tree:
    """All files of a checkout that people write."""

    def __init__(self, top):
        self.top = top
        self.files = [File(path, self._read(path)) for path in self._paths()]
        self.by_path = {file.path: file for file in self.files}
        self._paths_of_all = self._list_all()
        self._texts, self._made = {}, {}

    def once(self, make):
        """make(tree), made once."""
        if make not in self._made:
            self._made[make] = make(self)
        return self._made[make]

    def text_of(self, path):
        if path not in self._texts:
            self._texts[path] = self._read(path)
        return self._texts[path]

    def all_paths(self):
        return self._paths_of_all

    def exists(self, path):
        return path in self._paths_of_all

    def read_documents(self):
        """Reads what rules read later, for a tree that is about to go; returns the tree."""
        for path in self._paths_of_all:
            if path.endswith('.md'):
                self.text_of(path)
        return self

    def _list_all(self):
        found = set()
        for root, folders, names in os.walk(self.top):
            folders[:] = [f for f in folders if f not in ('.git', '__pycache__') and
                          not (root == self.top and f.startswith('build'))]
            found.update(os.path.relpath(os.path.join(root, name), self.top) for name in names)
        return found

    def _read(self, path):
        with open(os.path.join(self.top, path), encoding='utf-8', errors='replace') as stream:
            return stream.read()

    def _paths(self):
        paths = []
        for folder in FOLDERS:
            for root, folders, names in os.walk(os.path.join(self.top, folder)):
                folders[:] = sorted(f for f in folders if not f.startswith('.') and f != '__pycache__')
                paths += [os.path.relpath(os.path.join(root, name), self.top) for name in names
                          if name.endswith(BLOCK_ENDINGS + HASH_ENDINGS)]
        if os.path.exists(os.path.join(self.top, 'CMakeLists.txt')):
            paths.append('CMakeLists.txt')
        return sorted(p for p in paths if not any(fnmatch.fnmatch(p, pattern) for pattern in LEFT_OUT))

    def c_files(self, *folders):
        return [f for f in self.files if f.is_c and f.path.startswith(tuple(d + '/' for d in folders))]

