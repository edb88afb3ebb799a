"""What the set-up files of a submission declare, by the inspection that has evaluated them.

A setup.py is run for that, elsewhere and confined; the result is a claim of the submission's, which
is compared with its files here.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from grader.errors import SubmissionError
from grader.submission.folder import SETUP_FILES, SubmissionFolder, read_bounded
from grader.submission.manifest import FILE as MANIFEST
from grader.submission.manifest import read_manifest
from grader.submission.program import EntryPoint, Script
from grader.text.message import NOTHING, Message, msg
from grader.text.strings import shown

if TYPE_CHECKING:  # what only a package needs takes time to import
    from grader.submission.answer import SetUp, SetUpFacts

#: So many folders with set-up files are inspected.
MOST: Final = 50

_TARGET: Final = re.compile(r"(\w+(?:\.\w+)*)\s*:\s*(\w+(?:\.\w+)*)\s*(?:\[.*\])?")


@dataclass(frozen=True)
class Unevaluated:
    """A submission whose set-up files have to be evaluated before anything of it can be chosen.

    Attributes:
        base: the whole submission, where it lies unpacked.
        folders: those with set-up files, below it.
        inside: the archives in the submission that were unpacked, the innermost first.
    """

    base: Path
    folders: tuple[str, ...]
    inside: tuple[str, ...] = ()


@dataclass(frozen=True)
class Executable:
    """A program that a package installs for `ros2 run`, in Python.

    Attributes:
        module, function: of a console script; '' of a file that is one by itself.
        file: where a console script is declared; or that file.
    """

    name: str
    module: str
    function: str
    file: Path

    @property
    def entry(self) -> EntryPoint | Script:
        """What of it runs."""
        return EntryPoint(self.module, self.function) if self.module else Script(self.file)


@dataclass(frozen=True)
class PackageFolder:
    """A folder with set-up files, and what they declare.

    Attributes:
        set_up: None for a folder without them.
    """

    folder: Path
    executables: tuple[Executable, ...] = ()
    set_up: SetUp | None = None

    def executable(self, name: str) -> Executable:
        """Return the program of a name; KeyError: it has none."""
        return {each.name: each for each in self.executables}[name]

    @property
    def name(self) -> str:
        """That of the package: by its package.xml, else its set-up, else its folder."""
        file = self.folder / MANIFEST
        manifest = read_manifest(file) if file.is_file() else None
        told = self.declared.name if self.declared else ""
        return (manifest.name if manifest else "") or told or self.folder.name

    @property
    def declared(self) -> SetUpFacts | None:
        return self.set_up.told if self.set_up else None

    @property
    def problem(self) -> Message:
        """A sentence on the error that ended its set-up; '' where there was none."""
        if self.set_up is None or self.set_up.problem is None:
            return NOTHING
        file = self.set_up.problem.file
        return self.set_up.problem.ends(file if file in SETUP_FILES else "setup.py")

    @property
    def is_module(self) -> bool:
        """Whether a package in Python of its name lies in it."""
        return any((root / self.name / "__init__.py").is_file() for root in self.roots(self.name))

    @property
    def has_setup_py(self) -> bool:
        """Whether `colcon build` would run something."""
        return (self.folder / "setup.py").is_file()

    def roots(self, module: str) -> list[Path]:
        """List the folders to import `module` from, best first; none lies outside the package."""
        package = module.split(".")[0]
        lie_in = dict(
            each.partition("=")[::2]
            for each in (self.declared.package_folders if self.declared else ())
        )
        lies_in = Path(lie_in.get(package, ""))
        single = [str(lies_in.parent)] if lies_in.name == package else []
        folder = self.folder.resolve()
        names = (*single, *([lie_in[""]] if "" in lie_in else (".", "src")))
        # os.path: links that lead in a circle are no exception there
        roots = [Path(os.path.realpath(folder / name)) for name in names if "\0" not in name]
        return [root for root in dict.fromkeys(roots) if root.is_relative_to(folder)] or [folder]


def read_package(set_up: SetUp, submitted: SubmissionFolder) -> PackageFolder:
    """Read the programs that the set-up files of a folder install."""
    package = PackageFolder(submitted.base / set_up.folder, set_up=set_up)
    found: dict[str, Executable] = {}
    for line in set_up.told.scripts:
        name, _, target = line.partition("=") if "=" in line else ("", "", line)
        script = _console_script(name.strip(), target.strip(), package.folder, submitted)
        found.setdefault(script.name, script)
    for path, source in set_up.installed.items():
        place, _, name = path.rpartition("/")
        file = Path(os.path.normpath(package.folder / source))
        is_own = place == f"lib/{package.name}" and file.is_relative_to(package.folder)
        if is_own and file.is_file() and is_python(file):
            found.setdefault(name, Executable(name, "", "", file))
    return replace(package, executables=tuple(found.values()))


def is_python(file: Path) -> bool:
    """Whether a file is Python by its name, or by its first line."""
    first_line = (read_bounded(file) or b"").partition(b"\n")[0]
    return file.suffix == ".py" or (first_line.startswith(b"#!") and b"python" in first_line)


def _console_script(
    name: str, target: str, folder: Path, submitted: SubmissionFolder
) -> Executable:
    file = _file_of(folder, name or target)
    match = _TARGET.fullmatch(target)
    if not name or match is None:
        found = shown(f"{name} = {target}" if name else target)
        hint = msg(" A comma seems to be missing between two entries.") if "=" in target else ""
        raise SubmissionError(
            "{file} has the console script '{found}'.{hint} Expected 'name = "
            "package.module:function', for example 'turtle_controller = "
            "my_package.turtle_controller:main'.",
            file=submitted.called(file),
            found=found,
            hint=hint,
        )
    return Executable(name, match[1], match[2], file)


def _file_of(folder: Path, name: str) -> Path:
    """Return the set-up file that has the name of a script in it, or else setup.py."""
    files = [folder / each for each in SETUP_FILES if (folder / each).is_file()]
    named = (each for each in files if name.encode() in (read_bounded(each) or b""))
    return next(named, folder / "setup.py" if folder / "setup.py" in files else files[0])
