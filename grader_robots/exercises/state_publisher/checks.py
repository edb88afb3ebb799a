"""The checks of package and launch file, by the facts that were found; beside them the node's."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from grader import Checks, Finding, Recordings, Tolerances
from grader.exercise import unless_unknown
from grader.submission import package_trace, shown
from grader.text import NOTHING, Message, joined, msg
from grader_robots.exercises.description_package import installing, launching
from grader_robots.exercises.description_package.facts import (
    PackageFacts,
    PackageFault,
    not_followed,
    nothing,
)
from grader_robots.exercises.description_package.launching import (
    DESCRIPTION,
    JOINT_SOURCES,
    PUBLISHER,
)
from grader_robots.exercises.description_package.robots import of_text
from grader_robots.exercises.state_publisher import joints, timing, transforms

checks = Checks(*(part.checks for part in (timing, joints, transforms)))
#: What each part of a launch file is worth here.
WORTH = {"description": 0.4, "own": 0.4, "places": 0.2}
_TWO_NODES = msg(
    "It takes two nodes: {program} with the parameter {parameter}, and yours, by the names "
    "of your package and of its console script.",
    program=PUBLISHER,
    parameter=DESCRIPTION,
)


@checks(parrot="it is in the files, whatever a program sends")
def package(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It is a package with an entry point.

    A console script in setup.py starts the node, and nothing keeps `colcon build` or `ros2 run`
    from doing so. Half of the points where something does. A single file has none of them.
    setup.py is run with a `setup()` that only takes down what it gets.
    """
    trace = recordings.nominal.package
    if trace is None:
        rationale = msg("It is no package: there is no setup.py around the node.")
        help = msg("`ros2 pkg create --build-type ament_python NAME` makes one.")
        return Finding(0, rationale, help)
    facts = PackageFacts.of(trace)
    if facts is None:
        return nothing()
    if (not_known := not_followed(facts)) is not None:
        return not_known
    scripts = facts.setup.scripts
    runs = [*(each.name for each in scripts if not each.fault), *facts.plain_programs]
    wrong = list(_wrong(facts))
    if runs and not wrong:
        rationale = msg(
            "`ros2 run {package} {program}` can start it.", package=facts.name, program=runs[0]
        )
        return Finding(1, rationale)
    rationale = joined(wrong, " ") if wrong else msg("setup.py names no console script.")
    help = msg(
        "What `ros2 run` starts is a console script in the entry_points of "
        "setup.py; `colcon build` in a workspace says what else is wrong."
    )
    return Finding(0.5 if runs or scripts else 0, rationale, help)


def _wrong(facts: PackageFacts) -> Iterator[Message]:
    """What keeps colcon from building it, or `ros2 run` from starting something of it."""
    if (stop := installing.stops(facts)) is not None:
        yield stop.rationale
        return
    yield from (each.rationale for each in installing.unstarted(facts))
    if facts.setup.told and facts.setup.told != facts.name:
        yield msg(
            "package.xml calls the package {name!r}, and setup.py calls it {other!r}.",
            name=shown(facts.name),
            other=shown(facts.setup.told),
        )


