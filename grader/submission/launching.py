"""Whether a launch file says what to start of a package: several nodes, each in a process."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from grader.errors import SubmissionError
from grader.language.phrase import say
from grader.submission.building import shortcomings
from grader.submission.entry_points import Packages, find_module, not_started
from grader.submission.folder import HandedIn, listed, shown
from grader.submission.manifest import FILE, read_manifest
from grader.submission.set_ups import ConsoleScript, LaunchFile, Node, Package
from grader.submission.start import EntryPoint, Launch, Program, Submission

_ENDINGS = ("launch.py", "launch.xml", "launch.yaml", "launch.yml")
#: What the simulator stands in for.
_SIMULATOR = ("turtlesim", "turtlesim_node")


@dataclass(frozen=True)
class Launched:
    """A launch file that starts several programs of the package that it lies in."""

    launch: LaunchFile
    package: Package
    programs: tuple[tuple[ConsoleScript, Node], ...]
    others: tuple[Node, ...]  # of other packages, but for the simulator

    @property
    def first(self) -> tuple[Package, ConsoleScript]:
        """The program that it names first."""
        return self.package, self.programs[0][0]

    def start(self, handed_in: HandedIn, found: Submission) -> Submission:
        """A submission that would start the first program, with all of them."""
        called = handed_in.called(handed_in.base / self.launch.folder / self.launch.file)
        programs = tuple(
            Program(script.name, EntryPoint(script.module, script.function), node.arguments)
            for script, node in self.programs
        )
        started = {program.name for program in programs}
        left = [script.name for script in self.package.scripts if script.name not in started]
        notes = [*shortcomings(handed_in, *self.first), *not_started("console script", left)]
        if self.others:
            names = listed(f"{node.package} {node.executable}" for node in self.others)
            notes.append(
                say(
                    "{file} starts programs of other packages, and these were not: {names}",
                    file=called,
                    names=names,
                )
            )
        names = listed(program.name for program in programs)
        return replace(
            found,
            start=Launch(programs),
            found=say("{file}, which starts {names}", file=called, names=names),
            notes=tuple(notes),
        )


def find_launched(
    handed_in: HandedIn, packages: Packages, launches: Sequence[LaunchFile]
) -> Launched | None:
    """The launch file by which several programs are started, if there is just one such package."""
    each = (
        several_programs(launch_files(handed_in, package, launches), package)
        for package in packages.readable
        if package.scripts
    )
    found = [launched for launched in each if launched]
    if len(found) != 1:
        return None
    (launched,) = found
    scripts = (script for script, _ in launched.programs)
    try:
        modules = {find_module(handed_in, launched.package, script) for script in scripts}
    except SubmissionError:  # the one to start alone may be there
        return None
    return launched if len(modules) == 1 else None  # else they lie in several places


def launch_files(
    handed_in: HandedIn, package: Package, launches: Sequence[LaunchFile]
) -> list[LaunchFile]:
    """Those in a package."""
    return [each for each in launches if handed_in.base / each.folder == package.folder]


def is_launch_file(file: Path) -> bool:
    """Tell by its name whether `ros2 launch` would take a file: spiral_launch.py, a.launch.xml."""
    return file.name.endswith(_ENDINGS)


def several_programs(launches: list[LaunchFile], package: Package) -> Launched | None:
    """The launch file by which several programs of a package are started; None if none, or many."""
    found = [launched for launch in launches if (launched := _launched(launch, package))]
    return found[0] if len({launched.programs for launched in found}) == 1 else None


def not_run(
    handed_in: HandedIn, launches: list[LaunchFile], package: Package, started: ConsoleScript
) -> Iterator[str]:
    """Notes on launch files that would have made a difference."""
    names = _names(package)
    for launch in launches:
        called = handed_in.called(handed_in.base / launch.folder / launch.file)
        if launch.unread:
            yield (
                say(
                    "{file} was not run, and what it starts cannot be read ({unread}): "
                    "judged is {program} alone",
                    file=called,
                    unread=launch.unread,
                    program=shown(started.name),
                )
            )
            continue
        own = [node for node in launch.nodes if node.package in names]
        others = [node.executable for node in own if node.executable != started.name]
        if others:
            yield (
                say(
                    "{file} was not run: judged is {program} alone, without {names}",
                    file=called,
                    program=shown(started.name),
                    names=listed(dict.fromkeys(others)),
                )
            )
        elif not all(node.is_as_by_itself for node in own):
            yield (
                say(
                    "{file} was not run: {program} was started without its namespace, "
                    "remappings or parameters",
                    file=called,
                    program=shown(started.name),
                )
            )


def _launched(launch: LaunchFile, package: Package) -> Launched | None:
    names = _names(package)
    scripts = {script.name: script for script in package.scripts}
    own = [node for node in launch.nodes if node.package in names]
    if not launch.is_plain or len(own) < 2 or any(node.executable not in scripts for node in own):
        return None
    others = [node for node in launch.nodes if node.package not in names]
    return Launched(
        launch,
        package,
        tuple((scripts[node.executable], node) for node in own),
        tuple(node for node in others if (node.package, node.executable) != _SIMULATOR),
    )


def _names(package: Package) -> set[str]:
    """What the package is called."""
    manifest = None
    if (package.folder / FILE).is_file():
        manifest = read_manifest(package.folder / FILE)
    return {package.said.name, manifest.name if manifest else ""} - {""}
