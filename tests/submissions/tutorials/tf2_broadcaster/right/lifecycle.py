import math

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from tf2_ros import TransformBroadcaster
from turtlesim.msg import Pose


class FramePublisher(LifecycleNode):
    def __init__(self):
        super().__init__("turtle_tf2_frame_publisher")
        self.declare_parameter("turtlename", "turtle1")

    def on_configure(self, state):
        self.turtle = self.get_parameter("turtlename").value
        self.broadcaster = TransformBroadcaster(self)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.sub = self.create_subscription(Pose, f"/{self.turtle}/pose", self.on_pose, 10)
        return super().on_activate(state)

    def on_pose(self, pose):
        t = TransformStamped()
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = "world"
        t.child_frame_id = self.turtle
        t.transform.translation.x = pose.x
        t.transform.translation.y = pose.y
        t.transform.rotation.z = math.sin(pose.theta / 2)
        t.transform.rotation.w = math.cos(pose.theta / 2)
        self.broadcaster.sendTransform(t)


def main():
    rclpy.init()
    node = FramePublisher()
    node.trigger_configure()
    node.trigger_activate()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
