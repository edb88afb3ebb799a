"""Packages laid out below a prefix, as `colcon build` would install them, and by which names."""

from __future__ import annotations

import errno
import os
import re
import shutil
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import ros_doubles
from grader.submission import safe_files
from grader.submission.answer import SetUpFacts
from grader.submission.examining import cmake
from grader.submission.examining.packages import SourcePackage
from grader.submission.examining.setup_call import evaluate
from grader.submission.examining.steps import Ended, attempt, it
from grader.submission.manifest import FILE as MANIFEST
from grader.submission.package_trace import EMPTY, PREFIX, ROS, InstalledScript, Obstacle, Setup
from grader.submission.python_source import read_source
from grader.text.message import NOTHING, Message, msg
from ros_doubles import known

#: Set-ups that were evaluated already, by their folders.
Known = Mapping[Path, tuple[SetUpFacts, Obstacle | None]]
#: What stands in for ROS's packages, and where all of our code is.
DOUBLES: Final = Path(ros_doubles.__file__).parent / "packages"
CODE: Final = Path(__file__).resolve().parents[3]
MARKS = "share/ament_index/resource_index/packages"
#: Folders whose files a description package is expected to install.
_SHARED = (
    *("urdf", "meshes", "launch", "rviz", "xacro", "config", "robots", "worlds", "models"),
    *("params", "materials", "textures", "description", "mesh"),
)
#: So much of what a set-up says is taken: list entries, files, characters of a name.
_MOST, _MOST_FILES, _LONGEST = 500, 5000, 500
_SCRIPT = re.compile(r"\s*(?P<name>[^=\s]+)\s*=\s*(?P<module>[\w.]+)\s*:\s*(?P<function>[\w.]+)")


@dataclass
class Installed:
    """A package that is laid out.

    Attributes:
        package: it.
        name: what it is called below the prefix.
        setup: what it installs; what is told of it.
        files: path below the prefix -> file of the package, plain scripts as well.
        told: what its set-up says.
    """

    package: SourcePackage
    name: str
    setup: Setup
    files: dict[str, str] = field(default_factory=dict)
    told: SetUpFacts = field(default_factory=SetUpFacts)

    def own(self, path: str, prefix: Path) -> str:
        """A file of the package by a path below the prefix or in its folder; '' for others."""
        for base, named in ((prefix, self.files), (self.package.folder, None)):
            if path.startswith(f"{base}/"):
                inside = os.path.normpath(path.removeprefix(f"{base}/"))
                return named.get(inside, "") if named is not None else inside
        return ""


def lay_out(package: SourcePackage, root: Path, prefix: Path, known: Known) -> Installed:
    """Find out what a package installs, and copy that."""
    try:
        return attempt(lambda: _laid_out(package, root, prefix, known))
    except Ended as ended:
        name = package.name or package.folder.name[:_LONGEST]
        return Installed(package, name, nothing(name, ended.problem))


def nothing(name: str, problem: Obstacle) -> Setup:
    """Of a package that nobody can lay out."""
    return Setup(name, "", "", "", NOTHING, (), problem, (), (), (), "", (), (), ())


def _laid_out(package: SourcePackage, root: Path, prefix: Path, known: Known) -> Installed:
    facts, read = _set_up_facts(package, known)
    lines = facts.scripts[:_MOST]
    scripts = [_script(line[:_LONGEST], package, facts.packages) for line in lines]
    name = (package.name or facts.name or package.folder.name)[:_LONGEST]
    folders: list[str] = []
    found: dict[str, str] = {}
    for to, source in read.files[:_MOST_FILES]:
        path = package.folder / source
        if safe_files.is_folder(path):
            folders.append(source)
        elif not safe_files.is_file(path):
            read.absent.append(source)
        else:
            to = os.path.normpath(to)
            if _copy(path, prefix, to):
                found[to] = os.path.relpath(path, package.folder)
    where = facts.scripts_folder or "bin"
    programs = [*read.programs, *(f"{where}/{script.name}" for script in scripts)]
    plain = {f"{where}/{os.path.basename(each)}": each for each in facts.plain_scripts[:_MOST]}
    for program in (*programs, *plain):
        _touch(prefix / os.path.normpath(program.lstrip("/")), prefix)
    _make_known(package, name, prefix)
    setup = Setup(
        name=name,
        told=facts.name[:_LONGEST],
        folder="" if package.folder == root else os.path.relpath(package.folder, root),
        build_type=package.build_type,
        manifest=package.manifest,
        depends=package.depends,
        problem=next(iter(read.problems), None),
        absent=_shown(read.absent),
        folders=_shown(folders),
        scripts=tuple(scripts),
        scripts_folder=facts.scripts_folder[:_LONGEST],
        installed=tuple(sorted(found)),
        sources=tuple(found[each] for each in sorted(found)),
        left=_left(package, set(found.values())),
    )
    return Installed(package, name, setup, {**plain, **found}, facts)


def _set_up_facts(package: SourcePackage, known: Known) -> tuple[SetUpFacts, cmake.Read]:
    """What the set-up says of itself, and what it installs."""
    file = cmake.FILE if package.is_cmake else "setup.py"
    if not safe_files.is_file(package.folder / file):
        problem = Obstacle("error", msg("there is no {file}", file=file))
        return SetUpFacts(), cmake.Read("", [], [], [], [problem])
    if not package.is_cmake:
        facts, why = known.get(package.folder) or evaluate(package.folder)
        files = [
            (os.path.join(each.folder, os.path.basename(name)), name)
            for each in facts.data_files
            for name in each.files
        ]
        return facts, cmake.Read(facts.name, files, [], [], [why] if why else [])
    try:
        read = attempt(lambda: cmake.read(package.folder), cmake.FILE)
    except Ended as ended:
        return SetUpFacts(), cmake.Read("", [], [], [], [ended.problem])
    return SetUpFacts(read.project, package_folders=tuple(cmake.module_folders(read))), read


