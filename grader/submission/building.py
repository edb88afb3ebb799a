"""What of a package would keep `colcon build` or `ros2 run` from starting it, though it runs here.

For students who hand in what works in their editor alone. It costs no points, and what only a run
of setup.py could tell is not told. The rules are those of colcon-ros' ament_python (package.xml
makes a ROS package; `setup.py install`, then a marker if none was installed), of setuptools (what
is listed has to be there) and of ros2run (programs are looked for in lib/PACKAGE).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import Final

from grader.submission.constants import UNKNOWN
from grader.submission.folder import HandedIn, listed, shown
from grader.submission.manifest import FILE, Manifest, read_manifest
from grader.submission.setup_files import ConsoleScript, Package

_BUILD: Final = "colcon would not build this"
_FIND: Final = "ros2 run would not find this"


def shortcomings(
    handed_in: HandedIn, package: Package, script: ConsoleScript | None
) -> Iterator[str]:
    """A sentence on each, without a point at its end.

    Args:
        package: of which something is started.
        script: what of it; None if its set-up files name nothing.
    """
    folder = package.folder
    if (folder / "CMakeLists.txt").is_file():
        return  # ament_cmake_python, by other rules
    setup_py = folder / "setup.py"
    if not setup_py.is_file():
        yield f"{_BUILD}: no setup.py{_in(handed_in, folder)}"
        return
    manifest = None
    if not (folder / FILE).is_file():
        is_listed = FILE in _data_files(package)
        yield f"{_BUILD if is_listed else _FIND}: no {FILE} beside {handed_in.called(setup_py)}"
    elif (manifest := read_manifest(folder / FILE)) is not None:
        yield from _of_manifest(manifest, handed_in.called(folder / FILE))
    yield from _of_setup(handed_in, package, script)
    if script is not None and manifest is not None and manifest.name:
        yield from _of_place(handed_in, package, manifest.name)


def _of_manifest(manifest: Manifest, called: str) -> Iterator[str]:
    if manifest.fault:
        yield f"{_FIND}: {called} {manifest.fault}, so that colcon takes it for no ROS package"
    elif manifest.build_type is not None and manifest.build_type != "ament_python":
        named = f"the build type {shown(manifest.build_type)}"
        yield (
            f"{_BUILD}: {called} names {named if manifest.build_type else 'no build type'}; "
            "expected <build_type>ament_python</build_type> in <export>"
        )


def _of_setup(handed_in: HandedIn, package: Package, script: ConsoleScript | None) -> Iterator[str]:
    """What setup.py installs, and what it does not."""
    called = handed_in.called(package.folder / "setup.py")
    named = (name for name in _data_files(package) if name != FILE)
    if missing := [name for name in named if not _may_be_there(package.folder, name)]:
        yield f"{_BUILD}: {called} installs {listed(missing)}, and there is no such file"
    if package.setup.get("package_dir") is not None or package.source_folders:
        return  # not where their names say
    packages = _all_texts(package.setup.get("packages"))
    absent = [name for name in packages or () if not (package.folder / _path(name)).is_dir()]
    if absent:
        yield f"{_BUILD}: {called} lists the package {listed(absent)}, and there is no such folder"
    if script is None:
        return
    parent = script.module.rpartition(".")[0]
    if parent and packages is not None and parent not in packages:
        found = f"lists the packages {listed(packages)}" if packages else "lists no packages"
        yield f"ros2 run would not start this: {called} {found}, and so does not install {parent}"
    bare = [each for each in _parents(script.module) if _is_bare(package.folder / _path(each))]
    if bare and package.finds_packages:
        yield (
            f"ros2 run would not start this: find_packages() in {called} passes over "
            f"{listed(bare)}, which has no __init__.py"
        )


def _of_place(handed_in: HandedIn, package: Package, name: str) -> Iterator[str]:
    """Where the programs are installed, and where they are looked for."""
    if _may_place_programs(package.setup):
        return
    expected = f"$base/lib/{name}"
    setup_cfg = package.folder / "setup.cfg"
    if not package.scripts_folder:
        lacking = f"install_scripts={expected} below [install]"
        if setup_cfg.is_file():
            yield f"{_FIND}: {handed_in.called(setup_cfg)} has no {lacking}"
        else:
            yield f"{_FIND}: no setup.cfg{_in(handed_in, package.folder)} with {lacking}"
    elif package.scripts_folder.rstrip("/") != expected:
        yield (
            f"ros2 run {name} would find nothing: {handed_in.called(setup_cfg)} installs programs "
            f"in {shown(package.scripts_folder)}, and {FILE} calls the package {name}: expected "
            f"install_scripts={expected}"
        )


def _may_place_programs(setup: Mapping[str, object]) -> bool:
    """Whether a setup.py may install programs in a place of its own choice."""
    files = setup.get("data_files", [])
    entries = files if isinstance(files, list) else [UNKNOWN]
    places = [entry[0] if isinstance(entry, list) and entry else UNKNOWN for entry in entries]
    unusual = not setup or any(key in setup for key in ("options", "cmdclass", "script_args"))
    return unusual or any(
        place is UNKNOWN or (isinstance(place, str) and place.startswith("lib")) for place in places
    )


def _data_files(package: Package) -> list[str]:
    """The files that setup.py installs by `data_files`, as far as it names them."""
    entries = package.setup.get("data_files")
    files: list[str] = []
    for entry in entries if isinstance(entries, list) else []:
        match entry:
            case [_, list(names)]:
                files += [name for name in names if isinstance(name, str)]
    return list(dict.fromkeys(files))


def _may_be_there(folder: Path, name: str) -> bool:
    """Whether a file is there; what lies outside of the submission is nobody's matter."""
    if name.startswith("/") or ".." in PurePosixPath(name).parts:
        return True
    try:
        return (folder / name).is_file()
    except (OSError, ValueError):
        return False


def _all_texts(value: object) -> list[str] | None:
    """A list of names; None if it is not all known."""
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        return None
    return [str(name) for name in value]


def _path(package: str) -> str:
    return package.replace(".", "/")


def _parents(module: str) -> list[str]:
    parts = module.split(".")[:-1]
    return [".".join(parts[: n + 1]) for n in range(len(parts))]


def _is_bare(folder: Path) -> bool:
    return folder.is_dir() and not (folder / "__init__.py").exists()


def _in(handed_in: HandedIn, folder: Path) -> str:
    return "" if folder == handed_in.base else f" in {handed_in.called(folder)}"
