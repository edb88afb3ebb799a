"""Finds a launch file that starts several nodes of a package, each in a process."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from grader.errors import SubmissionError
from grader.message import msg
from grader.submission.building import shortcomings
from grader.submission.entry_points import Packages, find_module, not_started
from grader.submission.folder import SubmissionFolder, listed
from grader.submission.set_ups import ConsoleScript, PackageFolder
from grader.submission.start import EntryPoint, Launch, Program, Submission

if TYPE_CHECKING:  # what only a package needs takes time to import
    from grader.inspection import trace
    from grader.inspection.answer import Inspection
    from grader.inspection.trace import LaunchedNode

_ENDINGS: Final = ("launch.py", "launch.xml", "launch.yaml", "launch.yml")
#: What the simulator stands in for.
_SIMULATOR: Final = ("turtlesim", "turtlesim_node")
#: So many programs a run may have at once: they share its limits.
MOST_PROGRAMS: Final = 8
#: What ROS takes as a name, in the arguments of a program.
_NAME: Final = re.compile(r"[A-Za-z_~/{}][\w~/{}.]*")


@dataclass(frozen=True)
class Launched:
    """A launch file that starts several programs of the package that it lies in."""

    launch: trace.LaunchFile
    package: PackageFolder
    programs: tuple[tuple[ConsoleScript, tuple[str, ...]], ...]  # with their arguments
    others: tuple[LaunchedNode, ...]  # of other packages, but for the simulator

    @property
    def first(self) -> tuple[PackageFolder, ConsoleScript]:
        """The program that it starts first."""
        return self.package, self.programs[0][0]

    def start(self, submitted: SubmissionFolder, found: Submission) -> Submission:
        """Make of a submission that starts the first program one that starts all of them."""
        called = submitted.called(self.package.folder / self.launch.file)
        programs = tuple(
            Program(script.name, EntryPoint(script.module, script.function), arguments)
            for script, arguments in self.programs
        )
        started = {program.name for program in programs}
        left = [script.name for script in self.package.scripts if script.name not in started]
        notes = [*shortcomings(submitted, *self.first), *not_started("console script", left)]
        if self.others:
            names = listed(f"{node.package} {node.executable}" for node in self.others)
            notes.append(
                msg(
                    "{file} starts programs of other packages, and these were not: {names}",
                    file=called,
                    names=names,
                )
            )
        names = listed(program.name for program in programs)
        return replace(
            found,
            start=Launch(programs),
            found=msg("{file}, which starts {names}", file=called, names=names),
            notes=tuple(notes),
        )


def is_launch_file(file: Path) -> bool:
    """Whether `ros2 launch` would accept a file of this name: spiral_launch.py, a.launch.xml."""
    return file.name.endswith(_ENDINGS)


def find_launched(
    submitted: SubmissionFolder, packages: Packages, inspection: Inspection
) -> Launched | None:
    """Find the launch file that starts several programs; None if there is none, or many.

    Raises:
        SubmissionError: it starts more than `MOST_PROGRAMS`.
    """
    folder = submitted.base / inspection.package
    package = next((each for each in packages.readable if each.folder == folder), None)
    setup = inspection.trace.setup
    if package is None or not package.scripts or setup is None:
        return None
    names = {setup.name, setup.told}
    plain = [each for each in inspection.trace.launches if each.file in inspection.plain]
    found = [launched for launch in plain if (launched := _launched(launch, package, names))]
    if len({launched.programs for launched in found}) != 1:
        return None
    if len(found[0].programs) > MOST_PROGRAMS:
        raise SubmissionError(
            "{file} starts {number} programs; a run may have {most}",
            file=submitted.called(package.folder / found[0].launch.file),
            number=len(found[0].programs),
            most=MOST_PROGRAMS,
        )
    scripts = (script for script, _ in found[0].programs)
    try:
        modules = {find_module(submitted, package, script) for script in scripts}
    except SubmissionError:  # the one to start alone may be there
        return None
    return found[0] if len(modules) == 1 else None  # else they lie in several places


def _launched(launch: trace.LaunchFile, package: PackageFolder, names: set[str]) -> Launched | None:
    scripts = {script.name: script for script in package.scripts}
    nodes = [node for node in launch.nodes if node.package in names]
    if len(nodes) < 2 or launch.problem or launch.skipped:
        return None
    programs = []
    for node in nodes:
        arguments = None if node.condition else _arguments(node)
        if node.executable not in scripts or arguments is None:
            return None
        programs.append((scripts[node.executable], arguments))
    others = [node for node in launch.nodes if node.package not in names]
    return Launched(
        launch,
        package,
        tuple(programs),
        tuple(node for node in others if (node.package, node.executable) != _SIMULATOR),
    )


def _arguments(node: LaunchedNode) -> tuple[str, ...] | None:
    """The arguments that `ros2 launch` gives a program; None where they are not all known."""
    space = node.namespace
    space = space if space.startswith("/") or not space else f"/{space}"
    rules = [f"{old}:={new}" for old, new in (("__node", node.name), ("__ns", space)) if new]
    rules += node.remappings
    names = [part for rule in rules for part in rule.split(":=")]
    names += [each.name for each in node.parameters]
    is_complete = all(map(_NAME.fullmatch, names)) and all(
        each.text < 0 for each in node.parameters
    )
    if not is_complete or any("\0" in word for word in node.arguments):
        return None
    words = [word for rule in rules for word in ("-r", rule)]
    for each in node.parameters:
        words += ["-p", f"{each.name}:={_yaml(each.value)}"]
    return (*node.arguments, *(["--ros-args", *words] if words else []))


def _yaml(value: str) -> str:
    """Return a value as YAML: JSON as it is, everything else as a text."""
    try:
        json.loads(value)
    except ValueError:
        return json.dumps(value)
    return value
