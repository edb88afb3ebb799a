"""What is missing where the package is installed: by whom it is asked for, and where it lies."""

from __future__ import annotations

from collections.abc import Iterator
from posixpath import dirname

from grader import Checks, Finding, Tolerances
from grader.submission import package_trace, shown
from grader.text import Message, joined, msg
from grader_robots.exercises.description_package.facts import (
    PackageFacts,
    PackageFault,
    not_followed,
    of_package,
)

checks = Checks()
#: One thing missing leaves so much; two leave nothing.
ONE_MISSING = 0.5
#: The current folder of who launches, in the paths of a trace.
_EMPTY = f"{package_trace.EMPTY}/"
#: Where no launch file shows the robot.
WRITE = msg(
    "Write launch/display.launch.py: it starts robot_state_publisher with the description, "
    "joint_state_publisher_gui, and rviz2 with your .rviz file."
)
_BUILD = msg("colcon build stops there, and nothing is installed")
_LIST_IT = msg(
    "data_files in setup.py (or install() in CMakeLists.txt) has to list it, with the folder in "
    "which it is looked for."
)
_COMPARE = msg(
    "Compare the name with the file's, letter by letter; is the file in what you handed in? "
    "Neither git nor a zip hands on a folder without files."
)
_SHARE = msg(
    "Ask for the package's share folder: get_package_share_directory(NAME), or "
    "FindPackageShare(NAME)."
)
AS_CREATED = msg("Compare it with one that `ros2 pkg create` writes.")


