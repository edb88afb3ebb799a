"""Finds what would keep `colcon build` or `ros2 run` from starting a package, though it runs here.

For students whose submission works in their editor alone. It costs no points. The rules are those
of colcon-ros' ament_python (package.xml makes a ROS package; `setup.py install`, then a marker if
none was installed), of setuptools (what is listed has to be there) and of ros2run (programs are
searched in lib/PACKAGE).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import Final

from grader.submission import safe_files
from grader.submission.folder import SubmissionFolder
from grader.submission.manifest import FILE, Manifest, read_manifest
from grader.submission.program import EntryPoint, Program
from grader.submission.program_source import read_imports
from grader.submission.set_ups import PackageFolder
from grader.text.message import Message, msg
from grader.text.strings import listed, shown

_NOT_BUILT: Final = msg("colcon would not build this: {why}")
_NOT_FOUND: Final = msg("ros2 run would not find this: {why}")
_NOT_STARTED: Final = msg("ros2 run would not start this: {why}")


def shortcomings(
    submitted: SubmissionFolder, package: PackageFolder, program: Program | None
) -> Iterator[Message]:
    """Yield a sentence on each shortcoming, without a point at its end.

    Args:
        package: of which something is started.
        program: that is started; None if its set-up files name none.
    """
    folder = package.folder
    if problem := package.problem:
        yield _NOT_BUILT.given(why=problem)
    if (folder / "CMakeLists.txt").is_file():
        return  # ament_cmake_python, by other rules
    setup_py = folder / "setup.py"
    if not setup_py.is_file():
        yield _NOT_BUILT.given(why=_no("setup.py", submitted, folder))
        return
    manifest = None
    if not (folder / FILE).is_file():
        why = msg("no {file} beside {other}", file=FILE, other=submitted.called(setup_py))
        sentence = _NOT_BUILT if FILE in _installed(package) else _NOT_FOUND
        yield sentence.given(why=why)
    elif (manifest := read_manifest(folder / FILE)) is not None:
        yield from _of_manifest(manifest, submitted.called(folder / FILE))
    yield from _of_setup(submitted, package, program)
    if program is not None and manifest is not None and manifest.name:
        yield from _of_place(submitted, package, manifest.name)


def _of_manifest(manifest: Manifest, called: str) -> Iterator[Message]:
    if manifest.fault:
        yield _NOT_FOUND.given(
            why=msg(
                "{file} {fault}, so that colcon takes it for no ROS package",
                file=called,
                fault=manifest.fault,
            )
        )
    elif manifest.build_type is not None and manifest.build_type != "ament_python":
        named = msg("no build type")
        if manifest.build_type:
            named = msg("the build type {name}", name=shown(manifest.build_type))
        yield _NOT_BUILT.given(
            why=msg(
                "{file} names {named}; expected <build_type>ament_python</build_type> in <export>",
                file=called,
                named=named,
            )
        )


def _of_setup(
    submitted: SubmissionFolder, package: PackageFolder, program: Program | None
) -> Iterator[Message]:
    """Compare what setup.py installs with the files and the script."""
    called = submitted.called(package.folder / "setup.py")
    named = (name for name in _installed(package) if name != FILE)
    if missing := [name for name in named if not _may_be_there(package.folder, name)]:
        yield _NOT_BUILT.given(
            why=msg(
                "{file} installs {names}, and there is no such file",
                file=called,
                names=listed(missing),
            )
        )
    if package.declared is None or package.declared.package_folders:
        return  # not where their names say
    packages = package.declared.packages
    absent = [
        name for name in packages or () if not package.folder.joinpath(*name.split(".")).is_dir()
    ]
    if absent:
        yield _NOT_BUILT.given(
            why=msg(
                "{file} lists the package {names}, and there is no such folder",
                file=called,
                names=listed(absent),
            )
        )
    if packages is None or program is None or not isinstance(program.entry, EntryPoint):
        return
    module = program.entry.module
    top, _, _ = module.partition(".")
    root = next((r for r in package.roots(top) if (r / top).is_dir()), package.folder.resolve())
    loaded = read_imports(root, [replace(program, root=root)]).files
    folders = [file.parent.relative_to(root) for file in loaded]
    parents = dict.fromkeys((module.rpartition(".")[0], *(".".join(f.parts) for f in folders)))
    if lacking := [parent for parent in parents if parent and parent not in packages]:
        bare = [root.joinpath(*each.split("."), "__init__.py") for each in lacking]
        missing = [submitted.called(each) for each in bare if not each.exists()]
        words = {"file": called, "parent": listed(lacking), "names": listed(packages)}
        why = (
            msg("{file} lists the packages {names}, and so does not install {parent}", **words)
            if packages
            else msg("{file} lists no packages, and so does not install {parent}", **words)
        )
        if missing:
            why = msg("{why}: there is no {missing}", why=why, missing=listed(missing))
        yield _NOT_STARTED.given(why=why)


def _of_place(submitted: SubmissionFolder, package: PackageFolder, name: str) -> Iterator[Message]:
    """Compare where the programs are installed with where ros2 run searches."""
    declared = package.declared
    if declared is None or declared.has_commands:
        return
    if any(each.folder.startswith("lib") for each in declared.data_files):
        return  # in a place of its own choice
    expected = f"$base/lib/{name}"
    setup_cfg = package.folder / "setup.cfg"
    if not declared.scripts_folder:
        lacking = msg("install_scripts={expected} below [install]", expected=expected)
        if setup_cfg.is_file():
            file = submitted.called(setup_cfg)
            yield _NOT_FOUND.given(why=msg("{file} has no {lacking}", file=file, lacking=lacking))
        else:
            why = _no("setup.cfg", submitted, package.folder)
            yield _NOT_FOUND.given(why=msg("{none} with {lacking}", none=why, lacking=lacking))
    elif declared.scripts_folder.rstrip("/") == f"lib/{declared.name}" != f"lib/{name}":
        yield _NOT_FOUND.given(
            why=msg(
                "{manifest} calls the package {name}, and {setup} and setup.py call it {other}: "
                "expected <name>{other}</name>",
                manifest=submitted.called(package.folder / FILE),
                name=name,
                setup=submitted.called(setup_cfg),
                other=shown(declared.name),
            )
        )
    elif declared.scripts_folder.rstrip("/") != f"lib/{name}":
        yield msg(
            "ros2 run {name} would find nothing: {setup} installs programs in {place}, and "
            "{manifest} calls the package {name}: expected install_scripts={expected}",
            name=name,
            setup=submitted.called(setup_cfg),
            place=shown(f"$base/{declared.scripts_folder}"),
            manifest=FILE,
            expected=expected,
        )


def _installed(package: PackageFolder) -> list[str]:
    """The files that setup.py installs by `data_files`."""
    declared = package.declared
    return (
        list(dict.fromkeys(f for each in declared.data_files for f in each.files))
        if declared
        else []
    )


def _may_be_there(folder: Path, name: str) -> bool:
    """Whether a file exists; one outside of the submission is not checked."""
    if name.startswith("/") or ".." in PurePosixPath(name).parts:
        return True
    return safe_files.is_file(folder / name)


def _no(file: str, submitted: SubmissionFolder, folder: Path) -> Message:
    if folder == submitted.base:
        return msg("no {file}", file=file)
    return msg("no {file} in {folder}", file=file, folder=submitted.called(folder))
