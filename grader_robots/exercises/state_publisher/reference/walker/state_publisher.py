"""Moves a walking robot: turns its head, tilts its body, pushes its periscope, goes in a circle."""

from math import cos, pi, sin

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from tf2_ros import TransformBroadcaster

RATE = 30.0  # Hz
RADIUS = 2.0  # m
HEIGHT = 0.7  # m
STEP = pi / 180  # rad a message


class StatePublisher(Node):
    def __init__(self):
        super().__init__("state_publisher")
        self.joints = self.create_publisher(JointState, "joint_states", 10)
        self.broadcaster = TransformBroadcaster(self)
        self.tilt, self.tilt_step = 0.0, -STEP
        self.periscope, self.periscope_step = 0.0, 0.005
        self.swivel = 0.0
        self.angle = 0.0
        self.create_timer(1 / RATE, self.update)

    def update(self):
        now = self.get_clock().now().to_msg()
        self.publish_joints(now)
        self.publish_odometry(now)
        self.move()

    def publish_joints(self, now):
        state = JointState()
        state.header.stamp = now
        state.name = ["swivel", "tilt", "periscope"]
        state.position = [self.swivel, self.tilt, self.periscope]
        self.joints.publish(state)

    def publish_odometry(self, now):
        odometry = TransformStamped()
        odometry.header.stamp = now
        odometry.header.frame_id = "odom"
        odometry.child_frame_id = "axis"
        odometry.transform.translation.x = RADIUS * cos(self.angle)
        odometry.transform.translation.y = RADIUS * sin(self.angle)
        odometry.transform.translation.z = HEIGHT
        yaw = self.angle + pi / 2
        odometry.transform.rotation.z = sin(yaw / 2)
        odometry.transform.rotation.w = cos(yaw / 2)
        self.broadcaster.sendTransform(odometry)

    def move(self):
        self.swivel += STEP
        self.tilt += self.tilt_step
        if not -0.5 < self.tilt < 0.0:
            self.tilt_step = -self.tilt_step
        self.periscope += self.periscope_step
        if not 0.0 < self.periscope < 0.2:
            self.periscope_step = -self.periscope_step
        self.angle += STEP / 4


def main():
    rclpy.init()
    try:
        rclpy.spin(StatePublisher())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
