"""Notes which lines of a submission have run, and what its conditions were asked about.

A submission's files are compiled with a mark before each statement, which costs next to nothing
beside a trace function. The line numbers, and all that the program can see of itself but its
bytecode, are as without.
"""

from __future__ import annotations

import ast
import runpy
import sys
import warnings
from contextlib import suppress
from enum import Enum
from importlib.machinery import SourceFileLoader
from types import CodeType, FrameType, MemberDescriptorType
from typing import Any

from grader.run.lockstep.faults import pass_on
from grader.run.observe.files import Row, SubmissionFiles

#: Larger files get no marks [bytes]; so many conditions are asked for values, exceptions kept.
MOST_BYTES, MOST_ASKED, MOST_RAISED = 200_000, 60, 10
#: The names of a condition that are asked for; the longest value, and all of a line [characters].
MOST_NAMES, LONGEST_VALUE, LONGEST = 4, 40, 120
_PLAIN = (bool, int, float, str, type(None))
#: Stand in the syntax tree for what the marks use; see `_filled`.
_RAN, _ASK, _RAISED = "\0ran", "\0ask", "\0raised"


class _Ran(dict[int, bool]):
    """The lines that have run. A constant of code objects, and these are hashed."""

    __hash__ = object.__hash__  # type: ignore[assignment]


class LineMarks:
    """Has the files of a submission note which of their lines run."""

    def __init__(self, files: SubmissionFiles) -> None:
        self._files = files
        self._ran: dict[str, _Ran] = {}
        #: the values of a condition's names by its line; an exception by the line it came to
        self._asked: dict[tuple[str, int], str] = {}
        self._raised: dict[tuple[str, int], str] = {}
        self._times: dict[tuple[str, int], int] = {}

    def install(self) -> None:
        """Have all that is imported or run from now on compiled with marks."""
        get_plain = SourceFileLoader.get_code

        def get_code(loader: Any, name: str) -> CodeType | None:
            code, file = get_plain(loader, name), loader.get_filename(name)
            if code is None or not self._files.has(file):
                return code
            return self.marked(code, loader.get_data(file), file)

        def compile_program(source: Any, file: str, mode: str) -> CodeType:
            code: CodeType = pass_on(compile, source, file, mode)  # a SyntaxError is the file's
            return self.marked(code, source, file)

        SourceFileLoader.get_code = get_code  # type: ignore[assignment, method-assign]
        runpy.compile = compile_program  # type: ignore[attr-defined]

    def marked(self, code: CodeType, source: bytes | str, file: str) -> CodeType:
        """Return the code of a file with marks; as it is where it is not the submission's."""
        name = self._files.name(file)
        if not name or len(source) > MOST_BYTES:
            return code
        try:
            with warnings.catch_warnings():  # Python has warned already
                warnings.simplefilter("ignore")
                tree = ast.parse(source, file)
                for node in [*ast.walk(tree)]:
                    _mark(node)
                made = compile(tree, file, "exec", dont_inherit=True)
        except Exception:  # too deep, say: it runs without
            return code
        ran = self._ran.setdefault(name, _Ran())

        def ask(line: int, *names: str) -> None:
            self._ask(sys._getframe(1), name, line, names)

        def raised() -> None:
            self._note(name, file)

        return _filled(made, {_RAN: ran, _ASK: ask, _RAISED: raised})

    def rows(self) -> list[Row]:
        """Return the entry of each file in the account."""
        return [
            {
                "file": file,
                "lines": sorted(ran),
                "asked": _of(file, self._asked),
                "raised": _of(file, self._raised),
            }
            for file, ran in [*self._ran.items()]
        ]

    def _ask(self, frame: FrameType, file: str, line: int, names: tuple[str, ...]) -> None:
        """Keep the values of a condition's names: of its first time, its second, its fourth."""
        key = file, line
        times = self._times[key] = self._times.get(key, 0) + 1
        if times & (times - 1) or (key not in self._asked and len(self._asked) >= MOST_ASKED):
            return
        values = ((name, _value(frame, name)) for name in names)
        found = ", ".join(f"{name} = {value}" for name, value in values if value)
        self._asked[key] = found[:LONGEST]

    def _note(self, name: str, file: str) -> None:
        """Keep an exception of Python's own: another's text may be the submission's code."""
        error = sys.exc_info()[1]
        kind = type(error)
        if kind.__module__ != "builtins" or len(self._raised) >= MOST_RAISED:
            return
        with suppress(Exception):
            at = error.__traceback__ if error is not None else None
            line = 0
            while at is not None:  # the innermost of this file's
                line = at.tb_lineno if at.tb_frame.f_code.co_filename == file else line
                at = at.tb_next
            if line:
                self._raised.setdefault((name, line), f"{kind.__name__}: {error}"[:LONGEST])


