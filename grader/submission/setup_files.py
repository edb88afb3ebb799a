"""Console scripts in setup.py, setup.cfg and pyproject.toml, read without running anything."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, TypeVar

from grader.errors import SubmissionError
from grader.language.phrase import say
from grader.submission.constants import UNKNOWN, Constants
from grader.submission.folder import MAX_SOURCE_BYTES, HandedIn, read_bounded, shown
from grader.submission.python_source import parse

SETUP_FILES: Final = ("pyproject.toml", "setup.py", "setup.cfg")  # the first to name a script wins

_TARGET: Final = re.compile(r"(\w+(?:\.\w+)*)\s*:\s*(\w+(?:\.\w+)*)\s*(?:\[.*\])?")

_SCRIPTS_FOLDER: Final = ("install_scripts", "install-scripts")

_T = TypeVar("_T")


@dataclass(frozen=True)
class ConsoleScript:
    """`name = module:function`, as `file` says."""

    name: str
    module: str
    function: str
    file: Path


@dataclass(frozen=True)
class Package:
    """What the set-up files of one folder say."""

    folder: Path
    scripts: tuple[ConsoleScript, ...]
    has_setup_py: bool  # with a call of setup()
    unread: tuple[Path, ...]  # files whose entry points only a run could tell
    source_folders: tuple[str, ...]  # where top-level modules lie, relative to `folder`
    package_folders: Mapping[
        str, str
    ]  # where single top-level packages lie: package_dir={"a": "lib/a"}
    setup: Mapping[str, object] = field(default_factory=dict)  # arguments of setup(), or UNKNOWN
    finds_packages: bool = False  # setup.py calls find_packages()
    scripts_folder: str = ""  # where setup.cfg has programs installed: "$base/lib/spiral"

    @classmethod
    def without_setup(cls, folder: Path) -> Package:
        """One that has a package.xml alone."""
        return cls(folder, (), False, (), (), {})

    def roots(self, module: str) -> list[Path]:
        """List the folders to import `module` from, best first; none lies outside the package."""
        package = module.split(".")[0]
        lies_in = Path(self.package_folders.get(package, ""))
        single = [str(lies_in.parent)] if lies_in.name == package else []
        folder = self.folder.resolve()
        names = (*single, *(self.source_folders or (".", "src")))
        # os.path: links that lead in a circle are no exception there
        roots = [Path(os.path.realpath(folder / name)) for name in names if "\0" not in name]
        return [root for root in dict.fromkeys(roots) if root.is_relative_to(folder)] or [folder]


@dataclass
class _Said:
    """What one set-up file says, in its own words."""

    scripts: list[tuple[str, str]] = field(default_factory=list)  # name, "module:function"
    is_setup: bool = False
    unread: bool = False
    folders: dict[str, str] = field(default_factory=dict)  # package_dir
    searched: list[str] = field(default_factory=list)  # find_packages(where=…)
    setup: dict[str, object] = field(default_factory=dict)  # arguments of setup(), or UNKNOWN
    finds_packages: bool = False
    scripts_folder: str = ""


class _Unreadable(Exception):
    """A file that is not written in its language."""


def read_package(folder: Path, handed_in: HandedIn) -> Package | None:
    """Read the set-up files in a folder; None without any.

    Raises:
        SubmissionError: one does not parse, or has an entry that is no `name = module:function`,
            so that no tool could install the package; or it is a link to somewhere else.
    """
    readers = zip(SETUP_FILES, (_read_pyproject, _read_setup_py, _read_setup_cfg), strict=True)
    said = {
        folder / name: _read(folder / name, handed_in, read)
        for name, read in readers
        if (folder / name).is_file()
    }
    if not said:
        return None
    scripts: dict[str, ConsoleScript] = {}
    for file, words in said.items():
        for name, target in words.scripts:
            scripts.setdefault(name, _console_script(name, target, file, handed_in))
    of_setup_py = said.get(folder / "setup.py", _Said())
    folders = {name: lies_in for words in said.values() for name, lies_in in words.folders.items()}
    searched = [name for words in said.values() for name in words.searched]
    return Package(
        folder=folder,
        scripts=tuple(scripts.values()),
        has_setup_py=of_setup_py.is_setup,
        unread=tuple(file for file, words in said.items() if words.unread),
        source_folders=tuple(
            dict.fromkeys([folders[""], *searched] if "" in folders else searched)
        ),
        package_folders={name: lies_in for name, lies_in in folders.items() if name},
        setup=of_setup_py.setup,
        finds_packages=of_setup_py.finds_packages,
        scripts_folder=said.get(folder / "setup.cfg", _Said()).scripts_folder,
    )


def _read(file: Path, handed_in: HandedIn, read: Callable[[bytes], _Said]) -> _Said:
    handed_in.must_hold(file)
    called = handed_in.called(file)
    data = read_bounded(file)
    if data is None:
        raise SubmissionError(
            say(
                "{file} is larger than {max_source_bytes:.0f} MB; not a set-up file.",
                file=called,
                max_source_bytes=MAX_SOURCE_BYTES / 1e6,
            )
        )
    try:
        return read(data)
    except SyntaxError as error:
        where = say(", line {line}", line=error.lineno) if error.lineno else ""
        raise SubmissionError(
            say(
                "{file} does not parse{where}: {why}. Correct it until `colcon build` succeeds.",
                file=called,
                where=where,
                why=shown(error.msg),
            )
        ) from error
    except (_Unreadable, UnicodeDecodeError) as error:
        why = shown(" ".join(str(error).split()))
        raise SubmissionError(
            say("{file} cannot be read: {why}. Correct that line.", file=called, why=why)
        ) from error
    except RecursionError as error:
        raise SubmissionError(
            say("{file} is nested too deeply to be read. Write it plainly.", file=called)
        ) from error


def _console_script(name: str, target: str, file: Path, handed_in: HandedIn) -> ConsoleScript:
    match = _TARGET.fullmatch(target.strip())
    if not name or match is None:
        found = shown(f"{name} = {target}" if name else target)
        hint = say(" A comma seems to be missing between two entries.") if "=" in target else ""
        raise SubmissionError(
            say(
                "{file} has the console script '{found}'.{hint} Expected 'name = "
                "package.module:function', for example 'turtle_controller = "
                "my_package.turtle_controller:main'.",
                file=handed_in.called(file),
                found=found,
                hint=hint,
            )
        )
    return ConsoleScript(name, match[1], match[2], file)


def _read_setup_py(data: bytes) -> _Said:
    tree = parse(data, "setup.py")
    constants = Constants(tree)
    said = _Said()
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        match call.func:
            case ast.Name(id="setup") | ast.Attribute(attr="setup"):
                said.is_setup = True
                _hear_setup(constants.keywords(call.keywords), said)
            case ast.Name(id=name) | ast.Attribute(attr=name) if name in (
                "find_packages",
                "find_namespace_packages",
            ):
                said.finds_packages |= name == "find_packages"
                where = [k.value for k in call.keywords if k.arg == "where"] or call.args[:1]
                said.searched += _of_type(str, [constants.value(node) for node in where])
    return said


def _hear_setup(arguments: object, said: _Said) -> None:
    if not isinstance(arguments, dict):  # setup(**computed)
        said.unread = True
        return
    said.setup |= arguments
    said.folders |= _texts(arguments.get("package_dir"))
    entry_points = arguments.get("entry_points")
    if isinstance(entry_points, str):
        said.scripts += _ini_scripts(entry_points)
    elif isinstance(entry_points, dict):
        _hear_scripts(entry_points.get("console_scripts"), said)
    elif entry_points is not None:
        said.unread = True


def _hear_scripts(scripts: object, said: _Said) -> None:
    """Take `console_scripts` of a dict: "name = target" in a list, or as lines of a string."""
    if isinstance(scripts, str):
        scripts = scripts.splitlines()
    if isinstance(scripts, list):
        said.scripts += _entries(_of_type(str, scripts))
    said.unread |= scripts is UNKNOWN or (isinstance(scripts, list) and UNKNOWN in scripts)


def _read_setup_cfg(data: bytes) -> _Said:
    import configparser  # here: not every submission has one

    parser = configparser.RawConfigParser(strict=False)
    parser.optionxform = str  # type: ignore[assignment, method-assign]  # script names keep their case
    try:
        parser.read_string(data.decode("utf-8-sig"))
    except configparser.Error as error:
        raise _Unreadable(str(error)) from error
    scripts = parser.get("options.entry_points", "console_scripts", fallback="")
    folders = _entries(
        parser.get("options", "package_dir", fallback="").replace(",", "\n").splitlines()
    )
    where = parser.get("options.packages.find", "where", fallback="")
    return _Said(
        scripts=_entries(scripts.splitlines()),
        folders=dict(folders),
        searched=[where] if where else [],
        scripts_folder=next(
            filter(None, (parser.get("install", key, fallback="") for key in _SCRIPTS_FOLDER)), ""
        ),
    )


def _read_pyproject(data: bytes) -> _Said:
    import tomllib  # here: not every submission has one

    try:
        document = tomllib.loads(data.decode("utf-8-sig"))
    except tomllib.TOMLDecodeError as error:
        raise _Unreadable(str(error)) from error
    setuptools = _table(document, "tool", "setuptools")
    poetry = _table(document, "tool", "poetry")
    where = _table(setuptools, "packages", "find").get("where")
    packages = poetry.get("packages")
    lie_in = [_table(item).get("from") for item in packages] if isinstance(packages, list) else []
    return _Said(
        scripts=[
            *_texts(_table(document, "project", "scripts")).items(),
            *_poetry_scripts(_table(poetry, "scripts")),
        ],
        folders=_texts(setuptools.get("package-dir")),
        searched=_of_type(str, [*(where if isinstance(where, list) else [where]), *lie_in]),
    )


def _poetry_scripts(table: Mapping[str, object]) -> list[tuple[str, str]]:
    """Take `name = "module:function"`, or `reference` (`callable` before Poetry 1.2) of a table."""
    scripts = _texts(table)
    for name, value in table.items():
        target = _table(value).get("reference", _table(value).get("callable"))
        if isinstance(target, str) and _table(value).get("type") != "file":
            scripts[name] = target
    return list(scripts.items())


def _ini_scripts(text: str) -> list[tuple[str, str]]:
    """Take the section [console_scripts] of entry points that are one string in setup.py."""
    section, lines = "", []
    for line in map(str.strip, text.splitlines()):
        if line.startswith("["):
            section = line.strip("[] ")
        elif section == "console_scripts":
            lines.append(line)
    return _entries(lines)


def _entries(lines: Iterable[str]) -> list[tuple[str, str]]:
    """Split lines of `name = value`; one without `=` gets the name ""."""
    wanted = [
        line.strip() for line in lines if line.strip() and not line.strip().startswith(("#", ";"))
    ]
    parts = [line.partition("=") if "=" in line else ("", "", line) for line in wanted]
    return [(name.strip(), value.strip()) for name, _, value in parts]


def _table(value: object, *keys: str) -> Mapping[str, object]:
    """Go down to the table below `keys`; an empty one if anything on the way is no table."""
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value if isinstance(value, dict) else {}


def _texts(value: object) -> dict[str, str]:
    return {key: text for key, text in _table(value).items() if isinstance(text, str)}


def _of_type(kind: type[_T], values: Iterable[object]) -> list[_T]:
    return [value for value in values if isinstance(value, kind)]