@checks()
@of_package
def installed(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """Everything that is asked for is installed.

    setup.py is run with a `setup()` that only takes its arguments down (of a CMakeLists.txt, the
    install() commands are read), and the files are laid out below an empty prefix. What launch
    files ask for (descriptions, meshes, RViz's files, other launch files, programs, packages) has
    to be there, in that prefix and when it is moved to another place.

    - setup.py ends with an error, or lists a file that is not there, or a folder: 0, for colcon
      build stops there.
    - One thing is missing: half of the points. The files of one folder count as one thing.
    - More is missing: 0.

    A launch file that is not installed is missing where no other one is, and so is one that shows
    the robot in RViz. A marker below share/ament_index, or a package.xml, that nothing installs
    costs nothing: colcon adds both.
    """
    if (stop := stops(facts)) is not None:
        return Finding(0, stop.rationale, stop.help)
    found: dict[str, list[PackageFault]] = {}
    for each in _missing(facts):
        found.setdefault(each.what, []).append(each)
    if found and (not_known := not_followed(facts)):
        return not_known
    if not found:
        said = msg("{count} files are installed, and all that is asked for is among them.")
        return Finding(1, said.given(count=len(facts.setup.installed)))
    first, *others = found.values()
    texts = [first[0].rationale]
    if len(first) > 1:
        texts.append(msg("The same holds for {more} more.", more=len(first) - 1))
    texts += [each[0].rationale for each in others[:2]]
    return Finding(ONE_MISSING if len(found) == 1 else 0.0, joined(texts, " "), first[0].help)


def stops(facts: PackageFacts) -> PackageFault | None:
    """What keeps the package from being built at all."""
    setup = facts.setup
    if setup.problem is not None:
        return None if setup.problem.kind == "unknown" else _ended(facts, setup.problem)
    is_cmake = setup.build_type not in ("", "ament_python")
    if is_cmake and setup.told and setup.told != facts.name:
        return PackageFault(
            "name",
            msg(
                "CMakeLists.txt says project({told}), and package.xml calls the "
                "package {name}: {build}.",
                told=shown(setup.told),
                name=shown(facts.name),
                build=_BUILD,
            ),
            msg("Both have to be the same name, and the folder in share is called so."),
        )
    if setup.absent:
        name = shown(setup.absent[0])
        rationale = msg(
            "{file} installs {name!r}, and there is no such file or folder: {build}.",
            file="CMakeLists.txt" if is_cmake else "setup.py",
            name=name,
            build=_BUILD,
        )
        return PackageFault(name, rationale, _COMPARE)
    if setup.folders:
        return PackageFault(
            "folder",
            msg(
                "data_files lists {name!r}, which is a folder: {build} (can't copy: "
                "not a regular file).",
                name=shown(setup.folders[0]),
                build=_BUILD,
            ),
            msg(
                "data_files takes files. List those of a folder of their own, with the "
                "folder that they come into."
            ),
        )
    return None


def _ended(facts: PackageFacts, problem: package_trace.Obstacle) -> PackageFault:
    """Of a set-up that comes to no end, or is not there."""
    if problem.text.key == "there is no {file}":
        return PackageFault(
            "set-up",
            msg("The package cannot be built: {why}.", why=problem.text),
            msg(
                "<build_type> in package.xml is {build_type!r}: ament_python wants a setup.py, "
                "ament_cmake a CMakeLists.txt. Correct the one, or add the other.",
                build_type=shown(facts.setup.build_type) or "ament_python",
            ),
        )
    return PackageFault(
        "set-up",
        msg(
            "{what_happens}: {build}.",
            what_happens=problem.ends("setup.py"),
            build=_BUILD,
        ),
        msg("Run `python3 setup.py --name` in the package's folder: it shows the same."),
    )


def _missing(facts: PackageFacts) -> Iterator[PackageFault]:
    yield from unstarted(facts)
    if not facts.for_rviz:
        yield PackageFault("launch", msg("No launch file shows the robot in RViz."), WRITE)
    there = [each for each in facts.launches if _is_installed(each)]
    for launch in there if any(each.nodes for each in there) else facts.launches:
        yield from (lacking(facts, each) for each in launch.lacking)
        if launch.moved:
            yield moved(launch)
    for description in facts.descriptions:
        for mesh in description.meshes:
            if mesh.state == "left":
                yield _left(facts, msg("The description"), shown(mesh.uri), mesh.path)


def _is_installed(launch: package_trace.LaunchFile) -> bool:
    return not any(each.kind == "file" and each.source == launch.file for each in launch.lacking)


def moved(launch: package_trace.LaunchFile) -> PackageFault:
    """Of a path that is another where the package is installed in another place."""
    rationale = msg(
        "{file} asks for {path}, which is there only as long as the package "
        "lies where it was installed first.",
        file=launch.file,
        path=shown(launch.moved),
    )
    return PackageFault(launch.moved, rationale, _SHARE)


def lacking(facts: PackageFacts, lacks: package_trace.Lacking) -> PackageFault:
    """Of what a launch file names, and is not there."""
    of_kind = {"file": _file, "package": _package}.get(lacks.kind, _program)
    by: str | Message = lacks.by
    if lacks.line:
        by = msg("{file} (line {line})", file=lacks.by, line=lacks.line)
    return of_kind(facts, lacks, by)


def _file(facts: PackageFacts, lacks: package_trace.Lacking, by: str | Message) -> PackageFault:
    name, source = lacks.name, lacks.source
    if source == lacks.by:
        rationale = msg(
            "{source} is not installed: `ros2 launch {name}` does not find it.",
            source=source,
            name=facts.name,
        )
        return PackageFault("launch", rationale, _LIST_IT)
    path = shown(name.removeprefix(_EMPTY).removeprefix("/prefix/"))
    if not name.startswith(("/", "~")) or name.startswith(_EMPTY):
        rationale = msg(
            "{by} asks for {path}, a path from the current folder: it is there "
            "only for who stands in the right one.",
            by=by,
            path=path,
        )
        return PackageFault(name, rationale, _SHARE)
    if not name.startswith(("/prefix/", "/opt/ros/")):
        rationale = msg(
            "{by} asks for {path}: a path of one machine, which no other has.", by=by, path=path
        )
        return PackageFault(name, rationale, _SHARE)
    if source:
        return _left(facts, by, path, source)
    rationale = msg("{by} asks for {path}, and the package has no such file.", by=by, path=path)
    return PackageFault(name, rationale, _COMPARE)


def _package(facts: PackageFacts, lacks: package_trace.Lacking, by: str | Message) -> PackageFault:
    return PackageFault(
        f"package {lacks.name}",
        msg(
            "{by} asks for the package {name!r}, which is neither yours ({own}) "
            "nor among your dependencies.",
            by=by,
            name=shown(lacks.name),
            own=facts.name,
        ),
        msg(
            "Was the name copied from another package? If it is meant, package.xml has to name it."
        ),
    )


def _program(facts: PackageFacts, lacks: package_trace.Lacking, by: str | Message) -> PackageFault:
    package, _, program = lacks.name.partition(" ")
    values = {"by": by, "program": shown(program), "package": package}
    if package != facts.name:
        rationale = msg(
            "{by} starts {program!r} of the package {package}, which has no such program.", **values
        )
        help = msg("Compare the name: `ros2 pkg executables PACKAGE` lists them.")
        return PackageFault(lacks.name, rationale, help)
    if any(each.name == program for each in facts.setup.scripts):
        return _misplaced(facts)
    rationale = msg(
        "{by} starts {program!r} of {package}, and the set-up has no such console script.", **values
    )
    help = msg("Add it to console_scripts in setup.py: 'NAME = PACKAGE.MODULE:main'.")
    return PackageFault("scripts", rationale, help)


def unstarted(facts: PackageFacts) -> Iterator[PackageFault]:
    """What keeps colcon from finding the package, or `ros2 run` from starting its programs."""
    if facts.setup.manifest:
        rationale = msg(
            "package.xml cannot be used: {why}. colcon takes the folder for no ROS package.",
            why=facts.setup.manifest.map_texts(shown),
        )
        yield PackageFault("package.xml", rationale, AS_CREATED)
    for each in facts.setup.scripts:
        if each.fault:
            rationale = msg(
                "The console script {name!r} cannot start: {why}.",
                name=shown(each.name),
                why=each.fault.map_texts(shown),
            )
            help = msg(
                "It has the form 'NAME = PACKAGE.MODULE:FUNCTION': the file "
                "PACKAGE/MODULE.py has to be there, and the function in it."
            )
            yield PackageFault(f"script {each.name}", rationale, help)
    if facts.setup.scripts and facts.setup.scripts_folder.rstrip("/") != f"lib/{facts.name}":
        yield _misplaced(facts)


def _misplaced(facts: PackageFacts) -> PackageFault:
    """Of programs where nobody looks for them; without a setup.cfg that is bin."""
    name = facts.name
    rationale = msg(
        "Programs are installed in {folder}; expected lib/{name}: `ros2 run {name}` looks there.",
        folder=shown(facts.setup.scripts_folder) or "bin",
        name=name,
    )
    help = msg("setup.cfg needs install_scripts=$base/lib/{package} below [install].", package=name)
    return PackageFault("scripts", rationale, help)


def _left(facts: PackageFacts, by: str | Message, wanted: str, source: str) -> PackageFault:
    """Of a file of the package that nothing installs where it is asked for."""
    pairs = zip(facts.setup.installed, facts.setup.sources, strict=True)
    elsewhere = next((path for path, of in pairs if of == source), "")
    rationale = msg(
        "{by} asks for {wanted}; {source} is in the package, and nothing installs it there{but}.",
        by=by,
        wanted=wanted,
        source=source,
        but=msg(" (but as {elsewhere})", elsewhere=elsewhere) if elsewhere else "",
    )
    return PackageFault(dirname(source), rationale, _LIST_IT)
