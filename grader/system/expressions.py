"""Expressions of plain data: an exercise's `"=a + b"`, `"Hello World: {n}"`, a source's conditions.

A fixed part of Python's syntax over plain data (numbers, texts, lists, and objects with fields),
which is interpreted here: nothing can be imported, called or looked up but what is listed. What it
costs is bounded, since a program's messages are among the values.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, Final

from grader.text.message import Message, msg

#: The most steps of an evaluation, of which a value costs one for each value within it; the longest
#: text or list; the greatest whole number [bits].
MOST_STEPS, LONGEST, MOST_BITS = 200_000, 20_000, 256
#: The longest expression [characters], how many parts of it may be within each other, and the most
#: values of a template.
LONGEST_TEXT, DEEPEST, MOST_VALUES = 500, 60, 10_000
#: So many characters of a text cost a step, and so many digits a number may be rounded to.
PER_STEP, MOST_DIGITS = 64, 15
_BINARY: Final[Mapping[type, Callable[[Any, Any], Any]]] = {
    **{ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul},
    **{ast.Div: operator.truediv, ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod},
    **{ast.Pow: operator.pow},
}
_UNARY: Final[Mapping[type, Callable[[Any], Any]]] = {
    **{ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_},
}
_COMPARED: Final[Mapping[type, Callable[[Any, Any], bool]]] = {
    **{ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le},
    **{ast.Gt: operator.gt, ast.GtE: operator.ge},
    **{ast.In: lambda a, b: a in b, ast.NotIn: lambda a, b: a not in b},
}
_ONE, _SOME = range(1, 2), range(1, 100)
#: Functions, and how many arguments each may have.
FUNCTIONS: Final[Mapping[str, tuple[Callable[..., Any], range]]] = {
    **{"len": (len, _ONE), "sum": (sum, _ONE), "min": (min, _SOME), "max": (max, _SOME)},
    **{"abs": (abs, _ONE), "round": (round, range(1, 3)), "int": (int, _ONE)},
    **{"float": (float, _ONE), "str": (str, _ONE), "sorted": (sorted, _ONE)},
    **{"mean": (lambda values: sum(values) / len(values), _ONE), "sqrt": (math.sqrt, _ONE)},
    **{"log": (math.log, range(1, 3)), "exp": (math.exp, _ONE), "sin": (math.sin, _ONE)},
    **{"cos": (math.cos, _ONE), "atan2": (math.atan2, range(2, 3)), "hypot": (math.hypot, _SOME)},
    "index": (lambda values, value: values.index(value), range(2, 3)),
    "range": (lambda *ends: list(range(*ends)), range(1, 4)),
}
CONSTANTS: Final = {"pi": math.pi, "inf": math.inf, "nan": math.nan, "true": True, "false": False}
#: What a text has an expression in; {2} and {2,3} are a pattern's.
_HOLE: Final = re.compile(r"\{(?!\d+,?\d*\}|,\d+\})([^{}]*)\}")
#: How a value is written in a text: {x:.2f}.
_FORM: Final = re.compile(r"(.*?)(?::([0-9]{0,2}(?:\.[0-9]{1,2})?[a-z]?))?", re.DOTALL)
ALLOWED: Final = msg(
    "numbers, texts, lists, + - * / // % **, comparisons, and, or, not, `a if b else c`, "
    "fields (pose.x), places (data[-1], data[1:]), [x for x in data], and {functions}",
    functions=", ".join(FUNCTIONS),
)


class ExpressionError(Exception):
    """An expression is none, or its value cannot be computed; the message says why."""

    def __init__(self, message: Message) -> None:
        super().__init__(str(message))
        self.message = message


@dataclass(frozen=True)
class Expression:
    """A value that is computed of others.

    Attributes:
        text: as it was written, without its '='.
    """

    text: str
    tree: ast.expr

    @property
    def names(self) -> set[str]:
        """The names of the values that it needs."""
        return set(_names(self.tree, frozenset(CONSTANTS)))

    def value(self, names: Mapping[str, Any], most_steps: int = MOST_STEPS) -> Any:
        """Compute it.

        Args:
            names: the values that it may use.
            most_steps: so many it may take.

        Raises:
            ExpressionError: that is not possible with these.
        """
        return _Evaluation(names, most_steps).of(self)


@cache
def parse(text: str) -> Expression:
    """Parse an expression.

    Raises:
        ExpressionError: it is none of those that are allowed.
    """
    if len(text) > LONGEST_TEXT:
        raise ExpressionError(msg("an expression has at most {n} characters", n=LONGEST_TEXT))
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        what = getattr(error, "msg", str(error))
        raise ExpressionError(
            msg("`{text}` is no expression: {what}", text=text, what=what)
        ) from None
    level: list[ast.AST] = [tree]
    for _ in range(DEEPEST):
        level = [inner for node in level for inner in ast.iter_child_nodes(node)]
    if level:
        raise ExpressionError(msg("an expression has at most {n} levels", n=DEEPEST))
    for node in ast.walk(tree):
        if not _is_allowed(node):
            raise ExpressionError(
                msg(
                    "`{part}` is not allowed in `{text}`. Allowed are {allowed}",
                    part=ast.unparse(node) if isinstance(node, ast.expr) else type(node).__name__,
                    text=text,
                    allowed=ALLOWED,
                )
            )
        if isinstance(node, ast.Call) and len(node.args) not in FUNCTIONS[_name(node.func)][1]:
            raise ExpressionError(msg("`{part}` has too many or too few arguments",
                                      part=ast.unparse(node)))  # fmt: skip
    return Expression(text, tree)


def _names(node: ast.AST, known: frozenset[str]) -> Iterator[str]:
    """Yield the names in a part of an expression that are neither known nor functions called."""
    match node:
        case ast.Name(name):
            yield from {name} - known
        case ast.Call(_, arguments):
            for each in arguments:
                yield from _names(each, known)
        case ast.ListComp(element, [ast.comprehension(ast.Name(name), iterated, conditions)]):
            yield from _names(iterated, known)
            for each in (element, *conditions):
                yield from _names(each, known | {name})
        case _:
            for inner in ast.iter_child_nodes(node):
                yield from _names(inner, known)


def _name(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else ""


def _is_allowed(node: ast.AST) -> bool:
    match node:
        case ast.Constant(value):
            return isinstance(value, (bool, int, float, str))
        case ast.Call(func, _, keywords):
            return _name(func) in FUNCTIONS and not keywords
        case ast.Attribute(_, name):
            return not name.startswith("_")
        case ast.ListComp(_, generators):
            return len(generators) == 1
        case ast.comprehension(target, _, _, is_async):
            return isinstance(target, ast.Name) and not is_async
        case ast.Name() | ast.List() | ast.Subscript() | ast.Slice() | ast.IfExp() | ast.BoolOp():
            return True
        case ast.BinOp(_, sign):
            return type(sign) in _BINARY
        case ast.UnaryOp(sign):
            return type(sign) in _UNARY
        case ast.Compare(_, signs):
            return all(type(sign) in _COMPARED for sign in signs)
        case ast.operator() | ast.unaryop() | ast.cmpop() | ast.boolop() | ast.expr_context():
            return True
    return False


class _Evaluation:
    """One evaluation, with what it may still cost."""

    def __init__(self, names: Mapping[str, Any], most_steps: int) -> None:
        self._names = {**CONSTANTS, **names}
        self._most = self._left = most_steps

    def of(self, expression: Expression) -> Any:
        try:
            made = self._value(expression.tree)
            self._charge(made)
            return made
        except ExpressionError:
            raise
        except Exception as error:  # whatever the values of a program lead to
            raise ExpressionError(
                msg(
                    "`{text}` cannot be computed: {why}",
                    text=expression.text,
                    why=f"{error!s:.200}" or type(error).__name__,
                )
            ) from None

    def _value(self, node: Any) -> Any:
        self._left -= 1
        self._charge(0)  # there may be no step left
        return self._bounded(self._computed(node))

    def _computed(self, node: Any) -> Any:
        match node:
            case ast.Constant(value):
                return value
            case ast.Name(name):
                if name not in self._names:
                    raise ExpressionError(msg("there is no value {name}", name=name))
                return self._names[name]
            case ast.List(elements):
                return [self._value(each) for each in elements]
            case ast.Attribute(inner, name):
                fields = self._value(inner)
                if not isinstance(fields, Mapping) or name not in fields:
                    raise ExpressionError(msg("there is no field {name}", name=name))
                return fields[name]
            case ast.Subscript(inner, place):
                listed = self._value(inner)
                if isinstance(place, ast.Slice):
                    ends = (place.lower, place.upper, place.step)
                    begin, end, step = (e and self._value(e) for e in ends)
                    part = listed[begin:end:step]
                    self._left -= len(part)
                    return part
                at = self._value(place)
                if isinstance(listed, Mapping) and at not in listed:
                    raise ExpressionError(msg("there is no {name} yet", name=repr(at)))
                return listed[at]
            case ast.IfExp(test, then, other):
                return self._value(then if self._value(test) else other)
            case ast.BoolOp(sign, parts):
                is_and = isinstance(sign, ast.And)
                found: Any = is_and
                for each in parts:
                    found = self._value(each)
                    if bool(found) != is_and:
                        break
                return found
            case ast.UnaryOp(sign, inner):
                return _UNARY[type(sign)](self._value(inner))
            case ast.BinOp(left, sign, right):
                return self._combined(type(sign), self._value(left), self._value(right))
            case ast.Compare(left, signs, others):
                before = self._value(left)
                for compared, other in zip(signs, others, strict=True):
                    following = self._value(other)
                    if not isinstance(compared, (ast.In, ast.NotIn)):
                        self._charge(before)
                    if not isinstance(following, Mapping):
                        self._charge(following)
                    if not _COMPARED[type(compared)](before, following):
                        return False
                    before = following
                return True
            case ast.ListComp(element, [ast.comprehension(ast.Name(name), iterated, conditions)]):
                return self._listed(element, name, self._value(iterated), conditions)
            case ast.Call(ast.Name(name), arguments):
                values: list[Any] = [self._value(each) for each in arguments]
                if name != "len":
                    self._charge(values)
                if name == "range" and max(abs(int(v)) for v in values) > LONGEST:
                    raise ExpressionError(msg("a range has at most {n} numbers", n=LONGEST))
                if name == "round" and len(values) == 2 and abs(values[1]) > MOST_DIGITS:
                    raise ExpressionError(msg("a number has at most {n} digits", n=MOST_DIGITS))
                return FUNCTIONS[name][0](*values)
        raise ExpressionError(msg("`{part}` is not allowed", part=type(node).__name__))

    def _combined(self, sign: type, left: Any, right: Any) -> Any:
        are_numbers = isinstance(left, (int, float)) and isinstance(right, (int, float))
        if sign is ast.Pow and not (are_numbers and abs(right) <= MOST_BITS):
            raise ExpressionError(msg("a power has a number of at most {n} above", n=MOST_BITS))
        if sign is ast.Mult and not are_numbers:  # a text or a list, so many times
            times, other = (left, right) if isinstance(left, int) else (right, left)
            if not isinstance(times, int) or times * len(other) > LONGEST:
                raise ExpressionError(msg("a list has at most {n} values", n=LONGEST))
        if sign is ast.Mod and not are_numbers:
            raise ExpressionError(msg("texts are filled in as in {example}", example='"{n} of 3"'))
        made = _BINARY[sign](left, right)
        self._charge(made)
        return made

    def _listed(self, element: Any, name: str, values: Any, conditions: list[Any]) -> list[Any]:
        made, before = [], dict(self._names)
        for each in values:
            self._names[name] = each
            if all(self._value(condition) for condition in conditions):
                made.append(self._value(element))
        self._names = before
        return made

    def _charge(self, value: Any) -> None:
        """Charge for all that is within a value: it is copied, compared or written."""
        todo = [value]
        while todo:
            each = todo.pop()
            if isinstance(each, str):
                self._left -= len(each) // PER_STEP
            elif isinstance(each, (list, Mapping)):
                self._left -= len(each)
                if self._left >= 0:
                    todo += each.values() if isinstance(each, Mapping) else each
            if self._left < 0:
                raise ExpressionError(msg("an expression takes more than {n} steps", n=self._most))

    def _bounded(self, value: Any) -> Any:
        is_long = isinstance(value, (str, list)) and len(value) > LONGEST
        if is_long or (isinstance(value, int) and value.bit_length() > MOST_BITS):
            raise ExpressionError(msg("a value is too long or too great"))
        return value


# Templates: plain data with expressions in it ---------------------------------------------------


def check(template: Any, *, has_patterns: bool = False) -> set[str]:
    """Return the names that the expressions in a template need.

    Raises:
        ExpressionError: one of them is none, or can never be computed.
    """
    names = set[str]()
    for text in _texts(template):
        needed = {name for each in _expressions(text) for name in each.names}
        if has_patterns and is_pattern(text):
            _compiled(_HOLE.sub("x", text))
        elif not needed:
            filled(text, {})
        names |= needed
    return names


def looked_up(template: Any, name: str) -> set[str]:
    """Return what a template's expressions look up by a fixed key in a value: `heard["/data"]`."""
    trees = (each.tree for text in _texts(template) for each in _expressions(text))
    parts = (part for tree in trees for part in ast.walk(tree) if isinstance(part, ast.Subscript))
    keys = (part.slice for part in parts if _name(part.value) == name)
    return {str(key.value) for key in keys if isinstance(key, ast.Constant)}


