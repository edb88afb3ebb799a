"""What the package is worth that was handed in, and its launch file, by what was found of them."""

from __future__ import annotations

from dataclasses import replace

from grader.exercise.verdict import Finding
from grader.exercises.description_package import installing, launching
from grader.exercises.description_package.launching import JOINT_SOURCES, Part
from grader.exercises.description_package.looked import Looked, not_judged, nothing
from grader.language.phrase import joined, say
from grader.recording.recording import Recording
from grader.scenes.package.said import said, shown
from grader.scenes.package.trace import PREFIX, Launch, Node

STATE_PUBLISHER = launching.PUBLISHER
DESCRIPTION = "robot_description"
#: What each part of a launch file is worth.
ROBOT, OWN, PLACES = 0.4, 0.4, 0.2


def judge_package(recording: Recording) -> Finding:
    """Package.xml, setup.py, its console scripts."""
    if recording.package is None:
        return Finding(
            0,
            say("It is no package: there is no setup.py around the node."),
            say("`ros2 pkg create --build-type ament_python NAME` makes one."),
        )
    looked = Looked.at(recording.package)
    if looked is None:
        return nothing()
    if (not_known := installing.not_followed(looked)) is not None:
        return not_known
    setup = looked.setup
    runs = [each.name for each in setup.scripts if not each.fault] + _plain_programs(looked)
    wrong = _wrong(looked)
    if runs and not wrong:
        return Finding(
            1,
            say(
                "`ros2 run {package} {program}` can start it.", package=setup.name, program=runs[0]
            ),
        )
    return Finding(
        0.5 if runs or setup.scripts else 0,
        joined(wrong, " ") if wrong else say("setup.py names no console script."),
        say(
            "What `ros2 run` starts is a console script in the entry_points of "
            "setup.py; `colcon build` in a workspace says what else is wrong."
        ),
    )


def _wrong(looked: Looked) -> list[str]:
    """What keeps colcon from building it, or `ros2 run` from starting something of it."""
    setup = looked.setup
    if (stop := installing.stops(looked)) is not None:
        return [stop.rationale]
    wrong: list[str] = []
    if setup.told and setup.told != setup.name:
        wrong = [
            say(
                "package.xml calls the package {name!r}, and setup.py calls it {other!r}.",
                name=shown(setup.name),
                other=shown(setup.told),
            )
        ]
    return [*(each.rationale for each in installing.unstarted(looked)), *wrong]


def _plain_programs(looked: Looked) -> list[str]:
    """What is installed where `ros2 run` looks, as install(PROGRAMS) of CMake does it."""
    place, files = f"lib/{looked.name}/", looked.setup.installed
    return [path.removeprefix(place) for path in files if path.startswith(place)]


def judge_launch(recording: Recording) -> Finding:
    """The launch file that does most of what it should."""
    looked = Looked.at(recording.package) if recording.package else None
    if recording.package is not None and looked is None:
        return nothing()
    if looked is None or not looked.launches:
        return Finding(
            0,
            say("There is no launch file in a package."),
            say(
                "A launch file starts {program} with the robot's description and your node, so "
                "that nobody has to type both.",
                program=STATE_PUBLISHER,
            ),
        )
    best = max((_judge(looked, each) for each in looked.launches), key=lambda found: found.share)
    for each in looked.launches:
        if best.share < 1 and each.problem is not None and each.problem.kind == "unknown":
            return not_judged(each)
    return best


def _judge(looked: Looked, launch: Launch) -> Finding:
    if launch.problem is not None:
        return launching.ends(launch.file, launch.problem, 0)
    parts = (_robot(looked, launch), _own(looked, launch), _places(looked, launch))
    lacking = [part for part in parts if part is not None]
    if lacking:
        return launching.without(launch.file, lacking)
    return Finding(
        1,
        say("{file} starts {program} and your node.", file=launch.file, program=STATE_PUBLISHER),
    )


def _robot(looked: Looked, launch: Launch) -> Part | None:
    if launch.includes and not any(map(launching.is_publisher, launch.nodes)):
        return None  # what another package's launch file starts nobody knows here
    texts = launching.handed_on(looked, launch)
    if any("<robot" in text for text in texts):
        return None
    if why := launching.refused(looked, launch):
        return _part(
            ROBOT,
            say("{program} gets no description: {why}.", program=STATE_PUBLISHER, why=said(why)),
        )
    if lacking := launching.no_description(looked, launch, ROBOT):
        return lacking
    found = next(text.strip() for text in texts if text.strip())
    return _part(
        ROBOT,
        say(
            "{parameter} has to be the text of the URDF, and is {what}.",
            parameter=DESCRIPTION,
            what=repr(shown(found.removeprefix(f"{PREFIX}/"))[:60]),
        ),
    )


def _part(worth: float, why: str) -> Part:
    return Part(
        worth,
        why,
        say(
            "It takes two nodes: {program} with the parameter {parameter}, and yours, by the names "
            "of your package and of its console script.",
            program=STATE_PUBLISHER,
            parameter=DESCRIPTION,
        ),
    )


def _own(looked: Looked, launch: Launch) -> Part | None:
    name = looked.name
    scripts = {*(script.name for script in looked.setup.scripts), *_plain_programs(looked)}
    others = [node.executable for node in launch.nodes if node.executable in JOINT_SOURCES]
    if others:
        return _part(
            OWN,
            say(
                "it starts {program} as well, which sends other joint states beside your node's.",
                program=others[0],
            ),
        )
    if any(node.package == name and node.executable in scripts for node in launch.nodes):
        return None
    meant = filter(None, (_meant(node, name, scripts) for node in launch.nodes))
    return _part(OWN, next(meant, "") or say("it does not start your node."))


def _meant(node: Node, name: str, scripts: set[str]) -> str:
    """What is wrong with a node that is meant to be one's own."""
    if node.executable in scripts:
        return say(
            "it starts {program} of the package {package!r}; yours is called {own!r}.",
            program=node.executable,
            package=shown(node.package),
            own=name,
        )
    if node.package == name:
        return say("your package has no executable {program!r}.", program=shown(node.executable))
    return ""


def _places(looked: Looked, launch: Launch) -> Part | None:
    """What it asks for, and does not find where the package is installed."""
    started = {node.package for node in launch.nodes}
    for each in launch.lacking:
        if each.kind == "file" or (each.kind == "package" and each.name not in started):
            found = installing.lacking(looked, replace(each, by=each.by or launch.file))
            return Part(PLACES, found.rationale, found.help)
    if launch.moved:
        found = installing.moved(launch)
        return Part(PLACES, found.rationale, found.help)
    return None
