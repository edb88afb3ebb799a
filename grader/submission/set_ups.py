"""What the set-up files of a submission name to be started: what an inspection says of them.

A setup.py is run to learn that, elsewhere and confined; what comes of it is a claim of the
submission's, which is held against its files here.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final, Self

from grader.errors import SubmissionError
from grader.language import stored
from grader.language.phrase import say
from grader.submission.folder import HandedIn, read_bounded, shown

SETUP_FILES: Final = ("pyproject.toml", "setup.py", "setup.cfg")  # the first to name a script wins
#: So many folders with set-up files are asked about.
MOST: Final = 50

_TARGET: Final = re.compile(r"(\w+(?:\.\w+)*)\s*:\s*(\w+(?:\.\w+)*)\s*(?:\[.*\])?")


class NotInspected(Exception):
    """What there is to start only an inspection can tell.

    Attributes:
        base: all of what was handed in, where it lies unpacked.
        folders: those with set-up files, below it.
        inside: the archives in what was handed in that are looked into, the innermost first.
    """

    def __init__(self, base: Path, folders: Sequence[str]) -> None:
        super().__init__(base)
        self.base, self.folders = base, folders
        self.inside: list[str] = []


@dataclass(frozen=True)
class SetUp:
    """What the set-up files of a folder say; see `grader.scenes.package.inspection.Told`.

    Attributes:
        folder: where they lie; '.' for the top of what was handed in.
        problem: a sentence on what ended their evaluation; '' where it came to its end.
        data_files: (folder, file) of each.
    """

    folder: str
    problem: str = ""
    name: str = ""
    scripts: Sequence[str] = ()
    data_files: Sequence[tuple[str, str]] = ()
    packages: Sequence[str] | None = None
    package_folders: Sequence[str] = ()
    scripts_folder: str = ""
    has_commands: bool = False


@dataclass(frozen=True)
class Node:
    """One node that a launch file starts, and the arguments that its program gets."""

    package: str
    executable: str
    arguments: tuple[str, ...] = ()

    @property
    def is_as_by_itself(self) -> bool:
        """Whether its program does the same without these arguments, but for its name."""
        return not self.arguments or (
            len(self.arguments) == 3 and self.arguments[2].startswith("__node:=")
        )


@dataclass(frozen=True)
class LaunchFile:
    """A launch file, evaluated.

    Attributes:
        folder, file: of its package, and where it lies there.
        unread: why nobody knows what it starts; '' where one does.
        is_plain: whether it starts nothing but these nodes, whatever its arguments are.
    """

    folder: str
    file: str
    nodes: tuple[Node, ...] = ()
    unread: str = ""
    is_plain: bool = False


@dataclass(frozen=True)
class Inspected:
    """What an inspection has said of the packages in what was handed in."""

    set_ups: Sequence[SetUp] = ()
    launches: Sequence[LaunchFile] = ()

    def to_json(self) -> dict[str, Any]:
        """As `from_json` takes it."""
        return {**asdict(self), "phrases": stored.phrases_in(self)}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """The same, in the process that reads."""

        def text(told: str) -> str:
            return stored.restored((told,), data["phrases"])[0]

        launches = [
            LaunchFile(
                each["folder"],
                each["file"],
                tuple(Node(n["package"], n["executable"], tuple(n["arguments"])) for n in nodes),
                text(each["unread"]),
                each["is_plain"],
            )
            for each in data["launches"]
            for nodes in [each["nodes"]]
        ]
        set_ups = [SetUp(**{**each, "problem": text(each["problem"])}) for each in data["set_ups"]]
        return cls(set_ups, launches)


@dataclass(frozen=True)
class ConsoleScript:
    """`name = module:function`, as `file` says."""

    name: str
    module: str
    function: str
    file: Path


@dataclass(frozen=True)
class Package:
    """A folder with set-up files, and what they say."""

    folder: Path
    scripts: tuple[ConsoleScript, ...] = ()
    said: SetUp = field(default_factory=lambda: SetUp("."))

    @property
    def has_setup_py(self) -> bool:
        """Whether `colcon build` would run something."""
        return (self.folder / "setup.py").is_file()

    def roots(self, module: str) -> list[Path]:
        """List the folders to import `module` from, best first; none lies outside the package."""
        package = module.split(".")[0]
        lie_in = dict(each.partition("=")[::2] for each in self.said.package_folders)
        lies_in = Path(lie_in.get(package, ""))
        single = [str(lies_in.parent)] if lies_in.name == package else []
        folder = self.folder.resolve()
        names = (*single, *([lie_in[""]] if "" in lie_in else (".", "src")))
        # os.path: links that lead in a circle are no exception there
        roots = [Path(os.path.realpath(folder / name)) for name in names if "\0" not in name]
        return [root for root in dict.fromkeys(roots) if root.is_relative_to(folder)] or [folder]


def read_package(said: SetUp, handed_in: HandedIn) -> Package:
    """A folder by what its set-up files say.

    Raises:
        SubmissionError: they have an entry that is no `name = module:function`, so that no tool
            could install the package.
    """
    folder = handed_in.base / said.folder
    scripts: dict[str, ConsoleScript] = {}
    for line in said.scripts:
        name, _, target = line.partition("=") if "=" in line else ("", "", line)
        script = _console_script(name.strip(), target.strip(), folder, handed_in)
        scripts.setdefault(script.name, script)
    return Package(folder, tuple(scripts.values()), said)


def _console_script(name: str, target: str, folder: Path, handed_in: HandedIn) -> ConsoleScript:
    file = _file_of(folder, name or target)
    match = _TARGET.fullmatch(target)
    if not name or match is None:
        found = shown(f"{name} = {target}" if name else target)
        hint = say(" A comma seems to be missing between two entries.") if "=" in target else ""
        raise SubmissionError(
            say(
                "{file} has the console script '{found}'.{hint} Expected 'name = "
                "package.module:function', for example 'turtle_controller = "
                "my_package.turtle_controller:main'.",
                file=handed_in.called(file),
                found=found,
                hint=hint,
            )
        )
    return ConsoleScript(name, match[1], match[2], file)


def _file_of(folder: Path, name: str) -> Path:
    """The set-up file that names a script, as far as one has its name as it stands."""
    files = [folder / each for each in SETUP_FILES if (folder / each).is_file()]
    named = (each for each in files if name.encode() in (read_bounded(each) or b""))
    return next(named, folder / "setup.py" if folder / "setup.py" in files else files[0])
