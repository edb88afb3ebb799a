"""Finds the launch file that starts several programs of a submission, each in a process."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from grader.errors import SubmissionError
from grader.recording.recording import MOST_PROGRAMS
from grader.submission.entry_points import Packages
from grader.submission.folder import CMAKE, SubmissionFolder
from grader.submission.program import Program, Script
from grader.submission.program_source import is_among
from grader.submission.request import LaunchAsked
from grader.text.message import Message, joined, msg
from grader.text.strings import listed, shown
from ros_doubles.launch_time import WITH_THE_LAUNCH

if TYPE_CHECKING:  # what only a package needs takes time to import
    from grader.submission.answer import Inspection, LaunchOrder
    from grader.submission.package_trace import LaunchFile

#: What the simulator stands in for.
_SIMULATOR: Final = ("turtlesim", "turtlesim_node")
#: The most times that a program which has ended is started again.
MOST_RESPAWNS: Final = 3
LACKING: Final = msg("{program} of {file} was started without {names}")
OTHERS: Final = msg("{file} starts programs of other packages, and these were not: {names}")
LATER: Final = msg("{file} starts programs after an event, and these were not: {names}")
NOT_FOLLOWED: Final = msg("of {file} was not followed: {names}")
FAULTY: Final = msg("{file} cannot be launched: {why}")
SEVERAL: Final = msg(
    "several launch files start several programs, and none of them was used: {names}"
)
AGAIN: Final = msg("{program} of {file} is started again {n} times at most")


@dataclass(frozen=True)
class Launched:
    """What a launch file starts.

    Attributes:
        file: its name.
        programs: the submission's, in the order in which they are started; see `Packages.found`.
        notes: what is left out, and what is not followed.
        compiled: the submission's that are not in Python.
        several: the launch files of which one would have to be chosen.
    """

    file: str
    programs: tuple[Program, ...]
    notes: tuple[Message, ...]
    compiled: tuple[str, ...]
    several: tuple[str, ...] = ()

    @property
    def found(self) -> Message:
        names = listed({each.name: each.executable for each in self.programs}.values())
        return msg("{file}, which starts {names}", file=shown(self.file), names=names)


def find_launched(
    submitted: SubmissionFolder,
    packages: Packages,
    inspection: Inspection,
) -> Launched:
    """Find the launch file that is asked for, or the one that starts several programs.

    Where the exercise is about several, it may be one that starts a single one. It is none that
    starts more than an exercise names which is about one. One that starts nothing is returned where
    there is none, with notes.
    """
    launches, asked = inspection.launches, submitted.request.launch

    def launched(launch: LaunchFile) -> Launched:
        made = _Launching(submitted, packages, inspection)
        return made.launched(launch, inspection.orders[launch.file])

    if asked:
        found = launched(_asked(submitted, inspection, asked))
        if not (found.programs or found.compiled):
            raise SubmissionError(
                "{file} starts no program of {name}", file=shown(found.file), name=submitted.name
            )
    else:
        included = {file for order in inspection.orders.values() for file in order.included}
        outer = [each for each in launches if each.file not in included]
        faulty = [_faulty(each) for each in outer if each.problem is not None]
        every = [launched(each) for each in launches if each.problem is None]
        alone = [e for e in every if e.file not in included and _is_needed(e, packages)]
        several, among = _starting(alone, 2), _starting(every, 2)
        if len(submitted.request.programs) > 1 and len(among) != 1:
            several = _starting(alone, 1)
        if len(several) > 1:
            files = tuple(each.file for each in reversed((among or several).values()))
            return Launched("", (), (*faulty, SEVERAL.given(names=listed(files))), (), files)
        if not several:
            return Launched("", (), tuple(faulty), ())
        (found,) = several.values()
        found = replace(found, notes=(*faulty, *found.notes))
    if found.compiled:
        raise SubmissionError(
            "{file} starts {names}, which is not in Python. Only Python can be graded.",
            file=shown(found.file),
            names=listed(found.compiled),
        )
    if len(found.programs) > MOST_PROGRAMS:
        raise SubmissionError(
            "{file} starts {number} programs; a run may have {most}",
            file=shown(found.file),
            number=len(found.programs),
            most=MOST_PROGRAMS,
        )
    return found


def _starting(every: Sequence[Launched], least: int) -> dict[tuple[Program, ...], Launched]:
    """Return those that start so many programs, of equal ones the first."""
    return {
        each.programs: each
        for each in reversed(every)
        if len(each.programs) + len(each.compiled) >= least
    }


def one_of(launched: Launched, submitted: SubmissionFolder) -> SubmissionError:
    """Return the error that nothing else tells which of several launch files is meant."""
    return SubmissionError(
        "{name} has several launch files that start several programs: choose one with {commands}",
        name=submitted.name,
        commands=listed(f"--launch {shown(file)}" for file in launched.several),
    )


def _is_needed(launched: Launched, packages: Packages) -> bool:
    """Whether each program has something that the exercise names, where it names the one."""
    request = packages.submitted.request
    if len(request.programs) > 1 or not request.roles:
        return True
    found = map(packages.roles, launched.programs)
    return all(any(is_among(role, roles) for role in request.roles) for roles in found)


def undeclared(inspection: Inspection, asked: LaunchAsked) -> Iterator[Message]:
    """Yield a note on each argument that the launch file asked for does not declare."""
    for each in inspection.launches:
        names = sorted(asked.given.keys() - {*each.declared})
        for name in names if asked.is_called(each.file) else ():
            yield msg(
                "{file} declares no argument {name}, only {known}",
                file=shown(each.file),
                name=shown(name),
                known=listed(each.declared) or msg("none"),
            )


def _asked(submitted: SubmissionFolder, inspection: Inspection, asked: LaunchAsked) -> LaunchFile:
    """Return the launch file of a path or a name."""
    launches, orders = inspection.launches, inspection.orders
    paths = {each.file: each.file for each in launches}
    paths |= {file: order.path for file, order in orders.items()}
    named = [each for each in launches if each.file == asked.file]
    named = named or [each for each in launches if asked.is_called(paths[each.file])]
    named = named or [each for each in launches if asked.is_called(each.file)]
    if not named:  # by its path in more than was handed in
        ends = [each for each in launches if f"/{asked.file}".endswith(f"/{paths[each.file]}")]
        named = sorted(ends, key=lambda each: len(paths[each.file]))[-1:]
    if len(named) != 1:
        text = msg("{name} has no launch file {file}; it has: {names}")
        if named:
            text = msg("{name} has several launch files {file}: {names}. Give its path.")
        names = listed(each.file for each in named or launches) or msg("none")
        raise SubmissionError(text.given(name=submitted.name, file=shown(asked.file), names=names))
    if named[0].problem:
        raise SubmissionError(_faulty(named[0]))
    return named[0]


def _faulty(launch: LaunchFile) -> Message:
    assert launch.problem is not None
    why = joined([launch.problem.described, launch.problem.place])
    return FAULTY.given(file=shown(launch.file), why=why)


class _Launching:
    """Finds, one after the other, the programs that a launch file starts."""

    def __init__(self, submitted: SubmissionFolder, packages: Packages, of: Inspection) -> None:
        self._submitted, setup = submitted, of.trace.setup
        self._own = {each.name: each for each in packages.readable}
        self._names = {*self._own, *of.trace.others}  # of all packages
        folder = submitted.base / of.package
        judged = next((each for each in packages.readable if each.folder == folder), None)
        if setup is not None:
            self._names.add(setup.name)
            if judged is not None:  # by both of its names
                self._own |= {setup.name: judged, setup.told: judged}
        self._programs, self._compiled = list[Program](), list[str]()
        self._places = dict[int, int]()  # of the programs, by their numbers in the launch file
        self._others, self._later = list[str](), list[str]()
        self._has_simulator = False

    def launched(self, launch: LaunchFile, order: LaunchOrder) -> Launched:
        """Return what a launch file starts."""
        notes = list[Message]()
        for number, start in enumerate(order.programs):
            if lacking := self._add(number, start):
                program = shown(start.executable)
                notes.append(LACKING.given(program=program, names=listed(lacking)))
        notes += self._respawn(order)
        self._others += [f"{each.package} {each.file}" for each in launch.includes]
        left = {OTHERS: self._others, LATER: self._later, NOT_FOLLOWED: order.ignored}
        notes += [text.given(names=listed(names)) for text, names in left.items() if names]
        told = tuple(each.given(file=shown(launch.file)) for each in notes)
        return Launched(launch.file, tuple(self._programs), told, tuple(self._compiled))

    def _add(self, number: int, start: Program) -> Sequence[str]:
        """Add a program to those of its kind; return what it does not get."""
        package, program = self._own.get(start.package), self._program(start)
        name = f"{start.package} {start.executable}".strip()
        if program is not None:
            if start.after != WITH_THE_LAUNCH and start.after not in self._places:
                self._later.append(start.executable)
                return ()
            self._places[number] = len(self._programs)
            after = self._places.get(start.after, WITH_THE_LAUNCH)
            self._programs.append(replace(program, after=after))
            return start.lacking
        if (start.package, start.executable) == _SIMULATOR and not self._has_simulator:
            self._has_simulator = True
            return [word for word in start.arguments if not word.startswith(("-", "__node:="))]
        is_python = start.executable.endswith(".py")
        if package is None or ((package.folder / CMAKE).is_file() and not is_python):
            is_own = start.package in self._names
            (self._compiled if is_own else self._others).append(name)
        return ()  # its set-up does not install it: `not_installed` says so

    def _respawn(self, order: LaunchOrder) -> Iterator[Message]:
        """Add to those that are started what is started again at their ends."""
        for number, place in self._places.items():
            start, again = order.programs[number], self._programs[place]
            room = MOST_PROGRAMS - len(self._programs)
            most = min(MOST_RESPAWNS, max(room, 0))
            times = start.respawns if 0 <= start.respawns <= most else most
            if times != start.respawns:
                yield AGAIN.given(program=shown(start.executable), n=times)
            for _ in range(times):
                self._programs.append(replace(again, after=place, delay_s=start.respawn_s))
                place = len(self._programs) - 1

    def _program(self, start: Program) -> Program | None:
        """Return the submission's program that a launch file means, in Python."""
        if package := self._own.get(start.package):
            named = {each.name: each for each in package.executables}
            if executable := named.get(start.executable):
                start = replace(start, package=package.name, root=package.folder)
                return replace(start, entry=executable.entry)
        if start.package or not isinstance(start.entry, Script):
            return None
        file = self._submitted.base / start.entry.path
        if ".." in file.parts or not file.is_file():
            return None
        self._submitted.must_hold(file)
        return replace(start, executable=file.name, entry=Script(file), root=file.parent)
