"""A right solution that asks its watch in one loop: no timer, the last pose kept in a list."""

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

seen = []


def quarter_of(x, y, half=5.544445):
    if x < half:
        if y < half:
            return "south west"
        return "north west"
    return "south east" if y < half else "north east"


inks = {
    "north east": (255, 160, 0),
    "north west": (160, 0, 255),
    "south west": (0, 160, 160),
    "south east": (10, 10, 10),
}

rclpy.init()
node = rclpy.create_node("looper")
node.create_subscription(Pose, "/turtle1/pose", seen.append, 10)
commands = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
ink = node.create_client(SetPen, "/turtle1/set_pen")
ink.wait_for_service()

due, pace, last = 0, 0.0, ""
while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=0.05)
    if not seen:
        continue
    here = seen.pop()
    seen.clear()
    if not 0.7 < here.x < 10.4 or not 0.7 < here.y < 10.4:
        break
    quarter = quarter_of(here.x, here.y)
    if quarter != last:
        red, green, blue = inks[quarter]
        ink.call_async(SetPen.Request(r=red, g=green, b=blue, width=3))
        last = quarter
    now = node.get_clock().now().nanoseconds
    if now >= due:
        due = now + 300_000_000
        pace = pace + 0.045
        move = Twist()
        move.angular.z = -1.3
        move.linear.x = pace
        commands.publish(move)

commands.publish(Twist())
rclpy.spin(node)
