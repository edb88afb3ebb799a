"""Clockwise, on a small circle, faster; swings by sine, a head that wraps at half a turn."""

import math

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState
from tf2_ros.transform_broadcaster import TransformBroadcaster


class Walker(Node):
    def __init__(self):
        super().__init__("walker")
        self.pub = self.create_publisher(JointState, "/joint_states", 10)
        self.br = TransformBroadcaster(self)
        self.t0 = self.get_clock().now()
        self.timer = self.create_timer(0.02, self.tick)

    def tick(self):
        now = self.get_clock().now()
        t = (now - self.t0).nanoseconds * 1e-9
        js = JointState()
        js.header.stamp = now.to_msg()
        js.name = ["tilt", "periscope", "swivel"]
        swivel = -1.5 * t
        js.position = [
            0.4 * math.sin(1.2 * t),
            0.1 + 0.1 * math.cos(2 * t),
            math.atan2(math.sin(swivel), math.cos(swivel)),
        ]
        js.velocity = [0.48 * math.cos(1.2 * t), -0.2 * math.sin(2 * t), -1.5]
        a = -0.3 * t
        tf = TransformStamped()
        tf.header = js.header
        tf.header.frame_id = "odom"
        tf.child_frame_id = "axis"
        tf.transform.translation.x = 1.0 + 0.8 * math.cos(a)
        tf.transform.translation.y = -1.0 + 0.8 * math.sin(a)
        tf.transform.translation.z = 0.68
        yaw = a - math.pi / 2
        tf.transform.rotation.z = -math.sin(yaw / 2)
        tf.transform.rotation.w = -math.cos(yaw / 2)
        self.br.sendTransform([tf])
        self.pub.publish(js)


def main():
    rclpy.init()
    node = Walker()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
