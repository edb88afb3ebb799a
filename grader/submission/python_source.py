"""What a Python file says of itself, read from its syntax tree; nothing is imported or run."""

from __future__ import annotations

import ast
import posixpath
import re
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from string import Formatter
from typing import Final

from grader.submission import encoding
from grader.submission.folder import read_bounded

UNKNOWN: Final = object()  # the value of an expression that only a run could tell

_MAX_LENGTH: Final = 10_000  # of a folded string or list: "a = b + b" forty times over is a bomb
_MUTATORS: Final = {"append", "clear", "extend", "insert", "pop", "remove", "setdefault", "update"}
_NAMES_UNSEEN: Final = {"exec", "globals", "locals", "setattr", "vars"}  # may define any name
_UNPARSED_MAIN: Final = re.compile(rb"^(async\s+)?def\s+main\b", re.MULTILINE)


@dataclass(frozen=True)
class Source:
    """A Python file as far as it can be seen without running it."""

    parses: bool  # if not, the two below are guesses from the text, and `names` is empty
    has_guard: bool  # if __name__ == "__main__":
    has_main: bool  # a function `main` at module level
    calls_main: bool = False  # at module level, guard or not
    defined: tuple[str, ...] = ()  # functions, classes and variables at module level, in order
    names: frozenset[str] = frozenset()  # these and the imported ones
    open_ended: bool = False  # more names may come: import *, globals(), …
    is_refused: bool = False  # by `python3 FILE`, for its bytes; an import may pass over them

    def surely_lacks(self, name: str) -> bool:
        """Tell whether an import of the file could not give it this name."""
        return self.parses and not self.open_ended and name not in self.names


def parse(data: bytes, file_name: str) -> ast.Module:
    """Parse Python.

    Raises:
        SyntaxError: it does not parse; also for null bytes, wrong encodings, absurd nesting.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore"
            )  # "invalid escape sequence" is for the student's own run
            return ast.parse(data, file_name)
    except (ValueError, RecursionError, MemoryError) as error:
        raise SyntaxError(str(error) or "nested too deeply, or too large") from error


def read_source(path: Path) -> Source:
    """Look at a student's file.

    One that does not parse is no error here: the run shows the interpreter's own message.
    """
    data = read_bounded(path)
    if data is None:
        return Source(parses=False, has_guard=False, has_main=False)
    try:
        tree = parse(data, path.name)
    except SyntaxError:
        return Source(
            parses=False,
            has_guard=any(map(_looks_like_guard, data.splitlines())),
            has_main=bool(_UNPARSED_MAIN.search(data)),
        )
    return replace(_seen(tree), is_refused=bool(encoding.fault(data)))


def _looks_like_guard(line: bytes) -> bool:
    """Tell whether a line begins as `if __name__ == "__main__"` does, without a look at the rest.

    In steps, since an expression for all of it would try each `__name__` with each `__main__`.
    """
    if not re.match(rb"if\b", line):
        return False
    _, name, rest = line.partition(b"__name__")
    return bool(name) and re.search(rb"""['"]__main__['"]""", rest) is not None


def _seen(tree: ast.Module) -> Source:
    top = sorted(_module_level(tree), key=lambda node: getattr(node, "lineno", 0))
    defined: dict[str, None] = {}
    imported: set[str] = set()
    has_guard = has_main = calls_main = False
    for node in top:
        match node:
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
                defined[name] = None
                has_main = has_main or name == "main"
            case ast.ClassDef(name=name) | ast.Name(id=name, ctx=ast.Store()):
                defined[name] = None
            case ast.alias(name=name, asname=asname):
                imported.add(asname or name.split(".")[0])
            case ast.If(test=test):
                has_guard = has_guard or _is_guard(test)
            case ast.Call():
                calls_main = calls_main or "main" in _names_in(node)
    everywhere = list(ast.walk(tree))
    made_global = {
        name for node in everywhere if isinstance(node, ast.Global) for name in node.names
    }
    used = {node.id for node in everywhere if isinstance(node, ast.Name)}
    names = frozenset(defined) | imported | made_global
    open_ended = bool(used & _NAMES_UNSEEN or names & {"*", "__getattr__"})
    return Source(True, has_guard, has_main, calls_main, tuple(defined), names, open_ended)


def _module_level(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the nodes whose names are the module's: not those inside functions and classes."""
    pending: list[ast.AST] = list(tree.body)
    while pending:
        node = pending.pop()
        yield node
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)):
            pending += ast.iter_child_nodes(node)


def _names_in(node: ast.AST) -> set[str]:
    return {inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)}


def _is_guard(test: ast.expr) -> bool:
    texts = {inner.value for inner in ast.walk(test) if isinstance(inner, ast.Constant)}
    return "__name__" in _names_in(test) and "__main__" in texts


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
