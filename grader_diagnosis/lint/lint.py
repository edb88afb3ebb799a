"""Lints the source of a submission for what is seldom meant; the findings are for a diagnosis.

Runs once, where a submission is read. `docs/lint-findings.md` describes each kind. No finding is an
error by itself; a rule of the diagnosis reports it where it explains one.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from grader.recording.observations import LintFinding, SourceLine
from grader.submission import Function, last, parse, read_bounded, scope_nodes, seen
from grader.text import nearest
from grader_diagnosis.lint import paths, ros_mistakes, scopes
from grader_diagnosis.lint.scopes import Found, Source
from grader_diagnosis.misspelling import misspelt

#: So many findings are kept, and so much of a name or a line [characters].
MOST, LONGEST = 80, 300
#: So many files are looked at for one that an import may mean.
MOST_FILES = 1000
#: Longer sources are not linted [characters].
MOST_SOURCE = 200_000
SPINS = ("spin", "spin_once", "spin_until_future_complete", "add_node")
THREADS = ("Thread", "Process", "Timer")
#: Exceptions that catch every error, and functions that show the one that is being handled.
CATCH_ALL = ("Exception", "BaseException")
SHOWS = ("print_exc", "format_exc", "print_exception", "exc_info", "exception")
#: Functions that read or set attributes by names which the syntax tree does not show.
BY_NAME = ("getattr", "setattr", "hasattr", "vars", "locals", "globals", "eval", "exec", "__dict__")


@dataclass
class Names:
    """The names in all files together.

    Attributes:
        read: names of attributes that are read anywhere.
        functions: those that are defined anywhere, by name.
        bound: names that anything is assigned to, or that are arguments.
        kept: names of attributes that anything is assigned to.
        passed: names that any call is given, and functions that a lambda calls.
        are_all: whether nothing reads or sets attributes by names that are not seen here.
    """

    read: set[str] = field(default_factory=set)
    functions: dict[str, Function] = field(default_factory=dict)
    bound: set[str] = field(default_factory=set)
    kept: set[str] = field(default_factory=set)
    classes: set[str] = field(default_factory=set)
    passed: set[str] = field(default_factory=set)
    are_all: bool = True

    def add(self, source: Source) -> None:
        """Add the names in one file."""
        for node in source.nodes:
            match node:
                case ast.Attribute(attr=name, ctx=ast.Load()):
                    self.read.add(name)
                case ast.Attribute(attr=name):
                    self.kept.add(name)
                case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name):
                    self.bound.add(name)
                case ast.FunctionDef() | ast.AsyncFunctionDef():
                    self.functions[node.name] = node
                case ast.ClassDef(name=name):
                    self.classes.add(name)
                case ast.Call(args=args, keywords=words):
                    self.passed |= {last(each) for each in (*args, *(w.value for w in words))}
                case ast.Lambda(body=body):
                    self.passed |= _called_in(body)
                case ast.AugAssign(target=ast.Attribute(attr=name)):
                    self.read.add(name)

    def callbacks(self) -> set[str]:
        """Return the functions that are passed as callbacks, and all that these call."""
        found: set[str] = set()
        waiting = list(self.passed)
        while waiting:
            name = waiting.pop()
            if name in self.functions and name not in found:
                found.add(name)
                waiting += _called_in(self.functions[name])
        return found


def lint(root: Path, files: Iterable[Path]) -> tuple[LintFinding, ...]:
    """Lint files of a submission, by their paths below its root; () if they cannot be read."""

    def lies(name: str) -> bool:
        return (root / name).is_dir() or (root / f"{name}.py").is_file()

    lines = {}
    try:
        for file in files:
            text = (read_bounded(file) or b"").decode("utf-8", "replace")
            lines[file.relative_to(root).as_posix()] = text.splitlines()
        sources = {file: "\n".join(text) for file, text in lines.items()}
        is_short = sum(map(len, sources.values())) <= MOST_SOURCE
        parsed = parsed_of(sources) if is_short else {}
        found = find(parsed, sources, lies)[:MOST]
        found += _elsewhere(parsed, root, lies)
        steps = ((file, step) for file, source in parsed.items() for step in paths.find(source))
        found += islice(steps, paths.MOST)
    except (OSError, RecursionError, MemoryError, ValueError):
        return ()
    return tuple(
        LintFinding(
            *(kind, name[:LONGEST], near[:LONGEST]),
            SourceLine(file, line, text=lines[file][line - 1].strip()[:LONGEST]),
        )
        for file, (kind, name, near, line) in found
    )


def parsed_of(sources: Mapping[str, str]) -> dict[str, Source]:
    """Parse files, by their texts; what cannot be parsed is left out."""
    parsed = {}
    for file, text in sources.items():
        with suppress(SyntaxError):
            parsed[file] = Source(parse(text.encode("utf-8", "replace")))
    return parsed


def find(
    parsed: Mapping[str, Source], sources: Mapping[str, str], lies: Callable[[str], bool]
) -> list[tuple[str, Found]]:
    """Return the findings in some files, each with its file.

    Args:
        sources: the texts of all files.
        lies: whether there is a module of this name, as 'folder/name', in the submission.
    """
    by_name = re.compile(rf"\b({'|'.join(BY_NAME)})\b")
    names = Names(are_all=not any(by_name.search(text) for text in sources.values()))
    for source in parsed.values():
        names.add(source)
    files, callbacks = parsed.items(), names.callbacks()
    rules = (_of_classes, _not_declared, _without_brackets, _passed)
    found = [(f, each) for f, source in files for rule in rules for each in rule(source, names)]
    if names.are_all and not names.read & {"call_async", "call"}:
        found += ((file, each) for file, source in files for each in _unsent(source))
    found += ((file, each) for file, source in files for each in _beside(source, file, lies))
    found += _own_modules(parsed)
    found += ((file, each) for file, source in files for each in _swallows(source, callbacks))
    found += ros_mistakes.find(parsed)
    return list(dict.fromkeys(found))


def _beside(source: Source, file: str, lies: Callable[[str], bool]) -> Iterator[Found]:
    """Yield modules of the importing package that are imported as if they lay beside it."""
    folder = file.rpartition("/")[0]
    for node in source.nodes:
        match node:
            case ast.Import(names=names):
                modules = [each.name for each in names]
            case ast.ImportFrom(module=str() as module, level=0):
                modules = [module]
            case _:
                continue
        for name in (each.partition(".")[0] for each in modules):
            if folder and not lies(name) and lies(f"{folder}/{name}"):
                near = ".".join((*folder.split("/"), name))
                yield "beside", name, near, node.lineno


def _own_modules(sources: Mapping[str, Source]) -> Iterator[tuple[str, Found]]:
    """Yield imports from a module of the submission's that lacks the name, or imports this one."""
    imports = [
        (file, node, other)
        for file, source in sources.items()
        for node in source.nodes
        if isinstance(node, ast.ImportFrom) and (other := _imported_file(file, node, sources))
    ][:MOST]
    pairs = {(file, other) for file, _, other in imports}
    modules = {other: seen(sources[other].tree) for other in {other for _, other in pairs}}
    used = {
        file: {node.id for node in sources[file].nodes if isinstance(node, ast.Name)}
        for file in {file for file, other in pairs if (other, file) in pairs}
    }
    for file, node, other in imports:
        module = modules[other]
        for name in (alias.name for alias in node.names[:MOST]):
            if name != "*" and module.defined and module.surely_lacks(name):
                has = ", ".join(nearest(name, module.defined)[:1] or module.defined)
                yield file, ("not_defined", name, has, node.lineno)
        if (other, file) in pairs:
            is_used = used[file] & {alias.asname or alias.name for alias in node.names}
            yield file, ("circular", other, "" if is_used else "unused", node.lineno)


