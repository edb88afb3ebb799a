"""What the launch files describe: a robot_state_publisher, what moves its joints, and RViz."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from grader.exercise.verdict import Finding
from grader.exercises.description_package.looked import Looked, not_judged
from grader.language.phrase import joined, say
from grader.scenes.package.examining.known import FILES, KNOWN, SIMULATORS
from grader.scenes.package.launch_errors import advice
from grader.scenes.package.said import how_it_ends, shown
from grader.scenes.package.trace import Launch, Node, Problem
from robot_py.urdf import parse

PUBLISHER = "robot_state_publisher"
JOINT_SOURCES = ("joint_state_publisher", "joint_state_publisher_gui")
#: What each part of it is worth.
DESCRIPTION, JOINTS, RVIZ = 0.5, 0.25, 0.25
#: A launch file of the package that ends with an error leaves no more than this.
BROKEN = 0.5
_SIMULATORS = ("gz sim", "gazebo", "gzserver", "ign gazebo", "webots")
_MOVES = re.compile(r'type\s*=\s*["\'](?:revolute|continuous|prismatic)["\']')


class Part(NamedTuple):
    """A part that is missing."""

    worth: float
    rationale: str
    help: str


def judge(looked: Looked) -> Finding:
    """The launch file that comes nearest to showing the robot."""
    if not looked.launches:
        return Finding(
            0,
            say("The package has no launch file."),
            say(
                "Write launch/display.launch.py: it starts robot_state_publisher with "
                "the description, joint_state_publisher_gui, and rviz2 with your .rviz "
                "file."
            ),
        )
    found = {launch.file: lacking(looked, launch) for launch in looked.launches}
    shows = [each.file for each in looked.launches if any(map(is_rviz, each.nodes))]
    best = min(shows or found, key=lambda file: sum(part.worth for part in found[file]))
    share = 1.0 - sum(part.worth for part in found[best])
    broken = [
        each
        for each in looked.launches
        if each.problem is not None and each.problem.kind in ("error", "limit")
    ]
    if share < 1 and looked.not_known is not None:
        return not_judged(looked.not_known, say("{best} alone does not show the robot", best=best))
    if broken and (problem := broken[0].problem):
        file = broken[0].file
        return ends(file, problem, min(share, BROKEN) if file != best else 0.0)
    strange = next((each for each in looked.launches if each.file == best), None)
    if share <= DESCRIPTION and strange and (include := _not_followed(strange)):
        return Finding(
            0,
            say(
                "Not judged: {best} leaves it to {include}, a file of another package, to show the "
                "robot, and nobody knows here what that starts.",
                best=best,
                include=include,
            ),
            say("This is no fault of the package: tell whoever runs the course."),
            judged=False,
        )
    if not found[best]:
        return Finding(
            1,
            say(
                "{best} starts {publisher} with the description, and what belongs to it.",
                best=best,
                publisher=PUBLISHER,
            ),
        )
    return without(best, found[best])


def ends(file: str, problem: Problem, share: float) -> Finding:
    """Of a launch file that comes to no end; `share` of the points is left."""
    what_happens = how_it_ends(file, problem)
    return Finding(share, say("{what_happens}.", what_happens=what_happens), advice(problem.text))


def without(file: str, parts: Sequence[Part]) -> Finding:
    """Of a launch file that lacks some parts."""
    first, *others = (part.rationale for part in parts)
    texts = joined([first, *(say("{fault!u}", fault=each) for each in others)], " ")
    share = 1 - sum(part.worth for part in parts)
    return Finding(share, say("{file}: {faults}", file=file, faults=texts), parts[0].help)


def lacking(looked: Looked, launch: Launch) -> list[Part]:
    """What of the three parts a launch file does not have."""
    publishers = [node for node in launch.nodes if is_publisher(node)]
    texts = handed_on(looked, launch)
    undescribed = None if refused(looked, launch) else no_description(looked, launch, DESCRIPTION)
    parts = [undescribed] if undescribed else []
    is_needed = not publishers or moves(looked, texts)
    has_source = any(is_joint_source(looked, node) for node in launch.nodes)
    if is_needed and not has_source and not _includes_simulator(launch):
        parts.append(
            Part(
                JOINTS,
                say(
                    "nothing publishes /joint_states: the moving joints have no transforms,"
                    " and RViz shows what hangs on them white."
                ),
                say(
                    "Start joint_state_publisher_gui, or a node of yours that publishes JointState."
                ),
            )
        )
    rviz = _rviz(looked, launch)
    return [*parts, *([rviz] if rviz else [])]


def is_publisher(node: Node) -> bool:
    """Whether a node is a robot_state_publisher."""
    return PUBLISHER in (node.package, node.executable)


def is_rviz(node: Node) -> bool:
    """Whether a node is RViz."""
    return "rviz2" in (node.package, node.executable)


def handed_on(looked: Looked, launch: Launch) -> list[str]:
    """What robot_state_publisher gets as descriptions."""
    nodes = filter(is_publisher, launch.nodes)
    return [looked.text(p.text) for n in nodes for p in n.parameters if is_description(p.name)]


def refused(looked: Looked, launch: Launch) -> Problem | None:
    """Why xacro makes no description of the file that would be handed on."""
    problems = (each.problem for each in looked.descriptions if each.by == launch.file)
    return next((each for each in problems if each is not None), None)


def is_description(name: str) -> bool:
    """Whether a parameter is the one that robot_state_publisher reads."""
    return name == "robot_description"


def moves(looked: Looked, texts: list[str]) -> bool:
    """Whether a joint of the robot moves."""
    texts = texts or [looked.text(each.text) for each in looked.descriptions]
    for text in texts:
        model = parse(text).model
        if model is None:
            if _MOVES.search(text):
                return True
        elif any(joint.type.is_movable for joint in model.joints.values()):
            return True
    return not texts


def is_joint_source(looked: Looked, node: Node) -> bool:
    """Whether a node publishes joint states, as far as one can see."""
    if node.package in JOINT_SOURCES:
        return True
    if "joint_state_broadcaster" in node.arguments or "joint_broad" in node.arguments:
        return True
    if node.package == looked.name:
        scripts = {each.name: each for each in looked.setup.scripts}
        return node.executable not in scripts or scripts[node.executable].says
    is_another_s = node.package in looked.setup.depends and node.package not in KNOWN
    return is_another_s or node.package in looked.trace.others


def _includes_simulator(launch: Launch) -> bool:
    """A simulator publishes the joints of what it simulates."""
    included = any(each.package in SIMULATORS for each in launch.includes)
    return included or any(each.startswith(_SIMULATORS) for each in launch.processes)


def _not_followed(launch: Launch) -> str:
    """A launch file of another package of which it is not known what it starts; '' for none."""
    return next(
        (
            f"{each.package}/{each.file}"
            for each in launch.includes
            if each.file not in FILES.get(each.package, ()) and not each.file.endswith("()")
        ),
        "",
    )


def no_description(looked: Looked, launch: Launch, worth: float) -> Part | None:
    """Of a launch file in which no robot_state_publisher gets a text; None where one does."""
    publishers = [node for node in launch.nodes if is_publisher(node)]
    if not publishers:
        return Part(
            worth,
            say("it starts no robot_state_publisher."),
            say("Start it with the parameter robot_description: the text of your URDF."),
        )
    if any(text.strip() for text in handed_on(looked, launch)):
        return None
    names = [each.name for each in publishers[0].parameters]
    found = say("it gets no parameter.")
    if any(map(is_description, names)):
        found = say("it is empty.")
    elif names:
        found = say("its parameters are {names}.", names=shown(", ".join(names)))
    return Part(
        worth,
        say("robot_state_publisher has no robot_description: {found}", found=found),
        say(
            "Give it parameters=[{{'robot_description': ...}}] with the text of the"
            " URDF, not its path."
        ),
    )


def _rviz(looked: Looked, launch: Launch) -> Part | None:
    started = [node for node in launch.nodes if is_rviz(node)]
    if any(_has_file(node) for node in started):
        return None
    if started:
        return Part(
            RVIZ,
            say("rviz2 starts without a file: it shows an empty grid."),
            say(
                "Save RViz's settings into the package, install the file, and start "
                "rviz2 with arguments=['-d', FILE]."
            ),
        )
    files = [path for path in looked.setup.installed if path.endswith(".rviz")]
    by_hand = not any(is_rviz(n) for each in looked.launches for n in each.nodes)
    if files and by_hand:
        return None  # who launches it opens RViz with the file that is installed
    return Part(
        RVIZ,
        say("it starts no rviz2, and no .rviz file is installed for who opens it by hand.")
        if not files
        else say("it starts no rviz2."),
        say(
            "Start rviz2 with arguments=['-d', FILE], FILE being the .rviz file in "
            "the share folder."
        ),
    )


def _has_file(node: Node) -> bool:
    words = list(node.arguments)
    if any(word.startswith("-d ") or word.startswith("--display-config=") for word in words):
        return True
    at = next((n for n, w in enumerate(words) if w in ("-d", "--display-config")), len(words))
    return len(words) > at + 1 and words[at + 1].strip() != ""
