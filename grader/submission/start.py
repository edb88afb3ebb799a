"""A submission once it has been read: what to start, from where, and what it imports."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

from grader.message import Message
from grader.recording.observations import LintFinding
from grader.recording.recording import OwnInterfaces
from grader.strict_json import UNSTORED, not_empty
from grader.submission.private_copy import PrivateCopy


@dataclass(frozen=True)
class EntryPoint:
    """Import `module`, call `function` without arguments."""

    module: str
    function: str  # may be dotted: "Controller.main"


@dataclass(frozen=True)
class Script:
    """Run the file as `__main__`.

    With a `function`, load the file by its path under another name instead, and call that: the
    file does not start itself, and its name cannot be imported.
    """

    path: Path  # absolute
    function: str | None = None


@dataclass(frozen=True)
class Program:
    """A program that is started, in a process of its own.

    Attributes:
        name: as `ros2 launch` prints it, 'talker-1'; of a script that of its file.
        package: in which it is; '' for a script.
        executable: its console script, or its file.
        entry: what runs.
        root: comes first on its sys.path, and is its working directory; absolute.
        arguments: "--ros-args", "-r", "__ns:=/left".
        files: which of them are files of the submission, as absolute paths.
        after: the place among all of the one at whose end it is started; None: of none.
        delay_s: how long after that, or after the others [s].
    """

    name: str
    package: str
    executable: str
    entry: EntryPoint | Script
    root: Path
    arguments: tuple[str, ...] = ()
    files: tuple[int, ...] = ()
    after: int | None = None
    delay_s: float = 0.0

    def is_respawned(self, beside: Sequence[Program]) -> bool:
        """Whether it is another of these that is started again."""
        return self.after is not None and beside[self.after].name == self.name


@dataclass(frozen=True)
class Launch:
    """Start programs as a launch file does."""

    programs: Annotated[tuple[Program, ...], not_empty]


@dataclass(frozen=True)
class Whole:
    """Start nothing: all of it is inspected.

    Attributes:
        package: the one that is asked for, where there may be several; '' for none in particular.
    """

    package: str = ""


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
    """A submission, and how it starts."""

    name: str  # of the original: "alice.zip", "turtle_controller.py"
    root: Path  # in its copy, absolute; comes first on sys.path and is the working directory
    start: EntryPoint | Script | Launch | Whole
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
    #: the package and the console script of its program; '' and the file of a script
    of_package: str = field(default="", compare=False)
    executable: str = field(default="", compare=False)
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
    def programs(self) -> tuple[Program, ...]:
        """What is started, in this order."""
        if isinstance(self.start, Launch):
            return self.start.programs
        assert not isinstance(self.start, Whole)
        name = f"{self.executable}-1" if self.of_package else self.executable
        return (Program(name, self.of_package, self.executable, self.start, self.root),)

    def alone(self, program: Program) -> Submission:
        """Return the submission with one of its programs."""
        return replace(self, start=program.entry, root=program.root)

    def moved(self, folder: Path) -> Submission:
        """Return the submission as one run finds it, copied to another folder."""
        if folder == self.folder:
            return self
        moved = self.with_paths(lambda path: folder / path.relative_to(self.folder))
        return replace(moved, copy=self.copy and self.copy.moved(folder))

    def with_paths(self, there: Callable[[Path], Path]) -> Submission:
        """Return the submission with each path of its files replaced."""

        def placed(start: Any) -> Any:
            if isinstance(start, Script):
                return replace(start, path=there(start.path))
            if isinstance(start, Launch):
                return Launch(tuple(map(placed, start.programs)))
            if isinstance(start, Program):
                words, root = list(start.arguments), there(start.root)
                for each in start.files:
                    words[each] = str(there(Path(words[each])))
                return replace(start, entry=placed(start.entry), root=root, arguments=tuple(words))
            return start

        package, beside = self.package and there(self.package), tuple(map(there, self.beside))
        moved = replace(self, root=there(self.root), start=placed(self.start), package=package)
        return replace(moved, beside=beside)

    def with_original_paths(self, text: str) -> str:
        """Replace the copy's paths in a run's output by the original ones."""
        return self.copy.with_original_paths(text) if self.copy else text
