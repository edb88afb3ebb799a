"""How a student runs a node beside a robot by hand, and sees it move: for exercise sheets."""

from __future__ import annotations

from pathlib import PurePath

from grader.scenes.by_hand import command

_RUN = """\
In one terminal `robot_state_publisher` with the robot's description, in another your node:

    ros2 run robot_state_publisher robot_state_publisher \
--ros-args -p robot_description:="$(cat FILE.urdf)"
    {command}
"""
_WITH_PACKAGE = """\
The same from your package, in a workspace that has this folder in its `src`:

    colcon build && . install/setup.bash
    ros2 run {package} {name}
"""
_SEE = """\
To see the robot:

- Every grading leaves `report.html`: the robot's way from above and its joints over time. It needs
  nothing but a browser.
- On a desktop with ROS 2, `rviz2`, with the Fixed Frame `odom` and a RobotModel display on the
  topic `/robot_description`. A link that stays white and lies at the origin has no transform.
- `ros2 topic echo /joint_states` and `ros2 run tf2_tools view_frames` show what your node sends.
"""


def how_to_try(program: str, package: str) -> str:
    """See `grader.scenes.scene.Scene`."""
    name = PurePath(program).stem
    with_package = _WITH_PACKAGE.format(package=package, name=name) if package else ""
    run = _RUN.format(command=command(program, package))
    return "\n".join(part for part in (run, with_package, _SEE) if part)
