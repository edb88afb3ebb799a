from math import atan2, cos, hypot, sin

import rclpy
from geometry_msgs.msg import Twist
from my_robot_interfaces.msg import TurtleArray
from my_robot_interfaces.srv import CatchTurtle
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.declare_parameter("reach", 0.4)
        self.declare_parameter("gain_linear", 1.0)
        self.declare_parameter("gain_angular", 4.0)
        self.turtles = []
        self.caught = set()
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 1)
        self.client = self.create_client(CatchTurtle, "catch_turtle")
        self.create_subscription(TurtleArray, "alive_turtles", self.on_turtles, 1)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 1)

    def on_turtles(self, msg):
        self.turtles = [turtle for turtle in msg.turtles if turtle.name not in self.caught]

    def on_pose(self, me):
        if not self.turtles:
            self.pub.publish(Twist())
            return

        def way(turtle):
            return hypot(turtle.pose.x - me.x, turtle.pose.y - me.y)

        target = min(self.turtles, key=way)
        if way(target) < self.get_parameter("reach").value:
            self.catch(target)
            return
        error = atan2(target.pose.y - me.y, target.pose.x - me.x) - me.theta
        error = atan2(sin(error), cos(error))
        cmd = Twist()
        cmd.angular.z = self.get_parameter("gain_angular").value * error
        if abs(error) < 0.5:
            cmd.linear.x = max(1.0, self.get_parameter("gain_linear").value * way(target))
        self.pub.publish(cmd)

    def catch(self, turtle):
        self.pub.publish(Twist())
        self.caught.add(turtle.name)
        self.turtles.remove(turtle)
        future = self.client.call_async(CatchTurtle.Request(name=turtle.name))
        future.add_done_callback(self.on_caught)

    def on_caught(self, future):
        if not future.result().success:
            self.get_logger().warning(future.result().message)


def main():
    rclpy.init()
    try:
        rclpy.spin(Controller())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
