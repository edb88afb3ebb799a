"""Words of a syntax tree: what a copy can change for nothing changes none of them."""

import ast

import pytest

from grader.batch.similar.syntax import units


def words(source):
    return [[word.text for word in unit] for unit in units(ast.parse(source))]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("speed = 1.0", "v = 2.5"),
        ("def f(a):\n    return a", "def g(b) -> int:\n    '''Doc.'''\n    # why\n    return b"),
        ("from a import B\nB()", "from a import B as C\nC()"),
        ("import numpy as np\nnp.zeros(3)", "import numpy\nnumpy.zeros(4)"),
        ("a = 1\na += 2", "a = 1\na = a + 2"),
        ("f(x > 3)", "f(3 < x)"),
        ("x, y = 1, 2", "x = 1\ny = 2"),
        ("x: float = 1.0", "x = -1.0"),
        ("f(b=1, a='')", "f(a='x', b=3)"),
        ("x = 1", "x = 1\nprint(x)\nlogger.info('now')\npass"),
        ("x = 1", "import os\nx = 1"),
    ],
)
def test_both_read_the_same(one, other):
    assert words(one) == words(other)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("a.publish(1)", "a.subscribe(1)"),
        ("f(x < 3)", "f(x <= 3)"),
        ("if a:\n    b()", "while a:\n    b()"),
        ("x = None", "x = True"),
        ("a.b.c = 1", "a.b.d = 1"),
    ],
)
def test_these_do_not(one, other):
    assert words(one) != words(other)


def test_the_order_of_functions_changes_the_order_of_units_only():
    first, second = "def f():\n    return 1\n", "def g(a):\n    a.go()\n"
    assert sorted(words(first + second)) == sorted(words(second + first))


def test_every_word_knows_its_line():
    (unit,) = units(ast.parse("\n\nx = (\n  1 +\n  len('')\n)"))
    assert [word.line for word in unit if word.text in ("len", "text")] == [5, 5]


def test_a_tree_deeper_than_any_stack_is_read():
    tree: ast.expr = ast.Name("a", ast.Load())
    for _ in range(20_000):
        tree = ast.UnaryOp(ast.Not(), tree)
    statement = ast.Expr(tree, lineno=1)
    (unit,) = units(ast.Module([statement], []))
    assert len(unit) > 20_000
    while isinstance(tree, ast.UnaryOp):  # or taking it down would go as deep
        tree.operand, tree = ast.Name("a"), tree.operand
