"""What a setup.py installs: it is run with a `setup()` that only takes its arguments down."""

from __future__ import annotations

import configparser
import os
import runpy
import sys
from pathlib import Path
from typing import Any

from grader.scenes.package.examining.steps import in_folder


class Said(BaseException):
    """Ends a setup.py whose setup() has been called."""


def run_setup(folder: Path) -> dict[str, Any]:
    """In a copy of the process: run a setup.py in its folder; the arguments of setup() as JSON.

    Raises:
        Exception: whatever the setup.py raises.
    """
    import setuptools

    calls: list[dict[str, Any]] = []

    def setup(**arguments: Any) -> Any:
        calls.append(arguments)

    setuptools.setup = setup
    try:
        import distutils.core

        distutils.core.setup = setup
    except ImportError:  # Python 3.12, and no setuptools that brings one
        pass
    in_folder(str(folder), [str(folder)], {})
    sys.argv = ["setup.py", "install"]
    runpy.run_path(str(folder / "setup.py"), run_name="__main__")
    if not calls:
        raise RuntimeError("setup.py never calls setup()")
    return told(calls[-1], folder)


def told(arguments: dict[str, Any], folder: Path) -> dict[str, Any]:
    """What of the arguments counts.

    Raises:
        TypeError: `data_files` is no list of folders with files.
    """
    files = []
    for entry in arguments.get("data_files") or []:
        if isinstance(entry, str):
            files.append(("", [entry]))
        elif isinstance(entry, tuple | list) and len(entry) == 2:
            where, names = entry
            if isinstance(names, str) or not hasattr(names, "__iter__"):
                raise TypeError(f"data_files: expected a list of files, found {names!r:.100}")
            files.append((str(where), [os.fspath(name) for name in names]))
        else:
            raise TypeError(f"data_files: expected (folder, files), found {entry!r:.100}")
    return {
        "name": str(arguments.get("name") or ""),
        "data_files": files,
        "scripts": _scripts(arguments.get("entry_points"), folder),
        "plain_scripts": [os.fspath(each) for each in arguments.get("scripts") or []],
        "packages": _packages(arguments.get("packages")),
        "scripts_folder": _scripts_folder(folder),
    }


def is_told(said: Any) -> bool:
    """Whether an answer is one of `told`: a set-up may have written another in its place."""

    def are_texts(value: Any) -> bool:
        return isinstance(value, list) and all(isinstance(each, str) for each in value)

    def is_entry(value: Any) -> bool:
        return isinstance(value, list) and len(value) == 2 and isinstance(value[0], str)

    return (
        isinstance(said, dict)
        and all(isinstance(said.get(key), str) for key in ("name", "scripts_folder"))
        and all(are_texts(said.get(key)) for key in ("scripts", "plain_scripts"))
        and (said.get("packages") is None or are_texts(said["packages"]))
        and isinstance(said.get("data_files"), list)
        and all(is_entry(each) and are_texts(each[1]) for each in said["data_files"])
    )


def _packages(given: Any) -> list[str] | None:
    """The names of those that are listed; None where others may say them (setup.cfg)."""
    if not isinstance(given, list | tuple):
        return None
    return [str(each) for each in given]


def _scripts(given: Any, folder: Path) -> list[str]:
    """Lines such as 'talker = pkg.talker:main'."""
    if isinstance(given, str):
        parser = configparser.ConfigParser(delimiters=("=",))
        parser.optionxform = str  # type: ignore[assignment, method-assign]
        parser.read_string(given)
        given = {part: [f"{k} = {v}" for k, v in parser.items(part)] for part in parser.sections()}
    if not isinstance(given, dict):
        given = {}
    lines = given.get("console_scripts") or _config(folder).get(
        ("options.entry_points", "console_scripts"), ""
    )
    lines = lines.splitlines() if isinstance(lines, str) else lines
    return [str(line) for line in lines if str(line).strip()]


def _scripts_folder(folder: Path) -> str:
    found = _config(folder)
    for key in ("install_scripts", "install-scripts"):
        if value := found.get(("install", key)):
            return value.strip().removeprefix("$base/")
    return ""


def _config(folder: Path) -> dict[tuple[str, str], str]:
    parser = configparser.RawConfigParser()
    try:
        parser.read(folder / "setup.cfg", encoding="utf-8")
    except (configparser.Error, UnicodeDecodeError):
        return {}
    return {(part, key): value for part in parser.sections() for key, value in parser.items(part)}
