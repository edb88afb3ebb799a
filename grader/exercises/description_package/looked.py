"""What was found of a package, as the checks ask for it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from grader.exercise.verdict import Finding
from grader.language.phrase import say
from grader.recording.recording import Recordings
from grader.scenes.package.said import said
from grader.scenes.package.trace import Description, Launch, PackageTrace, Problem, Setup


@dataclass(frozen=True)
class Looked:
    """A package that was looked at."""

    trace: PackageTrace
    setup: Setup

    @classmethod
    def at(cls, trace: object) -> Looked | None:
        """What was found, by the trace of a look; None where nobody got so far."""
        found = PackageTrace.of(trace)
        return None if found.setup is None else cls(found, found.setup)

    @property
    def name(self) -> str:
        """The package's."""
        return self.setup.name

    @property
    def launches(self) -> Sequence[Launch]:
        """Its launch files."""
        return self.trace.launches

    @property
    def descriptions(self) -> list[Description]:
        """Those that a launch file hands on; where none does, those of the package's files."""
        every = self.trace.descriptions
        return [each for each in every if each.is_launched] or list(every)

    def text(self, number: int) -> str:
        """A text by its number."""
        return self.trace.texts[number] if number >= 0 else ""

    @property
    def starts_nothing(self) -> bool:
        """Whether all launch files come to their end, and none starts anything."""
        return not any(e.problem or e.nodes or e.includes or e.processes for e in self.launches)

    @property
    def not_known(self) -> Launch | None:
        """The first launch file that could not be evaluated for no fault of its own."""
        kinds = ("unknown", "argument")
        problems = ((each, each.problem) for each in self.launches if each.problem)
        return next((each for each, problem in problems if problem.kind in kinds), None)


def looked_at(recordings: Recordings, judge: Callable[[Looked], Finding]) -> Finding:
    """What a check finds of a package; the same for every check where nobody got so far."""
    looked = Looked.at(recordings.nominal.trace)
    return nothing(recordings.nominal.run.flags) if looked is None else judge(looked)


def nothing(remarks: Sequence[str] = ()) -> Finding:
    """Of a package that nobody could look at; the first remark says why."""
    return Finding(
        0,
        say("The package could not be looked at: {why}.", why=remarks[0])
        if remarks
        else say("The package could not be looked at."),
        say("Does setup.py or a launch file end the process that it runs in, or run without end?"),
    )


def nothing_started() -> Finding:
    """Of what nobody can tell, because no launch file starts anything."""
    return Finding(
        0,
        say("Not judged: no launch file starts anything, so there is nothing to look at."),
        say("Write the launch file that shows the robot first."),
        judged=False,
    )


def not_judged(launch: Launch, what: str = "") -> Finding:
    """Of what nobody can tell, because a launch file uses what the grader does not know."""
    problem = launch.problem or Problem("", "")
    values = {"file": launch.file, "why": said(problem)}
    return Finding(
        0,
        say("Not judged: {what}, and {file} could not be evaluated: {why}.", what=what, **values)
        if what
        else say("Not judged: {file} could not be evaluated: {why}.", **values),
        say("Give the argument a default_value: then `ros2 launch` needs no more than the file.")
        if problem.kind == "argument"
        else say("This is no fault of the package: tell whoever runs the course."),
        judged=False,
    )


def folder_of(path: str) -> str:
    """The folder of a path, to tell of many files at once."""
    return str(PurePosixPath(path).parent)
