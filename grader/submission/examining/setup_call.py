"""What setup.py, setup.cfg and pyproject.toml install, by setuptools, which reads them.

The `setup()` that a setup.py calls makes setuptools' own distribution of its arguments, which then
takes what the other two files say. No command is run and no plugin is loaded: nobody's entry points
are looked up. Nothing is fetched.
"""

from __future__ import annotations

import configparser
import importlib.metadata
import os
import runpy
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from grader.submission import safe_files
from grader.submission.answer import DataFiles, SetUpFacts
from grader.submission.examining.steps import NONSENSE, Ended, in_folder, it, step
from grader.submission.package_trace import Obstacle
from grader.system import strict_json

#: What a package may set for setuptools, which learns of these by entry points.
_KEYWORDS: Final = (
    *("dependency_links", "eager_resources", "entry_points", "exclude_package_data"),
    *("extras_require", "include_package_data", "install_requires", "namespace_packages"),
    *("packages", "python_requires", "setup_requires", "test_loader", "test_runner"),
    *("test_suite", "tests_require", "zip_safe"),
)
_OFFLINE: Final = ("VALIDATE_PYPROJECT_NO_NETWORK", "NO_NETWORK")


def evaluate(folder: Path) -> tuple[SetUpFacts, Obstacle | None]:
    """What the set-up of a folder says; and what ended it, where it came to no end."""

    def own(path: str) -> str:
        here = f"{folder}/"
        return path.removeprefix(here) if path.startswith(here) else ""

    try:
        return strict_json.from_json(SetUpFacts, step(lambda: run_setup(folder), own)), None
    except Ended as ended:
        problem = ended.problem
    except ValueError:
        problem = Obstacle("limit", it(NONSENSE))
    if not problem.file and not safe_files.is_file(folder / "setup.py"):
        names = ("pyproject.toml", "setup.cfg")
        problem = replace(problem, file=next(n for n in names if safe_files.is_file(folder / n)))
    return SetUpFacts(), problem


def run_setup(folder: Path) -> Any:
    """In a copy of the process: evaluate a set-up in its folder; return `SetUpFacts` as JSON.

    Where there is no setup.py, it is that of a frontend: a plain call of setup().

    Raises:
        Exception: whatever the setup.py raises, or setuptools does of it.
    """
    warnings.simplefilter("ignore")  # of setuptools, and for whoever builds the package
    importlib.metadata.entry_points = _no_entry_points
    os.environ.update(dict.fromkeys(_OFFLINE, "1"))
    import setuptools

    class Read(setuptools.Distribution):
        def fetch_build_eggs(self, requires: object) -> list[object]:
            return []

        def find_config_files(self) -> list[str]:  # none of the system's or the user's
            return ["setup.cfg"] if safe_files.is_file(folder / "setup.cfg") else []

    for name in _KEYWORDS:
        setattr(Read, name, None)
    made: list[Any] = []

    def setup(**arguments: Any) -> Any:
        arguments.pop("distclass", None)
        made.append(Read({"script_name": "setup.py", **arguments}))
        made[-1].parse_config_files()
        return made[-1]

    setuptools.setup = setuptools.distutils.core.setup = setup  # it may bring its own distutils
    in_folder(str(folder), [str(folder)], {})
    sys.argv = ["setup.py", "install"]
    if safe_files.is_file(folder / "setup.py"):
        runpy.run_path(str(folder / "setup.py"), run_name="__main__")
    else:
        setup()
    if not made:
        raise RuntimeError("setup.py never calls setup()")
    return strict_json.to_json(facts_of(made[-1]))


def _no_entry_points(**_: object) -> Any:
    return importlib.metadata.EntryPoints()


def facts_of(of: Any) -> SetUpFacts:
    """What of a distribution counts.

    Raises:
        TypeError: `data_files` is no list of folders with files.
    """
    _, scripts_folder = of.get_option_dict("install").get("install_scripts", ("", ""))
    return SetUpFacts(
        name=str(of.metadata.name or ""),
        data_files=tuple(map(_data_files, of.data_files or [])),
        scripts=tuple(_scripts(of.entry_points)),
        plain_scripts=tuple(os.fspath(each) for each in of.scripts or []),
        packages=None if of.packages is None else tuple(map(str, of.packages)),
        package_folders=tuple(f"{name}={at}" for name, at in (of.package_dir or {}).items()),
        scripts_folder=str(scripts_folder).strip().removeprefix("$base/"),
        has_commands=bool(of.cmdclass),
    )


def _data_files(entry: object) -> DataFiles:
    if isinstance(entry, str):
        return DataFiles("", (entry,))
    if not isinstance(entry, tuple | list) or len(entry) != 2:
        raise TypeError(f"data_files: expected (folder, files), found {entry!r:.100}")
    folder, names = entry
    if isinstance(names, str) or not hasattr(names, "__iter__"):
        raise TypeError(f"data_files: expected a list of files, found {names!r:.100}")
    return DataFiles(str(folder), tuple(os.fspath(name) for name in names))


def _scripts(given: Any) -> list[str]:
    """The console scripts of entry points, in either of the forms that setuptools takes."""
    if isinstance(given, str):
        parser = configparser.ConfigParser(delimiters=("=",))
        parser.optionxform = str  # type: ignore[assignment, method-assign]
        parser.read_string(given)
        given = {part: [f"{k} = {v}" for k, v in parser.items(part)] for part in parser.sections()}
    lines = given.get("console_scripts") or () if isinstance(given, dict) else ()
    lines = lines.splitlines() if isinstance(lines, str) else lines
    return [str(line) for line in lines if str(line).strip()]
