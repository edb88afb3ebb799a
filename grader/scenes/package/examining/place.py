"""Where the packages are laid out, and what is there called by everybody else."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from grader.scenes.package.examining import paths
from grader.scenes.package.examining.layout import MARKS, Installed
from grader.scenes.package.trace import EMPTY, PREFIX, ROS

DOUBLES: Final = Path(__file__).parent / "doubles"
CODE: Final = Path(__file__).resolve().parents[4]


@dataclass(frozen=True)
class Place:
    """Where packages are laid out.

    Attributes:
        prefix: where the submission's packages are installed.
        stubs: where those of ROS are said to be.
        empty: an empty folder, to stand in; `asked` is the file that takes down packages.
        judged: the package that is looked at.
        all: all packages of the submission.
        root: the folder that holds them.
    """

    prefix: Path
    stubs: Path
    empty: Path
    asked: Path
    judged: Installed
    all: tuple[Installed, ...]
    root: Path

    @property
    def home(self) -> Path:
        """The home folder of who launches; it is empty."""
        return self.empty / "home"

    def told(self, text: str) -> str:
        """A text with the places as everybody knows them."""
        for path, shown in ((self.prefix, PREFIX), (self.stubs, ROS), (self.home, "~")):
            text = text.replace(str(path), shown)
        for each in self.all:
            text = text.replace(str(each.package.folder), f"/source/{each.name}")
        text = text.replace(str(self.root), "/source")
        text = text.replace(str(self.empty), EMPTY)
        return text.replace(str(self.asked.parent), "/elsewhere")

    def own(self, path: str) -> str:
        """A file of any package of the submission; '' for others."""
        return next((f for each in self.all if (f := each.own(path, self.prefix))), "")

    def taken_away(self) -> str:
        """What was laid out and is not there any more, as everybody knows it; '' for nothing."""
        files = [file for each in self.all for file in each.files]
        gone = [file for file in files if not paths.is_file(self.prefix / file)]
        folders = [each for each in (self.home, self.stubs / "share") if not paths.is_folder(each)]
        gone.sort(key=lambda file: "/ament_index/" in file)  # nobody knows those
        return next(iter([*gone, *(self.told(str(each)) for each in folders)]), "")

    def knows(self, package: str) -> bool:
        """Whether it is a package of ROS that may be asked for, or one that is declared."""
        share = self.stubs / "share"
        is_name = package.strip(".") != ""
        return is_name and (
            paths.is_folder(share / package) or paths.is_file(self.stubs / MARKS / package)
        )

    def borrowed(self, wanted: str) -> tuple[str, str]:
        """A package that is not there, and the file of the submission that is asked for as its.

        Two empty texts: the path is of a package that is known, or of no file here.
        """
        share = f"{self.stubs}/share/"
        name, _, inside = wanted.removeprefix(share).partition("/")
        if not wanted.startswith(share) or self.knows(name):
            return "", ""
        for each in self.all:
            if f"share/{each.name}/{inside}" in each.files:
                return name, str(self.prefix / "share" / each.name / inside)
            if inside in each.package.files:
                return name, str(each.package.folder / inside)
        return "", ""

    def meant(self, wanted: str) -> str:
        """The file of the package that was meant by a path that is not there; '' for none."""
        name = os.path.basename(wanted)
        parts = wanted.split("/")[::-1]

        def likeness(file: str) -> int:
            same = zip(file.split("/")[::-1], parts, strict=False)
            return next((n for n, (a, b) in enumerate(same) if a != b), len(parts))

        everything = [
            str(each.package.folder / file)
            for each in (self.judged, *(e for e in self.all if e is not self.judged))
            for file in each.package.files
            if os.path.basename(file) == name
        ]
        return max(everything, key=likeness, default="")

    def environment(self) -> dict[str, str]:
        """Variables of a process that evaluates."""
        return {
            "AMENT_PREFIX_PATH": f"{self.prefix}:{self.stubs}",
            "PYTHONPATH": f"{DOUBLES}:{CODE}",
            "PATH": f"{self.stubs}/bin:{os.environ.get('PATH', '')}",
            "GRADER_ASKED": str(self.asked),
            "ROS_DISTRO": os.environ.get("ROS_DISTRO", "jazzy"),
            "ROS_VERSION": "2",
            "HOME": str(self.home),
            "USER": "student",
        }
