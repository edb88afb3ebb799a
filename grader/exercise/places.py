"""Where exercises lie, and how the files in one are found and read.

An exercise is a folder with exercise.yaml and checks.py. It lies in `grader/exercises/`, in a
package that somebody has installed (entry-point group `grader.exercises`, whose values name a
package or a module in the exercise's folder), or anywhere: then it is given as a path.
"""

from __future__ import annotations

import importlib
import importlib.machinery
import importlib.util
import re
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from importlib.resources import files
from itertools import count
from pathlib import Path
from types import ModuleType

from grader.errors import ExerciseError
from grader.exercise.check import Checks
from grader.exercise.foreign import contained
from grader.language.phrase import joined, say

GROUP = "grader.exercises"
DESCRIPTION, CHECKS = "exercise.yaml", "checks.py"

#: What the package of a folder that is in none is called, with a number.
_PACKAGE = "_grader_exercise_"
_numbers = count(1)


@dataclass(frozen=True)
class Place:
    """Where an exercise lies.

    Attributes:
        folder: its files.
        package: by which the folder is imported; "" for a folder that is in no package.
        name: what it is installed as; "" for a folder.
    """

    folder: Path
    package: str = ""
    name: str = ""

    @property
    def description(self) -> Path:
        """Its exercise.yaml."""
        return self.folder / DESCRIPTION


def names() -> list[str]:
    """The exercises that are installed."""
    return sorted({*_ours(), *_entry_points()})


def is_installed(name: str) -> bool:
    """Whether there is an installed exercise of this name."""
    return name in _ours() or name in _entry_points()


def installed(name: str) -> Place:
    """The installed exercise of this name.

    Raises:
        ExerciseError: there is none, or there are two.
    """
    ours, others = _ours(), _entry_points().get(name, [])
    found = [
        *([say("{group}.{name} of this package", group=GROUP, name=name)] if name in ours else []),
        *map(_told, others),
    ]
    if len(found) > 1:
        raise ExerciseError(
            say(
                "several exercises are installed as {name}: {found}. Remove one, or "
                "give the path of its folder.",
                name=repr(name),
                found=joined(found, ", "),
            )
        )
    if name in ours:
        return Place(ours[name], f"{GROUP}.{name}", name)
    if others:
        return _of_entry_point(others[0])
    raise ExerciseError(
        say(
            "there is no exercise {name}; there are: {names}",
            name=repr(name),
            names=", ".join(names()),
        )
    )


def in_folder(folder: Path) -> Place:
    """The exercise in a folder.

    Raises:
        ExerciseError: one of its two files is missing.
    """
    for name in (DESCRIPTION, CHECKS):
        if not (folder / name).is_file():
            raise ExerciseError(
                say(
                    "{path} is not an exercise: {why}",
                    path=str(folder),
                    why=_instead_of(folder / name),
                )
            )
    folder = folder.resolve()
    for name, ours in _ours().items():
        if ours.resolve() == folder:
            return installed(name)
    return Place(folder)


def _instead_of(file: Path) -> str:
    """What lies where a file should be."""
    if file.is_symlink() and not file.exists():
        return say(
            "{name} is a link to {target}, which is not there",
            name=file.name,
            target=str(file.readlink()),
        )
    if file.is_dir():
        return say("{name} is a folder, not a file", name=file.name)
    if file.exists():
        return say("{name} is not a regular file", name=file.name)
    return say("it has no {name}", name=file.name)


