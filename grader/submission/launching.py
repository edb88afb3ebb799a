"""Finds the launch file that starts several programs of a submission, each in a process."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from grader.errors import SubmissionError
from grader.message import Message, msg
from grader.recording.recording import MOST_PROGRAMS
from grader.submission.entry_points import Packages
from grader.submission.folder import SubmissionFolder, listed, shown
from grader.submission.set_ups import ConsoleScript, PackageFolder

if TYPE_CHECKING:  # what only a package needs takes time to import
    from grader.inspection.answer import Inspection
    from grader.inspection.trace import LaunchedNode, LaunchFile

_ENDINGS: Final = ("launch.py", "launch.xml", "launch.yaml", "launch.yml")
#: What the simulator stands in for.
_SIMULATOR: Final = ("turtlesim", "turtlesim_node")
#: What ROS takes as a name, in the arguments of a program.
_NAME: Final = re.compile(r"[A-Za-z_~/{}][\w~/{}.]*")


@dataclass(frozen=True)
class LaunchAsked:
    """A launch file that is asked for.

    Attributes:
        file: its path in the submission, or its name alone.
        given: values of its arguments.
    """

    file: str
    given: Mapping[str, str] = field(default_factory=dict)


class StartedScript(NamedTuple):
    """A console script that is started.

    Attributes:
        name: as `ros2 launch` prints it.
        arguments: of ROS, and its own.
        delay_s: how long after the others [s].
    """

    package: PackageFolder
    script: ConsoleScript
    name: str
    arguments: tuple[str, ...] = ()
    delay_s: float = 0.0

    @classmethod
    def alone(cls, package: PackageFolder, script: ConsoleScript) -> StartedScript:
        """Return one that is started by itself."""
        return cls(package, script, f"{script.name}-1")


@dataclass(frozen=True)
class Launched:
    """What a launch file starts.

    Attributes:
        file: its name.
        scripts: the submission's.
        notes: what is left out, and what is not followed.
    """

    file: str
    scripts: tuple[StartedScript, ...]
    notes: tuple[Message, ...]

    @property
    def found(self) -> Message:
        """A sentence for the user."""
        names = listed(each.script.name for each in self.scripts)
        return msg("{file}, which starts {names}", file=shown(self.file), names=names)


def is_launch_file(file: Path) -> bool:
    """Whether `ros2 launch` would accept a file of this name: spiral_launch.py, a.launch.xml."""
    return file.name.endswith(_ENDINGS)


def find_launched(
    submitted: SubmissionFolder,
    packages: Packages,
    inspection: Inspection,
    asked: str = "",
    *,
    is_needed: bool = True,
) -> Launched | None:
    """Find the launch file that is asked for, or the one that starts several programs.

    Where the exercise is about several, it may be one that starts a single one.

    Args:
        is_needed: else there is none where one would have to be chosen.

    Raises:
        SubmissionError: there is no such file, or it starts nothing, or more than `MOST_PROGRAMS`;
            or none is asked for and several start several.
    """
    launches = inspection.trace.launches
    if asked:
        found = _launched(submitted, packages, inspection, _asked(submitted, launches, asked))
        if not found.scripts:
            raise SubmissionError(
                "{file} starts no program of {name}", file=shown(found.file), name=submitted.name
            )
    else:
        included = {file for order in inspection.orders.values() for file in order.included}
        every = [
            _launched(submitted, packages, inspection, each)
            for each in launches
            if each.file in inspection.orders and each.file not in included
        ]
        least = 1 if len(submitted.programs) > 1 else 2
        several = {each.scripts: each for each in reversed(every) if len(each.scripts) >= least}
        if len(several) > 1 and not is_needed:
            return None
        if len(several) > 1:
            commands = [f"--launch {shown(each.file)}" for each in reversed(several.values())]
            raise SubmissionError(
                "{name} has several launch files that start several programs: choose one with "
                "{commands}",
                name=submitted.name,
                commands=listed(commands),
            )
        if not several:
            return None
        (found,) = several.values()
    if len(found.scripts) > MOST_PROGRAMS:
        raise SubmissionError(
            "{file} starts {number} programs; a run may have {most}",
            file=shown(found.file),
            number=len(found.scripts),
            most=MOST_PROGRAMS,
        )
    return found


def undeclared(inspection: Inspection, asked: LaunchAsked) -> Iterator[Message]:
    """Yield a note on each argument that the launch file asked for does not declare."""
    for each in inspection.trace.launches:
        names = sorted(asked.given.keys() - {*each.declared})
        for name in names if _is_called(each, asked.file) else ():
            yield msg(
                "{file} declares no argument {name}, only {known}",
                file=shown(each.file),
                name=shown(name),
                known=listed(each.declared) or msg("none"),
            )


def _is_called(launch: LaunchFile, asked: str) -> bool:
    """Whether a launch file has a path, or ends with a name."""
    return f"/{launch.file}".endswith(f"/{asked.removeprefix('./')}")


def _asked(submitted: SubmissionFolder, launches: Sequence[LaunchFile], asked: str) -> LaunchFile:
    """Return the launch file of a path or a name.

    Raises:
        SubmissionError: there is none, or several are; or it could not be evaluated.
    """
    named = [each for each in launches if _is_called(each, asked)]
    if len(named) != 1:
        text = msg("{name} has no launch file {file}; it has: {names}")
        if named:
            text = msg("{name} has several launch files {file}: {names}. Give its path.")
        names = listed(each.file for each in named or launches) or msg("none")
        raise SubmissionError(text.given(name=submitted.name, file=shown(asked), names=names))
    if problem := named[0].problem:
        from grader.inspection.error_texts import described

        raise SubmissionError(
            "{file} cannot be launched: {why}", file=shown(named[0].file), why=described(problem)
        )
    return named[0]


def _launched(
    submitted: SubmissionFolder, packages: Packages, inspection: Inspection, launch: LaunchFile
) -> Launched:
    """Return what a launch file starts of a submission's programs."""
    own = {each.name: each for each in packages.readable}
    setup = inspection.trace.setup
    folder = submitted.base / inspection.package
    judged = next((each for each in packages.readable if each.folder == folder), None)
    if setup is not None and judged is not None:  # by both of its names
        own |= {setup.name: judged, setup.told: judged}
    order = inspection.orders[launch.file]
    scripts, others, later, notes = list[StartedScript](), list[str](), list[str](), list[Message]()
    for number, (node, delay_s) in enumerate(zip(launch.nodes, order.delays_s, strict=False), 1):
        package = own.get(node.package)
        named = {} if package is None else {each.name: each for each in package.scripts}
        if delay_s < 0:
            later.append(node.executable)
        elif package is not None and node.executable in named:
            words, lacking = _arguments(node)
            notes += _not_given(launch.file, node, lacking)
            name = f"{node.executable}-{number}"
            script = StartedScript(package, named[node.executable], name, words, delay_s)
            scripts.append(script)
        elif package is judged is not None:
            continue  # which its set-up does not install: `not_installed` says so
        elif (node.package, node.executable) != _SIMULATOR:
            others.append(f"{node.package} {node.executable}")
    file = shown(launch.file)
    if others := [*others, *launch.processes]:
        text = msg("{file} starts programs of other packages, and these were not: {names}")
        notes.append(text.given(file=file, names=listed(others)))
    if later:
        text = msg("{file} starts programs after an event, and these were not: {names}")
        notes.append(text.given(file=file, names=listed(later)))
    if order.ignored:
        text = msg("of {file} was not followed: {names}")
        notes.append(text.given(file=file, names=listed(order.ignored)))
    return Launched(launch.file, tuple(scripts), tuple(notes))


