"""How a student runs a node beside turtlesim by hand, and sees the turtle: for exercise sheets."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import PurePath

from grader.language.telling import tell
from grader.scenes.by_hand import command

_BESIDE = """\
    turtlesim
    {command}
"""
_WITH_ROS2 = """\
    colcon build && . install/setup.bash
    ros2 run turtlesim_py turtlesim
    ros2 run {package} {name}
"""


def how_to_try(program: str, package: str) -> str:
    """See `grader.scenes.scene.Scene`."""
    name = PurePath(program).stem
    parts = [
        tell("In one terminal the simulator, in another your node:"),
        _BESIDE.format(command=command(program, package)),
    ]
    if package:
        parts += [
            tell("The same with `ros2`, in a workspace that has this folder in its `src`:"),
            _WITH_ROS2.format(package=package, name=name),
        ]
    parts += [tell("To see the turtle:"), "\n".join(_seen())]
    return "\n\n".join(part.strip("\n") for part in parts) + "\n"


def _seen() -> Iterator[str]:
    """What shows the turtle, a point of a list each."""
    points = (
        tell(
            "Every grading leaves `report.html`: the picture, the way, an animation, the speeds "
            "over time. It needs nothing but a browser."
        ),
        tell(
            "`turtlesim` prints the address of a page, on which the turtle draws while your node "
            "drives it. `grader run` with `--live` shows a grading there, and `grader view` plays "
            "it again, tick by tick, with the line of your code behind each command."
        ),
        tell(
            "`turtlesim_node` is the same without a page. With `ros2`, `ros2 run rqt_image_view "
            "rqt_image_view /turtlesim/image` shows the picture, and `ros2 service call "
            "/turtlesim/save_canvas std_srvs/srv/Trigger` writes it as a PNG file."
        ),
        tell(
            "On a desktop with ROS 2, `ros2 run turtlesim turtlesim_node` opens the original's "
            "window; your node drives that turtle as well."
        ),
    )
    for point in points:
        yield textwrap.fill(
            f"- {point}",
            100,
            subsequent_indent="  ",
            break_long_words=False,
            break_on_hyphens=False,
        )
