"""A robot of two joints, and something that moves it."""

import math
from collections.abc import Sequence

from grader_robots.robot_py.robot_state import Placed
from grader_robots.scene.driving import Said, joint_state, tf

URDF = """<robot name="two">
  <link name="axis"/><link name="body"/><link name="head"/>
  <joint name="turn" type="continuous">
    <parent link="axis"/><child link="body"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="neck" type="fixed"><parent link="body"/><child link="head"/></joint>
</robot>"""


def walks(tick: int, now_ns: int) -> Sequence[Said]:
    """It turns and goes round in a circle of 1 m, at 31.25 Hz."""
    if tick % 2:
        return ()
    angle = tick / 100
    moved, half = (math.cos(angle), math.sin(angle), 0.5), (angle + math.pi / 2) / 2
    turned = (0.0, 0.0, math.sin(half), math.cos(half))
    return (
        joint_state(now_ns, ["turn"], [angle]),
        tf(Placed(now_ns, "odom", "axis", moved, turned)),
    )