def _copy(path: Path, prefix: Path, to: str) -> bool:
    """Whether it could be copied; OSError: there is no room left."""
    target = Path(os.path.normpath(prefix / to))
    if not target.is_relative_to(prefix):
        return False  # somewhere else on the machine: nobody finds it there
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            shutil.copyfile(path, target)
        except OSError:  # it is longer than a run's files may be, or there is no more room
            target.unlink(missing_ok=True)
            target.symlink_to(path)
    except (OSError, ValueError) as error:  # where it would lie no file can be
        if getattr(error, "errno", None) == errno.ENOSPC:
            raise
        return False
    return True


def _shown(names: list[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(each[:_LONGEST] for each in names))[:_MOST]


def _touch(path: Path, prefix: Path) -> None:
    if Path(os.path.normpath(path)).is_relative_to(prefix):
        safe_files.touch(path)


def _make_known(package: SourcePackage, name: str, prefix: Path) -> None:
    """Marker and package.xml, which colcon adds by itself."""
    _touch(prefix / MARKS / name, prefix)
    manifest = os.path.normpath(f"share/{name}/{MANIFEST}")
    if safe_files.is_file(package.folder / MANIFEST) and not safe_files.is_file(prefix / manifest):
        _copy(package.folder / MANIFEST, prefix, manifest)
    share = Path(os.path.normpath(prefix / "share" / name))
    if share.is_relative_to(prefix):
        with suppress(OSError, ValueError):
            share.mkdir(parents=True, exist_ok=True)


def make_stubs(stubs: Path, declared: set[str], own: set[str]) -> None:
    """A prefix with the packages of ROS that may be asked for, and those that are declared."""
    for name, files in known.FILES.items():
        for file in files:
            _touch(stubs / "share" / name / file, stubs)
    for name in sorted((known.KNOWN | declared) - own):
        if re.fullmatch(r"[\w-]{1,100}", name):
            # its share folder, who asks for it makes: a hundred folders take long to take away
            _touch(stubs / MARKS / name, stubs)
    xacro = stubs / "bin" / "xacro"
    xacro.parent.mkdir()
    xacro.touch(0o755)  # not by chmod, which is refused at the level `landlock`
    xacro.write_text(f"#!{sys.executable}\nimport xacro\n\nxacro.main()\n")


def _left(package: SourcePackage, installed: set[str]) -> tuple[str, ...]:
    return tuple(
        each
        for each in package.files
        if each.split("/")[0] in _SHARED
        and each not in installed
        and not each.endswith((".pyc", ".md", ".txt", "__init__.py"))
    )[:200]


def _script(
    line: str, package: SourcePackage, installed: tuple[str, ...] | None
) -> InstalledScript:
    """A console script; `installed` are the Python packages that setup.py names, if it does."""
    found = _SCRIPT.match(line)
    if found is None:
        why = it(msg("is not of the form 'name = module:function'"))
        return InstalledScript(line[:100], "", "", why, "", False)
    name, module, function = found["name"], found["module"], found["function"]
    base = module.replace(".", "/")
    for folder in ("", "src/"):
        for file in (f"{folder}{base}.py", f"{folder}{base}/__init__.py"):
            if safe_files.is_file(package.folder / file):
                fault, source, says = _of(package.folder / file, file, function)
                parent = module.rpartition(".")[0]
                if not fault and parent and installed is not None and parent not in installed:
                    fault = msg(
                        "setup.py does not list the package {package}, so nothing installs it",
                        package=parent,
                    )
                return InstalledScript(name, module, function, fault, source, says)
    fault = msg("there is no module {module}", module=module)
    return InstalledScript(name, module, function, fault, "", False)


def _of(path: Path, file: str, function: str) -> tuple[Message, str, bool]:
    """The fault of a script, its source, and whether that speaks of joint states."""
    try:
        text = safe_files.read(path, 1_000_000).decode("utf-8-sig", "replace")
    except OSError:
        return msg("{file} cannot be read", file=file), file, False
    says, source = "JointState" in text or "joint_states" in text, read_source(path)
    first = function.split(".")[0]
    if source.surely_lacks(first):
        return msg("{file} has no {name}", file=file, name=first), file, says
    return NOTHING if source.parses else msg("{file} does not parse", file=file), file, says


@dataclass(frozen=True)
class Workspace:
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

    def shown(self, text: str) -> str:
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
        gone = [file for file in files if not safe_files.is_file(self.prefix / file)]
        folders = [
            each for each in (self.home, self.stubs / "share") if not safe_files.is_folder(each)
        ]
        gone.sort(key=lambda file: "/ament_index/" in file)  # nobody knows those
        return next(iter([*gone, *(self.shown(str(each)) for each in folders)]), "")

    def knows(self, package: str) -> bool:
        """Whether it is a package of ROS that may be asked for, or one that is declared."""
        share = self.stubs / "share"
        is_name = package.strip(".") != ""
        return is_name and (
            safe_files.is_folder(share / package)
            or safe_files.is_file(self.stubs / MARKS / package)
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
