"""No tf2_ros: TFMessage on /tf by a publisher; a joint state a joint; a sleep in a plain loop."""

import math
import time

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage


def main(args=None):
    rclpy.init(args=args)
    node = Node("states")
    states = node.create_publisher(JointState, "/joint_states", 100)
    tf = node.create_publisher(TFMessage, "/tf", 100)
    began = time.time()
    while rclpy.ok():
        t = time.time() - began
        stamp = node.get_clock().now().to_msg()
        for name, position in (
            ("swivel", t / 2),
            ("tilt", -0.25 + 0.25 * math.sin(t)),
            ("periscope", 0.1 * (1 - math.cos(t))),
        ):
            state = JointState()
            state.header.stamp = stamp
            state.name = [name]
            state.position = [position]
            states.publish(state)
        transform = TransformStamped()
        transform.header.stamp = stamp
        transform.header.frame_id = "odom"
        transform.child_frame_id = "axis"
        transform.transform.translation.x = 2.0 * math.cos(t / 4)
        transform.transform.translation.y = 2.0 * math.sin(t / 4)
        transform.transform.translation.z = 0.7
        yaw = t / 4 + math.pi / 2
        transform.transform.rotation.z = math.sin(yaw / 2)
        transform.transform.rotation.w = math.cos(yaw / 2)
        tf.publish(TFMessage(transforms=[transform]))
        rclpy.spin_once(node, timeout_sec=0)
        time.sleep(0.025)


if __name__ == "__main__":
    main()
