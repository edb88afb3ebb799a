"""A timer, a parameter, an executor of several threads, and a listener that looks at its own robot, as newer pages do it."""

from math import cos, pi, sin

import rclpy
from geometry_msgs.msg import Quaternion
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import JointState
from tf2_ros import (
    Buffer,
    TransformBroadcaster,
    TransformException,
    TransformListener,
    TransformStamped,
)


class StatePublisher(Node):
    def __init__(self):
        super().__init__("state_publisher")
        self.declare_parameter("rate", 60.0)
        self.joint_pub = self.create_publisher(JointState, "joint_states", 10)
        self.broadcaster = TransformBroadcaster(self, qos=10)
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.step = 0
        self.timer = self.create_timer(1 / self.get_parameter("rate").value, self.update)
        self.create_timer(5.0, self.look)

    def update(self):
        degree = pi / 360
        now = self.get_clock().now().to_msg()
        swing = abs((self.step % 240) - 120) / 120
        state = JointState()
        state.header.stamp = now
        state.name = ["swivel", "tilt", "periscope"]
        state.position = [self.step * degree, -0.5 * swing, 0.2 * swing]
        odom = TransformStamped()
        odom.header.stamp = now
        odom.header.frame_id = "odom"
        odom.child_frame_id = "axis"
        angle = self.step * degree / 4
        odom.transform.translation.x = cos(angle) * 2
        odom.transform.translation.y = sin(angle) * 2
        odom.transform.translation.z = 0.7
        odom.transform.rotation = Quaternion(
            z=sin((angle + pi / 2) / 2), w=cos((angle + pi / 2) / 2)
        )
        self.joint_pub.publish(state)
        self.broadcaster.sendTransform(odom)
        self.step += 1

    def look(self):
        try:
            found = self.buffer.lookup_transform("odom", "box", Time())
            self.get_logger().info(f"the box is at {found.transform.translation.z:.2f} m")
        except TransformException as error:
            self.get_logger().warn(str(error))


def main():
    try:
        rclpy.init()
        node = StatePublisher()
        executor = MultiThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
