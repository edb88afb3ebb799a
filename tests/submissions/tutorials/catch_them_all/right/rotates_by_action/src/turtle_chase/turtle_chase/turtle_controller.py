import math

import rclpy
from geometry_msgs.msg import Twist, Vector3
from my_robot_interfaces.msg import TurtleArray
from my_robot_interfaces.srv import CatchTurtle
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class TurtleController(Node):
    """Idle -> turning (by turtlesim's action) -> driving -> idle."""

    def __init__(self):
        super().__init__("turtle_controller")
        self.state = "idle"
        self.target = None
        self.pose = None
        self.turtles = []
        self.rotate = ActionClient(self, RotateAbsolute, "turtle1/rotate_absolute")
        self.catch = self.create_client(CatchTurtle, "catch_turtle")
        self.pub = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)
        self.create_subscription(TurtleArray, "alive_turtles", self.on_turtles, LATCHED)

    def on_turtles(self, msg):
        self.turtles = msg.turtles

    def on_pose(self, pose):
        self.pose = pose
        if self.state == "idle" and self.turtles:
            self.target = min(self.turtles, key=self.distance)
            self.turn()
        elif self.state == "driving":
            self.drive()

    def turn(self):
        self.state = "turning"
        goal = RotateAbsolute.Goal()
        goal.theta = self.bearing()
        self.rotate.wait_for_server()
        self.rotate.send_goal_async(goal).add_done_callback(self.on_accepted)

    def on_accepted(self, future):
        future.result().get_result_async().add_done_callback(self.on_turned)

    def on_turned(self, future):
        self.state = "driving"

    def drive(self):
        left = self.distance(self.target)
        if left < 0.45:
            self.pub.publish(Twist())
            self.state = "catching"
            future = self.catch.call_async(CatchTurtle.Request(turtle=self.target))
            future.add_done_callback(self.on_caught)
            return
        steer = math.remainder(self.bearing() - self.pose.theta, 2 * math.pi)
        self.pub.publish(
            Twist(linear=Vector3(x=min(3.0, 3 * left)), angular=Vector3(z=4.0 * steer))
        )

    def on_caught(self, future):
        self.turtles = future.result().left.turtles
        self.state = "idle"

    def distance(self, turtle):
        return math.hypot(turtle.x - self.pose.x, turtle.y - self.pose.y)

    def bearing(self):
        return math.atan2(self.target.y - self.pose.y, self.target.x - self.pose.x)


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(TurtleController())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
