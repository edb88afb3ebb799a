"""What of a package would keep `colcon build` or `ros2 run` from starting it, though it runs here.

For students who hand in what works in their editor alone. It costs no points. The rules are those
of colcon-ros' ament_python (package.xml makes a ROS package; `setup.py install`, then a marker if
none was installed), of setuptools (what is listed has to be there) and of ros2run (programs are
looked for in lib/PACKAGE).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from grader.message import Message, msg
from grader.submission.folder import HandedInFolder, listed, shown
from grader.submission.manifest import FILE, Manifest, read_manifest
from grader.submission.set_ups import ConsoleScript, PackageFolder


def shortcomings(
    handed_in: HandedInFolder, package: PackageFolder, script: ConsoleScript | None
) -> Iterator[Message]:
    """A sentence on each, without a point at its end.

    Args:
        package: of which something is started.
        script: what of it; None if its set-up files name nothing.
    """
    folder = package.folder
    if problem := package.problem:
        yield _not_built(problem)
    if (folder / "CMakeLists.txt").is_file():
        return  # ament_cmake_python, by other rules
    setup_py = folder / "setup.py"
    if not setup_py.is_file():
        yield _not_built(_no("setup.py", handed_in, folder))
        return
    manifest = None
    if not (folder / FILE).is_file():
        why = msg("no {file} beside {other}", file=FILE, other=handed_in.called(setup_py))
        yield _not_built(why) if FILE in _installed(package) else _not_found(why)
    elif (manifest := read_manifest(folder / FILE)) is not None:
        yield from _of_manifest(manifest, handed_in.called(folder / FILE))
    yield from _of_setup(handed_in, package, script)
    if script is not None and manifest is not None and manifest.name:
        yield from _of_place(handed_in, package, manifest.name)


def _of_manifest(manifest: Manifest, called: str) -> Iterator[Message]:
    if manifest.fault:
        yield _not_found(
            msg(
                "{file} {fault}, so that colcon takes it for no ROS package",
                file=called,
                fault=manifest.fault,
            )
        )
    elif manifest.build_type is not None and manifest.build_type != "ament_python":
        named = msg("no build type")
        if manifest.build_type:
            named = msg("the build type {name}", name=shown(manifest.build_type))
        yield _not_built(
            msg(
                "{file} names {named}; expected <build_type>ament_python</build_type> in <export>",
                file=called,
                named=named,
            )
        )


def _of_setup(
    handed_in: HandedInFolder, package: PackageFolder, script: ConsoleScript | None
) -> Iterator[Message]:
    """What setup.py installs, and what it does not."""
    called = handed_in.called(package.folder / "setup.py")
    named = (name for name in _installed(package) if name != FILE)
    if missing := [name for name in named if not _may_be_there(package.folder, name)]:
        yield _not_built(
            msg(
                "{file} installs {names}, and there is no such file",
                file=called,
                names=listed(missing),
            )
        )
    if package.told is None or package.told.package_folders:
        return  # not where their names say
    packages = package.told.packages
    absent = [name for name in packages or () if not (package.folder / _path(name)).is_dir()]
    if absent:
        yield _not_built(
            msg(
                "{file} lists the package {names}, and there is no such folder",
                file=called,
                names=listed(absent),
            )
        )
    if script is None:
        return
    parent = script.module.rpartition(".")[0]
    if parent and packages is not None and parent not in packages:
        words = {"file": called, "parent": shown(parent)}
        yield _not_started(
            msg(
                "{file} lists the packages {names}, and so does not install {parent}",
                names=listed(packages),
                **words,
            )
            if packages
            else msg("{file} lists no packages, and so does not install {parent}", **words)
        )


def _of_place(handed_in: HandedInFolder, package: PackageFolder, name: str) -> Iterator[Message]:
    """Where the programs are installed, and where they are looked for."""
    told = package.told
    if told is None or told.has_commands:
        return
    if any(each.folder.startswith("lib") for each in told.data_files):
        return  # in a place of its own choice
    expected = f"$base/lib/{name}"
    setup_cfg = package.folder / "setup.cfg"
    if not told.scripts_folder:
        lacking = msg("install_scripts={expected} below [install]", expected=expected)
        if setup_cfg.is_file():
            file = handed_in.called(setup_cfg)
            yield _not_found(msg("{file} has no {lacking}", file=file, lacking=lacking))
        else:
            why = _no("setup.cfg", handed_in, package.folder)
            yield _not_found(msg("{none} with {lacking}", none=why, lacking=lacking))
    elif told.scripts_folder.rstrip("/") != f"lib/{name}":
        yield msg(
            "ros2 run {name} would find nothing: {setup} installs programs in {place}, and "
            "{manifest} calls the package {name}: expected install_scripts={expected}",
            name=name,
            setup=handed_in.called(setup_cfg),
            place=shown(f"$base/{told.scripts_folder}"),
            manifest=FILE,
            expected=expected,
        )


def _not_built(why: Message) -> Message:
    return msg("colcon would not build this: {why}", why=why)


def _not_found(why: Message) -> Message:
    return msg("ros2 run would not find this: {why}", why=why)


def _not_started(why: Message) -> Message:
    return msg("ros2 run would not start this: {why}", why=why)


def _installed(package: PackageFolder) -> list[str]:
    """The files that setup.py installs by `data_files`."""
    told = package.told
    return list(dict.fromkeys(f for each in told.data_files for f in each.files)) if told else []


def _may_be_there(folder: Path, name: str) -> bool:
    """Whether a file is there; what lies outside of the submission is nobody's matter."""
    if name.startswith("/") or ".." in PurePosixPath(name).parts:
        return True
    try:
        return (folder / name).is_file()
    except (OSError, ValueError):
        return False


def _path(package: str) -> str:
    return package.replace(".", "/")


def _no(file: str, handed_in: HandedInFolder, folder: Path) -> Message:
    if folder == handed_in.base:
        return msg("no {file}", file=file)
    return msg("no {file} in {folder}", file=file, folder=handed_in.called(folder))
