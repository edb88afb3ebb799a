"""Finds out what names stand for, and where in the window a condition on the pose is true.

Nothing is run for that.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterable, Iterator
from typing import Any

from grader.submission import last, scope_nodes
from grader.system import expressions
from grader_diagnosis.lint.scopes import Found, Source

#: The window's side [m], as turtlesim draws it.
SIZE_M = 11.09
MIDDLE_M = SIZE_M / 2
#: Where a stop is looked for: so far from a wall [m]; and where nobody stops.
NEAR_M, RING_M = 0.2, 1.5
#: So many steps one evaluation may take, and so many conditions are judged.
MOST_STEPS, MOST = 400, 60
_FAR_M = SIZE_M - NEAR_M
_ALONG = (3.0, MIDDLE_M, 8.0)
WALLS = {
    "left": [(NEAR_M, at) for at in _ALONG],
    "right": [(_FAR_M, at) for at in _ALONG],
    "bottom": [(at, NEAR_M) for at in _ALONG],
    "top": [(at, _FAR_M) for at in _ALONG],
}
_CORNERS = [(x, y) for x in (NEAR_M, _FAR_M) for y in (NEAR_M, _FAR_M)]
_RING = [
    (MIDDLE_M + RING_M * math.cos(turn), MIDDLE_M + RING_M * math.sin(turn))
    for turn in (0.3, 1.2, 1.9, 2.8, 3.5, 4.4, 5.1, 6.0)
]
#: What is known of what stands in a source; its ints are floats.
_SIGNS = ast.Add | ast.Sub | ast.Mult | ast.Div | ast.Pow | ast.Lt | ast.LtE | ast.Gt | ast.GtE
_FUNCTIONS = {"fabs": "abs", **{n: n for n in ("min", "max", "abs", "float", "hypot", "sqrt")}}
#: Methods that change what a list or a dict holds.
_CHANGES = ("append", "extend", "insert", "pop", "remove", "clear", "update", "setdefault")


class Unknown(Exception):
    """An expression has other parts than numbers, the pose, and what is assigned once."""


class Values:
    """What the names in a submission's files stand for."""

    def __init__(self, sources: Iterable[Source]) -> None:
        self._assigned: dict[str, list[ast.expr | None]] = {}
        for node in (node for source in sources for node in source.nodes):
            match node:
                case ast.Assign(targets=targets, value=value):
                    for target in targets:
                        self._add(target, value)
                case ast.AnnAssign(target=target, value=ast.expr() as value):
                    self._add(target, value)
                case ast.AugAssign(target=target):
                    self._add(target, None)
                case ast.arg(arg=name):
                    self._assigned.setdefault(name, []).append(None)
        self._steps = 0

    def _add(self, target: ast.expr, value: ast.expr | None) -> None:
        match target, value:
            case (ast.Tuple(elts=targets), ast.Tuple(elts=values)) if len(targets) == len(values):
                for each, part in zip(targets, values, strict=True):
                    self._add(each, part)
            case (ast.Name() | ast.Attribute(), _):
                for name in {last(target), ast.unparse(target)}:
                    self._assigned.setdefault(name, []).append(value)

    def assigned(self, name: str) -> list[ast.expr | None]:
        """Return what is assigned to `name` or `self.name`; plain constants where that is all.

        None stands for what cannot be known: an argument, a sum that grows.
        """
        found = self._assigned.get(name, [])
        if None in found:
            return found
        return [each for each in found if not isinstance(each, ast.Constant)] or found

    def of(self, node: ast.expr, x: float = math.nan, y: float = math.nan) -> Any:
        """Evaluate an expression where the turtle is at a place [m]; no place for a constant.

        Raises:
            Unknown: it cannot be known, or takes too long.
        """
        self._steps = 0
        try:
            found = expressions.Expression("", self._resolve(node)).value({"x": x, "y": y})
        except (expressions.ExpressionError, ArithmeticError, RecursionError) as error:
            raise Unknown from error
        if not isinstance(found, bool | float) or math.isnan(found):
            raise Unknown
        return found

    def _resolve(self, node: ast.expr) -> ast.expr:
        """Return an expression with what its names stand for: of numbers, x and y alone."""
        self._steps += 1
        if self._steps > MOST_STEPS:
            raise Unknown
        match node:
            case ast.Constant(value=int() | float() as number):
                return ast.Constant(float(number))
            case ast.UnaryOp(op=ast.USub() | ast.Not() as sign, operand=part):
                return ast.UnaryOp(sign, self._resolve(part))
            case ast.BinOp(left=left, op=sign, right=right) if isinstance(sign, _SIGNS):
                return ast.BinOp(self._resolve(left), sign, self._resolve(right))
            case ast.BoolOp(op=sign, values=parts):
                return ast.BoolOp(sign, [*map(self._resolve, parts)])
            case ast.Compare(ops=signs) if all(isinstance(sign, _SIGNS) for sign in signs):
                others = [*map(self._resolve, node.comparators)]
                return ast.Compare(self._resolve(node.left), signs, others)
            case ast.Call(func=called, args=args, keywords=[]) if last(called) in _FUNCTIONS:
                name = ast.Name(_FUNCTIONS[last(called)])
                return ast.Call(name, [*map(self._resolve, args)], [])
            case ast.Attribute(value=ast.Attribute(attr="linear" | "angular")):
                raise Unknown
            case ast.Attribute(attr="x" | "y" as name) | ast.Name(id="x" | "y" as name):
                return ast.Name(name)
            case ast.Attribute() | ast.Name():
                match self.assigned(last(node)):
                    case [ast.expr() as kept]:
                        return self._resolve(kept)
            case ast.List(elts=parts) | ast.Tuple(elts=parts):
                return ast.List([*map(self._resolve, parts)])
        raise Unknown