def import_checks(place: Place) -> Checks:
    """The checks of an exercise; those of a folder are read anew every time.

    The files of a folder see each other as those of a package do: `from . import shape`.

    Raises:
        ExerciseError: there are none, or importing them fails; with file and line.
    """
    module: ModuleType
    if place.package:
        name = f"{place.package}.checks"
        module = _imported(name, place)
    else:
        package = f"{_PACKAGE}{next(_numbers)}"
        with contained(), _without_bytecode():
            importlib.invalidate_caches()
            module = _imported_folder(package, place)
    checks = getattr(module, "checks", None)
    if not isinstance(checks, Checks):
        found = say("nothing of that name") if checks is None else f"a {type(checks).__name__}"
        raise ExerciseError(
            say(
                "{checks}: expected `checks = Checks()`, of `from grader import "
                "Checks`; found {found}",
                checks=CHECKS,
                found=found,
            )
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
    """A file that an exercise names: below a folder, or as PACKAGE/PATH in an installed package.

    Raises:
        ExerciseError: there is nothing.
    """
    if (folder / where).exists():
        return folder / where
    package, _, rest = where.partition("/")
    if package.isidentifier() and importlib.util.find_spec(package) is not None:
        path = Path(str(files(package))) / rest
        if path.exists():
            return path
    raise ExerciseError(
        say(
            "there is no {where}, neither in {folder} nor in an installed package",
            where=repr(where),
            folder=str(folder),
        )
    )


# Installed ones -------------------------------------------------------------------------------


def _ours() -> Mapping[str, Path]:
    folder = Path(str(files("grader"))) / "exercises"
    return {path.parent.name: path.parent for path in folder.glob(f"*/{DESCRIPTION}")}


def _entry_points() -> Mapping[str, list[EntryPoint]]:
    """By name; a distribution that is found twice on the path counts once."""
    # an installation changes the folder; reading all that is installed takes longer than the rest
    return _entry_points_of(tuple((folder, _changed_ns(folder)) for folder in sys.path))


def _changed_ns(folder: str) -> int:
    try:
        return Path(folder).stat().st_mtime_ns
    except OSError:
        return 0


@lru_cache(maxsize=2)
def _entry_points_of(_path: tuple[tuple[str, int], ...]) -> Mapping[str, list[EntryPoint]]:
    found: dict[str, dict[str, EntryPoint]] = {}
    for point in entry_points(group=GROUP):
        found.setdefault(point.name, {}).setdefault(_told(point), point)
    return {name: list(points.values()) for name, points in found.items()}


def _told(point: EntryPoint) -> str:
    return say(
        "{module} of {package}",
        module=point.value,
        package=point.dist.name if point.dist else say("an unknown package"),
    )


def _of_entry_point(point: EntryPoint) -> Place:
    try:
        spec = importlib.util.find_spec(point.value)
    except Exception as error:  # importing what is above it can do anything
        raise ExerciseError(
            say("{told} cannot be imported: {error}", told=_told(point), error=str(error))
        ) from None
    if spec is None:
        raise ExerciseError(
            say("{told} is not there, though its package is installed", told=_told(point))
        )
    folders = list(spec.submodule_search_locations or [])
    folder = Path(folders[0]) if folders else Path(spec.origin or "").parent
    package = spec.parent or ""
    for name in (DESCRIPTION, CHECKS):
        if not (folder / name).is_file():
            raise ExerciseError(
                say(
                    "{told} is not an exercise: {folder}: {why}",
                    told=_told(point),
                    folder=str(folder),
                    why=_instead_of(folder / name),
                )
            )
    return Place(folder, package, point.name)


# Importing ------------------------------------------------------------------------------------


def _make_package(name: str, folder: Path) -> None:
    """A package of its own for a folder, whether it has an __init__.py or not."""
    init = folder / "__init__.py"
    spec: importlib.machinery.ModuleSpec | None
    if init.is_file():
        spec = importlib.util.spec_from_file_location(
            name, init, submodule_search_locations=[str(folder)]
        )
        assert spec is not None
    else:
        spec = importlib.machinery.ModuleSpec(name, None, is_package=True)
        spec.submodule_search_locations = [str(folder)]
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    if init.is_file():
        assert spec.loader is not None
        with _told_as_the_author_s(folder, init.name):
            spec.loader.exec_module(module)


def _imported(name: str, place: Place) -> ModuleType:
    with contained(), _told_as_the_author_s(place.folder, CHECKS):
        return importlib.import_module(name)


@contextmanager
def _told_as_the_author_s(folder: Path, file: str) -> Iterator[None]:
    """What goes wrong in the files of a folder, with file and line, as an ExerciseError.

    Args:
        file: that is imported, for errors that do not know where they are.
    """
    try:
        yield
    except BaseException as error:  # SystemExit too: a file must not end us unjudged
        if isinstance(error, KeyboardInterrupt):
            raise
        raise ExerciseError(describe(error, folder, file)) from error


def describe(error: BaseException, folder: Path, file: str = "") -> str:
    """An exception in the files of a folder: 'checks.py, line 3: NameError: ...'.

    Args:
        file: in which it is if it does not know that itself.
    """
    name = type(error).__name__
    if isinstance(error, SyntaxError) and error.filename:
        return say(
            "{file}, line {line}: {name}: {what}",
            file=_shown(error.filename, folder),
            line=str(error.lineno),
            name=name,
            what=error.msg,
        )
    text = f"{name}: {error}" if str(error) else name
    if isinstance(error, ImportError) and (absent := _absent(error, folder)):
        text = say(
            "{name}: there is no {absent} beside {checks}", name=name, absent=absent, checks=CHECKS
        )
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if Path(frame.filename).is_relative_to(folder)]
    missing = getattr(error, "name", None) if isinstance(error, ModuleNotFoundError) else None
    if missing and (folder / f"{missing}.py").is_file():
        text += ". " + say(
            "A file beside {checks} is imported by `from . import {missing}`",
            checks=CHECKS,
            missing=missing,
        )
    if not own:
        return f"{file}: {text}" if file else text
    return say(
        "{file}, line {line}: {what}",
        file=_shown(own[-1].filename, folder),
        line=str(own[-1].lineno),
        what=text,
    )


def _absent(error: ImportError, folder: Path) -> str:
    """The file beside checks.py that was imported from there and is not; '' for other errors."""
    package, _, module = (error.name or "").partition(".")
    if not package.startswith(_PACKAGE):
        return ""
    named = re.match(r"cannot import name '(\w+)'", str(error))  # `name_from` is new in 3.12
    module = module or (named[1] if named else "")
    is_there = (folder / f"{module}.py").is_file() or (folder / module).is_dir()
    return "" if not module or "." in module or is_there else f"{module}.py"


def _shown(file: str, folder: Path) -> str:
    path = Path(file)
    return str(path.relative_to(folder)) if path.is_relative_to(folder) else file


@contextmanager
def _without_bytecode() -> Iterator[None]:
    """Leave no __pycache__ in somebody's folder."""
    before = sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    try:
        yield
    finally:
        sys.dont_write_bytecode = before