def _imported_file(file: str, node: ast.ImportFrom, files: Iterable[str]) -> str | None:
    """Return the file of the submission that `from ... import` reads; None for any other."""
    path = _imported_path(file, node)
    return next((each for each in (f"{path}.py", f"{path}/__init__.py") if each in files), None)


def _imported_path(file: str, node: ast.ImportFrom) -> str:
    """Return where `from ... import` looks below the root of the submission: 'folder/name'."""
    folders = file.split("/")[: -node.level] if node.level else []
    return "/".join([*folders, *(node.module or "").split(".")])


def _elsewhere(
    parsed: Mapping[str, Source], root: Path, lies: Callable[[str], bool]
) -> Iterator[tuple[str, Found]]:
    """Yield imports of modules of a package that lie in another place, or in other letters."""
    missing = [
        (path, file, node.lineno)
        for file, source in parsed.items()
        for node in source.nodes
        if isinstance(node, ast.ImportFrom)
        and node.module
        and "/" in (path := _imported_path(file, node))
        and lies(path.rpartition("/")[0])
        and not lies(path)
    ]
    files = islice(root.rglob("*.py"), MOST_FILES) if missing else ()
    there = {each.name.lower(): each.relative_to(root).as_posix() for each in files}
    for path, file, line in missing:
        if near := there.get(f"{path.rpartition('/')[2].lower()}.py"):
            yield file, ("elsewhere", f"{path}.py", near, line)