def held(source: Source, values: Values) -> Iterator[Found]:
    """Yield what the names in a file hold, where that may end a program."""
    changed, divisors, seen = set(), set(), set()
    for node in source.nodes:
        match node:
            case ast.Subscript(value=of, ctx=ast.Store() | ast.Del()):
                changed.add(last(of))
            case ast.Call(func=ast.Attribute(value=of, attr=name)) if name in _CHANGES:
                changed.add(last(of))
            case ast.BinOp(op=ast.Div() | ast.FloorDiv() | ast.Mod(), right=right) if last(right):
                divisors.add(ast.unparse(right))
    for node in source.nodes:
        match node:
            case ast.Assign(targets=[target], value=value) if last(target):
                name = ast.unparse(target)
                if name in seen:
                    continue
                seen.add(name)
                given = values.assigned(name)
                numbers = (ast.Constant, ast.UnaryOp, type(None))  # None: a sum that grows
                is_number = all(isinstance(each, numbers) for each in given)
                if name in divisors and is_number and getattr(value, "value", None) == 0:
                    yield "zero", name, ast.unparse(value), node.lineno
                if last(target) in changed or len(given) > 1:
                    continue
                match value:
                    case ast.Dict(keys=[ast.Constant() as first, *_] as keys) if None not in keys:
                        written = ", ".join(ast.unparse(key) for key in keys if key)
                        yield "holds", name, written, first.lineno
                    case ast.List(elts=parts) | ast.Tuple(elts=parts) if parts:
                        yield "holds", name, f"0 to {len(parts) - 1}", node.lineno
            case ast.FunctionDef():
                inside = [*scope_nodes(node)]
                if any(isinstance(each, ast.Yield | ast.YieldFrom) for each in inside):
                    loops = (each.lineno for each in inside if isinstance(each, ast.For))
                    yield "ends", node.name, "", min(loops, default=node.lineno)


