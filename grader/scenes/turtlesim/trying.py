"""How a student runs a node beside turtlesim by hand, and sees the turtle: for exercise sheets."""

from __future__ import annotations

from pathlib import PurePath

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
    path = PurePath(program)
    in_package = bool(package) and len(path.parts) > 1
    module = ".".join(path.with_suffix("").parts)
    # as it is graded: a package's own modules are found by the package's name
    command = f"python3 -m {module}" if in_package else f"python3 {program}"
    with_ros2 = _WITH_ROS2.format(package=package, name=path.stem) if package else ""
    return "\n".join(part for part in (_RUN.format(command=command), with_ros2, _SEE) if part)
