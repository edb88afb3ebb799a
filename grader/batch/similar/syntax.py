"""A Python file as words of its syntax tree, without what a copy can change for nothing.

Left out are comments, formatting, docstrings, annotations, imports, and statements that only print
or log. Names that the file itself gives are all the same word; those of others (`create_publisher`,
`linear`) stay, since a copy must keep them, and an imported name stands for what it was imported
as. Numbers are all the same word, and so are texts: a copy with slightly changed constants is one
still, and what a program does with its constants is seen in its behaviour. `a += b` reads as
`a = a + b`, `a > b` as `b < a`, `a, b = 1, 2` as two assignments.

Every function is a unit of its own, and so is what stands in a class or a module beside functions:
their order plays no part.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

#: What stands for a name of the file's own, a number, a text.
OWN, NUMBER, TEXT = "own", "number", "text"
#: Words of a unit, and of a source, that are looked at; a long submission has some 2,000.
MOST_WORDS = 60_000
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_LEFT_OUT = (ast.Import, ast.ImportFrom, ast.Global, ast.Nonlocal, ast.Pass)
#: Methods of a logger; what a statement only tells is no part of what a program does.
_TELLING = {"debug", "info", "warn", "warning", "error", "fatal", "critical", "log"}


class Word(NamedTuple):
    """A word, and the line that it stands in."""

    text: str
    line: int


#: Of one function, or of what stands beside functions.
Unit = list[Word]
_Item = ast.AST | str


@dataclass
class _Names:
    """Which names are the file's own, and what imported ones were called before."""

    own: set[str] = field(default_factory=set)
    attributes: set[str] = field(default_factory=set)
    imported: dict[str, str] = field(default_factory=dict)


def units(tree: ast.Module, own_modules: Iterable[str] = ()) -> Iterator[Unit]:
    """The units of a file, in the order in which they begin.

    Args:
        own_modules: modules that were handed in with it: what is imported from them is own, too.
    """
    yield from _Reader(_names(tree, set(own_modules))).units(tree)


def _names(tree: ast.Module, own_modules: set[str]) -> _Names:
    names = _Names()
    for node in ast.walk(tree):
        match node:
            case ast.ImportFrom(module=module, names=aliases, level=level):
                is_own = bool(level) or not own_modules.isdisjoint((module or "").split("."))
                _import(names, aliases, is_own)
            case ast.Import(names=aliases):
                _import(names, aliases, False)
            case ast.ClassDef(name=name, body=body):
                names.own.add(name)
                names.attributes.update(_defined_in(body))
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.Lambda():
                names.own.update([node.name] if not isinstance(node, ast.Lambda) else [])
                _parameters(names, node)
            case ast.Name(id=name, ctx=ast.Store()):
                names.own.add(name)
            case ast.ExceptHandler(name=str(name)):
                names.own.add(name)
    return names


def _import(names: _Names, aliases: list[ast.alias], is_own: bool) -> None:
    for alias in aliases:
        known_as = alias.asname or alias.name.partition(".")[0]
        if is_own:
            names.own.add(known_as)
        else:
            names.imported[known_as] = alias.name if alias.asname else known_as


def _defined_in(body: list[ast.stmt]) -> Iterator[str]:
    """Names that a class gives: methods and variables."""
    for node in body:
        if isinstance(node, _FUNCTIONS):
            yield node.name
        else:
            stored = (n for n in ast.walk(node) if isinstance(n, ast.Name))
            yield from (n.id for n in stored if isinstance(n.ctx, ast.Store))


def _parameters(
    names: _Names, function: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
) -> None:
    of = function.args
    every = [*of.posonlyargs, *of.args, *of.kwonlyargs]
    every += [arg for arg in (of.vararg, of.kwarg) if arg is not None]
    names.own.update(arg.arg for arg in every)
    first = every[0].arg if every else ""
    # What is stored in `self` is the file's own; what in a message, the message's.
    for node in ast.walk(function):
        match node:
            case ast.Attribute(value=ast.Name(id=name), attr=attr, ctx=ast.Store()) if (
                name == first
            ):
                names.attributes.add(attr)


