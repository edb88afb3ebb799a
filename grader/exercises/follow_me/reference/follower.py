"""Spawn turtle2, and have it follow turtle1."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import Spawn

GAP_M = 1.0


class Follower(Node):
    """Keeps turtle2 behind turtle1."""

    def __init__(self):
        super().__init__("follower")
        self.leader = self.own = None
        self.velocity = self.create_publisher(Twist, "/turtle2/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.see_leader, 10)
        self.create_subscription(Pose, "/turtle2/pose", self.see_own, 10)
        spawning = self.create_client(Spawn, "/spawn")
        spawning.wait_for_service()
        spawning.call_async(Spawn.Request(x=2.0, y=2.0, theta=0.0, name="turtle2"))
        self.create_timer(0.05, self.drive)

    def see_leader(self, pose):
        """Keep where turtle1 is."""
        self.leader = pose

    def see_own(self, pose):
        """Keep where turtle2 is."""
        self.own = pose

    def drive(self):
        """Drive to the place behind turtle1."""
        if self.leader is None or self.own is None:
            return
        x = self.leader.x - GAP_M * math.cos(self.leader.theta)
        y = self.leader.y - GAP_M * math.sin(self.leader.theta)
        way = math.hypot(x - self.own.x, y - self.own.y)
        turn = math.atan2(y - self.own.y, x - self.own.x) - self.own.theta
        turn = math.remainder(turn, 2 * math.pi)
        twist = Twist()
        if way > 0.1:
            twist.linear.x = 3.0 * way * max(0.0, math.cos(turn))
            twist.angular.z = 5.0 * turn
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
