"""What is missing where the package is installed: by whom it is asked for, and where it lies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from grader.exercise.verdict import Finding
from grader.exercises.description_package.looked import Looked, folder_of, how_it_ends, shown
from grader.scenes.package.trace import EMPTY, Lacking, Problem

#: One thing missing leaves so much; two leave nothing.
ONE_MISSING = 0.5
#: The current folder of who launches, in the paths of a trace.
_EMPTY = f"{EMPTY}/"
_BUILD = "colcon build stops there, and nothing is installed"


class Missing(NamedTuple):
    """Something that is asked for and not there.

    Attributes:
        what: to tell several files of one folder as one thing.
    """

    what: str
    rationale: str
    help: str


def judge(looked: Looked) -> Finding:
    """Whether everything is installed that something asks for."""
    stops = _stops(looked)
    if stops is not None:
        return stops
    found: dict[str, list[Missing]] = {}
    for each in _missing(looked):
        found.setdefault(each.what, []).append(each)
    if not found:
        count = len(looked.setup.installed)
        return Finding(1, f"{count} files are installed, and all that is asked for is among them.")
    first = next(iter(found.values()))
    more = len(first) - 1
    rationale = first[0].rationale + (f" The same holds for {more} more." if more else "")
    others = [each[0] for each in list(found.values())[1:]]
    rationale += "".join(f" {each.rationale}" for each in others[:2])
    return Finding(ONE_MISSING if len(found) == 1 else 0.0, rationale, first[0].help)


def _stops(looked: Looked) -> Finding | None:
    """What keeps the package from being built at all."""
    setup = looked.setup
    if setup.problem is not None:
        problem = setup.problem
        if problem.kind == "unknown":
            return None if next(_missing(looked), None) is None else _not_known(problem)
        if problem.text.startswith("there is no"):
            return Finding(
                0,
                f"The package cannot be built: {problem.text}.",
                f"<build_type> in package.xml is {shown(setup.build_type) or 'ament_python'!r}: "
                "ament_python wants a setup.py, ament_cmake a CMakeLists.txt. Correct the one, or "
                "add the other.",
            )
        return Finding(
            0,
            f"setup.py {how_it_ends(problem)}: {_BUILD}.",
            "Run `python3 setup.py --name` in the package's folder: it shows the same.",
        )
    if _is_cmake(looked) and setup.told and setup.told != looked.name:
        return Finding(
            0,
            f"CMakeLists.txt says project({shown(setup.told)}), and package.xml calls the package "
            f"{shown(looked.name)}: {_BUILD}.",
            "Both have to be the same name, and the folder in share is called so.",
        )
    if setup.absent:
        name, is_cmake = shown(setup.absent[0]), _is_cmake(looked)
        said = "CMakeLists.txt" if is_cmake else "setup.py"
        return Finding(
            0,
            f"{said} installs {name!r}, and there is no such {'folder or ' * is_cmake}file: "
            f"{_BUILD}.",
            "Compare the name with what is there; a folder without files is not in what git, or a "
            "zip, hands on."
            if is_cmake
            else "Compare the name in data_files with the file's, or use glob(), which lists what "
            "is there.",
        )
    if setup.folders:
        return Finding(
            0,
            f"data_files lists {shown(setup.folders[0])!r}, which is a folder: {_BUILD} (can't "
            "copy: not a regular file).",
            "data_files takes files. List those of a folder of their own, with the folder that "
            "they come into.",
        )
    return None


def _not_known(problem: Problem) -> Finding:
    """Of a set-up that nobody can follow here, where something seems to be missing."""
    said = f"{problem.file or 'setup.py'} could not be followed: {shown(problem.text)}"
    return Finding(0, f"Not judged: {said}.", "Tell whoever runs the course.", judged=False)


def _is_cmake(looked: Looked) -> bool:
    return looked.setup.build_type not in ("", "ament_python")


def _missing(looked: Looked) -> Iterator[Missing]:
    setup = looked.setup
    if setup.manifest:
        yield Missing(
            "package.xml",
            f"package.xml cannot be used: {shown(setup.manifest)}. colcon takes the folder for no "
            "ROS package.",
            "Compare it with one that `ros2 pkg create` writes.",
        )
    yield from _scripts(looked)
    for launch in looked.launches:
        for each in launch.lacking:
            of_kind = {"file": _file, "package": _package}.get(each.kind, _program)
            yield of_kind(looked, each)
        if launch.moved:
            yield Missing(
                launch.moved,
                f"{launch.file} asks for {shown(launch.moved)}, which is there only as long as the "
                "package lies where it was installed first.",
                "Ask for the share folder: get_package_share_directory(), FindPackageShare().",
            )
    for description in looked.descriptions:
        for mesh in description.meshes:
            if mesh.state == "left":
                yield Missing(
                    folder_of(mesh.path),
                    f"The description asks for {shown(mesh.uri)}; {mesh.path} is in the package, "
                    f"and nothing installs it there{_nearby(looked, mesh.path)}.",
                    "data_files in setup.py (or install() in CMakeLists.txt) has to list it, with "
                    "the folder that the description names.",
                )


def _by(lacking: Lacking) -> str:
    """The file that asks for something, with the line."""
    return f"{lacking.by} (line {lacking.line})" if lacking.line else lacking.by


def _file(looked: Looked, lacking: Lacking) -> Missing:
    name, source, by = lacking.name, lacking.source, _by(lacking)
    if source == lacking.by:
        return Missing(
            "launch",
            f"{source} is not installed: `ros2 launch {looked.name}` does not find it.",
            "data_files in setup.py (or install() in CMakeLists.txt) has to list the launch files.",
        )
    if not name.startswith(("/", "~")) or name.startswith(_EMPTY):
        return Missing(
            name,
            f"{by} asks for {shown(name.removeprefix(_EMPTY))}, a path from the current folder: it "
            "is there only for who stands in the right one.",
            "Join it to the package's share folder: get_package_share_directory(NAME).",
        )
    if name.startswith("~") or not name.startswith(("/prefix/", "/opt/ros/")):
        return Missing(
            name,
            f"{by} asks for {shown(name)}: a path of one machine, which no other has.",
            "Ask for the package's share folder: get_package_share_directory(NAME), or "
            "FindPackageShare(NAME).",
        )
    path = name.removeprefix("/prefix/")
    if source:
        return Missing(
            folder_of(source),
            f"{by} asks for {shown(path)}; {source} is in the package, and nothing installs it "
            f"there{_nearby(looked, source)}.",
            "Compare the folder in data_files (or install() in CMakeLists.txt) with the path that "
            "is asked for.",
        )
    return Missing(
        name,
        f"{by} asks for {shown(path)}, and the package has no such file.",
        "Compare the name with the file's, letter by letter; is the file in what you handed in?",
    )


def _package(looked: Looked, lacking: Lacking) -> Missing:
    name, by = lacking.name, _by(lacking)
    return Missing(
        f"package {name}",
        f"{by} asks for the package {shown(name)!r}, which is neither yours ({looked.name}) nor "
        "among your dependencies.",
        "Was the name copied from another package? If it is meant, package.xml has to name it.",
    )


def _program(looked: Looked, lacking: Lacking) -> Missing:
    name, by = lacking.name, _by(lacking)
    package, _, program = name.partition(" ")
    if package != looked.name:
        return Missing(
            name,
            f"{by} starts {shown(program)!r} of the package {package}, which has no such program.",
            "Compare the name: `ros2 pkg executables PACKAGE` lists them.",
        )
    where = looked.setup.scripts_folder or "bin"
    if any(each.name == program for each in looked.setup.scripts):
        return Missing(
            "scripts",
            f"{by} starts {shown(program)!r} of {package}, which is installed in {where}; expected "
            f"lib/{package}: `ros2 launch` and `ros2 run` look there.",
            f"setup.cfg needs install_scripts=$base/lib/{package} below [install].",
        )
    return Missing(
        "scripts",
        f"{by} starts {shown(program)!r} of {package}, and the set-up has no such console script.",
        "Add it to console_scripts in setup.py: 'NAME = PACKAGE.MODULE:main'.",
    )


def _scripts(looked: Looked) -> Iterator[Missing]:
    for each in looked.setup.scripts:
        if each.fault:
            yield Missing(
                f"script {each.name}",
                f"The console script {shown(each.name)!r} cannot start: {shown(each.fault)}.",
                "It has the form 'NAME = PACKAGE.MODULE:FUNCTION': the file PACKAGE/MODULE.py has "
                "to be there, and the function in it.",
            )
    folder, expected = looked.setup.scripts_folder, f"lib/{looked.name}"
    if looked.setup.scripts and folder.rstrip("/") != expected:
        found = f"in {folder}" if folder else "in bin, since setup.cfg says nothing else"
        yield Missing(
            "scripts",
            f"Programs are installed {shown(found)}; expected {expected}: `ros2 run {looked.name}` "
            "looks there.",
            f"setup.cfg needs install_scripts=$base/{expected} below [install].",
        )


def _nearby(looked: Looked, source: str) -> str:
    """Where it is installed instead."""
    pairs: Sequence[tuple[str, str]] = list(
        zip(looked.setup.installed, looked.setup.sources, strict=True)
    )
    elsewhere = next((path for path, of in pairs if of == source), "")
    return f" (but as {elsewhere})" if elsewhere else ""
