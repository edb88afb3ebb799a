"""Drive turtle1 with the keyboard: the original's turtle_teleop_key.

The letter keys lie around F as the headings lie around the turtle: G is right, R is up, and so on.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.action import ActionClient

from turtlesim_py.programs.keyboard import Keyboard, NotATerminal
from turtlesim_py.ros import program
from turtlesim_py.ros.executor import TickExecutor
from turtlesim_py.ros.rclcpp_node import RclcppNode
from turtlesim_py.ros.turtle_endpoints import TOPIC_QOS

#: The original's words, since 1.8.3 with the keys as a keyboard of Linux gives them.
HELP = """\
Reading from keyboard
---------------------------
Use arrow keys to move the turtle.
Use g|b|v|c|d|e|r|t keys to rotate to absolute orientations. 'f' to cancel a rotation.
'q' to quit.
"""
#: For who asks what the program does.
ABOUT = """\
Drive turtle1 with the keyboard of this terminal: arrow keys drive, the letters round F turn to a
heading, F cancels a turn, Q ends. A turtlesim_node has to be running.

parameters:
    scale_linear     speed ahead and back [m/s] (2.0)
    scale_angular    speed of a turn [rad/s] (2.0)
    interfaces       package of the messages: turtlesim or turtlesim_msgs"""
#: Key -> how far ahead and how far to the left, in units of the scales.
DRIVE = {"up": (1.0, 0.0), "down": (-1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}
#: Key -> absolute heading [rad]; the original's digits.
HEADINGS = {
    "g": 0.0,
    "t": 0.7854,
    "r": 1.5708,
    "e": 2.3562,
    "d": 3.1416,
    "c": -2.3562,
    "v": -1.5708,
    "b": -0.7854,
}
#: Between two looks at what the graph has sent [s].
PAUSE_S = 0.02


class TeleopTurtle(RclcppNode):
    """The node `/teleop_turtle`: turns keys into commands and rotation goals."""

    def __init__(self) -> None:
        super().__init__("teleop_turtle")
        self.declare("scale_angular", 2.0, "Speed of a turn [rad/s]")
        self.declare("scale_linear", 2.0, "Speed ahead and back [m/s]")
        self._velocity = self.create_publisher(Twist, "turtle1/cmd_vel", TOPIC_QOS)
        self._type = self.declare_interfaces().RotateAbsolute
        self._rotation = ActionClient(self, self._type, "turtle1/rotate_absolute")
        self._goal: Any = None  # the future of its handle

    def press(self, key: str) -> None:
        """Do what a key stands for; nothing for the others."""
        if key in DRIVE:
            ahead, left = DRIVE[key]
            twist = Twist()
            twist.linear.x = ahead * self.get_parameter("scale_linear").value
            twist.angular.z = left * self.get_parameter("scale_angular").value
            self._velocity.publish(twist)
        elif key in HEADINGS:
            self._rotate(HEADINGS[key])
        elif key == "f" and self._goal is not None:
            # at once, or as soon as the simulator has accepted it
            self._goal.add_done_callback(lambda goal: goal.result().cancel_goal_async())

    def destroy_node(self) -> None:
        """Leave the graph."""
        self._rotation.destroy()  # rclpy forgets actions
        super().destroy_node()

    def _rotate(self, heading_rad: float) -> None:
        if not self._rotation.server_is_ready():
            self.get_logger().warning("There is no turtle1 here: is turtlesim_node running?")
            return
        self._goal = self._rotation.send_goal_async(self._type.Goal(theta=heading_rad))


def drive(node: TeleopTurtle, stopped: Callable[[], bool]) -> None:
    """Pass on keys until Q is pressed, the terminal is closed, or it is stopped.

    Raises:
        NotATerminal: there are no keys.
    """
    executor = TickExecutor(node)
    with Keyboard(0) as keyboard:
        print(HELP, end="", flush=True)
        while not (stopped() or keyboard.closed):
            for key in keyboard.keys(PAUSE_S):
                if key == "q":
                    return
                node.press(key)
            executor.spin_some()


def main(argv: list[str] | None = None) -> int:
    """Run until Q, SIGINT or SIGTERM; 2 where there is no terminal."""
    try:
        return program.run("turtle_teleop_key", TeleopTurtle, drive, argv, ABOUT)
    except NotATerminal as error:
        print(f"turtle_teleop_key: {error}", file=sys.stderr)
        return program.UNUSABLE


if __name__ == "__main__":
    sys.exit(main())