def find(source: Source, values: Values) -> Iterator[Found]:
    """Yield where the pose is compared with the middle of the window, or tells that a wall is near.

    Yields: the kind of `LintFinding`, its name and near, and a line.
    """
    conditions: list[tuple[ast.expr, set[str], str]] = []
    for node in source.nodes:
        if isinstance(node, ast.Compare):
            yield from _of_the_middle(node, source, values)
        if not isinstance(node, ast.BoolOp | ast.Compare) or len(conditions) >= MOST:
            continue
        if not _is_part(node, source, values) and (told := _walls(node, values)) is not None:
            conditions.append((node, *told))
    all_told = {wall for _, told, _ in conditions for wall in told}
    missing = ", ".join(wall for wall in WALLS if wall not in all_told)
    for node, _, wrong in conditions:
        near = wrong or missing
        line = node.lineno if near else _where_used(node, source)
        yield "at_wall", ast.unparse(node), near, line


def _where_used(node: ast.expr, source: Source) -> int:
    """Return the line that decides by a condition; that of the `if` which asks its function."""
    outer = source.function_around(node)
    returns = (n for n in ast.walk(outer) if isinstance(n, ast.Return)) if outer else ()
    if outer is None or not any(each.value for each in returns):
        return node.lineno
    for each in source.nodes:
        if isinstance(each, ast.If | ast.While):
            asked = (last(n.func) for n in ast.walk(each.test) if isinstance(n, ast.Call))
            if outer.name in asked:
                return each.lineno
    return node.lineno


def _of_the_middle(node: ast.Compare, source: Source, values: Values) -> Iterator[Found]:
    parts = [node.left, *node.comparators]
    axes = [last(each) for each in parts if last(each) in ("x", "y")]
    for part in parts if axes else []:
        try:
            limit = values.of(part)
        except Unknown:
            continue
        if 4 < limit < 7 or (limit == 0 and len(parts) == 2):
            beside = _axes_beside(node, source)
            is_one_axis = len(beside) > 1 and len({*beside}) == 1
            yield "at_middle", "one axis" if is_one_axis else axes[0], str(limit), node.lineno


def _axes_beside(node: ast.Compare, source: Source) -> list[str]:
    """Return the axes that the expression around a comparison compares, one for each time."""
    outer: ast.AST = node
    while isinstance(source.parents.get(outer), ast.expr):
        outer = source.parents[outer]
    return [
        last(part)
        for each in ast.walk(outer)
        if isinstance(each, ast.Compare) and len(each.ops) == 1
        for part in (each.left, *each.comparators)
        if last(part) in ("x", "y")
    ]


def _is_part(node: ast.expr, source: Source, values: Values) -> bool:
    """Whether a larger condition is judged as a whole."""
    outer = source.parents.get(node)
    while isinstance(outer, ast.BoolOp) or (
        isinstance(outer, ast.UnaryOp) and isinstance(outer.op, ast.Not)
    ):
        try:
            values.of(outer, MIDDLE_M, MIDDLE_M)
        except Unknown:
            return False
        if isinstance(outer, ast.BoolOp):
            return True
        outer = source.parents.get(outer)
    return False


def _walls(node: ast.expr, values: Values) -> tuple[set[str], str] | None:
    """Judge a condition to stop, or to drive on; None for what is neither.

    Returns: the walls that it tells, and what is wrong with it: 'never', 'always' - it is true;
        'middle' - it is, far from all walls; 'corners' - it is, in corners only; '' for nothing.
    """
    try:
        ring = {bool(values.of(node, x, y)) for x, y in _RING}
        corners = [bool(values.of(node, x, y)) for x, y in _CORNERS]
        at = {w: [bool(values.of(node, x, y)) for x, y in each] for w, each in WALLS.items()}
        is_fixed = not {last(each) for each in ast.walk(node)} & {"x", "y"}
    except Unknown:
        return None
    if len(ring) > 1:
        return None  # it tells parts of the window apart
    (inside,) = ring
    told = {wall for wall, found in at.items() if all(each is not inside for each in found)}
    if not told and not any(each is not inside for each in corners):
        return None if is_fixed else (set(), "always" if inside else "never")
    if not told:
        return told, "corners"
    is_any = isinstance(node, ast.BoolOp) and isinstance(node.op, ast.Or)
    return told, "middle" if inside and is_any else ""
