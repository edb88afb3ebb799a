import numpy as np
import rclpy
from my_robot_interfaces.msg import Turtle, TurtleArray
from my_robot_interfaces.srv import CatchTurtle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from turtlesim.srv import Kill, Spawn

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class TurtleSpawner(Node):
    def __init__(self):
        super().__init__("turtle_spawner")
        self.rng = np.random.default_rng()
        self.turtles = TurtleArray()
        group = ReentrantCallbackGroup()
        self.spawner = self.create_client(Spawn, "spawn", callback_group=group)
        self.killer = self.create_client(Kill, "kill", callback_group=group)
        self.pub = self.create_publisher(TurtleArray, "alive_turtles", LATCHED)
        self.srv = self.create_service(CatchTurtle, "catch_turtle", self.catch)
        self.timer = self.create_timer(3.0, self.spawn)

    async def spawn(self):
        if len(self.turtles.turtles) >= 10:
            return
        x, y = self.rng.uniform(0.5, 10.5, 2)
        turtle = Turtle(name=f"prey_{self.rng.integers(1_000_000)}", x=float(x), y=float(y))
        await self.spawner.call_async(Spawn.Request(name=turtle.name, x=turtle.x, y=turtle.y))
        self.turtles.turtles.append(turtle)
        self.pub.publish(self.turtles)

    async def catch(self, request, response):
        await self.killer.call_async(Kill.Request(name=request.turtle.name))
        left = [each for each in self.turtles.turtles if each.name != request.turtle.name]
        self.turtles.turtles = left
        self.pub.publish(self.turtles)
        response.left = self.turtles
        return response


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(TurtleSpawner())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
