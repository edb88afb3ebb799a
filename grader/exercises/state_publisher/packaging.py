"""Whether what was handed in is a package that `ros2 run` and `ros2 launch` can start."""

from __future__ import annotations

from collections.abc import Iterator

from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.seen import sentence
from grader.language.phrase import joined, say
from grader.recording.recording import Recording
from grader.scenes.package.launch_errors import advice
from grader.scenes.package.said import phrase_of
from grader.scenes.package.trace import (
    EMPTY,
    PREFIX,
    Lacking,
    Launch,
    Node,
    PackageTrace,
    Problem,
    Setup,
)
from grader.text import clip_inside, without_controls

STATE_PUBLISHER = "robot_state_publisher"
DESCRIPTION = "robot_description"
JOINT_SOURCES = ("joint_state_publisher", "joint_state_publisher_gui")
#: What each part of a launch file is worth.
ROBOT, OWN, PLACES = 0.4, 0.4, 0.2
_LONGEST = 200


def judge_package(recording: Recording) -> Finding:
    """Package.xml, setup.py, its console scripts."""
    if recording.package is None:
        return Finding(
            0,
            say("It is no package: there is no setup.py around the node."),
            say("`ros2 pkg create --build-type ament_python NAME` makes one."),
        )
    setup = PackageTrace.of(recording.package).setup
    if setup is None:
        return _not_looked_at()
    if setup.problem is not None and setup.problem.kind == "unknown":
        return _not_judged(
            say("Not judged: setup.py could not be run: {why}.", why=_said(setup.problem))
        )
    wrong = list(_wrong(setup))
    runs = [each.name for each in setup.scripts if not each.fault] + _plain_programs(setup)
    if runs and not wrong:
        return Finding(
            1,
            say(
                "`ros2 run {package} {program}` can start it.", package=setup.name, program=runs[0]
            ),
        )
    return Finding(
        0.5 if runs or setup.scripts else 0,
        sentence(wrong or [say("setup.py names no console script")]),
        say(
            "What `ros2 run` starts is a console script in the entry_points of "
            "setup.py; `colcon build` in a workspace says what else is wrong."
        ),
    )


def _wrong(setup: Setup) -> Iterator[str]:
    """What keeps colcon from building it, or `ros2 run` from starting something of it."""
    if setup.problem is not None and setup.problem.text.startswith("there is no"):
        yield say("the package cannot be built: {why}", why=_said(setup.problem))
        return
    if setup.problem is not None:
        yield say(
            "setup.py ends with {error}{place}",
            error=_said(setup.problem),
            place=_placed(setup.problem),
        )
        return
    if setup.manifest:
        yield say("package.xml: {why}", why=phrase_of(setup.manifest))
    if setup.absent:
        yield say(
            "setup.py installs {file}, and there is no such file", file=_shown(setup.absent[0])
        )
    if setup.folders:
        yield say(
            "setup.py lists {folder} as a file, and it is a folder", folder=_shown(setup.folders[0])
        )
    for script in setup.scripts:
        if script.fault:
            yield say(
                "`ros2 run` cannot start {program}: {why}",
                program=_shown(script.name),
                why=phrase_of(script.fault),
            )
    folder, expected = setup.scripts_folder, f"lib/{setup.name}"
    if setup.told and setup.told != setup.name:
        yield say(
            "package.xml calls the package {name!r}, and setup.py calls it {other!r}",
            name=_shown(setup.name),
            other=_shown(setup.told),
        )
    elif setup.scripts and folder.rstrip("/") != expected:
        yield say(
            "programs are installed in {folder}, and `ros2 run` looks in {expected}: setup.cfg "
            "needs install_scripts=$base/{expected}",
            folder=_shown(folder) or "bin",
            expected=expected,
        )


def _plain_programs(setup: Setup) -> list[str]:
    """What is installed where `ros2 run` looks, as install(PROGRAMS) of CMake does it."""
    place = f"lib/{setup.name}/"
    return [path.removeprefix(place) for path in setup.installed if path.startswith(place)]


def judge_launch(recording: Recording) -> Finding:
    """The launch file that does most of what it should."""
    trace = PackageTrace.of(recording.package) if recording.package else PackageTrace()
    setup, launches = trace.setup, trace.launches
    if recording.package is not None and setup is None:
        return _not_looked_at()
    if setup is None or not launches:
        return Finding(
            0,
            say("There is no launch file in a package."),
            say(
                "A launch file starts {program} with the robot's description and your node, so "
                "that nobody has to type both.",
                program=STATE_PUBLISHER,
            ),
        )
    best = max((_judge(each, setup, trace) for each in launches), key=lambda found: found.share)
    for each in launches:
        if best.share < 1 and each.problem is not None and each.problem.kind == "unknown":
            said = say(
                "Not judged: {file} could not be evaluated: {why}.",
                file=each.file,
                why=_said(each.problem),
            )
            return _not_judged(said)
    return best


