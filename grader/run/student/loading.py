"""Loads a submission's program as a student's machine would: without our packages.

Our packages with the same names as the submission's are out of reach, whatever is installed.
"""

from __future__ import annotations

import array
import functools
import importlib
import importlib.machinery
import importlib.util
import re
import runpy
import sys
import traceback
import types
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from grader.run.lockstep import faults
from grader.run.observe import hooks

#: Installed packages that a submission must never pick up in place of its own.
OURS = ("turtlesim_challenge", "turtlesim_py", "grader")
#: How a line begins that declares the encoding of a file (PEP 263).
ENCODING = re.compile(rb"[ \t\f]*#.*?coding[:=][ \t]*[-\w.]+")
#: Lists of numbers in messages, and what their arrays have as a type.
NUMBERS = {"sequence<double>": "d", "sequence<float>": "f"}


class OnlyFromSubmission:
    """An import hook: modules of these names come from the submission or not at all."""

    def __init__(self, root: str) -> None:
        self._root = root

    def find_spec(self, name, path=None, target=None):  # type: ignore[no-untyped-def]
        """Find a top-level module of ours below the submission's root only."""
        if name not in OURS:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, [self._root])
        if spec is None:
            raise ModuleNotFoundError(f"No module named {name!r} in the submission", name=name)
        return spec


class AfterImport:
    """An import hook: calls functions with a module when that has been loaded."""

    def __init__(self, calls: Mapping[str, Sequence[Callable[[types.ModuleType], None]]]) -> None:
        self._calls = calls

    def find_spec(self, name, path=None, target=None):  # type: ignore[no-untyped-def]
        if name not in self._calls:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def exec_module(module: types.ModuleType) -> None:
                load(module)
                for call in self._calls[name]:
                    call(module)

            spec.loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec


# What is started ------------------------------------------------------------------------------


class ProgramStart(NamedTuple):
    """What is started; as JSON the last argument of its process.

    Attributes:
        root: the folder that comes first on the import path.
        target: a module, or the absolute path of a script.
        function: what is called of it, "Controller.main"; None for a script as a whole.
        arguments: those of the program.
        beside: folders of other packages of the submission, which are installed there, too.
    """

    root: str
    target: str
    function: str | None
    arguments: Sequence[str] = ()
    beside: Sequence[str] = ()


def call(start: ProgramStart, on_error: Callable[[BaseException], None]) -> int:
    """Run a submission's program to its end; return its exit code.

    Tracebacks go without our own lines.

    Args:
        on_error: called with an uncaught exception, before its traceback is printed; also with one
            that Python does not print.
    """
    try:
        code = run(start)
    except KeyboardInterrupt as interrupt:
        on_error(interrupt)
        return 130
    except SystemExit as leaving:
        on_error(leaving)
        code = leaving.code
        if isinstance(code, str):
            print(code, file=sys.stderr)
            return 1
    except BaseException as error:
        on_error(error)
        faults.hide_our_frames(error)
        traceback.print_exception(error)
        return 1
    return code if isinstance(code, int) else 0


def run(start: ProgramStart) -> object:
    """Start a submission's program; return what its function returned."""
    if Path(start.target).is_absolute():  # what is installed for `ros2 run` may end in anything
        must_be_text(start.target)
        if start.function is None:
            runpy.run_path(start.target, run_name="__main__")
            return None
        name = Path(start.target).stem
        spec = importlib.util.spec_from_file_location(name, start.target)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
    else:
        module = importlib.import_module(start.target)
        check_origin(module, start.root)
    function: Any = functools.reduce(getattr, str(start.function).split("."), module)
    return function()


def must_be_text(file: str) -> None:
    """Refuse what `python3 FILE` refuses, and `runpy` accepts or reports without a line.

    Raises:
        SyntaxError: bytes that are no UTF-8 and no declared encoding either, or null bytes.
    """
    data = Path(file).read_bytes()
    try:
        at, why = data.index(0), "source code cannot contain null bytes"
    except ValueError:
        try:
            data.decode()
            return
        except UnicodeDecodeError as error:
            if any(ENCODING.match(line) for line in data.splitlines()[:2]):
                return  # the compiler goes by it
            at = error.start
            why = f"Non-UTF-8 code starting with '\\x{data[at]:02x}', but no encoding declared"
    line = data.count(b"\n", 0, at) + 1
    raise SyntaxError(f"{why}; save the file as UTF-8", (file, line, None, None))


def check_origin(module: types.ModuleType, root: str) -> None:
    """Check that a module is the submission's, not another of the same name.

    Raises:
        ImportError: it is not; the text says what to do.
    """
    file = getattr(module, "__file__", None)
    if file is None or not Path(file).resolve().is_relative_to(Path(root).resolve()):
        raise ImportError(
            f"{module.__name__!r} is also the name of a module of Python's or ROS's own "
            f"({file or 'built in'}); call yours something else"
        )


def hide_the_grader(start: ProgramStart) -> None:
    """Make the interpreter look as it would on a student's machine."""
    sys.argv = [Path(start.target).name, *start.arguments]
    sys.path[:1] = dict.fromkeys((start.root, *start.beside))
    sys.meta_path.insert(0, OnlyFromSubmission(start.root))
    for name in [name for name in sys.modules if name.partition(".")[0] in OURS]:
        del sys.modules[name]


# Messages -------------------------------------------------------------------------------------


def accept_numbers(module: Any) -> None:
    """Have lists of numbers in messages accept what they accept where nothing checks fields.

    A submission's messages check their fields (`grader.run.environment`), since a single number of
    another type goes wrong on its way into C. A list does not: it becomes an `array.array`, which
    converts or refuses. Where nothing checks, `position = [0, 1]` and a numpy array are right.

    Args:
        module: `rclpy.publisher`; each type of messages is changed when a publisher is made.
    """
    # where that fails, rclpy decides what it accepts
    hooks.after(module.Publisher, "__init__", lambda made, _: convert_lists(made.msg_type))


def convert_lists(message: Any) -> None:
    """Have the lists of a type of messages converted before they are checked."""
    for field, kind in message.get_fields_and_field_types().items():
        if kind in NUMBERS:
            _convert(message, field, NUMBERS[kind])


def _convert(message: Any, field: str, code: str) -> None:
    checked = getattr(message, field)
    if hasattr(checked.fset, "__wrapped__"):
        return  # by an earlier publisher

    def converted(self: Any, value: Any) -> None:
        if not isinstance(value, array.array):
            with suppress(TypeError, ValueError, OverflowError):
                value = array.array(code, value)
        checked.fset(self, value)

    converted.__wrapped__ = checked.fset  # type: ignore[attr-defined]
    setattr(message, field, checked.setter(converted))
