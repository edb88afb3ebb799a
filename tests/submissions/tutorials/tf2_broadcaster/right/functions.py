from math import cos, sin

import rclpy
from geometry_msgs.msg import Quaternion, TransformStamped
from tf2_ros import TransformBroadcaster
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("turtle_tf2_frame_publisher")
turtle = node.declare_parameter("turtlename", "turtle1").value
broadcaster = TransformBroadcaster(node)


def on_pose(pose):
    t = TransformStamped()
    t.header.stamp = node.get_clock().now().to_msg()
    t.header.frame_id = "world"
    t.child_frame_id = turtle
    t.transform.translation.x = pose.x
    t.transform.translation.y = pose.y
    t.transform.rotation = Quaternion(z=sin(pose.theta / 2), w=cos(pose.theta / 2))
    broadcaster.sendTransform([t])


node.create_subscription(Pose, "/" + turtle + "/pose", on_pose, 10)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
