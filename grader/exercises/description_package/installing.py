"""What is missing where the package is installed: by whom it is asked for, and where it lies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from grader.exercise.verdict import Finding
from grader.exercises.description_package.looked import Looked, folder_of
from grader.language.phrase import joined, say
from grader.scenes.package.said import how_it_ends, phrase_of, said, shown
from grader.scenes.package.trace import EMPTY, Lacking, Launch, Problem

#: One thing missing leaves so much; two leave nothing.
ONE_MISSING = 0.5
#: The current folder of who launches, in the paths of a trace.
_EMPTY = f"{EMPTY}/"
_BUILD = say("colcon build stops there, and nothing is installed")


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
    found: dict[str, list[Missing]] = {}
    if (stop := stops(looked)) is not None:
        return Finding(0, stop.rationale, stop.help)
    for each in _missing(looked):
        found.setdefault(each.what, []).append(each)
    if found and (not_known := not_followed(looked)):
        return not_known
    if not found:
        return Finding(
            1,
            say(
                "{count} files are installed, and all that is asked for is among them.",
                count=len(looked.setup.installed),
            ),
        )
    first = next(iter(found.values()))
    more = len(first) - 1
    told: list[str] = [first[0].rationale]
    if more:
        told.append(say("The same holds for {more} more.", more=more))
    told += [each[0].rationale for each in list(found.values())[1:3]]
    return Finding(ONE_MISSING if len(found) == 1 else 0.0, joined(told, " "), first[0].help)


def not_followed(looked: Looked) -> Finding | None:
    """Of a set-up that nobody can follow here; None where it can be."""
    problem = looked.setup.problem
    if problem is None or problem.kind != "unknown":
        return None
    return Finding(
        0,
        say(
            "Not judged: {file} could not be followed: {why}.",
            file=problem.file or "setup.py",
            why=said(problem),
        ),
        say("Tell whoever runs the course."),
        judged=False,
    )


def stops(looked: Looked) -> Missing | None:
    """What keeps the package from being built at all."""
    setup = looked.setup
    if setup.problem is not None:
        return None if setup.problem.kind == "unknown" else _ended(looked, setup.problem)
    is_cmake = setup.build_type not in ("", "ament_python")
    if is_cmake and setup.told and setup.told != looked.name:
        return Missing(
            "name",
            say(
                "CMakeLists.txt says project({told}), and package.xml calls the "
                "package {name}: {build}.",
                told=shown(setup.told),
                name=shown(looked.name),
                build=_BUILD,
            ),
            say("Both have to be the same name, and the folder in share is called so."),
        )
    if setup.absent:
        return _absent(shown(setup.absent[0]), is_cmake)
    if setup.folders:
        return Missing(
            "folder",
            say(
                "data_files lists {name!r}, which is a folder: {build} (can't copy: "
                "not a regular file).",
                name=shown(setup.folders[0]),
                build=_BUILD,
            ),
            say(
                "data_files takes files. List those of a folder of their own, with the "
                "folder that they come into."
            ),
        )
    return None


def _ended(looked: Looked, problem: Problem) -> Missing:
    """Of a set-up that comes to no end, or is not there."""
    if problem.text.startswith("there is no"):
        return Missing(
            "set-up",
            say("The package cannot be built: {why}.", why=phrase_of(problem.text)),
            say(
                "<build_type> in package.xml is {build_type!r}: ament_python wants a "
                "setup.py, ament_cmake a CMakeLists.txt. Correct the one, or add the "
                "other.",
                build_type=shown(looked.setup.build_type) or "ament_python",
            ),
        )
    return Missing(
        "set-up",
        say(
            "{what_happens}: {build}.",
            what_happens=how_it_ends("setup.py", problem),
            build=_BUILD,
        ),
        say("Run `python3 setup.py --name` in the package's folder: it shows the same."),
    )


def _absent(name: str, is_cmake: bool) -> Missing:
    """Of something that is to be installed, and is not there."""
    if is_cmake:
        return Missing(
            name,
            say(
                "CMakeLists.txt installs {name!r}, and there is no such folder or file: {build}.",
                name=name,
                build=_BUILD,
            ),
            say(
                "Compare the name with what is there; a folder without files is not in what git, "
                "or a zip, hands on."
            ),
        )
    return Missing(
        name,
        say(
            "setup.py installs {name!r}, and there is no such file: {build}.",
            name=name,
            build=_BUILD,
        ),
        say(
            "Compare the name in data_files with the file's, or use glob(), which lists what is "
            "there."
        ),
    )


def _missing(looked: Looked) -> Iterator[Missing]:
    yield from unstarted(looked)
    for launch in looked.launches:
        yield from (lacking(looked, each) for each in launch.lacking)
        if launch.moved:
            yield moved(launch)
    for description in looked.descriptions:
        for mesh in description.meshes:
            if mesh.state == "left":
                yield Missing(
                    folder_of(mesh.path),
                    _left(looked, say("The description"), shown(mesh.uri), mesh.path),
                    say(
                        "data_files in setup.py (or install() in CMakeLists.txt) has to list "
                        "it, with the folder that the description names."
                    ),
                )


def moved(launch: Launch) -> Missing:
    """Of a path that is another where the package is installed in another place."""
    return Missing(
        launch.moved,
        say(
            "{file} asks for {path}, which is there only as long as the package "
            "lies where it was installed first.",
            file=launch.file,
            path=shown(launch.moved),
        ),
        say("Ask for the share folder: get_package_share_directory(), FindPackageShare()."),
    )


def lacking(looked: Looked, lacks: Lacking) -> Missing:
    """Of what a launch file names, and is not there."""
    of_kind = {"file": _file, "package": _package}.get(lacks.kind, _program)
    return of_kind(looked, lacks)


def _by(lacking: Lacking) -> str:
    """The file that asks for something, with the line."""
    if not lacking.line:
        return lacking.by
    return say("{file} (line {line})", file=lacking.by, line=lacking.line)


def _file(looked: Looked, lacking: Lacking) -> Missing:
    name, source, by = lacking.name, lacking.source, _by(lacking)
    if source == lacking.by:
        return Missing(
            "launch",
            say(
                "{source} is not installed: `ros2 launch {name}` does not find it.",
                source=source,
                name=looked.name,
            ),
            say(
                "data_files in setup.py (or install() in CMakeLists.txt) has to list "
                "the launch files."
            ),
        )
    if not name.startswith(("/", "~")) or name.startswith(_EMPTY):
        return Missing(
            name,
            say(
                "{by} asks for {path}, a path from the current folder: it is there "
                "only for who stands in the right one.",
                by=by,
                path=shown(name.removeprefix(_EMPTY)),
            ),
            say("Join it to the package's share folder: get_package_share_directory(NAME)."),
        )
    if name.startswith("~") or not name.startswith(("/prefix/", "/opt/ros/")):
        return Missing(
            name,
            say(
                "{by} asks for {path}: a path of one machine, which no other has.",
                by=by,
                path=shown(name),
            ),
            say(
                "Ask for the package's share folder: get_package_share_directory(NAME),"
                " or FindPackageShare(NAME)."
            ),
        )
    path = name.removeprefix("/prefix/")
    if source:
        return Missing(
            folder_of(source),
            _left(looked, by, shown(path), source),
            say(
                "Compare the folder in data_files (or install() in CMakeLists.txt) with"
                " the path that is asked for."
            ),
        )
    return Missing(
        name,
        say("{by} asks for {path}, and the package has no such file.", by=by, path=shown(path)),
        say(
            "Compare the name with the file's, letter by letter; is the file in what you handed in?"
        ),
    )


def _package(looked: Looked, lacking: Lacking) -> Missing:
    name, by = lacking.name, _by(lacking)
    return Missing(
        f"package {name}",
        say(
            "{by} asks for the package {name!r}, which is neither yours ({own}) "
            "nor among your dependencies.",
            by=by,
            name=shown(name),
            own=looked.name,
        ),
        say(
            "Was the name copied from another package? If it is meant, package.xml has to name it."
        ),
    )


def _program(looked: Looked, lacking: Lacking) -> Missing:
    name, by = lacking.name, _by(lacking)
    package, _, program = name.partition(" ")
    if package != looked.name:
        return Missing(
            name,
            say(
                "{by} starts {program!r} of the package {package}, which has no such program.",
                by=by,
                program=shown(program),
                package=package,
            ),
            say("Compare the name: `ros2 pkg executables PACKAGE` lists them."),
        )
    where = looked.setup.scripts_folder or "bin"
    if any(each.name == program for each in looked.setup.scripts):
        return Missing(
            "scripts",
            say(
                "{by} starts {program!r} of {package}, which is installed in {where}; "
                "expected lib/{package}: `ros2 launch` and `ros2 run` look there.",
                by=by,
                program=shown(program),
                package=package,
                where=where,
            ),
            _scripts_needed(package),
        )
    return Missing(
        "scripts",
        say(
            "{by} starts {program!r} of {package}, and the set-up has no such console script.",
            by=by,
            program=shown(program),
            package=package,
        ),
        say("Add it to console_scripts in setup.py: 'NAME = PACKAGE.MODULE:main'."),
    )


def unstarted(looked: Looked) -> Iterator[Missing]:
    """What keeps colcon from finding the package, or `ros2 run` from starting its programs."""
    if looked.setup.manifest:
        yield Missing(
            "package.xml",
            say(
                "package.xml cannot be used: {why}. colcon takes the folder for no ROS package.",
                why=shown(phrase_of(looked.setup.manifest)),
            ),
            say("Compare it with one that `ros2 pkg create` writes."),
        )
    for each in looked.setup.scripts:
        if each.fault:
            yield Missing(
                f"script {each.name}",
                say(
                    "The console script {name!r} cannot start: {why}.",
                    name=shown(each.name),
                    why=shown(phrase_of(each.fault)),
                ),
                say(
                    "It has the form 'NAME = PACKAGE.MODULE:FUNCTION': the file "
                    "PACKAGE/MODULE.py has to be there, and the function in it."
                ),
            )
    folder, name = looked.setup.scripts_folder, looked.name
    if looked.setup.scripts and folder.rstrip("/") != f"lib/{name}":
        yield Missing(
            "scripts",
            say(
                "Programs are installed in {folder}; expected lib/{name}: `ros2 run {name}` looks "
                "there.",
                folder=shown(folder),
                name=name,
            )
            if folder
            else say(
                "Programs are installed in bin, since setup.cfg says nothing else; expected "
                "lib/{name}: `ros2 run {name}` looks there.",
                name=name,
            ),
            _scripts_needed(name),
        )


def _scripts_needed(package: str) -> str:
    return say(
        "setup.cfg needs install_scripts=$base/lib/{package} below [install].", package=package
    )


def _left(looked: Looked, by: str, wanted: str, source: str) -> str:
    """Of a file of the package that nothing installs where it is asked for."""
    pairs: Sequence[tuple[str, str]] = list(
        zip(looked.setup.installed, looked.setup.sources, strict=True)
    )
    elsewhere = next((path for path, of in pairs if of == source), "")
    values = {"by": by, "wanted": wanted, "source": source, "elsewhere": elsewhere}
    if elsewhere:
        return say(
            "{by} asks for {wanted}; {source} is in the package, and nothing installs it there "
            "(but as {elsewhere}).",
            **values,
        )
    return say(
        "{by} asks for {wanted}; {source} is in the package, and nothing installs it there.",
        **values,
    )
