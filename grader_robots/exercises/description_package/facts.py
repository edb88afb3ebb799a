"""The facts about a package that exercises weigh."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import NamedTuple

from grader import Finding, Recordings, Tolerances
from grader.exercise import UNKNOWN, not_judged
from grader.submission import package_trace
from grader.text import Message, msg
from ros_doubles.known import SIMULATORS

#: Obstacles of a launch file that may be one of several: it wants what its user knows, too.
NO_FAULT = (UNKNOWN, "argument")
_SIMULATORS = ("gz sim", "gazebo", "gzserver", "ign gazebo", "webots")


class PackageFault(NamedTuple):
    """Something that is wrong with a package, or missing.

    Attributes:
        what: tells several files of one folder as one thing, and what an exercise gives points for.
    """

    what: str
    rationale: Message
    help: Message


@dataclass(frozen=True)
class PackageFacts:
    """A package that was inspected."""

    trace: package_trace.PackageTrace
    setup: package_trace.Setup

    @classmethod
    def of(cls, trace: object) -> PackageFacts | None:
        """The facts in the trace of an inspection; None where it found no package."""
        found = package_trace.PackageTrace.of(trace)
        return None if found.setup is None else cls(found, found.setup)

    @property
    def name(self) -> str:
        """The package's."""
        return self.setup.name

    @property
    def launches(self) -> Sequence[package_trace.LaunchFile]:
        return self.trace.launches

    @property
    def descriptions(self) -> list[package_trace.Description]:
        """Those that a launch file hands on; where none does, those of the package's files."""
        every = self.trace.descriptions
        return [each for each in every if each.is_launched] or list(every)

    @property
    def for_rviz(self) -> list[package_trace.LaunchFile]:
        """The launch files that do more than put the robot into Gazebo."""
        return [
            each
            for each in self.launches
            if any(map(is_rviz, each.nodes)) or not includes_simulator(each)
        ]

    def text(self, number: int) -> str:
        return self.trace.texts[number] if number >= 0 else ""

    @property
    def plain_programs(self) -> list[str]:
        """What is installed where `ros2 run` looks, as install(PROGRAMS) of CMake does it."""
        place, files = f"lib/{self.name}/", self.setup.installed
        return [path.removeprefix(place) for path in files if path.startswith(place)]

    @property
    def starts_nothing(self) -> bool:
        """Whether all launch files come to their end, and none starts anything."""
        return not any(e.problem or e.nodes or e.includes or e.processes for e in self.launches)


def is_rviz(node: package_trace.LaunchedNode) -> bool:
    return "rviz2" in (node.package, node.executable)


def includes_simulator(launch: package_trace.LaunchFile) -> bool:
    """A simulator publishes the joints of what it simulates."""
    included = any(each.package in SIMULATORS for each in launch.includes)
    return included or any(each.startswith(_SIMULATORS) for each in launch.processes)


def of_package(
    judge: Callable[[PackageFacts, Tolerances], Finding],
) -> Callable[[Recordings, Tolerances], Finding]:
    """A check of a package; the same for every check where the inspection found nothing."""

    @wraps(judge)
    def check(recordings: Recordings, tolerances: Tolerances) -> Finding:
        recording = recordings.nominal
        facts = PackageFacts.of(recording.trace)
        return nothing(recording.run.flags) if facts is None else judge(facts, tolerances)

    return check


def unjudged(why: Message, help: Message) -> Finding:
    return Finding(0, why, help, judged=False)


def no_robot(why: Message) -> Finding:
    """Of what nobody can tell, because there is no robot."""
    return unjudged(why, msg("See what is said of the description first."))


def nothing(remarks: Sequence[Message] = ()) -> Finding:
    """Of a package that nobody could look at; the first remark says why."""
    return Finding(
        0,
        msg("The package could not be looked at: {why}.", why=remarks[0])
        if remarks
        else msg("The package could not be looked at."),
        msg("Does setup.py or a launch file end the process that it runs in, or run without end?"),
    )


def nothing_started() -> Finding:
    """Of what nobody can tell, because no launch file starts anything."""
    return unjudged(
        msg("Not judged: no launch file starts anything, so there is nothing to look at."),
        msg("Write the launch file that shows the robot first."),
    )


def not_followed(facts: PackageFacts) -> Finding | None:
    """Of a set-up that nobody can follow here; None where it can be."""
    problem = facts.setup.problem
    if problem is None or problem.kind != UNKNOWN:
        return None
    return not_judged(problem.file or "setup.py", problem)