def _texts(template: Any) -> Iterator[str]:
    """Yield the texts in a template, which may be too large."""
    todo, count = [template], 0
    while todo:
        each, count = todo.pop(), count + 1
        if count > MOST_VALUES:
            raise ExpressionError(msg("there are at most {n} values", n=MOST_VALUES))
        if isinstance(each, str):
            yield each
        elif isinstance(each, (Mapping, list, tuple)):
            todo += each.values() if isinstance(each, Mapping) else each


def _expressions(text: str) -> list[Expression]:
    """Parse the expressions of a text: of its holes, or the one that it is."""
    if text.startswith("="):
        return [parse(text[1:])]
    return [parse(_split(hole)[0]) for hole in _HOLE.findall(text)]


def with_fields(template: Any, name: str, fields: Mapping[str, Any]) -> Any:
    """Return a template in which the fields of a name are constants; what is constant is computed.

    Raises:
        ExpressionError: it needs another field of that name, or cannot be computed.
    """
    if isinstance(template, Mapping):
        return {key: with_fields(value, name, fields) for key, value in template.items()}
    if isinstance(template, (list, tuple)):
        return [with_fields(each, name, fields) for each in template]
    if not isinstance(template, str) or f"{name}." not in template:
        return template
    if template.startswith("="):
        computed = parse(_with_constants(template[1:], name, fields))
        return f"={computed.text}" if computed.names else computed.value({})

    def written(hole: re.Match[str]) -> str:
        text, form = _split(hole[1])
        # in brackets, since {2} is a pattern's
        constant = f"({_with_constants(text, name, fields)})"
        return f"{{{constant}:{form}}}" if form else f"{{{constant}}}"

    made = _HOLE.sub(written, template)
    return made if is_pattern(made) or check(made, has_patterns=True) else filled(made, {})


