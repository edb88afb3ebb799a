"""A thread spins, the main one loops with a rate of 20 Hz; a numpy angle, a helper for quaternions."""

import threading

import numpy as np
import rclpy
from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from tf2_ros import TransformBroadcaster


def yaw_to_quaternion(yaw):
    return Quaternion(x=0.0, y=0.0, z=float(np.sin(yaw / 2)), w=float(np.cos(yaw / 2)))


def triangle(phase, low, high):
    phase = phase % 2.0
    return low + (high - low) * (phase if phase < 1 else 2 - phase)


def main():
    rclpy.init()
    node = rclpy.create_node("mover")
    thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    thread.start()
    joints = node.create_publisher(JointState, "joint_states", 10)
    broadcaster = TransformBroadcaster(node)
    rate = node.create_rate(20)
    step = 0
    while rclpy.ok():
        stamp = node.get_clock().now().to_msg()
        joints.publish(
            JointState(
                header=Header(stamp=stamp),
                name=["periscope", "swivel", "tilt"],
                position=[
                    triangle(step / 50, 0.0, 0.3),
                    0.03 * step,
                    triangle(step / 40, -1.0, 0.5),
                ],
            )
        )
        angle = 0.02 * step
        transform = TransformStamped(
            header=Header(stamp=stamp, frame_id="odom"), child_frame_id="axis"
        )
        transform.transform.translation = Vector3(
            x=float(3 * np.cos(angle)), y=float(3 * np.sin(angle)), z=0.9
        )
        transform.transform.rotation = yaw_to_quaternion(angle + np.pi / 2)
        broadcaster.sendTransform(transform)
        step += 1
        rate.sleep()


if __name__ == "__main__":
    main()
