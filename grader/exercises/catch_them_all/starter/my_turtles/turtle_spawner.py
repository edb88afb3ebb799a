"""Spawn turtles for turtle1 to catch, and kill those that it has caught. Fill in the TODOs."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.srv import Kill, Spawn

PERIOD_S = 2.0


class TurtleSpawner(Node):
    """Spawns turtles, and tells which live."""

    def __init__(self):
        super().__init__("turtle_spawner")
        self.spawning = self.create_client(Spawn, "/spawn")
        self.killing = self.create_client(Kill, "/kill")
        self.create_timer(PERIOD_S, self.spawn)
        # TODO 1: tell the other node which turtles live, and where: on a topic of yours.
        # TODO 2: hear of it which it has caught, and kill that one.

    def spawn(self):
        """Called every two seconds."""
        # TODO 3: unless ten live, spawn one somewhere: self.spawning.call_async(...).


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