# Attributes and methods ---------------------------------------------------------------------------


def _methods(of: ast.ClassDef) -> list[Function]:
    return [node for node in of.body if isinstance(node, Function)]


def _set_in(node: ast.AST) -> dict[str, int]:
    """Map the attributes of self that are set below a node to the line where first."""
    lines: dict[str, int] = {}
    for each in ast.walk(node):
        match each:
            case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Store()):
                lines[name] = min(each.lineno, lines.get(name, each.lineno))
    return lines


def _of_the_start(of: ast.ClassDef) -> set[str]:
    """Return the attributes that are set when the first callback is called."""
    inits = (method for method in _methods(of) if method.name == "__init__")
    found = {name for init in inits for name in _set_in(init)}
    for node in of.body:
        if isinstance(node, ast.Assign):
            found |= {target.id for target in node.targets if isinstance(target, ast.Name)}
    return found


def _of_classes(source: Source, names: Names) -> Iterator[Found]:
    for of in source.nodes:
        if isinstance(of, ast.ClassDef):
            if names.are_all:
                yield from _unread(of, names)
            yield from _of_methods(of)
            for method in _methods(of):
                yield from _meant_for_self(of, method, names)


def _unread(of: ast.ClassDef, names: Names) -> Iterator[Found]:
    start = _of_the_start(of)
    for name, line in _set_in(of).items():
        if name in start or name in names.read:
            continue
        near = next((o for o in sorted(start & names.read) if misspelt(name, o)), None)
        if near is not None:
            yield "unread", name, near, line


def _of_methods(of: ast.ClassDef) -> Iterator[Found]:
    kept = _set_in(of)
    for method in _methods(of):
        if method.decorator_list:
            continue
        if method.name in kept:
            yield "method", method.name, "", kept[method.name]
        arguments = [*method.args.posonlyargs, *method.args.args]
        if not method.args.vararg and [each.arg for each in arguments[:1]] not in (
            ["self"],
            ["cls"],
        ):
            yield "without_self", method.name, "", method.lineno


def _meant_for_self(of: ast.ClassDef, method: Function, names: Names) -> Iterator[Found]:
    """Yield variables that are never read, where an attribute has the same name."""
    start = _of_the_start(of)
    for name, line in scopes.unread(method).items():
        if name in start and name in names.read:
            yield "local", name, f"self.{name}", line


