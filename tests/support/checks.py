# SPDX-License-Identifier: GPL-3.0-or-later
"""Python of a shell test, whose failed assertions are sentences: the expected value, and the one that came.

    checks.py SCRIPT LINE - [ARGUMENT...] <<'P'     as `python3 -`; called by `checks` of cli.sh and station.sh
    checks.py SCRIPT LINE FILE [ARGUMENT...]        as `python3 FILE`

`assert a["u"] < 2 * b, name` that fails ends the script with
    test_x.sh, line 12: expected a["u"] < 2 * b; came a["u"] = 0.3, 2 * b = 0.1 (name: leaf)
Beside what Python has, the code finds expect(value, wanted, what); and wait_until(lambda: condition, seconds=30), which
returns the condition's value once it is true, or says which condition it waited for and what came last.
Assertions of modules that it imports from the test's own folder are told in the same way.
"""
import ast
import importlib.machinery
import os
import re
import sys
import time

HERE = __file__
LONGEST = 300  # characters of a value in a message


class Unexpected(AssertionError):
    """A sentence for whoever reads the test's output."""


def shortened(value):
    text = repr(value)
    return text if len(text) <= LONGEST else text[:LONGEST] + " … (%d characters)" % len(text)


def plain(page):
    """A page without the elements around names that people gave."""
    return re.sub(r'<span translate="no">(.*?)</span>', r"\1", page, flags=re.S)


def expect(value, wanted, what):
    if value != wanted:
        raise Unexpected("%s: expected %s; came %s" % (what, shortened(wanted), shortened(value)))


class Assertion:
    """The values of one assertion while it is evaluated: of the condition that failed, as they were then."""

    def __init__(self):
        self.values = {}
        self.failed = None

    def value(self, source, value):
        self.values[source] = value
        return value

    def condition(self, source, value):
        if value:
            self.values = {}
        elif self.failed is None:
            self.failed = source
        return value

    def came(self):
        values = ", ".join("%s = %s" % (name, shortened(value)) for name, value in self.values.items())
        return "; came " + values if values else ""

    def check(self, source, holds, message):
        if holds:
            return
        told = message()
        raise Unexpected("expected %s%s%s" % (self.failed or source, self.came(), "" if told is None else
                                              " (%s)" % (told if isinstance(told, str) else shortened(told))))


def wait_until(source, condition, seconds=30):
    end = time.monotonic() + seconds
    while True:
        assertion = Assertion()
        value = condition(assertion)
        if value:
            return value
        if time.monotonic() > end:
            raise Unexpected("waited %g s in vain for %s%s" % (seconds, assertion.failed or source, assertion.came()))
        time.sleep(0.02)


def call(function, *arguments):
    return ast.Call(ast.Attribute(ast.Name("__assertion__", ast.Load()), function, ast.Load()), list(arguments), [])


class Rewriter(ast.NodeTransformer):
    """Turns each assertion into the same one that keeps the values it saw; nothing is evaluated twice."""

    def operand(self, node):
        try:
            ast.literal_eval(node)
            return node
        except ValueError:
            return call("value", ast.Constant(ast.unparse(node)), node)

    def condition(self, node):
        source = ast.Constant(ast.unparse(node))
        if isinstance(node, ast.BoolOp):
            conditions = [self.condition(value) for value in node.values]
            if isinstance(node.op, ast.And):
                return ast.BoolOp(node.op, conditions)
            return call("condition", source, ast.BoolOp(node.op, [self.values_of(value) for value in node.values]))
        return call("condition", source, self.values_of(node))

    def values_of(self, node):
        """`node` with its operands kept: the sides of a comparison; what all() goes through; else its value."""
        if isinstance(node, ast.Compare):
            return ast.Compare(self.operand(node.left), node.ops, [self.operand(side) for side in node.comparators])
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return ast.UnaryOp(node.op, self.values_of(node.operand))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "all" and \
                len(node.args) == 1 and isinstance(node.args[0], ast.GeneratorExp):
            each = node.args[0]
            return ast.Call(node.func, [ast.GeneratorExp(self.condition(each.elt), each.generators)], [])
        return self.operand(node)

    def visit_Call(self, node):
        """wait_until(lambda: condition, ...) keeps what the condition saw, as an assertion does."""
        self.generic_visit(node)
        if isinstance(node.func, ast.Name) and node.func.id == "wait_until" and isinstance(node.args[0], ast.Lambda):
            condition = node.args[0]
            source = ast.Constant(ast.unparse(condition.body))
            condition.args.args.append(ast.arg("__assertion__"))
            condition.body = self.condition(condition.body)
            node.args.insert(0, source)
            ast.fix_missing_locations(node)
        return node

    def visit_Assert(self, node):
        check = call("check", ast.Constant(ast.unparse(node.test)), self.condition(node.test),
                     ast.Lambda(ast.arguments([], [], None, [], [], None, []), node.msg or ast.Constant(None)))
        begin = ast.Assign([ast.Name("__assertion__", ast.Store())], ast.Call(ast.Name("__Assertion__", ast.Load()), [], []))
        return [ast.fix_missing_locations(ast.copy_location(new, node)) for new in (begin, ast.Expr(check))]


def compiled(source, path, first_line=0):
    tree = ast.parse(source, path)
    ast.increment_lineno(tree, first_line)
    return compile(Rewriter().visit(tree), path, "exec")


def end_by_sentence(kind, error, trace):
    """Instead of a traceback: where the assertion stands, who called it, and its sentence."""
    if not issubclass(kind, Unexpected):
        return sys.__excepthook__(kind, error, trace)
    places = []
    while trace:
        path = trace.tb_frame.f_code.co_filename
        if path != HERE:
            places.append("%s, line %d" % (os.path.basename(path), trace.tb_lineno))
        trace = trace.tb_next
    called = "".join(" (called at %s)" % place for place in reversed(places[:-1]))
    print("%s%s: %s" % (places[-1], called, error), file=sys.stderr)


def main():
    script, line, path = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    sys.argv = sys.argv[3:]
    sys.path[0] = "" if path == "-" else os.path.dirname(os.path.abspath(path))
    sys.dont_write_bytecode = True
    builtins = sys.modules["builtins"]
    builtins.expect, builtins.wait_until, builtins.plain, builtins.__Assertion__ = expect, wait_until, plain, Assertion
    folder = os.path.abspath(sys.path[0])

    def source_to_code(loader, data, module, *, _optimize=-1):
        if os.path.dirname(os.path.abspath(module)) == folder:
            return compiled(data, module)
        return compile(data, module, "exec", dont_inherit=True, optimize=_optimize)

    importlib.machinery.SourceFileLoader.source_to_code = source_to_code
    sys.excepthook = end_by_sentence
    if path == "-":
        code = compiled(sys.stdin.read(), script, line)
    else:
        with open(path) as file:
            code = compiled(file.read(), path)
    exec(code, {"__name__": "__main__", "__builtins__": builtins})


main()
