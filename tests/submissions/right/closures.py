"""One function, with the callbacks inside it."""

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


def run() -> None:
    rclpy.init()
    node = rclpy.create_node("spiral")
    velocity = node.create_publisher(Twist, "turtle1/cmd_vel", 10)
    pen = node.create_client(SetPen, "turtle1/set_pen")

    linear = 0.2
    last = (False, False)
    is_first = True
    at_wall = False

    def send(x: float, z: float) -> None:
        twist = Twist()
        twist.linear.x = x
        twist.angular.z = z
        velocity.publish(twist)

    def step() -> None:
        nonlocal linear
        if at_wall:
            return
        send(linear, 1.0)
        linear += 0.06

    def watch(pose: Pose) -> None:
        nonlocal last, is_first, at_wall
        if at_wall:
            return
        distance = min(pose.x, pose.y, 11.09 - pose.x, 11.09 - pose.y)
        if distance < 1.0:
            at_wall = True
            send(0.0, 0.0)
            node.get_logger().info("done")
            return
        side = (pose.x > 5.54, pose.y > 5.54)
        if is_first or side != last:
            is_first = False
            last = side
            red = 255 if side[0] else 0
            green = 255 if side[1] else 0
            request = SetPen.Request(r=red, g=green, b=0, width=2, off=0)
            pen.call_async(request)

    node.create_subscription(Pose, "turtle1/pose", watch, 10)
    node.create_timer(0.25, step)
    rclpy.spin(node)


if __name__ == "__main__":
    run()
