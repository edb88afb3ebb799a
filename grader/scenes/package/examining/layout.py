"""Packages laid out below a prefix, as `colcon build` would install them."""

from __future__ import annotations

import ast
import errno
import os
import re
import shutil
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from grader.scenes.package.examining import cmake, known, paths
from grader.scenes.package.examining.packages import MANIFEST, Package
from grader.scenes.package.examining.setup_call import evaluate
from grader.scenes.package.examining.steps import Ended, attempt
from grader.scenes.package.inspection import Told
from grader.scenes.package.trace import Problem, Script, Setup

#: Set-ups that were evaluated already, by their folders.
Known = Mapping[Path, tuple[Told, Problem | None]]
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
        files: path below the prefix -> file of the package.
    """

    package: Package
    name: str
    setup: Setup
    files: dict[str, str] = field(default_factory=dict)

    def own(self, path: str, prefix: Path) -> str:
        """A file of the package by a path below the prefix or in its folder; '' for others."""
        for base, named in ((prefix, self.files), (self.package.folder, None)):
            if path.startswith(f"{base}/"):
                inside = os.path.normpath(path.removeprefix(f"{base}/"))
                return named.get(inside, "") if named is not None else inside
        return ""


def lay_out(package: Package, root: Path, prefix: Path, known: Known) -> Installed:
    """Find out what a package installs, and copy that."""
    try:
        return attempt(lambda: _laid_out(package, root, prefix, known))
    except Ended as ended:
        name = package.name or package.folder.name[:_LONGEST]
        return Installed(package, name, nothing(name, ended.problem))


def nothing(name: str, problem: Problem) -> Setup:
    """Of a package that nobody can lay out."""
    return Setup(name, "", "", "", "", (), problem, (), (), (), "", (), (), ())


def _laid_out(package: Package, root: Path, prefix: Path, known: Known) -> Installed:
    said, problem, absent, files, programs = _said(package, known)
    lines = said.scripts[:_MOST]
    scripts = [_script(line[:_LONGEST], package, said.packages) for line in lines]
    name = (package.name or said.name or package.folder.name)[:_LONGEST]
    folders: list[str] = []
    found: dict[str, str] = {}
    for where, source in files[:_MOST_FILES]:
        path = package.folder / source
        if paths.is_folder(path):
            folders.append(source)
        elif not paths.is_file(path):
            absent.append(source)
        else:
            to = os.path.normpath(os.path.join(where, os.path.basename(source)))
            if _copy(path, prefix, to):
                found[to] = os.path.relpath(path, package.folder)
    where = said.scripts_folder or "bin"
    programs += [f"{where}/{script.name}" for script in scripts]
    programs += [f"{where}/{os.path.basename(each)}" for each in said.plain_scripts]
    for program in programs:
        _touch(prefix / os.path.normpath(program.lstrip("/")), prefix)
    _make_known(package, name, prefix)
    setup = Setup(
        name=name,
        told=said.name[:_LONGEST],
        folder="" if package.folder == root else os.path.relpath(package.folder, root),
        build_type=package.build_type,
        manifest=package.manifest,
        depends=package.depends,
        problem=problem,
        absent=_shown(absent),
        folders=_shown(folders),
        scripts=tuple(scripts),
        scripts_folder=said.scripts_folder[:_LONGEST],
        installed=tuple(sorted(found)),
        sources=tuple(found[each] for each in sorted(found)),
        left=_left(package, set(found.values())),
    )
    return Installed(package, name, setup, found)


def _said(
    package: Package, known: Known
) -> tuple[Told, Problem | None, list[str], list[tuple[str, str]], list[str]]:
    """What the set-up says, its problem, what is absent, (folder, file) of each, programs."""
    if package.is_cmake:
        if not paths.is_file(package.folder / cmake.FILE):
            return Told(), Problem("error", "there is no CMakeLists.txt"), [], [], []
        try:
            found = attempt(lambda: cmake.read(package.folder), cmake.FILE)
        except Ended as ended:
            return Told(), ended.problem, [], [], []
        problem = found.problems[0] if found.problems else None
        return Told(found.project), problem, found.absent, found.files, found.programs
    if not paths.is_file(package.folder / "setup.py"):
        return Told(), Problem("error", "there is no setup.py"), [], [], []

    said, problem = known.get(package.folder) or evaluate(package.folder)
    files = [(each.folder, name) for each in said.data_files for name in each.files]
    return said, problem, [], files, []


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
        with suppress(OSError, ValueError):  # its name is none that a file can have
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()


def _make_known(package: Package, name: str, prefix: Path) -> None:
    """Marker and package.xml, which colcon adds by itself."""
    _touch(prefix / MARKS / name, prefix)
    manifest = os.path.normpath(f"share/{name}/{MANIFEST}")
    if paths.is_file(package.folder / MANIFEST) and not paths.is_file(prefix / manifest):
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
    xacro.write_text(f"#!{sys.executable}\nimport xacro\n\nxacro.main()\n")
    xacro.chmod(0o755)


def _left(package: Package, installed: set[str]) -> tuple[str, ...]:
    return tuple(
        each
        for each in package.files
        if each.split("/")[0] in _SHARED
        and each not in installed
        and not each.endswith((".pyc", ".md", ".txt", "__init__.py"))
    )[:200]


def _script(line: str, package: Package, installed: tuple[str, ...] | None) -> Script:
    """A console script; `installed` are the Python packages that setup.py names, if it does."""
    found = _SCRIPT.match(line)
    if found is None:
        return Script(
            line[:100], "", "", "it is not of the form 'name = module:function'", "", False
        )
    name, module, function = found["name"], found["module"], found["function"]
    base = module.replace(".", "/")
    for folder in ("", "src/"):
        for file in (f"{folder}{base}.py", f"{folder}{base}/__init__.py"):
            if paths.is_file(package.folder / file):
                fault, source, says = _of(package.folder / file, file, function)
                parent = module.rpartition(".")[0]
                if not fault and parent and installed is not None and parent not in installed:
                    fault = f"setup.py does not list the package {parent}, so nothing installs it"
                return Script(name, module, function, fault, source, says)
    return Script(name, module, function, f"there is no module {module}", "", False)


def _of(path: Path, file: str, function: str) -> tuple[str, str, bool]:
    """The fault of a script, its source, and whether that speaks of joint states."""
    try:
        text = paths.read(path, 1_000_000).decode("utf-8-sig", "replace")
    except OSError:
        return f"{file} cannot be read", file, False
    says = "JointState" in text or "joint_states" in text
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return f"{file} does not parse", file, says
    names = {
        name
        for node in ast.walk(tree)
        for name in (
            [node.name]
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
            else [target.id for target in node.targets if isinstance(target, ast.Name)]
            if isinstance(node, ast.Assign)
            else [alias.asname or alias.name for alias in node.names]
            if isinstance(node, ast.Import | ast.ImportFrom)
            else []
        )
    }
    first = function.split(".")[0]
    return ("" if first in names else f"{file} has no {first}"), file, says
