import random

import rclpy
from geometry_msgs.msg import Pose2D
from my_robot_interfaces.msg import Turtle, TurtleArray
from my_robot_interfaces.srv import CatchTurtle
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from turtlesim.srv import Kill, Spawn

SIZE = 11.08


class Spawner(Node):
    def __init__(self):
        super().__init__("spawner")
        self.declare_parameters("", [("period", 2.0), ("max_alive", 5), ("margin", 1.0)])
        self.turtles: dict[str, Turtle] = {}
        clients = ReentrantCallbackGroup()
        self.spawn_client = self.create_client(Spawn, "/spawn", callback_group=clients)
        self.kill_client = self.create_client(Kill, "/kill", callback_group=clients)
        self.pub = self.create_publisher(TurtleArray, "alive_turtles", 10)
        work = MutuallyExclusiveCallbackGroup()
        self.create_service(CatchTurtle, "catch_turtle", self.on_catch, callback_group=work)
        self.create_timer(self.get_parameter("period").value, self.on_spawn, callback_group=work)
        self.create_timer(0.1, self.on_publish)

    def on_publish(self):
        msg = TurtleArray(turtles=list(self.turtles.values()))
        msg.header.stamp = self.get_clock().now().to_msg()
        self.pub.publish(msg)

    def on_spawn(self):
        if len(self.turtles) >= self.get_parameter("max_alive").value:
            return
        margin = self.get_parameter("margin").value
        pose = Pose2D(
            x=random.uniform(margin, SIZE - margin),
            y=random.uniform(margin, SIZE - margin),
            theta=random.uniform(-3.14, 3.14),
        )
        self.spawn_client.wait_for_service()
        response = self.spawn_client.call(Spawn.Request(x=pose.x, y=pose.y, theta=pose.theta))
        self.turtles[response.name] = Turtle(name=response.name, pose=pose)

    def on_catch(self, request, response):
        if request.name not in self.turtles:
            response.message = f"there is no {request.name}"
            return response
        self.kill_client.call(Kill.Request(name=request.name))
        del self.turtles[request.name]
        response.success = True
        return response


def main():
    rclpy.init()
    node = Spawner()
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
