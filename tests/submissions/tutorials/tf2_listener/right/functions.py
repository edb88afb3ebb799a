import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.time import Time
from tf2_ros import Buffer, TransformException, TransformListener
from turtlesim.srv import Spawn

rclpy.init()
node = rclpy.create_node("turtle_tf2_frame_listener")
node.declare_parameter("target_frame", "turtle1")
buffer = Buffer()
listener = TransformListener(buffer, node)

client = node.create_client(Spawn, "/spawn")
client.wait_for_service()
future = client.call_async(Spawn.Request(x=4.0, y=2.0, theta=0.0, name="turtle2"))
rclpy.spin_until_future_complete(node, future)

publisher = node.create_publisher(Twist, "/turtle2/cmd_vel", 10)


def drive():
    target = node.get_parameter("target_frame").value
    try:
        t = buffer.lookup_transform("turtle2", target, Time())
    except TransformException as problem:
        node.get_logger().info(str(problem))
        return
    x, y = t.transform.translation.x, t.transform.translation.y
    msg = Twist()
    msg.linear.x = 0.5 * math.hypot(x, y)
    msg.angular.z = math.atan2(y, x)
    publisher.publish(msg)


node.create_timer(1.0, drive)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