def _judge(launch: Launch, setup: Setup, trace: PackageTrace) -> Finding:
    if launch.problem is not None:
        return Finding(
            0,
            say(
                "`ros2 launch` starts nothing of {file}: {why}{place}.",
                file=launch.file,
                why=_said(launch.problem),
                place=_placed(launch.problem),
            ),
            advice(launch.problem.text),
        )
    asked = ((ROBOT, _robot(launch, trace)), (OWN, _own(launch, setup)))
    faults = [*asked, (PLACES, _places(launch, setup))]
    told = [why for _, why in faults if why]
    if not told:
        return Finding(
            1,
            say(
                "{file} starts {program} and your node.",
                file=launch.file,
                program=STATE_PUBLISHER,
            ),
        )
    nodes = say(
        "It takes two nodes: {program} with the parameter {parameter}, and yours, by the names of "
        "your package and of its console script.",
        program=STATE_PUBLISHER,
        parameter=DESCRIPTION,
    )
    places = say(
        "What a launch file reads is found below "
        "get_package_share_directory(your package), where data_files in "
        "setup.py puts it."
    )
    return Finding(
        1 - sum(cost for cost, why in faults if why),
        say("{file}: {faults}.", file=launch.file, faults=joined(told, say("; "))),
        nodes if any(why for _, why in asked) else places,
    )


def _robot(launch: Launch, trace: PackageTrace) -> str:
    nodes = [node for node in launch.nodes if STATE_PUBLISHER in (node.executable, node.package)]
    if not nodes:
        # what another package's launch file starts nobody knows here
        if launch.includes:
            return ""
        return say("it does not start {program}", program=STATE_PUBLISHER)
    given = [each for node in nodes for each in node.parameters if each.name == DESCRIPTION]
    texts = [trace.texts[each.text] for each in given if each.text >= 0]
    if any("<robot" in text for text in texts):
        return ""
    refused = [each.problem for each in trace.descriptions if each.by == launch.file]
    if why := next((each for each in refused if each is not None), None):
        return say("{program} gets no description: {why}", program=STATE_PUBLISHER, why=_said(why))
    if given:
        found = next((text.strip() for text in texts if text.strip()), "")
        told = repr(_shown(found.removeprefix(f"{PREFIX}/"))[:60]) if found else say("empty")
        return say(
            "{parameter} has to be the text of the URDF, and is {what}",
            parameter=DESCRIPTION,
            what=told,
        )
    return say(
        "{program} gets no parameter {parameter}, and ends at once",
        program=STATE_PUBLISHER,
        parameter=DESCRIPTION,
    )


def _own(launch: Launch, setup: Setup) -> str:
    scripts = {*(script.name for script in setup.scripts), *_plain_programs(setup)}
    others = [node.executable for node in launch.nodes if node.executable in JOINT_SOURCES]
    if others:
        return say(
            "it starts {program} as well, which sends other joint states beside your node's",
            program=others[0],
        )
    if any(node.package == setup.name and node.executable in scripts for node in launch.nodes):
        return ""
    meant = filter(None, (_meant(node, setup, scripts) for node in launch.nodes))
    return next(meant, "") or say("it does not start your node")


def _meant(node: Node, setup: Setup, scripts: set[str]) -> str:
    """What is wrong with a node that is meant to be one's own."""
    if node.executable in scripts:
        return say(
            "it starts {program} of the package {package!r}; yours is called {own!r}",
            program=node.executable,
            package=_shown(node.package),
            own=setup.name,
        )
    if node.package == setup.name:
        return say("your package has no executable {program!r}", program=_shown(node.executable))
    return ""


def _places(launch: Launch, setup: Setup) -> str:
    """What it asks for, and does not find where the package is installed."""
    started = {node.package for node in launch.nodes}
    for each in launch.lacking:
        if each.kind == "package" and each.name not in started:
            return say(
                "there is no package {package!r}; yours is called {own!r}",
                package=_shown(each.name),
                own=setup.name,
            )
        if each.kind == "file":
            return _absent(each, setup)
    if launch.moved:
        return say("the path {path!r} is there on one computer only", path=_shown(launch.moved))
    return ""


def _absent(file: Lacking, setup: Setup) -> str:
    if file.name.startswith(f"{EMPTY}/"):
        name = file.name.removeprefix(f"{EMPTY}/")
        return say(
            "it reads {path!r}, a path from the current folder, which may be any",
            path=_shown(name),
        )
    name = file.name.removeprefix(f"{PREFIX}/")
    if name == file.name:
        return say("the path {path!r} is there on one computer only", path=_shown(name))
    if not file.source:
        return say("there is no {file}", file=_shown(name))
    pairs = zip(setup.installed, setup.sources, strict=True)
    if elsewhere := next((path for path, source in pairs if source == file.source), ""):
        return say(
            "it reads {path}, and setup.py installs that file as {other}",
            path=_shown(name),
            other=_shown(elsewhere),
        )
    return say("setup.py does not install {file}", file=_shown(file.source))


def _not_looked_at() -> Finding:
    return Finding(
        0,
        say("The package could not be looked at."),
        say("Does setup.py or a launch file end the process that it runs in, or run without end?"),
    )


def _not_judged(why: str) -> Finding:
    return Finding(
        0,
        why,
        say("This is no fault of the package: tell whoever runs the course."),
        judged=False,
    )


def _shown(text: str) -> str:
    """A text of the submission's in a sentence; a phrase that fits there stays one."""
    made = clip_inside(without_controls(" ".join(text.split()), "?"), _LONGEST).rstrip(".")
    return text if made == text else made


def _said(problem: Problem) -> str:
    """What a problem says, in a sentence."""
    return _shown(phrase_of(problem.text))


def _placed(problem: Problem) -> str:
    """' (launch/a.launch.py, line 9)'; '' for no place."""
    if not problem.file:
        return ""
    if not problem.line:
        return f" ({problem.file})"
    return say(" ({file}, line {line})", file=problem.file, line=problem.line)
