"""A submission once it has been read: what to start, from where, and what it imports."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

from grader.recording.observations import LintFinding
from grader.recording.recording import OwnInterfaces
from grader.submission.private_copy import PrivateCopy
from grader.submission.program import BASE, OF_THE_RUN, PREFIX, EntryPoint, Program, Script
from grader.system.strict_json import UNSTORED
from grader.text.message import Message


@dataclass(frozen=True)
class Imports:
    """The modules, by the first part of their names, that are not the submission's own.

    Each with the place of its first import ("file.py, line 3"), in the order of these.

    Attributes:
        surely: imported whenever the submission is run.
        perhaps: only if a function is called, a condition holds, another import fails.
        files: the submission's own that are loaded, surely or perhaps; known while it is read.
    """

    surely: dict[str, str] = field(default_factory=dict)
    perhaps: dict[str, str] = field(default_factory=dict)
    files: tuple[Path, ...] = field(default=(), compare=False, metadata=UNSTORED)


@dataclass(frozen=True)
class Submission:
    """A submission, and what of it is started."""

    name: str  # of the original: "alice.zip", "turtle_controller.py"
    root: Path  # in its copy, absolute; comes first on sys.path and is the working directory
    #: what is started, in this order; nothing where all of it is inspected
    programs: tuple[Program, ...]
    found: Message  # a sentence for the user: "console script turtle_controller in setup.py"
    imports: Imports = field(default_factory=Imports, compare=False)
    #: for the result: faults that a run does not show, and what was not started
    notes: tuple[Message, ...] = field(default=(), compare=False)
    #: of its source
    lint_findings: tuple[LintFinding, ...] = field(default=(), compare=False)
    #: what its program gets beside those that are installed
    interfaces: OwnInterfaces = field(default_factory=OwnInterfaces, compare=False)
    #: the same, with those that it does not import
    defined: OwnInterfaces = field(default_factory=OwnInterfaces, compare=False)
    #: files that it lacked and that were added, below `root`
    added: tuple[Path, ...] = field(default=(), compare=False)
    #: the folder of the package that its program is in, absolute; None where it is in none
    package: Path | None = field(default=None, compare=False)
    #: the folders of other packages in it, from which it can import, absolute
    beside: tuple[Path, ...] = field(default=(), compare=False)
    #: whether a launch file starts it
    is_launched: bool = field(default=False, compare=False)
    #: the name of the package that is asked for, where nothing is started
    asked: str = field(default="", compare=False)
    #: a trace of the scene package, where its whole package was inspected
    seen: object = field(default=None, compare=False, metadata=UNSTORED)
    #: the processor time that the inspection took [s]
    spent_s: float = field(default=0.0, compare=False, metadata=UNSTORED)
    #: the copy for its runs; None where they use the original
    copy: PrivateCopy | None = field(default=None, compare=False, metadata=UNSTORED)

    @property
    def remarks(self) -> tuple[Message, ...]:
        """The remarks for the result: its notes, and what was left out of its copy."""
        return (*self.notes, *(self.copy.remarks if self.copy else ()))

    @property
    def folder(self) -> Path:
        """The read-only folder of its files, as its runs find it."""
        return self.copy.folder if self.copy else self.root

    @property
    def installed(self) -> str:
        """The prefix below which its packages are laid out as installed; '' where none are."""
        return str(self.copy.installed or "") if self.copy else ""

    @property
    def entry(self) -> EntryPoint | Script | None:
        """What its first program runs."""
        return self.programs[0].entry

    @property
    def is_by_itself(self) -> bool:
        """Whether it is one function that no launch file starts."""
        is_one = len(self.programs) == 1 and isinstance(self.entry, EntryPoint)
        return is_one and not self.is_launched

    def alone(self, program: Program) -> Submission:
        """Return the submission with one of its programs."""
        return replace(self, programs=(program,), root=program.root)

    def moved(self, folder: Path) -> Submission:
        """Return the submission as one run finds it, copied to another folder."""
        if folder == self.folder:
            return self
        moved = self.with_paths(lambda path: folder / path.relative_to(self.folder))
        return replace(moved, copy=self.copy and self.copy.moved(folder))

    def with_paths(self, there: Callable[[Path], Path]) -> Submission:
        """Return the submission with each path of its files replaced."""

        def placed(program: Program) -> Program:
            entry = program.entry
            if isinstance(entry, Script):
                entry = replace(entry, path=there(entry.path))
            return replace(program, entry=entry, root=there(program.root))

        package, beside = self.package and there(self.package), tuple(map(there, self.beside))
        programs = tuple(map(placed, self.programs))
        moved = replace(self, root=there(self.root), programs=programs, package=package)
        return replace(moved, beside=beside)

    def words(self, arguments: Iterable[str]) -> list[str]:
        """Return arguments of a program with the places of its files in them."""
        places = {BASE: str(self.folder), PREFIX: self.installed}
        words = list(arguments)
        for mark, place in places.items():
            words = [word.replace(mark, place) for word in words]
        return words

    @property
    def environment(self) -> dict[str, str]:
        """The variables that a launch file sets for its one program, as far as they can be."""
        given = self.programs[0].environment if len(self.programs) == 1 else ()
        pairs = (word.partition("=")[::2] for word in self.words(given) if "\0" not in word)
        return {n: value for n, value in pairs if n.isidentifier() and not n.startswith(OF_THE_RUN)}

    def with_original_paths(self, text: str) -> str:
        """Replace the copy's paths in a run's output by the original ones."""
        return self.copy.with_original_paths(text) if self.copy else text
