"""Whether what was handed in is a package that `ros2 run` and `ros2 launch` can start."""

from __future__ import annotations

from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.seen import sentence
from grader.packaged import LaunchDescription, LaunchedNode, Packaged

STATE_PUBLISHER = "robot_state_publisher"
JOINT_SOURCES = ("joint_state_publisher", "joint_state_publisher_gui")
#: What each part of a launch file is worth.
ROBOT, OWN, PLACES = 0.4, 0.4, 0.2


def judge_package(packaged: Packaged | None) -> Finding:
    """Package.xml, setup.py, its console script."""
    if packaged is None:
        return Finding(
            0,
            "It is no package: there is no setup.py around the node.",
            "`ros2 pkg create --build-type ament_python NAME` makes one.",
        )
    if packaged.started and not packaged.shortcomings:
        return Finding(1, f"`ros2 run {packaged.name} {packaged.started}` can start it.")
    return Finding(
        0.5 if packaged.started else 0,
        sentence(list(packaged.shortcomings)),
        "What `ros2 run` starts is a console script in the entry_points of setup.py.",
    )


def judge_launch(packaged: Packaged | None) -> Finding:
    """The launch file that does most of what it should."""
    if packaged is None or not packaged.launches:
        return Finding(
            0,
            "There is no launch file in a package.",
            f"A launch file starts {STATE_PUBLISHER} with the robot's description and your node, "
            "so that nobody has to type both.",
        )
    return max((_judge(each, packaged) for each in packaged.launches), key=lambda f: f.share)


def _judge(launch: LaunchDescription, packaged: Packaged) -> Finding:
    if launch.fault:
        return Finding(
            0,
            f"`ros2 launch` starts nothing of {launch.file}: {launch.fault}.",
            "`python3 FILE` tells of what does not parse; `ros2 launch` of the rest.",
        )
    faults: list[tuple[float, str]] = []
    if why := _robot(launch):
        faults.append((ROBOT, why))
    if why := _own(launch, packaged):
        faults.append((OWN, why))
    if why := _places(launch, packaged):
        faults.append((PLACES, why))
    if not faults:
        return Finding(1, f"{launch.file} starts {STATE_PUBLISHER} and your node.")
    return Finding(
        1 - sum(cost for cost, _ in faults),
        f"{launch.file}: {'; '.join(why for _, why in faults)}.",
        f"It takes two nodes: {STATE_PUBLISHER} with the parameter robot_description, and yours, "
        "by the names of your package and of its console script. What they need is installed by "
        "data_files in setup.py.",
    )


def _robot(launch: LaunchDescription) -> str:
    nodes = [node for node in launch.nodes if _may_be(node, STATE_PUBLISHER, (STATE_PUBLISHER,))]
    described = [n for n in nodes if n.parameters is None or "robot_description" in n.parameters]
    if described or (launch.includes and not nodes):
        return ""
    if nodes:
        return f"{STATE_PUBLISHER} gets no parameter robot_description, and ends at once"
    return f"it does not start {STATE_PUBLISHER}"


def _own(launch: LaunchDescription, packaged: Packaged) -> str:
    others = [node.executable for node in launch.nodes if node.executable in JOINT_SOURCES]
    if others:
        return f"it starts {others[0]} as well, which sends other joint states beside your node's"
    if any(_may_be(node, packaged.name, packaged.scripts) for node in launch.nodes):
        return ""
    for node in launch.nodes:
        if node.executable in packaged.scripts:
            return (
                f"it starts {node.executable} of the package {node.package!r:.60}; yours is called "
                f"{packaged.name!r:.60}"
            )
        if node.package == packaged.name:
            return f"your package has no executable {node.executable!r:.60}"
    return "it does not start your node"


def _may_be(node: LaunchedNode, package: str, executables: tuple[str, ...]) -> bool:
    is_package = node.package is None or node.package == package
    return is_package and (node.executable is None or node.executable in executables)


def _places(launch: LaunchDescription, packaged: Packaged) -> str:
    if launch.absolute:
        return f"the path {launch.absolute[0]!r:.80} is there on one computer only"
    if not launch.is_installed:
        return "setup.py does not install it"
    if packaged.not_installed:
        return f"setup.py does not install {packaged.not_installed[0]}"
    return ""
