"""A right solution in functions alone: one dictionary for what it knows, closures for callbacks."""

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

MIDDLE, REACH = 5.5444, 4.8
PALETTE = [(200, 30, 30), (30, 200, 30), (30, 30, 200), (220, 220, 0)]


def far_out(pose):
    return max(abs(pose.x - MIDDLE), abs(pose.y - MIDDLE)) > REACH


def corner(pose):
    return 2 * int(pose.y > MIDDLE) + int(pose.x > MIDDLE)


def request(number):
    wanted = SetPen.Request()
    wanted.r, wanted.g, wanted.b = PALETTE[number]
    wanted.width = 5
    return wanted


def velocity(step):
    message = Twist()
    message.linear.x = 0.08 * step
    message.angular.z = 1.5
    return message


def main():
    rclpy.init()
    node = rclpy.create_node("functional")
    wheel = node.create_publisher(Twist, "/turtle1/cmd_vel", 1)
    brush = node.create_client(SetPen, "/turtle1/set_pen")
    knows = {"steps": 0, "corner": -1, "over": False}

    def forward():
        if knows["over"]:
            return
        knows["steps"] += 1
        wheel.publish(velocity(knows["steps"]))

    def look(pose):
        if not knows["over"] and far_out(pose):
            knows["over"] = True
            wheel.publish(Twist())
        if not knows["over"] and corner(pose) != knows["corner"]:
            knows["corner"] = corner(pose)
            brush.call_async(request(corner(pose)))

    brush.wait_for_service()
    node.create_subscription(Pose, "/turtle1/pose", look, 1)
    node.create_timer(0.25, forward)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
