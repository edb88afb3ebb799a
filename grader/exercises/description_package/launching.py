"""What the launch files describe: a robot_state_publisher, what moves its joints, and RViz."""

from __future__ import annotations

import re
from typing import NamedTuple

from grader.exercise.verdict import Finding
from grader.exercises.description_package.looked import Looked, how_it_ends, not_judged, shown
from grader.language.phrase import joined, say
from grader.scenes.package.examining.known import FILES, KNOWN, SIMULATORS
from grader.scenes.package.launch_errors import advice
from grader.scenes.package.trace import Launch, Node
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
    if broken:
        launch = broken[0]
        assert launch.problem is not None
        return Finding(
            min(share, BROKEN) if launch.file != best else 0.0,
            say("{what_happens}.", what_happens=how_it_ends(launch.file, launch.problem)),
            advice(launch.problem.text),
        )
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
    first, *others = (part.rationale for part in found[best])
    texts = joined([first, *(say("{fault!u}", fault=each) for each in others)], " ")
    return Finding(share, say("{file}: {faults}", file=best, faults=texts), found[best][0].help)


def lacking(looked: Looked, launch: Launch) -> list[Part]:
    """What of the three parts a launch file does not have."""
    parts = []
    publishers = [node for node in launch.nodes if is_publisher(node)]
    texts = [
        looked.text(p.text) for n in publishers for p in n.parameters if is_description(p.name)
    ]
    if not publishers:
        parts.append(
            Part(
                DESCRIPTION,
                say("it starts no robot_state_publisher."),
                say("Start it with the parameter robot_description: the text of your URDF."),
            )
        )
    elif not any(text.strip() for text in texts) and not _is_refused(looked, launch):
        parts.append(_no_description(publishers[0]))
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


def _is_refused(looked: Looked, launch: Launch) -> bool:
    """Whether it would hand on a description, if xacro made one of the file."""
    return any(each.by == launch.file and each.problem for each in looked.descriptions)


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


def _no_description(node: Node) -> Part:
    names = [each.name for each in node.parameters]
    found = (
        say("its parameters are {names}.", names=shown(", ".join(names)))
        if names
        else say("it gets no parameter.")
    )
    return Part(
        DESCRIPTION,
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
