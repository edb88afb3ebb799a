"""Reads what a Python file defines, and why Python refuses it; nothing is imported or run.

`python3 FILE` refuses what is not in the encoding that the file declares, UTF-8 where it declares
none. An import of the same file is laxer in older Pythons: it passes over such bytes in comments.
"""

from __future__ import annotations

import ast
import codecs
import io
import re
import tokenize
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Final

from grader.submission.folder import read_bounded
from grader.text.message import NOTHING, Message, joined, msg
from grader.text.strings import shown

Function = ast.FunctionDef | ast.AsyncFunctionDef
_NAMES_UNSEEN: Final = {"exec", "globals", "locals", "setattr", "vars"}  # may define any name
_UNPARSED_MAIN: Final = re.compile(rb"^(async\s+)?def\s+main\b", re.MULTILINE)
_SAVE: Final = msg("save it as UTF-8")
_UTF_16: Final = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


@dataclass(frozen=True)
class PythonSource:
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
        """Whether an import of the file could not define this name."""
        return self.parses and not self.open_ended and name not in self.names


def last(called: ast.AST) -> str:
    """'drive' of bot.drive; '' for what has no name."""
    match called:
        case ast.Attribute(attr=name) | ast.Name(id=name):
            return name
    return ""


def scope_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of a scope itself, without those in its functions and classes."""
    waiting = list(ast.iter_child_nodes(node))
    while waiting:
        each = waiting.pop()
        yield each
        if not isinstance(each, Function | ast.ClassDef | ast.Lambda):
            waiting += ast.iter_child_nodes(each)


@cache  # what a file imports, has on the graph and may do wrong is asked of one tree
def parse(data: bytes) -> ast.Module:
    """Parse Python; the tree stays as it is.

    Raises:
        SyntaxError: it does not parse; also for null bytes, wrong encodings, absurd nesting.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore"
            )  # "invalid escape sequence" is for the student's own run
            return ast.parse(data)
    except (ValueError, RecursionError, MemoryError) as error:
        raise SyntaxError(str(error) or "nested too deeply, or too large") from error


def read_source(path: Path) -> PythonSource:
    """Read a student's file.

    One that does not parse is no error here: the run shows the interpreter's own message.
    """
    data = read_bounded(path)
    if data is None:
        return PythonSource(parses=False, has_guard=False, has_main=False)
    try:
        tree = parse(data)
    except SyntaxError:
        return PythonSource(
            parses=False,
            has_guard=any(map(_begins_guard, data.splitlines())),
            has_main=bool(_UNPARSED_MAIN.search(data)),
        )
    return replace(seen(tree), is_refused=bool(byte_fault(data)))


def _begins_guard(line: bytes) -> bool:
    """Whether a line begins as `if __name__ == "__main__"` does, whatever its rest is.

    In steps, since an expression for all of it would try each `__name__` with each `__main__`.
    """
    if not re.match(rb"if\b", line):
        return False
    _, name, rest = line.partition(b"__name__")
    return bool(name) and re.search(rb"""['"]__main__['"]""", rest) is not None


def seen(tree: ast.Module) -> PythonSource:
    """Return what the syntax tree of a file shows."""
    top = sorted(scope_nodes(tree), key=lambda node: getattr(node, "lineno", 0))
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
    return PythonSource(True, has_guard, has_main, calls_main, tuple(defined), names, open_ended)


def _names_in(node: ast.AST) -> set[str]:
    return {inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)}


def _is_guard(test: ast.expr) -> bool:
    texts = {inner.value for inner in ast.walk(test) if isinstance(inner, ast.Constant)}
    return "__name__" in _names_in(test) and "__main__" in texts


# Bytes -------------------------------------------------------------------------------------------


def byte_fault(data: bytes) -> Message:
    """Say why Python refuses a file with these bytes, as what follows its name; '' if it does not.

    "is saved as UTF-16, and Python reads UTF-8: save it as UTF-8"
    """
    if data.startswith(_UTF_16):
        return msg("is saved as UTF-16, and Python reads UTF-8: {save}", save=_SAVE)
    if b"\0" in data:
        return msg(
            "has a null byte in line {line}, as no text has: {save}",
            line=_line(data, data.index(0)),
            save=_SAVE,
        )
    try:
        encoding = _declared(data)
        data.decode(encoding)
    except UnicodeDecodeError as error:
        return msg(
            "has a byte (0x{byte:02x}) in line {line} that is no {encoding}, so that"
            " `python3` refuses it: {save}",
            byte=error.object[error.start],
            line=_line(data, error.start),
            encoding=shown(encoding.removesuffix("-sig").upper()),
            save=_SAVE,
        )
    except (SyntaxError, LookupError, ValueError):
        pass  # of the declaration: Python's own words are clear
    return NOTHING


def byte_faults(files: Iterable[Path], root: Path) -> list[Message]:
    """A sentence on each of some files below a folder that Python refuses for its bytes."""
    found: list[Message] = []
    for file in files:
        try:
            why = byte_fault(read_bounded(file) or b"")
        except OSError:
            continue
        found += [joined([shown(file.relative_to(root)), why], " ")] if why else []
    return found


def _declared(data: bytes) -> str:
    """The encoding by the first two lines; their own bytes are not judged here."""
    mark = codecs.BOM_UTF8 if data.startswith(codecs.BOM_UTF8) else b""
    plain = data[len(mark) :].decode("ascii", "replace").encode("ascii", "replace")
    return tokenize.detect_encoding(io.BytesIO(mark + plain).readline)[0]


def _line(data: bytes, at: int) -> int:
    return data.count(b"\n", 0, at) + 1
