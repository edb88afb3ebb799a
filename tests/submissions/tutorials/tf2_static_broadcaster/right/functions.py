import math
import sys

import rclpy
from geometry_msgs.msg import TransformStamped
from tf2_ros import StaticTransformBroadcaster

rclpy.init(args=sys.argv)
name = sys.argv[1]
x, y, z, roll, pitch, yaw = map(float, sys.argv[2:8])

node = rclpy.create_node("static_turtle_tf2_broadcaster")
broadcaster = StaticTransformBroadcaster(node)

t = TransformStamped()
t.header.stamp = node.get_clock().now().to_msg()
t.header.frame_id = "world"
t.child_frame_id = name
t.transform.translation.x = x
t.transform.translation.y = y
t.transform.translation.z = z
a, b, c = roll / 2, pitch / 2, yaw / 2
q = t.transform.rotation
q.x = math.sin(a) * math.cos(b) * math.cos(c) - math.cos(a) * math.sin(b) * math.sin(c)
q.y = math.cos(a) * math.sin(b) * math.cos(c) + math.sin(a) * math.cos(b) * math.sin(c)
q.z = math.cos(a) * math.cos(b) * math.sin(c) - math.sin(a) * math.sin(b) * math.cos(c)
q.w = math.cos(a) * math.cos(b) * math.cos(c) + math.sin(a) * math.sin(b) * math.sin(c)
broadcaster.sendTransform(t)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