def _of(file: str, texts: dict[tuple[str, int], str]) -> list[Row]:
    return [{"line": line, "text": text} for (name, line), text in [*texts.items()] if name == file]


# Marks ----------------------------------------------------------------------------------------


def _mark(node: ast.AST) -> None:
    """Put a mark before each statement of a node's blocks."""
    for name in ("body", "orelse", "finalbody"):
        block = getattr(node, name, None)
        if not isinstance(block, list) or not block or not isinstance(block[0], ast.stmt):
            continue
        first = _first(node, block) if name == "body" else 0
        marked = block[:first]
        if isinstance(node, ast.ExceptHandler):
            marked.append(_at(block[0], ast.Expr(ast.Call(ast.Constant(_RAISED), [], []))))
        for statement in block[first:]:
            marked += [_at(statement, each) for each in _marks(statement)]
            marked.append(statement)
        setattr(node, name, marked)


def _first(node: ast.AST, block: list[ast.stmt]) -> int:
    """Return where the first mark may stand: after the docstring, and what must be on top."""
    first = 0
    if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
        first = int(ast.get_docstring(node, clean=False) is not None)
    while getattr(block[first] if first < len(block) else None, "module", "") == "__future__":
        first += 1
    return first


def _marks(statement: ast.stmt) -> list[ast.stmt]:
    line = ast.Constant(statement.lineno)
    place = ast.Subscript(ast.Constant(_RAN), line, ast.Store())
    found: list[ast.stmt] = [ast.Assign([place], ast.Constant(True))]
    if isinstance(statement, ast.If | ast.While):
        asked = [ast.Constant(name) for name in _names(statement.test)[:MOST_NAMES]]
        if asked:
            found.append(ast.Expr(ast.Call(ast.Constant(_ASK), [line, *asked], [])))
    return found


def _names(test: ast.expr) -> list[str]:
    """Return the names in a condition, and their attributes: 'self.state'."""
    found: list[str] = []
    inner: set[ast.AST] = set()
    for node in ast.walk(test):
        match node:
            case ast.Call(func=called):
                inner.add(called)
            case ast.Attribute(value=ast.Name(id=name) as owner, attr=attribute):
                inner.add(owner)
                if node not in inner:
                    found.append(f"{name}.{attribute}")
            case ast.Name(id=name) if node not in inner:
                found.append(name)
    return [*dict.fromkeys(found)]


def _at(statement: ast.stmt, mark: ast.stmt) -> ast.stmt:
    """Give a mark the place of its statement, so that no line number changes."""
    for node in ast.walk(mark):
        ast.copy_location(node, statement)
        if isinstance(node, ast.expr | ast.stmt):
            node.end_lineno, node.end_col_offset = statement.lineno, statement.col_offset
    return mark


def _filled(code: CodeType, marks: dict[str, object]) -> CodeType:
    """Replace what stands for the marks' own objects, in a code object and those in it."""

    def filled(constant: object) -> object:
        if isinstance(constant, CodeType):
            return _filled(constant, marks)
        return marks.get(constant, constant) if isinstance(constant, str) else constant

    return code.replace(co_consts=tuple(map(filled, code.co_consts)))


def _value(frame: FrameType, name: str) -> str:
    """Return a name's value as text, without running any code of the submission's; '' for none."""
    head, _, attribute = name.partition(".")
    with suppress(Exception):
        value = frame.f_locals[head] if head in frame.f_locals else frame.f_globals[head]
        if attribute:
            slot = type(value).__dict__.get(f"_{attribute}")  # a field of a message
            if isinstance(slot, MemberDescriptorType):
                value = slot.__get__(value)
            else:
                value = object.__getattribute__(value, "__dict__")[attribute]
        if isinstance(value, Enum):
            return f"{type(value).__name__}.{value._name_}"[:LONGEST_VALUE]
        parts = value if type(value) in (tuple, list) else [value]
        if all(type(part) in _PLAIN for part in parts[:4]) and len(parts) <= 4:
            shown = f"{value:.4g}" if type(value) is float else repr(value)
            return shown if len(shown) <= LONGEST_VALUE else ""
        return f"<{type.__getattribute__(type(value), '__name__')}>"[:LONGEST_VALUE]
    return ""
