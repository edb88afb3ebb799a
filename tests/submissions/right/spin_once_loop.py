# drives the turtle in a loop and asks for news with spin_once
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

TOPIC_VEL = "/turtle1/cmd_vel"
TOPIC_POSE = "/turtle1/pose"
SERVICE_PEN = "/turtle1/set_pen"

ANGULAR = 1.0
STEP = 0.05
PERIOD = 0.2


class Listener(Node):
    def __init__(self):
        super().__init__("spiral_loop")
        self.x = None
        self.y = None
        self.vel = self.create_publisher(Twist, TOPIC_VEL, 10)
        self.pen = self.create_client(SetPen, SERVICE_PEN)
        self.create_subscription(Pose, TOPIC_POSE, self.listen, 10)

    def listen(self, pose):
        self.x = pose.x
        self.y = pose.y

    def quadrant(self):
        right = self.x > 5.544
        top = self.y > 5.544
        if top and right:
            return 0
        elif top:
            return 1
        elif right:
            return 3
        else:
            return 2

    def is_close_to_wall(self):
        return self.x < 0.7 or self.y < 0.7 or self.x > 10.4 or self.y > 10.4


def main():
    rclpy.init()
    node = Listener()
    node.pen.wait_for_service(timeout_sec=5.0)
    colors = [[255, 255, 255], [255, 100, 0], [0, 0, 0], [0, 255, 0]]
    old = -1
    speed = 0.0
    last = time.time()
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.1)
        if node.x is None:
            continue
        if node.is_close_to_wall():
            node.vel.publish(Twist())
            print("stop at", node.x, node.y)
            break
        if node.quadrant() != old:
            old = node.quadrant()
            color = colors[old]
            request = SetPen.Request()
            request.r = color[0]
            request.g = color[1]
            request.b = color[2]
            request.width = 3
            request.off = 0
            node.pen.call_async(request)
        if time.time() - last >= PERIOD:
            last = time.time()
            speed += STEP
            twist = Twist()
            twist.linear.x = speed
            twist.angular.z = ANGULAR
            node.vel.publish(twist)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
