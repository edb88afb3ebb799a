"""Spawn turtles for turtle1 to catch, and kill those that it has caught."""

import json
import random

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String
from turtlesim.srv import Kill, Spawn

PERIOD_S = 2.0
MOST = 8


class TurtleSpawner(Node):
    """Spawns turtles, and says which live on alive_turtles."""

    def __init__(self):
        super().__init__("turtle_spawner")
        self.alive = {}  # name -> [x, y]
        self.spawning = self.create_client(Spawn, "/spawn")
        self.killing = self.create_client(Kill, "/kill")
        self.publisher = self.create_publisher(String, "alive_turtles", 10)
        self.create_subscription(String, "caught_turtle", self.caught, 10)
        self.spawning.wait_for_service()
        self.create_timer(PERIOD_S, self.spawn)

    def spawn(self):
        """Spawn the next turtle somewhere, unless there are many."""
        if len(self.alive) >= MOST:
            return
        x, y = random.uniform(1.0, 10.0), random.uniform(1.0, 10.0)
        future = self.spawning.call_async(Spawn.Request(x=x, y=y, theta=0.0))
        future.add_done_callback(lambda done: self.spawned(done.result().name, x, y))

    def spawned(self, name, x, y):
        """Say that one more lives."""
        self.alive[name] = [x, y]
        self.say()

    def caught(self, message):
        """Kill the turtle that was caught."""
        if self.alive.pop(message.data, None) is not None:
            self.killing.call_async(Kill.Request(name=message.data))
            self.say()

    def say(self):
        """Publish which turtles live, and where."""
        self.publisher.publish(String(data=json.dumps(self.alive)))


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(TurtleSpawner())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
