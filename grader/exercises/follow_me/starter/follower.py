"""Spawn turtle2, and have it follow turtle1. Fill in the TODOs."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import Spawn


class Follower(Node):
    """Keeps turtle2 behind turtle1."""

    def __init__(self):
        super().__init__("follower")
        self.leader = None
        self.velocity = self.create_publisher(Twist, "/turtle2/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.see_leader, 10)
        self.spawning = self.create_client(Spawn, "/spawn")
        # TODO 1: wait for the service, and spawn turtle2.
        # TODO 2: keep where turtle2 is, too.
        self.create_timer(0.05, self.drive)

    def see_leader(self, pose):
        """Keep where turtle1 is."""
        self.leader = pose

    def drive(self):
        """Called twenty times a second."""
        twist = Twist()
        # TODO 3: drive towards turtle1, and keep a metre behind it.
        self.velocity.publish(twist)


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(Follower())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
