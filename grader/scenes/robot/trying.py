"""How a student runs a node beside a robot by hand, and sees it move: for exercise sheets."""

from __future__ import annotations

from pathlib import PurePath

from grader.language.telling import tell
from grader.scenes.by_hand import command


def how_to_try(program: str, package: str) -> str:
    """See `grader.scenes.scene.Scene`."""
    name = PurePath(program).stem
    with_package = _with_package(package, name) if package else ""
    run = tell(
        "In one terminal `robot_state_publisher` with the robot's description, in another your "
        "node:\n\n"
        "    ros2 run robot_state_publisher robot_state_publisher "
        '--ros-args -p robot_description:="$(cat FILE.urdf)"\n'
        "    {command}\n",
        command=command(program, package),
    )
    return "\n".join(part for part in (run, with_package, _see()) if part)


def _with_package(package: str, name: str) -> str:
    return tell(
        "The same from your package, in a workspace that has this folder in its `src`:\n\n"
        "    colcon build && . install/setup.bash\n"
        "    ros2 run {package} {name}\n",
        package=package,
        name=name,
    )


def _see() -> str:
    return tell(
        "To see the robot:\n\n"
        "- Every grading leaves `report.html`: the robot's way from above and its joints over "
        "time. It needs\n"
        "  nothing but a browser.\n"
        "- On a desktop with ROS 2, `rviz2`, with the Fixed Frame `odom` and a RobotModel display "
        "on the\n"
        "  topic `/robot_description`. A link that stays white and lies at the origin has no "
        "transform.\n"
        "- `ros2 topic echo /joint_states` and `ros2 run tf2_tools view_frames` show what your "
        "node sends.\n"
    )