class _Reader:
    """Goes through a tree with a list of what is still to be read: no depth makes it fall over."""

    def __init__(self, names: _Names) -> None:
        self._names = names
        self._waiting: list[ast.AST] = []

    def units(self, tree: ast.Module) -> Iterator[Unit]:
        self._waiting = [tree]
        while self._waiting:
            unit = self._unit(self._waiting.pop())
            if unit:
                yield unit

    def _unit(self, top: ast.AST) -> Unit:
        found: Unit = []
        inner: list[ast.AST] = []
        line = getattr(top, "lineno", 1)
        pending: list[tuple[_Item, int]] = [(item, line) for item in reversed(self._begin(top))]
        while pending and len(found) < MOST_WORDS:
            item, line = pending.pop()
            if isinstance(item, str):
                found.append(Word(item, line))
            elif isinstance(item, (*_FUNCTIONS, ast.ClassDef)):
                inner.append(item)
            else:
                line = getattr(item, "lineno", line)
                pending += [(part, line) for part in reversed(self._parts(item))]
        self._waiting += reversed(inner)
        return found

    def _begin(self, top: ast.AST) -> list[_Item]:
        match top:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                count = len(top.args.args) + len(top.args.kwonlyargs)
                defaults = [d for d in (*top.args.defaults, *top.args.kw_defaults) if d is not None]
                head: list[_Item] = [*top.decorator_list, f"def {count}"]
                return [*head, *defaults, *top.body]
            case ast.ClassDef():
                return [*top.decorator_list, "class", *top.bases, *top.body]
            case ast.Module():
                return [*top.body]
        return []

    def _parts(self, node: ast.AST) -> list[_Item]:
        """What a node is made of, in its order."""
        if isinstance(node, _LEFT_OUT) or (isinstance(node, ast.Expr) and _only_tells(node.value)):
            return []
        if isinstance(node, ast.stmt):
            return self._statement(node)
        return self._expression(node)

    def _statement(self, node: ast.stmt) -> list[_Item]:
        match node:
            case ast.Expr(value=value):
                return ["do", value]
            case ast.Assign(targets=[ast.Tuple(elts=left)], value=ast.Tuple(elts=right)) if len(
                left
            ) == len(right) and not any(isinstance(e, ast.Starred) for e in left):
                both = zip(left, right, strict=True)
                return [part for target, value in both for part in ("=", target, value)]
            case ast.Assign(targets=targets, value=value):
                return ["=", *targets, value]
            case ast.AnnAssign(target=target, value=value):
                return [] if value is None else ["=", target, value]
            case ast.AugAssign(target=target, op=op, value=value):
                return ["=", target, type(op).__name__, target, value]
            case ast.If(test=test, body=body, orelse=other):
                return ["if", test, *body, *(["else"] if other else []), *other, "end"]
        return self._anything(node)

    def _expression(self, node: ast.AST) -> list[_Item]:
        match node:
            case ast.Name(id=name):
                return [self._name(name)]
            case ast.Attribute(value=value, attr=attr):
                return [value, "." + (OWN if attr in self._names.attributes else attr)]
            case ast.Constant(value=value):
                return [_constant(value)]
            case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=ast.Constant() as number):
                return [number]
            case ast.JoinedStr(values=values):
                return [TEXT, *(v for v in values if isinstance(v, ast.FormattedValue))]
            case ast.FormattedValue(value=value):
                return [value]
            case ast.Call(func=func, args=args, keywords=keywords):
                named = sorted(keywords, key=lambda keyword: keyword.arg or "")
                return ["call", func, *args, *named, ")"]
            case ast.keyword(arg=arg, value=value):
                return [OWN if arg in self._names.own else f"{arg}=", value]
            case ast.Compare(left=left, ops=[ast.Gt() | ast.GtE() as op], comparators=[right]):
                return ["Lt" if isinstance(op, ast.Gt) else "LtE", right, left]
            case ast.Compare(left=left, ops=ops, comparators=right):
                return [*(type(op).__name__ for op in ops), left, *right]
            case ast.BinOp(left=left, op=op, right=right):
                return [type(op).__name__, left, right]
            case ast.expr_context() | ast.arguments():
                return []
        return self._anything(node)

    def _anything(self, node: ast.AST) -> list[_Item]:
        parts: list[_Item] = [*ast.iter_child_nodes(node)]
        kind = type(node).__name__
        return [kind, *parts, "end"] if isinstance(node, ast.stmt) and parts else [kind, *parts]

    def _name(self, name: str) -> str:
        imported = self._names.imported.get(name)
        if imported is not None:
            return imported
        return OWN if name in self._names.own else name


def _only_tells(value: ast.expr) -> bool:
    """Whether a statement is a docstring, or prints, or logs."""
    match value:
        case ast.Constant():
            return True
        case ast.Call(func=ast.Name(id="print")):
            return True
        case ast.Call(func=ast.Attribute(value=of, attr=attr)) if attr in _TELLING:
            names = {getattr(n, "id", getattr(n, "attr", "")) for n in ast.walk(of)}
            return any("log" in str(name).lower() for name in names)
    return False


def _constant(value: object) -> str:
    if value is None or isinstance(value, bool) or value is Ellipsis:
        return repr(value)
    return TEXT if isinstance(value, str | bytes) else NUMBER
