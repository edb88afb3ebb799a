"""How a student runs a node beside turtlesim by hand, and sees the turtle: for exercise sheets."""

from __future__ import annotations

from pathlib import PurePath

from grader.scenes.by_hand import command

_RUN = """\
In one terminal the simulator, in another your node:

    turtlesim_node
    {command}
"""
_WITH_ROS2 = """\
The same with `ros2`, in a workspace that has this folder in its `src`:

    colcon build && . install/setup.bash
    ros2 run turtlesim_py turtlesim_node
    ros2 run {package} {name}
"""
_SEE = """\
To see the turtle:

- Every grading leaves `report.html`: the picture, the way, an animation, the speeds over time. It
  needs nothing but a browser.
- `turtlesim_node` opens no window. While it goes, `ros2 run rqt_image_view rqt_image_view
  /turtlesim/image` shows the picture, and `ros2 service call /turtlesim/save_canvas
  std_srvs/srv/Trigger` writes it as a PNG file.
- On a desktop with ROS 2, `ros2 run turtlesim turtlesim_node` opens the original's window; your
  node drives that turtle as well.
"""


def how_to_try(program: str, package: str) -> str:
    """See `grader.scenes.scene.Scene`."""
    name = PurePath(program).stem
    with_ros2 = _WITH_ROS2.format(package=package, name=name) if package else ""
    run = _RUN.format(command=command(program, package))
    return "\n".join(part for part in (run, with_ros2, _SEE) if part)
