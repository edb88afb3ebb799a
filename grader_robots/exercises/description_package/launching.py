"""What the launch files describe: a robot_state_publisher, what moves its joints, and RViz."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from grader import Checks, Finding, Tolerances
from grader.exercise import unless_unknown
from grader.submission import advice, package_trace, shown
from grader.text import joined, msg
from grader_robots.exercises.description_package import installing
from grader_robots.exercises.description_package.facts import (
    NO_FAULT,
    PackageFacts,
    PackageFault,
    includes_simulator,
    is_rviz,
    of_package,
    unjudged,
)
from grader_robots.exercises.description_package.robots import of_description, of_text
from grader_robots.robot_py.urdf import parse
from ros_doubles.known import FILES, KNOWN

checks = Checks()
PUBLISHER = "robot_state_publisher"
#: The parameter that it reads, and the topic that it publishes.
DESCRIPTION = "robot_description"
JOINT_SOURCES = ("joint_state_publisher", "joint_state_publisher_gui")
#: What each part of it is worth here: without a description nothing shows.
WORTH = {"description": 1.0, "joints": 0.25, "rviz": 0.25}
_MOVES = re.compile(r'type\s*=\s*["\'](?:revolute|continuous|prismatic)["\']')


@checks()
@of_package
def launch(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """A launch file shows the robot: its description, its joints, RViz.

    Each launch file (Python, XML or YAML) is evaluated with its default arguments, and nothing is
    started. The best of them counts; one that puts the robot into Gazebo only if it starts RViz:

    - robot_state_publisher with the parameter robot_description, a URDF that urdfdom takes;
      without it nothing shows: 0,
    - something that publishes joint states, if any joint moves: joint_state_publisher, with or
      without gui, a node of the package, a controller, a simulator: a quarter,
    - rviz2 with a file: a quarter. Who opens RViz by hand needs an .rviz file that is installed.

    If `ros2 launch` ends with an error, its own or for want of a file that it reads, of a program
    or of a package: 0. One that uses what the grader does not know makes this check not judged,
    where nothing else passes it.
    """
    if not facts.launches:
        return Finding(0, msg("The package has no launch file."), installing.WRITE)
    found = [(each, _judge(facts, each)) for each in facts.for_rviz]
    if not found:
        first = facts.launches[0]
        alone = msg("No launch file shows the robot in RViz: {file} puts it into Gazebo.")
        found = [(first, Finding(0, alone.given(file=first.file), installing.WRITE))]
    best, finding = max(found, key=lambda each: each[1].share)
    why = msg("{best} alone does not show the robot", best=best.file)
    finding = unless_unknown(facts.trace, finding, why, NO_FAULT)
    if not finding.judged:
        return finding
    ended = [judged for each, judged in found if _ends_early(each)]
    if finding.share < 1 and ended:
        return replace(ended[0], share=finding.share)
    if finding.share <= WORTH["joints"] + WORTH["rviz"] and (include := _not_followed(best)):
        why = msg(
            "Not judged: {best} leaves it to {include}, a file of another package, to show the "
            "robot, and nobody knows here what that starts.",
            best=best.file,
            include=include,
        )
        return unjudged(why, msg("This is no fault of the package: tell whoever runs the course."))
    return finding


def _judge(facts: PackageFacts, launch: package_trace.LaunchFile) -> Finding:
    if (stopped := starts_nothing(facts, launch)) is not None:
        return stopped
    for text in filter(str.strip, handed_on(facts, launch)):
        robot = of_text(launch.file, text)
        if not robot.share:
            return robot
    if faults := list(_lacking(facts, launch)):
        return without(launch.file, faults, WORTH)
    said = msg("{best} starts {publisher} with the description, and what belongs to it.")
    return Finding(1, said.given(best=launch.file, publisher=PUBLISHER))


def starts_nothing(facts: PackageFacts, launch: package_trace.LaunchFile) -> Finding | None:
    """Of a launch file with which `ros2 launch` ends with an error; None where it does not."""
    if _ends_early(launch):
        assert launch.problem is not None
        return ends(launch.file, launch.problem)
    if (fault := not_started(facts, launch)) is None:
        return None
    consequence = msg("`ros2 launch` starts nothing of {file}.", file=launch.file)
    return Finding(0, joined([fault.rationale, consequence], " "), fault.help)


def _ends_early(launch: package_trace.LaunchFile) -> bool:
    """Whether it ends with an error of its own."""
    return launch.problem is not None and launch.problem.kind in ("error", "limit")


def not_started(facts: PackageFacts, launch: package_trace.LaunchFile) -> PackageFault | None:
    """What `ros2 launch` ends with for want of something that it needs; None where all is there."""
    if (stop := installing.stops(facts)) is not None:
        return stop
    if facts.setup.manifest:
        return next(installing.unstarted(facts))
    if not (launch.nodes or launch.includes or launch.processes):
        return None  # it has nothing to start
    for each in launch.lacking:
        if not _is_handed_on(facts, launch, each):
            return installing.lacking(facts, replace(each, by=each.by or launch.file))
    if launch.moved:
        return installing.moved(launch)
    unmade = (each for each in facts.descriptions if each.by == launch.file and each.problem)
    if (description := next(unmade, None)) is not None:
        found = of_description(facts, description)
        return PackageFault("description", found.rationale, found.help)
    return None


def _is_handed_on(
    facts: PackageFacts, launch: package_trace.LaunchFile, lacks: package_trace.Lacking
) -> bool:
    """Whether a file that is not there is only named to a program, which starts all the same."""
    sources = {each.source for each in facts.trace.descriptions}
    if lacks.kind != "file" or (lacks.source and lacks.source in sources):
        return False
    words = [*launch.processes]
    for node in launch.nodes:
        words += [*node.arguments, *(each.value for each in node.parameters)]
    return any(lacks.name.removeprefix(f"{package_trace.EMPTY}/") in word for word in words)


def ends(file: str, problem: package_trace.Obstacle) -> Finding:
    """Of a launch file that comes to no end."""
    rationale = msg("{what_happens}.", what_happens=problem.ends(file))
    return Finding(0, rationale, advice(str(problem.text)))


def without(file: str, faults: Sequence[PackageFault], worth: Mapping[str, float]) -> Finding:
    """Of a launch file with faults, each of which costs what that part is worth."""
    first, *others = (fault.rationale for fault in faults)
    texts = joined([first, *(msg("{fault!u}", fault=each) for each in others)], " ")
    rationale = msg("{file}: {faults}", file=file, faults=texts)
    share = max(0.0, 1.0 - sum(worth[fault.what] for fault in faults))
    return Finding(share, rationale, faults[0].help)


def _lacking(facts: PackageFacts, launch: package_trace.LaunchFile) -> Iterator[PackageFault]:
    """What of the three parts a launch file does not have."""
    if not refused(facts, launch) and (undescribed := no_description(facts, launch)):
        yield undescribed
    is_needed = not any(map(is_publisher, launch.nodes)) or moves(facts, handed_on(facts, launch))
    has_source = any(is_joint_source(facts, node) for node in launch.nodes)
    if is_needed and not has_source and not includes_simulator(launch):
        rationale = msg(
            "nothing publishes /joint_states: the moving joints have no transforms,"
            " and RViz shows what hangs on them white."
        )
        help = msg("Start joint_state_publisher_gui, or a node of yours that publishes JointState.")
        yield PackageFault("joints", rationale, help)
    if rviz := _rviz(facts, launch):
        yield rviz


def is_publisher(node: package_trace.LaunchedNode) -> bool:
    """Whether a node is a robot_state_publisher."""
    return PUBLISHER in (node.package, node.executable)


def handed_on(facts: PackageFacts, launch: package_trace.LaunchFile) -> list[str]:
    nodes = filter(is_publisher, launch.nodes)
    return [facts.text(p.text) for n in nodes for p in n.parameters if p.name == DESCRIPTION]


def refused(facts: PackageFacts, launch: package_trace.LaunchFile) -> package_trace.Obstacle | None:
    """Why xacro makes no description of the file that would be handed on."""
    problems = (each.problem for each in facts.descriptions if each.by == launch.file)
    return next((each for each in problems if each is not None), None)


def moves(facts: PackageFacts, texts: list[str]) -> bool:
    """Whether a joint of the robot moves."""
    texts = texts or [facts.text(each.text) for each in facts.descriptions]
    for text in texts:
        model = parse(text).model
        if model is None:
            if _MOVES.search(text):
                return True
        elif any(joint.type.is_movable for joint in model.joints.values()):
            return True
    return not texts


def is_joint_source(facts: PackageFacts, node: package_trace.LaunchedNode) -> bool:
    """Whether a node publishes joint states, as far as one can see."""
    if node.package in JOINT_SOURCES:
        return True
    if "joint_state_broadcaster" in node.arguments or "joint_broad" in node.arguments:
        return True
    if node.package == facts.name:
        scripts = {each.name: each for each in facts.setup.scripts}
        return node.executable not in scripts or scripts[node.executable].says
    is_another_s = node.package in facts.setup.depends and node.package not in KNOWN
    return is_another_s or node.package in facts.trace.others


def _not_followed(launch: package_trace.LaunchFile) -> str:
    """A launch file of another package of which it is not known what it starts; '' for none."""
    for each in launch.includes:
        if each.file not in FILES.get(each.package, ()) and not each.file.endswith("()"):
            return f"{each.package}/{each.file}"
    return ""


def no_description(facts: PackageFacts, launch: package_trace.LaunchFile) -> PackageFault | None:
    """Of a launch file in which no robot_state_publisher gets a text; None where one does."""
    publishers = [node for node in launch.nodes if is_publisher(node)]
    if not publishers:
        rationale = msg("it starts no robot_state_publisher.")
        help = msg("Start it with the parameter robot_description: the text of your URDF.")
        return PackageFault("description", rationale, help)
    if any(text.strip() for text in handed_on(facts, launch)):
        return None
    names = [each.name for each in publishers[0].parameters]
    found = msg("it gets no parameter.")
    if DESCRIPTION in names:
        found = msg("it is empty.")
    elif names:
        found = msg("its parameters are {names}.", names=shown(", ".join(names)))
    rationale = msg("robot_state_publisher has no robot_description: {found}", found=found)
    help = msg(
        "Give it parameters=[{{'robot_description': ...}}] with the text of the URDF, not its path."
    )
    return PackageFault("description", rationale, help)


def _rviz(facts: PackageFacts, launch: package_trace.LaunchFile) -> PackageFault | None:
    started = [node for node in launch.nodes if is_rviz(node)]
    missing = [each.name for each in launch.lacking]
    if any(_has_file(node, missing) for node in started):
        return None
    if started:
        rationale = msg("rviz2 starts without a file that is there: it shows an empty grid.")
        help = msg(
            "Save RViz's settings into the package, install the file, and start "
            "rviz2 with arguments=['-d', FILE]."
        )
        return PackageFault("rviz", rationale, help)
    files = [path for path in facts.setup.installed if path.endswith(".rviz")]
    by_hand = not any(is_rviz(n) for each in facts.launches for n in each.nodes)
    if files and by_hand:
        return None  # who launches it opens RViz with the file that is installed
    return PackageFault(
        "rviz",
        msg("it starts no rviz2, and no .rviz file is installed for who opens it by hand.")
        if not files
        else msg("it starts no rviz2."),
        msg(
            "Start rviz2 with arguments=['-d', FILE], FILE being the .rviz file in "
            "the share folder."
        ),
    )


def _has_file(node: package_trace.LaunchedNode, missing: Sequence[str]) -> bool:
    words = [word for each in node.arguments for word in each.replace("=", " ", 1).split()]
    at = next((n for n, w in enumerate(words) if w in ("-d", "--display-config")), len(words))
    return len(words) > at + 1 and not any(
        words[at + 1] in (each, each.removeprefix(f"{package_trace.EMPTY}/")) for each in missing
    )
