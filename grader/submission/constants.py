"""The strings, lists and dicts that a Python file writes down, folded without running it."""

from __future__ import annotations

import ast
import posixpath
import re
from collections import Counter
from string import Formatter
from typing import Final

UNKNOWN: Final = object()  # the value of an expression that only a run could tell

_MAX_LENGTH: Final = 10_000  # of a folded string or list: "a = b + b" forty times over is a bomb
_MUTATORS: Final = {"append", "clear", "extend", "insert", "pop", "remove", "setdefault", "update"}


class Constants:
    """The strings, lists and dicts in a module, as far as its text alone fixes them.

    A name counts if it is bound once in the whole file and never changed. All else is UNKNOWN,
    also inside of lists and dicts; nothing is guessed.
    """

    def __init__(self, tree: ast.Module) -> None:
        self._bound = _bound_once(tree)
        self._known: dict[str, object] = {}

    def value(self, node: ast.expr) -> object:
        """Fold an expression to str, None, list or dict; else UNKNOWN."""
        match node:
            case ast.Constant(value=str() as value):
                return _short(value)
            case ast.Constant(value=None):
                return None
            case ast.Name(id=name):
                return self._named(name)
            case ast.JoinedStr(values=parts):
                return _joined([self._part(part) for part in parts])
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                return _sum(self.value(left), self.value(right))
            case ast.BinOp(left=left, op=ast.Mod(), right=right):
                return _percent(self.value(left), self.value(right))
            case ast.List(elts=items) | ast.Tuple(elts=items):
                return [self.value(item) for item in items]
            case ast.Dict(keys=keys, values=values):
                return self._dict(list(zip(keys, values, strict=True)))
            case ast.Call(func=ast.Name(id="dict"), args=[], keywords=keywords):
                return self.keywords(keywords)
            case ast.Call(
                func=ast.Attribute(
                    value=ast.Attribute(value=ast.Name(id="os"), attr="path"), attr="join"
                ),
                args=[_, *_] as parts,
                keywords=[],
            ):
                return _path([self.value(part) for part in parts])
            case ast.Call(
                func=ast.Attribute(value=template, attr="format"), args=args, keywords=keywords
            ):
                return _format(
                    self.value(template), [self.value(arg) for arg in args], self.keywords(keywords)
                )
        return UNKNOWN

    def keywords(self, keywords: list[ast.keyword]) -> object:
        """Fold the arguments of a call to a dict; UNKNOWN if `**more` of them are."""
        return self._dict([(ast.Constant(k.arg) if k.arg else None, k.value) for k in keywords])

    def _named(self, name: str) -> object:
        if name not in self._known:
            self._known[name] = UNKNOWN  # stands if the name is defined by itself
            if name in self._bound:
                self._known[name] = self.value(self._bound[name])
        return self._known[name]

    def _part(self, part: ast.expr) -> object:
        match part:
            case ast.FormattedValue(value=value, conversion=-1, format_spec=None):
                return self.value(value)
        return self.value(part)

    def _dict(self, items: list[tuple[ast.expr | None, ast.expr]]) -> object:
        result: dict[str, object] = {}
        for key_node, value_node in items:
            value = self.value(value_node)
            if key_node is None:
                if not isinstance(value, dict):
                    return UNKNOWN
                result |= value
            elif isinstance(key := self.value(key_node), str):
                result[key] = value
        return result


def _bound_once(tree: ast.Module) -> dict[str, ast.expr]:
    """Find the names that have one assignment and are not changed in any other way."""
    changes: Counter[str] = Counter()
    values: dict[str, ast.expr] = {}
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Store() | ast.Del()) | ast.arg(arg=name):
                changes[name] += 1
            case (
                ast.FunctionDef(name=name)
                | ast.AsyncFunctionDef(name=name)
                | ast.ClassDef(name=name)
            ):
                changes[name] += 1
            case ast.alias(name=name, asname=asname):
                changes[asname or name.split(".")[0]] += 1
            case ast.Subscript(ctx=ast.Store() | ast.Del()):
                changes[_base(node)] += 1
            case ast.Call(func=ast.Attribute(attr=attr) as method) if attr in _MUTATORS:
                changes[_base(method)] += 1
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                values[name] = value
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value):
                values[name] = value
    return {name: value for name, value in values.items() if changes[name] == 1}


def _base(node: ast.expr) -> str:
    """Find the name that `a.b['c'].d` hangs on; "" if it hangs on none."""
    while isinstance(node, (ast.Attribute, ast.Subscript)):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def _sum(left: object, right: object) -> object:
    if isinstance(left, str) and isinstance(right, str):
        return _short(left + right)
    if isinstance(left, list) and isinstance(right, list):
        return _short(left + right)
    return UNKNOWN


def _joined(parts: list[object]) -> object:
    texts = [part for part in parts if isinstance(part, str)]
    return _short("".join(texts)) if len(texts) == len(parts) else UNKNOWN


def _path(parts: list[object]) -> object:
    texts = [part for part in parts if isinstance(part, str)]
    return _short(posixpath.join(*texts)) if len(texts) == len(parts) else UNKNOWN


def _percent(template: object, values: object) -> object:
    """Do `template % values` with nothing but %s and %(name)s: a width may ask for gigabytes."""
    if not isinstance(template, str) or re.sub(r"%(\(\w+\))?s|%%", "", template).count("%"):
        return UNKNOWN
    arguments: object = tuple(values) if isinstance(values, list) else values
    contents = (
        values.values()
        if isinstance(values, dict)
        else values
        if isinstance(values, list)
        else [values]
    )
    if not all(isinstance(content, str) for content in contents):
        return UNKNOWN
    try:
        return _short(template % arguments)
    except (TypeError, ValueError, KeyError):
        return UNKNOWN


def _format(template: object, positional: list[object], named: object) -> object:
    """Do `template.format(…)` with nothing but {}, {0} and {name}."""
    if not isinstance(template, str) or not isinstance(named, dict):
        return UNKNOWN
    if not all(isinstance(content, str) for content in (*positional, *named.values())):
        return UNKNOWN
    try:
        fields = list(Formatter().parse(template))
        if any(
            spec or conversion or not re.fullmatch(r"\w*", field or "")
            for _, field, spec, conversion in fields
        ):
            return UNKNOWN
        return _short(template.format(*positional, **named))
    except (IndexError, ValueError, KeyError):
        return UNKNOWN


def _short(value: str | list[object]) -> object:
    return value if len(value) <= _MAX_LENGTH else UNKNOWN
