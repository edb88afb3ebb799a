import math
import sys

import rclpy
from geometry_msgs.msg import Quaternion, TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode
from tf2_ros import StaticTransformBroadcaster


def quaternion(roll, pitch, yaw):
    cx, cy, cz = (math.cos(angle / 2) for angle in (roll, pitch, yaw))
    sx, sy, sz = (math.sin(angle / 2) for angle in (roll, pitch, yaw))
    return Quaternion(
        x=sx * cy * cz - cx * sy * sz,
        y=cx * sy * cz + sx * cy * sz,
        z=cx * cy * sz - sx * sy * cz,
        w=cx * cy * cz + sx * sy * sz,
    )


class StaticFrame(LifecycleNode):
    def on_activate(self, state):
        self.broadcaster = StaticTransformBroadcaster(self)
        t = TransformStamped()
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = "world"
        t.child_frame_id = sys.argv[1]
        p = t.transform.translation
        p.x, p.y, p.z = (float(text) for text in sys.argv[2:5])
        t.transform.rotation = quaternion(*(float(text) for text in sys.argv[5:8]))
        self.broadcaster.sendTransform(t)
        return super().on_activate(state)


def main():
    rclpy.init()
    node = StaticFrame("static_turtle_tf2_broadcaster")
    node.trigger_configure()
    node.trigger_activate()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
