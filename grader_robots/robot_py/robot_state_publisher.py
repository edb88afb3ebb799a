"""The node robot_state_publisher: /robot_description, /tf_static, and /tf from /joint_states."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
from rcl_interfaces.msg import SetParametersResult
from rclpy.logging import get_logger
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, qos_profile_sensor_data
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState as JointStateMessage
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from grader_robots.robot_py import robot_state
from grader_robots.robot_py.robot_state import (
    NodeLog,
    Parameters,
    Placed,
    RefusedDescription,
    Robot,
    RobotState,
)
from turtlesim_py.ros import program
from turtlesim_py.ros.rclcpp_node import RclcppNode, UnusableStart

#: Printed by --help.
ABOUT = """\
Tell where the links of a robot are: its description on robot_description, its fixed joints on
/tf_static, and on /tf those that joint_states names.
    robot_state_publisher --ros-args -p robot_description:="$(cat robot.urdf)"

parameters:
    robot_description   the URDF itself, not a file's name
    publish_frequency   so many messages a second on /tf at most, by their stamps (20.0)
    frame_prefix        stands before every frame's name
    ignore_timestamp    publish whatever the stamp (false)
    use_sim_time        follow /clock (false)"""
NS_PER_S = 1_000_000_000
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: What of a publisher's quality may be overridden.
OVERRIDABLE = (QoSPolicyKind.DEPTH, QoSPolicyKind.HISTORY, QoSPolicyKind.RELIABILITY)
PARSER = "urdf_xml_parser/URDFXMLParser"


class RobotStatePublisher(RclcppNode):
    """The node `/robot_state_publisher`.

    Args:
        arguments: without those of ROS; the first may be a file with the description.

    Raises:
        UnusableStart: the description or publish_frequency cannot be used.
        UnusableParameter: a parameter is of another type.
    """

    def __init__(self, arguments: Sequence[str] = ()) -> None:
        super().__init__("robot_state_publisher")
        description = self.declare("robot_description", "", "") or self._from_file(arguments)
        frequency = self.declare("publish_frequency", 20.0, "")
        if not robot_state.is_usable_frequency(frequency):
            raise UnusableStart(robot_state.FREQUENCY_AT_START)
        prefix = self.declare("frame_prefix", "", "")
        parameters = Parameters(frequency, prefix, self.declare("ignore_timestamp", False, ""))
        self._tf = self.create_publisher(
            TFMessage,
            "/tf",
            QoSProfile(depth=100),
            qos_overriding_options=QoSOverridingOptions((*OVERRIDABLE, QoSPolicyKind.DURABILITY)),
        )
        self._tf_static = self.create_publisher(
            TFMessage,
            "/tf_static",
            LATCHED,
            qos_overriding_options=QoSOverridingOptions(OVERRIDABLE),
        )
        self._description = self.create_publisher(String, "robot_description", LATCHED)
        #: all that were sent on /tf_static, by frame; none ever goes, not even with its robot
        self._static_frames: dict[str, Placed] = {}
        try:
            self._state = RobotState(self._read(description), parameters)
        except RefusedDescription as error:
            raise UnusableStart(str(error)) from None
        self._publish_description()
        self.create_subscription(
            JointStateMessage,
            "joint_states",
            self._on_joint_state,
            qos_profile_sensor_data,
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )
        self._publish_fixed()
        self.add_on_set_parameters_callback(self._check)
        self.add_post_set_parameters_callback(self._on_parameters)

    # The robot --------------------------------------------------------------------------------

    def _from_file(self, arguments: Sequence[str]) -> str:
        if not arguments:
            self._fail(robot_state.MISSING)
        self.get_logger().warning(robot_state.FROM_FILE)
        try:
            text = Path(arguments[0]).read_text(encoding="utf-8", errors="surrogateescape")
        except OSError:
            self._fail(robot_state.UNREADABLE.format(arguments[0]))
        self.set_parameters([Parameter("robot_description", value=text)])
        return text

    def _fail(self, text: str) -> NoReturn:
        self.get_logger().fatal(text)
        raise UnusableStart(text)

    def _read(self, description: str) -> Robot:
        """Read a description; print what urdfdom, urdf and kdl_parser print of it."""
        try:
            robot = Robot.of(description)
        except RefusedDescription as error:
            for found in error.findings:
                print(found, file=sys.stderr)
            if str(error) == robot_state.UNUSABLE:
                print(f"Failed to parse robot description using: {PARSER}", file=sys.stderr)
            raise
        for found in robot.findings:
            print(found, file=sys.stderr)
        self._log(robot.logs)
        return robot

    def _publish_description(self) -> None:
        self._description.publish(String(data=self._state.robot.description))
        self.get_logger().info(robot_state.INITIALIZED)

    def _publish_fixed(self) -> None:
        now_ns = self.get_clock().now().nanoseconds
        fixed = self._state.robot.fixed(self._state.parameters.frame_prefix, now_ns)
        self._static_frames.update((one.child_frame, one) for one in fixed)
        self._tf_static.publish(tf_message(list(self._static_frames.values())))

    # Joint states -----------------------------------------------------------------------------

    def _on_joint_state(self, message: Any) -> None:
        stamp = message.header.stamp
        stamp_ns = stamp.sec * NS_PER_S + stamp.nanosec
        state = robot_state.JointState(stamp_ns, message.name, message.position)
        heard = self._state.hear(state, self.get_clock().now().nanoseconds)
        self._log(heard.logs)
        if heard.transforms is not None:
            self._tf.publish(tf_message(heard.transforms))

    # Parameters -------------------------------------------------------------------------------

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            if reason := self._problem(parameter):
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def _problem(self, parameter: Parameter) -> str:
        if parameter.name == "publish_frequency":
            fits = robot_state.is_usable_frequency(parameter.value)
            return "" if fits else robot_state.FREQUENCY
        if parameter.name != "robot_description":
            return ""
        if not parameter.value:
            return robot_state.EMPTY
        try:
            self._read(parameter.value)
        except RefusedDescription as error:
            self.get_logger().warning(str(error))
            return str(error)
        return ""

    def _on_parameters(self, parameters: list[Parameter]) -> None:
        new = {parameter.name: parameter.value for parameter in parameters}
        changed = {field.name: new[field.name] for field in fields(Parameters) if field.name in new}
        self._state.parameters = replace(self._state.parameters, **changed)
        if "robot_description" in new:
            self._state.set_robot(Robot.of(new["robot_description"]))
            self._publish_description()
            self._publish_fixed()

    def _log(self, logs: Sequence[NodeLog]) -> None:
        for log in logs:
            logger = get_logger(log.logger) if log.logger else self.get_logger()
            # one call a severity: rclpy refuses a call site that changes its severity
            if log.severity == "WARN":
                logger.warning(log.text)
            else:
                logger.error(log.text)


def tf_message(transforms: Sequence[Placed]) -> TFMessage:
    """Return the transforms as a ROS message."""
    message = TFMessage()
    for one in transforms:
        sent = TransformStamped(child_frame_id=one.child_frame)
        sent.header.frame_id = one.frame
        sent.header.stamp.sec, sent.header.stamp.nanosec = divmod(one.stamp_ns, NS_PER_S)
        sent.transform.translation = Vector3(**dict(zip("xyz", one.translation, strict=True)))
        sent.transform.rotation = Quaternion(**dict(zip("xyzw", one.rotation, strict=True)))
        message.transforms.append(sent)
    return message


def main(argv: list[str] | None = None) -> int:
    """Run until SIGINT or SIGTERM; 2 where description or parameters cannot be used."""
    arguments = remove_ros_args(sys.argv if argv is None else argv)[1:]
    create = partial(RobotStatePublisher, arguments)
    return program.run("robot_state_publisher", create, program.spin, argv, ABOUT)


if __name__ == "__main__":
    sys.exit(main())
