"""Finds the folder of an exercise and imports the files in it.

An exercise is a folder with exercise.yaml and checks.py. It lies in an installed package (entry
points of the group `grader.exercises`, whose values name a package or a module in the exercise's
folder), or anywhere: then it is given as a path.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import re
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from dataclasses import dataclass
from importlib.machinery import SourceFileLoader
from importlib.metadata import EntryPoint
from importlib.resources import files
from itertools import count
from pathlib import Path
from types import ModuleType

from grader.errors import ExerciseError
from grader.exercise.asking import CHECKS, PACKAGE, describe
from grader.exercise.check import Checks
from grader.system import extensions
from grader.system.extensions import EXERCISES, described
from grader.text.message import NOTHING, Message, msg

DESCRIPTION = "exercise.yaml"

_numbers = count(1)


@dataclass(frozen=True)
class Place:
    """The folder of an exercise.

    Attributes:
        folder: with its files.
        package: by which the folder is imported; "" for a folder that is in no package.
        name: under which it is installed; "" for a folder.
    """

    folder: Path
    package: str = ""
    name: str = ""

    @property
    def description(self) -> Path:
        return self.folder / DESCRIPTION


def names() -> list[str]:
    """Return the names of the installed exercises."""
    return list(extensions.points(EXERCISES))


def is_installed(name: str) -> bool:
    """Whether there is an installed exercise of this name."""
    return extensions.is_there(EXERCISES, name)


def installed(name: str) -> Place:
    """Return the installed exercise of this name."""
    found = extensions.points(EXERCISES).get(name, [])
    if len(found) > 1:
        raise ExerciseError(
            "several exercises are installed as {name}: {found}. Remove one, or "
            "give the path of its folder.",
            name=repr(name),
            found=", ".join(map(described, found)),
        )
    if found:
        return _of_entry_point(found[0])
    raise ExerciseError(
        "there is no exercise {name_or_path}; there are: {names}. Another one"
        " is given as the path of its folder, with {description} and {checks}; "
        "an edited copy as the path of its {description}.",
        name_or_path=repr(name),
        names=", ".join(names()),
        description=DESCRIPTION,
        checks=CHECKS,
    )


def in_folder(folder: Path) -> Place:
    """Return the exercise in a folder."""
    if why := _wrong_with(folder):
        raise ExerciseError("{path} is not an exercise: {why}", path=str(folder), why=why)
    folder = folder.resolve()
    for name, points in extensions.points(EXERCISES).items():
        with suppress(ExerciseError):
            if any(_of_entry_point(each).folder.resolve() == folder for each in points):
                return installed(name)
    return Place(folder)


def _wrong_with(folder: Path) -> Message:
    """Say why there is no exercise in a folder; '' where there is one."""
    for name in (DESCRIPTION,) if _expects(folder) else (DESCRIPTION, CHECKS):
        if not (folder / name).is_file():
            return msg("it has no {name}", name=name)
    return NOTHING


def is_exercise(folder: Path) -> bool:
    """Whether a folder has what an exercise needs."""
    return not _wrong_with(folder)


def _expects(folder: Path) -> bool:
    """Whether all is said as data, so that there need be no checks of its own."""
    with suppress(OSError):
        return (
            re.search(rb"^expect:", (folder / DESCRIPTION).read_bytes(), re.MULTILINE) is not None
        )
    return False


def import_checks(place: Place) -> Checks:
    """Import the checks of an exercise; those of a folder are read anew every time.

    The files of a folder see each other as those of a package do: `from . import shape`.
    """
    module: ModuleType
    if place.package:
        name = f"{place.package}.checks"
        module = _imported(name, place)
    else:
        package = f"{PACKAGE}{next(_numbers)}"
        with contained(), _without_bytecode():
            importlib.invalidate_caches()
            module = _imported_folder(package, place)
    checks = getattr(module, "checks", None)
    if not isinstance(checks, Checks):
        found = msg("nothing of that name") if checks is None else f"a {type(checks).__name__}"
        raise ExerciseError(
            "{checks}: expected `checks = Checks()`, of `from grader import Checks`; found {found}",
            checks=CHECKS,
            found=found,
        )
    return checks


def _imported_folder(package: str, place: Place) -> ModuleType:
    try:
        _make_package(package, place.folder)
        return _imported(f"{package}.checks", place)
    except ExerciseError:
        for name in [name for name in sys.modules if f"{name}.".startswith(f"{package}.")]:
            del sys.modules[name]
        raise


def locate(folder: Path, where: str) -> Path:
    """Find a file that an exercise names: below a folder, or as PACKAGE/PATH in a package."""
    if (folder / where).exists():
        return folder / where
    package, _, rest = where.partition("/")
    if package.isidentifier() and importlib.util.find_spec(package) is not None:
        path = Path(str(files(package))) / rest
        if path.exists():
            return path
    raise ExerciseError(
        "there is no {where}, neither in {folder} nor in an installed package",
        where=repr(where),
        folder=str(folder),
    )


# Installed ones -------------------------------------------------------------------------------


def _of_entry_point(point: EntryPoint) -> Place:
    try:
        spec = importlib.util.find_spec(point.value)
    except Exception as error:  # importing what is above it can do anything
        raise ExerciseError(
            "{told} cannot be imported: {error}", told=described(point), error=str(error)
        ) from None
    if spec is None:
        raise ExerciseError(
            "{told} is not there, though its package is installed", told=described(point)
        )
    folders = list(spec.submodule_search_locations or [])
    folder = Path(folders[0]) if folders else Path(spec.origin or "").parent
    package = spec.parent or ""
    if why := _wrong_with(folder):
        raise ExerciseError(
            "{told} is not an exercise: {folder}: {why}",
            told=described(point),
            folder=str(folder),
            why=why,
        )
    return Place(folder, package, point.name)


# Importing ------------------------------------------------------------------------------------


def _make_package(name: str, folder: Path) -> None:
    """Make a package of a folder, whether it has an __init__.py or not."""
    init = folder / "__init__.py"
    loader = SourceFileLoader(name, str(init)) if init.is_file() else None
    spec = importlib.util.spec_from_loader(name, loader, is_package=True)
    assert spec is not None
    spec.submodule_search_locations = [str(folder)]
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    if loader is not None:
        with _as_exercise_errors(folder, init.name):
            loader.exec_module(module)


def _imported(name: str, place: Place) -> ModuleType:
    with contained(), _as_exercise_errors(place.folder, CHECKS):
        return importlib.import_module(name)


@contextmanager
def _as_exercise_errors(folder: Path, file: str) -> Iterator[None]:
    """Turn any exception in the files of a folder into an ExerciseError with file and line.

    Args:
        file: that is imported, for errors without a place.
    """
    try:
        yield
    except BaseException as error:  # SystemExit too: a file must not end us unjudged
        if isinstance(error, KeyboardInterrupt):
            raise
        raise ExerciseError(describe(error, folder, file)) from error


@contextmanager
def _without_bytecode() -> Iterator[None]:
    """Leave no __pycache__ in somebody's folder."""
    before = sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    try:
        yield
    finally:
        sys.dont_write_bytecode = before


# Standard output and the current folder belong to the whole process; two that change them and
# change them back at the same time would leave them changed.
_one_at_a_time = threading.RLock()


@contextmanager
def contained() -> Iterator[None]:
    """Send what is printed to standard error, and restore the current folder afterwards.

    Standard output may be a result that a program reads, and paths of the command line may be
    relative.
    """
    with _one_at_a_time, redirect_stdout(sys.stderr):
        before: Path | None
        try:
            before = Path.cwd()
        except OSError:  # it was deleted
            before = None
        try:
            yield
        finally:
            if before is not None:
                with suppress(OSError):
                    os.chdir(before)
