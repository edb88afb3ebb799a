"""A loop that sleeps, numpy, motions as classes, velocities too, clockwise, w of a quaternion below 0."""

import time
from abc import ABC, abstractmethod

import numpy as np
import rclpy
from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
from rclpy.node import Node
from sensor_msgs.msg import JointState
from tf2_ros import TransformBroadcaster


class Motion(ABC):
    def __init__(self, name):
        self.name = name

    @abstractmethod
    def at(self, t): ...


class Turn(Motion):
    def at(self, t):
        return np.remainder(-1.7 * t, 2 * np.pi), -1.7


class Swing(Motion):
    def __init__(self, name, low, high, period):
        super().__init__(name)
        self.middle, self.wide, self.speed = (low + high) / 2, (high - low) / 2, 2 * np.pi / period

    def at(self, t):
        phase = self.speed * t
        return self.middle - self.wide * np.cos(phase), self.wide * self.speed * np.sin(phase)


class Robot(Node):
    MOTIONS = (Turn("swivel"), Swing("tilt", -0.5, 0, 4), Swing("periscope", 0, 0.2, 6))

    def __init__(self, hz=20):
        super().__init__("robot")
        self.hz = hz
        self.states = self.create_publisher(JointState, "joint_states", 1)
        self.broadcaster = TransformBroadcaster(self)
        self.start = time.time()

    def run(self):
        while rclpy.ok():
            self.publish(time.time() - self.start)
            rclpy.spin_once(self, timeout_sec=0)
            time.sleep(1 / self.hz)

    def publish(self, t):
        message = JointState(name=[motion.name for motion in self.MOTIONS])
        message.header.stamp = self.get_clock().now().to_msg()
        message.position, message.velocity = np.array([m.at(t) for m in self.MOTIONS]).T
        self.states.publish(message)
        angle = -0.25 * t
        sent = TransformStamped()
        sent.header.stamp = message.header.stamp
        sent.header.frame_id, sent.child_frame_id = "odom", "axis"
        sent.transform.translation = Vector3(x=3 * np.cos(angle), y=3 * np.sin(angle), z=1.0)
        half = angle / 2 - np.pi / 4
        sent.transform.rotation = Quaternion(x=0.0, y=0.0, z=-np.sin(half), w=-np.cos(half))
        self.broadcaster.sendTransform(sent)


def main():
    rclpy.init()
    Robot().run()
