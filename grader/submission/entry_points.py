"""Chooses the program of a package that is the node, and finds its module."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING

from grader.errors import SubmissionError
from grader.submission.folder import SubmissionFolder, files_below, is_passed_by
from grader.submission.interfaces import TWICE
from grader.submission.program import Program, Script
from grader.submission.program_source import is_among, read_imports, roles_in
from grader.submission.python_source import read_source
from grader.submission.set_ups import Executable, PackageFolder, read_package
from grader.text.message import Message, msg
from grader.text.strings import listed, nearest, shown

if TYPE_CHECKING:
    from grader.recording.subject import Role
    from grader.submission.answer import SetUp

Choice = tuple[PackageFolder, Executable]


@dataclass(frozen=True)
class Packages:
    """The folders of a submission that have set-up files, from the top down."""

    submitted: SubmissionFolder
    readable: tuple[PackageFolder, ...]
    faults: tuple[SubmissionError, ...]  # of the others; they matter if no script fits

    @property
    def every(self) -> list[Choice]:
        """All programs, each with its package."""
        return [(package, each) for package in self.readable for each in package.executables]

    def choose(self) -> Choice | None:
        """Choose the script asked for, else the usual one, else the only one; None without any.

        Of several it is the one whose source has most of what the exercise names.
        """
        every, request = self.every, self.submitted.request
        matching = [each for each in every if request.is_wanted(each[1].name, each[0].name)]
        if len(matching) == 1:
            return matching[0]
        if matching:
            raise self._twice(matching)
        if self.faults:
            raise self.faults[0]
        names = [script.name for _, script in every]
        if request.executable and every:
            raise no_such_executable(self.submitted, request.executable, names)
        if len(every) > 1:
            fitting = self._fitting(every)
            if len(fitting) == 1:
                return fitting[0]
            names = [script.name for _, script in fitting]
            if len(set(names)) > 1:
                raise several_programs(self.submitted, names)
            raise self._twice(every)
        return every[0] if every else None

    def program(self, package: PackageFolder, executable: Executable, number: int = 1) -> Program:
        """Return a program as it is started without a launch file, see `found`."""
        name = executable.name
        return Program(f"{name}-{number}", package.name, name, executable.entry, package.folder)

    def package(self, program: Program) -> PackageFolder | None:
        """Return the package of a program whose root is its folder; None of a file in none."""
        of = {each.folder: each for each in self.readable} if program.package else {}
        return of.get(program.root)

    def found(self, program: Program) -> tuple[Program, tuple[Path, ...]]:
        """Return a program of a package with the root that it has when it runs.

        Returns:
            The program; and folders below that root, on the way to its module, that lack an
            __init__.py.

        Raises:
            SubmissionError: its module is not there, or lacks its function; its file is a link to
                somewhere else.
        """
        package = self.package(program)
        if isinstance(program.entry, Script):
            self.submitted.must_hold(program.entry.path)
            return replace(program, root=program.entry.path.parent), ()
        assert package is not None
        executable = package.executable(program.executable)
        root, bare = _find_module(self.submitted, package, executable)
        return replace(program, root=root), bare

    @property
    def roots(self) -> list[Path]:
        """The folders from which packages in Python are imported."""
        return [
            each.roots(each.name)[0]
            for each in self.readable
            if each.has_setup_py or each.is_module
        ]

    def roles(self, program: Program) -> set[Role]:
        """Return what the source of a program has on the graph."""
        try:
            program, _ = self.found(program)
        except SubmissionError:
            return set()
        return roles_in(read_imports(program.root, [program]).files)

    def _fitting(self, every: list[Choice]) -> list[Choice]:
        """Return the programs that have most of what the exercise names, or all where none has."""
        wanted = self.submitted.request.roles
        found = [self.roles(self.program(*choice)) for choice in every]
        counts = [sum(is_among(role, roles) for role in wanted) for roles in found]
        return [each for each, n in zip(every, counts, strict=True) if n == max(counts)]

    def together(self, names: Sequence[str]) -> list[Choice]:
        """Return the scripts of these names, or of several just as many others; else none."""
        every = self.every
        found = [[each for each in every if fnmatchcase(each[1].name, name)] for name in names]
        if all(len(each) == 1 for each in found):
            return [each[0] for each in found]
        return every if len(every) == len(names) > 1 else []

    def others(self, started: Sequence[Program]) -> list[str]:
        """The names of the programs that are something else than those that are started."""
        entries = [each.entry for each in started]
        others = [choice for choice in self.every if choice[1].entry not in entries]
        return [self.called(package.name, each.name) for package, each in others]

    def called(self, package: str, name: str) -> str:
        """Name a program, with its package where another has one of that name."""
        same = [each for _, each in self.every if each.name == name]
        return f"{package}/{name}" if package and len(same) > 1 else name

    def holding(self, file: Path) -> PackageFolder | None:
        """The package with a setup.py in whose folder a file lies."""
        with_setup = (package for package in self.readable if package.has_setup_py)
        return next((each for each in with_setup if file.is_relative_to(each.folder)), None)

    def _twice(self, matching: list[Choice]) -> SubmissionError:
        where = listed(self.submitted.called(script.file) for _, script in matching)
        packages = {package.name for package, _ in matching}
        if len(packages) < len(matching):
            return SubmissionError(TWICE.given(name=shown(min(packages)), places=where))
        return SubmissionError(
            "{name} has the program {program} more than once: {where}. "
            "Choose one with --executable PACKAGE/NAME.",
            name=self.submitted.name,
            program=shown(matching[0][1].name),
            where=where,
        )


def find_packages(submitted: SubmissionFolder, set_ups: Sequence[SetUp]) -> Packages:
    """Read the folders with set-up files; not those below a folder that has a console script."""
    readable: list[PackageFolder] = []
    faults: list[SubmissionError] = []
    have_script: set[Path] = set()
    base = submitted.base
    seen = [each for each in set_ups if not is_passed_by(base / each.folder, base)]
    for each in seen or set_ups:  # else all of it would be nothing
        folder = base / each.folder
        if not have_script.isdisjoint((folder, *folder.parents)):
            continue
        try:
            package = read_package(each, submitted)
        except SubmissionError as fault:
            faults.append(fault)
        else:
            readable.append(package)
            have_script |= {folder} if package.executables else set()
    return Packages(submitted, tuple(readable), tuple(faults))


def _find_module(
    submitted: SubmissionFolder, package: PackageFolder, script: Executable
) -> tuple[Path, tuple[Path, ...]]:
    """Find the script's module in its package, and nowhere else; see `Packages.found`.

    Returns:
        The folder to import it from, and package folders on the way without an __init__.py.
    """
    inside = Path(*script.module.split("."))
    roots = package.roots(script.module)
    for root in roots:
        for file in (root / inside / "__init__.py", root / f"{inside}.py"):
            if file.is_file():
                submitted.must_hold(file)
                _must_define(submitted, script, file)
                folders = list(inside.parents)[:-1]  # the last is root itself
                bare = [f for f in folders if not (root / f / "__init__.py").exists()]
                return root, tuple(bare)
    raise _no_module(submitted, package, script, roots[0] / f"{inside}.py")


def no_such_executable(
    submitted: SubmissionFolder, executable: str, names: list[str]
) -> SubmissionError:
    """The error that nothing has the name that was asked for."""
    return SubmissionError(
        "{name} has no program {executable}; it has: {names}. Choose one of these with "
        "--executable NAME, or correct the name.",
        name=submitted.name,
        executable=shown(executable),
        names=listed(names),
    )


def several_programs(
    submitted: SubmissionFolder, names: Iterable[str], ending: str = ""
) -> SubmissionError:
    """The error that one has to be chosen; `ending`: of the name of a file."""
    return SubmissionError(
        "{name} has several programs to start: {names}. {advice}",
        name=submitted.name,
        names=listed(names),
        advice=submitted.request.advice(ending),
    )


def not_started(names: list[str]) -> list[Message]:
    """Return a note on the programs of a submission that were not started; empty without any."""
    if not names:
        return []
    return [
        msg(
            "another program was not started: {names}",
            "other programs were not started: {names}",
            n=len(names),
            names=listed(names),
        )
    ]


def _must_define(submitted: SubmissionFolder, script: Executable, file: Path) -> None:
    source = read_source(file)
    wanted = script.function.split(".")[0]
    if not source.surely_lacks(wanted):
        return
    names = dict.fromkeys([*nearest(wanted, source.defined), *source.defined])
    raise SubmissionError(
        "{file} defines no function {wanted} (it defines: {names}). {starts}: "
        "give the function that name, or correct the entry point.",
        file=submitted.called(file),
        wanted=shown(wanted),
        names=listed(names) or msg("nothing"),
        starts=_starts(submitted, script),
    )


def _no_module(
    submitted: SubmissionFolder, package: PackageFolder, script: Executable, expected: Path
) -> SubmissionError:
    found = [file for file in files_below(package.folder) if file.suffix == ".py"]
    wanted = submitted.called(expected)
    same_name = [submitted.called(file) for file in found if file.name == expected.name]
    nodes = (file for file in found if file.name not in ("setup.py", "__init__.py"))
    others = [submitted.called(file) for file in nodes]
    meant = list(dict.fromkeys(nearest(wanted, others) + same_name))
    there = msg("Python files: {names}.", names=listed(others) or msg("none"))
    if (as_text := expected.with_name(f"{expected.name}.txt")).is_file():
        there = msg("Near: {names}.", names=submitted.called(as_text))
    elif meant:
        there = msg("Near: {names}.", names=listed(meant))
    return SubmissionError(
        "{starts}, but there is no file {wanted}. {there} Correct the entry "
        "point, or the name or place of the file.",
        starts=_starts(submitted, script),
        wanted=wanted,
        there=there,
    )


def _starts(submitted: SubmissionFolder, script: Executable) -> Message:
    target = shown(f"{script.module}:{script.function}")
    return msg(
        "{file} starts {script} by {target}",
        file=submitted.called(script.file),
        script=shown(script.name),
        target=target,
    )