def _not_declared(source: Source, _: Names) -> Iterator[Found]:
    return scopes.not_declared(source.tree)


# Brackets -----------------------------------------------------------------------------------------


def _without_brackets(source: Source, names: Names) -> Iterator[Found]:
    """Yield functions that are not called where only their result makes sense."""
    for node in source.nodes:
        asked: Sequence[ast.expr] = ()
        match node:
            case ast.If(test=test) | ast.While(test=test) | ast.IfExp(test=test):
                asked = list(_leaves(test))
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                asked = list(_leaves(operand))
            case ast.Expr(value=ast.Attribute(attr=name) as value) if name not in names.kept:
                yield "uncalled", ast.unparse(value), "", node.lineno
            case ast.Expr(value=ast.Name() as value):
                asked = [value]
        for each in asked:
            match each:
                case ast.Attribute(value=ast.Name(id="self"), attr=name):
                    is_function = name in names.functions and name not in names.kept
                case ast.Name(id=name):
                    is_function = name in names.functions and name not in names.bound
                case _:
                    continue
            if is_function and not names.functions[name].decorator_list:
                yield "uncalled", ast.unparse(each), "", each.lineno


def _leaves(test: ast.expr) -> Iterator[ast.expr]:
    """Yield the operands of a condition."""
    match test:
        case ast.BoolOp(values=values):
            for value in values:
                yield from _leaves(value)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield from _leaves(operand)
        case ast.Compare(left=left, comparators=others):
            yield from (left, *others)
        case _:
            yield test


def _passed(source: Source, names: Names) -> Iterator[Found]:
    """Yield what a thread or an executor is wrongly given: a call's result, or a class."""
    for node in source.nodes:
        if not isinstance(node, ast.Call):
            continue
        to = last(node.func)
        if to in THREADS:
            for word in node.keywords:
                inner = word.value
                if word.arg not in ("target", "function") or not isinstance(inner, ast.Call):
                    continue
                function = names.functions.get(last(inner.func))
                is_idle = function is not None and scopes.returns_nothing(function)
                if is_idle or last(inner.func) in SPINS:
                    name = ast.unparse(inner.func)
                    yield "called", name, f"{to}({word.arg}=", inner.lineno
        if to in SPINS:
            for each in node.args:
                if isinstance(each, ast.Name) and each.id in names.classes - names.bound:
                    yield "class", each.id, ast.unparse(node.func), node.lineno


def _called_in(node: ast.AST) -> set[str]:
    return {last(each.func) for each in ast.walk(node) if isinstance(each, ast.Call)}


def _unsent(source: Source) -> Iterator[Found]:
    """Yield requests that are made, where nothing ever calls a service."""
    for call in source.calls("Request"):
        if isinstance(call.func, ast.Attribute):
            yield "unsent", ast.unparse(call.func.value), "", call.lineno


# Errors that are never shown ----------------------------------------------------------------------


def _swallows(source: Source, callbacks: set[str]) -> Iterator[Found]:
    """Yield each `except` in a callback that catches all errors, and neither raises nor shows."""
    for function in source.nodes:
        if isinstance(function, Function) and function.name in callbacks:
            for node in scope_nodes(function):
                if isinstance(node, ast.ExceptHandler) and _catches_all(node) and _is_silent(node):
                    yield "swallows", function.name, "", node.lineno


def _catches_all(handler: ast.ExceptHandler) -> bool:
    match handler.type:
        case None:
            return True
        case ast.Tuple(elts=kinds):
            return any(last(kind) in CATCH_ALL for kind in kinds)
        case kind:
            return last(kind) in CATCH_ALL


def _is_silent(handler: ast.ExceptHandler) -> bool:
    for node in ast.walk(handler):
        match node:
            case ast.Raise():
                return False
            case ast.Name(id=name) if name == handler.name:
                return False
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.keyword(arg=name):
                if name in SHOWS:
                    return False
    return True