def _arguments(node: LaunchedNode) -> tuple[tuple[str, ...], list[str]]:
    """The arguments that `ros2 launch` gives a program; and what cannot be given."""
    space = node.namespace
    space = space if space.startswith("/") or not space else f"/{space}"
    rules = [f"{old}:={new}" for old, new in (("__node", node.name), ("__ns", space)) if new]
    rules += node.remappings
    given = [("-r", rule, all(map(_NAME.fullmatch, rule.split(":=")))) for rule in rules]
    given += [
        (
            *("-p", f"{each.name}:={_yaml(each.value)}"),
            each.text < 0 and _NAME.fullmatch(each.name) is not None,
        )
        for each in node.parameters
    ]
    words = [word for option, rule, fits in given if fits for word in (option, rule)]
    plain = [word for word in node.arguments if "\0" not in word]
    lacking = [rule for _, rule, fits in given if not fits]
    return (*plain, *(["--ros-args", *words] if words else [])), lacking


def _not_given(file: str, node: LaunchedNode, lacking: Sequence[str]) -> Iterator[Message]:
    if lacking:
        yield msg(
            "{program} of {file} was started without {names}",
            program=shown(node.executable),
            file=shown(file),
            names=listed(lacking),
        )


def _yaml(value: str) -> str:
    """Return a value as YAML: JSON as it is, everything else as a text."""
    try:
        json.loads(value)
    except ValueError:
        return json.dumps(value)
    return value