def _with_constants(text: str, name: str, fields: Mapping[str, Any]) -> str:
    class Constants(ast.NodeTransformer):
        def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
            if _name(node.value) != name:
                self.generic_visit(node)
                return node
            if node.attr not in fields:
                raise ExpressionError(msg("there is no value {name} here, only {known}",
                    name=f"{name}.{node.attr}", known=", ".join(fields) or "none"))  # fmt: skip
            return ast.Constant(fields[node.attr])

    parse(text)  # which says what is wrong with it
    return ast.unparse(Constants().visit(ast.parse(text.strip(), mode="eval")))


def filled(
    template: Any,
    names: Mapping[str, Any],
    *,
    has_patterns: bool = False,
    most_steps: int = MOST_STEPS,
) -> Any:
    """Return plain data with the values of a template's expressions.

    Args:
        has_patterns: whether texts between strokes become patterns: /[0-9]+/. What an expression
            returns is none.
        most_steps: so many an expression may take.

    Raises:
        ExpressionError: one cannot be computed with these.
    """
    fill = partial(filled, names=names, has_patterns=has_patterns, most_steps=most_steps)
    if isinstance(template, Mapping):
        return {key: fill(value) for key, value in template.items()}
    if isinstance(template, (list, tuple)):
        return [fill(each) for each in template]
    if not isinstance(template, str):
        return template
    if template.startswith("="):
        return parse(template[1:]).value(names, most_steps)
    is_one = has_patterns and is_pattern(template)

    def written(hole: re.Match[str]) -> str:
        text, form = _split(hole[1])
        try:
            made = format(parse(text).value(names, most_steps), form)
        except (ValueError, TypeError, OverflowError) as error:
            why = msg("{hole} cannot be written: {why}", hole=hole[0], why=str(error))
            raise ExpressionError(why) from None
        if len(made) > LONGEST:
            raise ExpressionError(msg("a value is too long or too great"))
        return re.escape(made).replace("\\ ", " ") if is_one else made  # as a sentence shows it

    made = _HOLE.sub(written, template)
    return _compiled(made) if is_one else made


def is_pattern(text: str) -> bool:
    """Whether a text is a pattern: /[0-9]+/."""
    return len(text) > 2 and text[0] == text[-1] == "/"


def _compiled(text: str) -> re.Pattern[str]:
    try:
        return re.compile(text[1:-1])
    except (re.error, OverflowError, RecursionError) as error:
        why = msg("{pattern} is no pattern: {why}", pattern=text, why=str(error))
        raise ExpressionError(why) from None


def _split(hole: str) -> tuple[str, str]:
    """Return the expression of a hole, and how its value is written."""
    found = _FORM.fullmatch(hole)
    return (found[1], found[2] or "") if found else (hole, "")
