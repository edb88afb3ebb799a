"""Whether what was handed in is a package that `ros2 run` and `ros2 launch` can start."""

from __future__ import annotations

from collections.abc import Iterator

from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.seen import sentence
from grader.recording.recording import Recording
from grader.scenes.package.launch_errors import advice
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
            "It is no package: there is no setup.py around the node.",
            "`ros2 pkg create --build-type ament_python NAME` makes one.",
        )
    setup = PackageTrace.of(recording.package).setup
    if setup is None:
        return _not_looked_at()
    if setup.problem is not None and setup.problem.kind == "unknown":
        return _not_judged("setup.py could not be run", setup.problem)
    wrong = list(_wrong(setup))
    runs = [each.name for each in setup.scripts if not each.fault] + _plain_programs(setup)
    if runs and not wrong:
        return Finding(1, f"`ros2 run {setup.name} {runs[0]}` can start it.")
    return Finding(
        0.5 if runs or setup.scripts else 0,
        sentence(wrong or ["setup.py names no console script"]),
        "What `ros2 run` starts is a console script in the entry_points of setup.py; "
        "`colcon build` in a workspace says what else is wrong.",
    )


def _wrong(setup: Setup) -> Iterator[str]:
    """What keeps colcon from building it, or `ros2 run` from starting something of it."""
    if setup.problem is not None and setup.problem.text.startswith("there is no"):
        yield f"the package cannot be built: {_shown(setup.problem.text)}"
        return
    if setup.problem is not None:
        yield f"setup.py ends with {_shown(setup.problem.text)}{_placed(setup.problem)}"
        return
    if setup.manifest:
        yield f"package.xml: {setup.manifest}"
    if setup.absent:
        yield f"setup.py installs {_shown(setup.absent[0])}, and there is no such file"
    if setup.folders:
        yield f"setup.py lists {_shown(setup.folders[0])} as a file, and it is a folder"
    for script in setup.scripts:
        if script.fault:
            yield f"`ros2 run` cannot start {_shown(script.name)}: {script.fault}"
    folder, expected = setup.scripts_folder, f"lib/{setup.name}"
    if setup.told and setup.told != setup.name:
        yield (
            f"package.xml calls the package {_shown(setup.name)!r}, and setup.py calls it "
            f"{_shown(setup.told)!r}"
        )
    elif setup.scripts and folder.rstrip("/") != expected:
        yield (
            f"programs are installed in {_shown(folder) or 'bin'}, and `ros2 run` looks in "
            f"{expected}: setup.cfg needs install_scripts=$base/{expected}"
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
            "There is no launch file in a package.",
            f"A launch file starts {STATE_PUBLISHER} with the robot's description and your node, "
            "so that nobody has to type both.",
        )
    best = max((_judge(each, setup, trace) for each in launches), key=lambda found: found.share)
    for each in launches:
        if best.share < 1 and each.problem is not None and each.problem.kind == "unknown":
            return _not_judged(f"{each.file} could not be evaluated", each.problem)
    return best


def _judge(launch: Launch, setup: Setup, trace: PackageTrace) -> Finding:
    if launch.problem is not None:
        return Finding(
            0,
            f"`ros2 launch` starts nothing of {launch.file}: "
            f"{_shown(launch.problem.text)}{_placed(launch.problem)}.",
            advice(launch.problem.text),
        )
    asked = ((ROBOT, _robot(launch, trace)), (OWN, _own(launch, setup)))
    faults = [*asked, (PLACES, _places(launch, setup))]
    told = [why for _, why in faults if why]
    if not told:
        return Finding(1, f"{launch.file} starts {STATE_PUBLISHER} and your node.")
    nodes = (
        f"It takes two nodes: {STATE_PUBLISHER} with the parameter {DESCRIPTION}, and yours, "
        "by the names of your package and of its console script."
    )
    places = (
        "What a launch file reads is found below get_package_share_directory(your package), "
        "where data_files in setup.py puts it."
    )
    return Finding(
        1 - sum(cost for cost, why in faults if why),
        f"{launch.file}: {'; '.join(told)}.",
        nodes if any(why for _, why in asked) else places,
    )


