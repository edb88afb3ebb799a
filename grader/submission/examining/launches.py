"""A launch file, evaluated with doubles of ROS's launch in a copy of the process.

What a launch file names and is not there is taken down (`Lacking`), and the package's own file of
the same name stands in for it: so one mistake hides no others.
"""

from __future__ import annotations

import builtins
import io
import os
import sys
from collections.abc import Mapping
from functools import partial
from typing import Any, Final

from grader.submission.examining.launch_record import SUFFIXES, LaunchRecord
from grader.submission.examining.layout import DOUBLES, Installed, Workspace
from grader.submission.examining.packages import is_description
from grader.submission.examining.steps import in_folder, it, problem_of
from grader.system import strict_json
from grader.text.message import msg
from ros_doubles import NotKnown, known

#: Packages of ROS that have doubles.
DOUBLED: Final = ("launch", "launch_ros", "launch_xml", "launch_yaml", "ament_index_python")
_MOST: Final = 200


def evaluate(place: Workspace, of: Installed, file: str, given: Mapping[str, str]) -> Any:
    """In a copy of the process: a launch file of a package, as `Evaluated` in JSON.

    Args:
        given: values of its arguments.
    """
    record = begin(place)
    from launch import LaunchContext

    record.context = LaunchContext()
    record.context.record = record
    record.context.launch_configurations.update(given)
    installed = {source: path for path, source in of.files.items()}
    if file in installed:
        path = str(place.prefix / installed[file])
    else:
        path = str(of.package.folder / file)
        record.lack("file", f"{place.prefix}/share/{of.name}/{file}", path)
    problem = None
    for work in (partial(record.run, path), record.time.let_pass):
        try:
            work()
        except MemoryError:
            raise
        except BaseException as error:
            problem = problem or problem_of(error, place.own)
    return strict_json.to_json(record.evaluated(file, problem, *_asked(place)), strict_json.OURS)


def begin(place: Workspace) -> LaunchRecord:
    """In the copy: stand where nobody's files are, and find the doubles first.

    Returns:
        The record of what is evaluated from here on: it knows each file that is read.
    """
    source = str(place.judged.package.folder)
    in_folder(str(place.empty), [str(DOUBLES), source], place.environment())
    place.asked.write_text("")
    for name in [name for name in sys.modules if name.partition(".")[0] in DOUBLED]:
        del sys.modules[name]  # ROS's own, that somebody has imported before
    sys.meta_path.insert(0, _Unknown(place))
    record = LaunchRecord(place)
    _watch_files(record, place)
    return record


def _asked(place: Workspace) -> tuple[list[str], list[str]]:
    """Packages that were asked for: those that are there, and those that are not."""
    lines = place.asked.read_text(encoding="utf-8", errors="replace").splitlines()
    entries = [line.partition(" ") for line in lines]
    there, missing = (dict.fromkeys(n for s, _, n in entries if s == sign) for sign in "+-")
    ours = {each.name for each in place.all}
    return [each for each in there if each not in ours][:_MOST], list(missing)[:_MOST]


def _watch_files(record: LaunchRecord, place: Workspace) -> None:
    """A file of the submission's that is read and is not there is the one that was meant."""
    real = io.open

    def opened(file: Any, mode: str = "r", *args: Any, **kwargs: Any) -> Any:
        if isinstance(file, str | os.PathLike) and "r" in mode and "+" not in mode:
            name = os.fspath(file)
            if isinstance(name, str) and not os.path.exists(name) and _is_meant(name, place):
                file = record.path(os.path.abspath(name))
            if isinstance(name, str) and is_description(name):
                record.sources.append(os.path.abspath(os.fspath(file)))
        return real(file, mode, *args, **kwargs)

    builtins.open = io.open = opened


def _is_meant(name: str, place: Workspace) -> bool:
    """Whether a file that is not there is one of a package, rather than one of the system's."""
    full = os.path.abspath(name)
    if full.startswith((f"{place.prefix}/", f"{place.stubs}/", f"{place.empty}/")):
        return True
    return bool(place.meant(full)) or full.endswith(SUFFIXES[:6])


class _Unknown:
    """Modules that the doubles have under another name, or not at all: no fault of the package."""

    def __init__(self, place: Workspace) -> None:
        self._declared = set(place.judged.setup.depends)

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        """Stand in for what would be found nowhere else, or refuse it."""
        import importlib.machinery

        top = name.partition(".")[0]
        is_of_launch = top in DOUBLED or top.startswith("launch_")
        if not is_of_launch and top not in self._declared | known.KNOWN:
            return None
        if importlib.machinery.PathFinder.find_spec(name, path) is not None:
            return None
        if is_of_launch:
            from launch import _core

            if (made := _core.submodule(name)) is not None:
                return known.spec_of(made)
            what = msg("imports {name}, which the grader does not have", name=name)
            raise NotKnown(it(what))
        return known.module(name)
