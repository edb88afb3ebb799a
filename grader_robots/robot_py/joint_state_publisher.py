"""The node joint_state_publisher: /joint_states for joints without a controller."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from rcl_interfaces.msg import ParameterDescriptor, ParameterType
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from grader_robots.robot_py import joint_states
from grader_robots.robot_py.joint_states import (
    JointStateOptions,
    JointStates,
    NodeEnded,
    UnusableDescription,
    Values,
)
from turtlesim_py.ros import program
from turtlesim_py.ros.rclcpp_node import UnusableStart

#: Printed by --help.
ABOUT = """\
Say of every joint of robot_description where it is: at its zero, or where a source says. With a
file's name, its description is taken at once.
    joint_state_publisher [robot.urdf]

parameters:
    rate                         messages a second (10)
    source_list                  topics with joint states to take over; not joint_states itself
    zeros.JOINT                  a joint's zero, where it is not 0 or the middle of its limits
    delta                        go on by so much with each message (0.0)
    publish_default_positions    (true) publish_default_velocities (false)
    publish_default_efforts      (false)
    use_mimic_tags               (true) use_smallest_joint_limits (true)
    use_sim_time                 follow /clock (false)"""
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: Name, default and type, in the original's order.
PARAMETERS: tuple[tuple[str, Any, int], ...] = (
    ("publish_default_efforts", False, ParameterType.PARAMETER_BOOL),
    ("publish_default_positions", True, ParameterType.PARAMETER_BOOL),
    ("publish_default_velocities", False, ParameterType.PARAMETER_BOOL),
    ("rate", 10, ParameterType.PARAMETER_INTEGER),
    ("source_list", [], ParameterType.PARAMETER_STRING_ARRAY),
    ("use_mimic_tags", True, ParameterType.PARAMETER_BOOL),
    ("use_smallest_joint_limits", True, ParameterType.PARAMETER_BOOL),
    ("delta", 0.0, ParameterType.PARAMETER_DOUBLE),
)


#: A type -> how its values are written on the command line.
IN_WORDS: dict[type, str] = {bool: "true or false", list: "a list of topics"}


def is_number(value: object) -> bool:
    """Whether it is a number, and not just true or false."""
    return isinstance(value, int | float) and not isinstance(value, bool)


class JointStatePublisher(Node):
    """The node `/joint_state_publisher`.

    Args:
        arguments: without those of ROS; the first may be a file with the description.

    Raises:
        UnusableStart: a parameter or the file cannot be used.
    """

    def __init__(self, arguments: Sequence[str] = ()) -> None:
        try:
            super().__init__(
                "joint_state_publisher", automatically_declare_parameters_from_overrides=True
            )
        except ValueError as error:  # rclpy's, of an empty list, which has no type
            raise UnusableStart(f"a parameter cannot be used: {error}") from None
        for name, default, kind in PARAMETERS:
            # overrides are declared already, with any type, as in the original
            if not self.has_parameter(name):
                self.declare_parameter(name, default, ParameterDescriptor(type=kind))
        self._joints = JointStates(self._options())
        if arguments:
            self._configure_from(arguments[0])
        else:
            self.get_logger().info(joint_states.WAITING)
        self.create_subscription(String, "robot_description", self._on_description, LATCHED)
        for topic in self._value("source_list"):
            self.create_subscription(JointState, topic, self._on_source, 10)
        self._publisher = self.create_publisher(JointState, "joint_states", 10)
        rate = self._value("rate")
        if rate <= 0:
            raise UnusableStart(f"parameter rate is {rate}, expected a number above 0")
        self.create_timer(1.0 / rate, self._on_timer)

    def _value(self, name: str) -> Any:
        """Return a parameter's value; a number may be whole or not, as in the original."""
        value = self.get_parameter(name).value
        default = next(default for known, default, _ in PARAMETERS if known == name)
        fits = is_number(value) if is_number(default) else type(value) is type(default)
        if not fits:
            expected = "a number" if is_number(default) else IN_WORDS[type(default)]
            raise UnusableStart(f"parameter {name} is {value!r}, expected {expected}")
        return value

    def _options(self) -> JointStateOptions:
        below = self.get_parameters_by_prefix
        zeros = {name: parameter.value for name, parameter in below("zeros").items()}
        rules = {name: parameter.value for name, parameter in below("dependent_joints").items()}
        for name, value in zeros.items():
            if not is_number(value):
                raise UnusableStart(f"parameter zeros.{name} is {value!r}, expected a number")
        try:
            dependent = joint_states.dependences(rules)
        except ValueError as error:
            raise UnusableStart(str(error)) from None
        names = [name for name, _, _ in PARAMETERS if name not in ("rate", "source_list")]
        values = {name: self._value(name) for name in names}
        return JointStateOptions(zeros=zeros, dependent_joints=dependent, **values)

    def _configure_from(self, path: str) -> None:
        try:
            self._joints.configure(Path(path).read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, UnusableDescription) as error:
            raise UnusableStart(f"{path}: {error}") from None

    def _on_description(self, message: Any) -> None:
        try:
            self._joints.configure(message.data)
        except UnusableDescription as error:
            self.get_logger().warning(str(error))

    def _on_source(self, message: Any) -> None:
        values = Values(message.name, message.position, message.velocity, message.effort)
        try:
            self._joints.hear(values)
        except NodeEnded as error:
            self._end(error)

    def _on_timer(self) -> None:
        message = JointState()
        message.header.stamp = self.get_clock().now().to_msg()
        try:
            values = self._joints.tick()
        except NodeEnded as error:
            self._end(error)
        if values is None:
            return
        message.name, message.position = values.names, values.positions
        message.velocity, message.effort = values.velocities, values.efforts
        self._publisher.publish(message)

    def _end(self, why: NodeEnded) -> NoReturn:
        self.get_logger().error(str(why))
        sys.exit(1)


def main(argv: list[str] | None = None) -> int:
    """Run until SIGINT or SIGTERM; 2 where arguments or parameters cannot be used."""
    arguments = remove_ros_args(sys.argv if argv is None else argv)[1:]
    create = partial(JointStatePublisher, arguments)
    return program.run("joint_state_publisher", create, program.spin, argv, ABOUT)


if __name__ == "__main__":
    sys.exit(main())