def _robot(launch: Launch, trace: PackageTrace) -> str:
    nodes = [node for node in launch.nodes if STATE_PUBLISHER in (node.executable, node.package)]
    if not nodes:
        # what another package's launch file starts nobody knows here
        return "" if launch.includes else f"it does not start {STATE_PUBLISHER}"
    given = [each for node in nodes for each in node.parameters if each.name == DESCRIPTION]
    texts = [trace.texts[each.text] for each in given if each.text >= 0]
    if any("<robot" in text for text in texts):
        return ""
    refused = [each.problem for each in trace.descriptions if each.by == launch.file]
    if why := next((each for each in refused if each is not None), None):
        return f"{STATE_PUBLISHER} gets no description: {_shown(why.text)}"
    if given:
        found = next((text.strip() for text in texts if text.strip()), "")
        told = repr(_shown(found.removeprefix(f"{PREFIX}/"))[:60]) if found else "empty"
        return f"{DESCRIPTION} has to be the text of the URDF, and is {told}"
    return f"{STATE_PUBLISHER} gets no parameter {DESCRIPTION}, and ends at once"


def _own(launch: Launch, setup: Setup) -> str:
    scripts = {*(script.name for script in setup.scripts), *_plain_programs(setup)}
    others = [node.executable for node in launch.nodes if node.executable in JOINT_SOURCES]
    if others:
        return f"it starts {others[0]} as well, which sends other joint states beside your node's"
    if any(node.package == setup.name and node.executable in scripts for node in launch.nodes):
        return ""
    return next(filter(None, (_meant(node, setup, scripts) for node in launch.nodes)), "") or (
        "it does not start your node"
    )


def _meant(node: Node, setup: Setup, scripts: set[str]) -> str:
    """What is wrong with a node that is meant to be one's own."""
    if node.executable in scripts:
        return (
            f"it starts {node.executable} of the package {_shown(node.package)!r}; yours is called "
            f"{setup.name!r}"
        )
    if node.package == setup.name:
        return f"your package has no executable {_shown(node.executable)!r}"
    return ""


def _places(launch: Launch, setup: Setup) -> str:
    """What it asks for, and does not find where the package is installed."""
    started = {node.package for node in launch.nodes}
    for each in launch.lacking:
        if each.kind == "package" and each.name not in started:
            return f"there is no package {_shown(each.name)!r}; yours is called {setup.name!r}"
        if each.kind == "file":
            return _absent(each, setup)
    if launch.moved:
        return f"the path {_shown(launch.moved)!r} is there on one computer only"
    return ""


def _absent(file: Lacking, setup: Setup) -> str:
    if file.name.startswith(f"{EMPTY}/"):
        name = file.name.removeprefix(f"{EMPTY}/")
        return f"it reads {_shown(name)!r}, a path from the current folder, which may be any"
    name = file.name.removeprefix(f"{PREFIX}/")
    if name == file.name:
        return f"the path {_shown(name)!r} is there on one computer only"
    if not file.source:
        return f"there is no {_shown(name)}"
    pairs = zip(setup.installed, setup.sources, strict=True)
    if elsewhere := next((path for path, source in pairs if source == file.source), ""):
        return f"it reads {_shown(name)}, and setup.py installs that file as {_shown(elsewhere)}"
    return f"setup.py does not install {_shown(file.source)}"


def _not_looked_at() -> Finding:
    return Finding(
        0,
        "The package could not be looked at.",
        "Does setup.py or a launch file end the process that it runs in, or run without end?",
    )


def _not_judged(what: str, problem: Problem) -> Finding:
    return Finding(
        0,
        f"Not judged: {what}: {_shown(problem.text)}.",
        "This is no fault of the package: tell whoever runs the course.",
        judged=False,
    )


def _shown(text: str) -> str:
    """A text of the submission's in a sentence."""
    return clip_inside(without_controls(" ".join(text.split()), "?"), _LONGEST).rstrip(".")


def _placed(problem: Problem) -> str:
    """' (launch/a.launch.py, line 9)'; '' for no place."""
    line = f", line {problem.line}" if problem.line else ""
    return f" ({problem.file}{line})" if problem.file else ""