@checks(parrot="it is in the files, whatever a program sends")
def launch(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Its launch file starts robot and node.

    A launch file of the package starts robot_state_publisher with the parameter
    robot_description, a URDF that urdfdom takes (2/5), and the package's own node, without another
    source of joint states beside it (2/5); setup.py installs it and all files that it names, and
    none of them is looked for in somebody's home (1/5). It is evaluated with its default
    arguments, where the package is laid out as if installed, and starts nothing. If `ros2 launch`
    ends with an error, its own or for want of a file that it reads, of a program or of a package:
    0. Of several launch files the best counts.
    """
    trace = recordings.nominal.package
    facts = None if trace is None else PackageFacts.of(trace)
    if trace is not None and facts is None:
        return nothing()
    if facts is None or not facts.launches:
        help = msg(
            "A launch file starts {program} with the robot's description and your node, so "
            "that nobody has to type both.",
            program=PUBLISHER,
        )
        return Finding(0, msg("There is no launch file in a package."), help)
    best = max((_judge(facts, each) for each in facts.launches), key=lambda found: found.share)
    return unless_unknown(facts.trace, best)


def _judge(facts: PackageFacts, launch: package_trace.LaunchFile) -> Finding:
    if launch.problem is not None:
        return launching.ends(launch.file, launch.problem)
    stopped = launching.starts_nothing(facts, launch)
    if faults := list(_faults(facts, launch)):
        found = launching.without(launch.file, faults, WORTH)
        return found if stopped is None else replace(found, share=0)
    return stopped or Finding(
        1, msg("{file} starts {program} and your node.", file=launch.file, program=PUBLISHER)
    )


def _faults(facts: PackageFacts, launch: package_trace.LaunchFile) -> Iterator[PackageFault]:
    """What is wrong with the description, one's own node, and the files that it asks for."""
    texts = launching.handed_on(facts, launch)
    starts_publisher = any(map(launching.is_publisher, launch.nodes))
    # what another package's launch file starts nobody knows here
    is_known = starts_publisher or not launch.includes
    if is_known and not any("<robot" in text for text in texts):
        yield _undescribed(facts, launch, texts)
    else:
        refused = (of_text(launch.file, text) for text in texts if "<robot" in text)
        robots = [PackageFault("description", f.rationale, f.help) for f in refused if not f.share]
        yield from robots[:1]
    if wrong := _without_node(facts, launch):
        yield PackageFault("own", wrong, _TWO_NODES)
    started = {node.package for node in launch.nodes}
    asked = [
        installing.lacking(facts, replace(each, by=each.by or launch.file))
        for each in launch.lacking
        if each.kind == "file" or (each.kind == "package" and each.name not in started)
    ]
    if launch.moved:
        asked.append(installing.moved(launch))
    yield from (fault._replace(what="places") for fault in asked[:1])


def _undescribed(
    facts: PackageFacts, launch: package_trace.LaunchFile, texts: list[str]
) -> PackageFault:
    """Why what robot_state_publisher gets is no URDF."""
    if why := launching.refused(facts, launch):
        text = msg("{program} gets no description: {why}.", program=PUBLISHER, why=why.described)
        return PackageFault("description", text, _TWO_NODES)
    if fault := launching.no_description(facts, launch):
        return fault
    found = next(text.strip() for text in texts if text.strip())
    text = msg(
        "{parameter} has to be the text of the URDF, and is {what}.",
        parameter=DESCRIPTION,
        what=repr(shown(found.removeprefix(f"{package_trace.PREFIX}/"))[:60]),
    )
    return PackageFault("description", text, _TWO_NODES)


def _without_node(facts: PackageFacts, launch: package_trace.LaunchFile) -> Message:
    """Why a launch file does not start one's own node alone; '' where it does."""
    others = [node.executable for node in launch.nodes if node.executable in JOINT_SOURCES]
    if others:
        return msg(
            "it starts {program} as well, which sends other joint states beside your node's.",
            program=others[0],
        )
    # what `ros2 run` finds
    programs = {*(script.name for script in facts.setup.scripts), *facts.plain_programs}
    if any(n.package == facts.name and n.executable in programs for n in launch.nodes):
        return NOTHING
    meant = filter(None, (_meant(node, facts.name, programs) for node in launch.nodes))
    return next(meant, msg("it does not start your node."))


def _meant(node: package_trace.LaunchedNode, name: str, programs: set[str]) -> Message:
    """What is wrong with a node that is meant to be one's own."""
    if node.executable in programs:
        return msg(
            "it starts {program} of the package {package!r}; yours is called {own!r}.",
            program=node.executable,
            package=shown(node.package),
            own=name,
        )
    if node.package == name:
        return msg("your package has no executable {program!r}.", program=shown(node.executable))
    return NOTHING
