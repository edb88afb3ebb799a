"""Drive turtle1 to the nearest turtle, again and again."""

import json
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String
from turtlesim.msg import Pose

REACH_M = 0.4


class TurtleController(Node):
    """Drives turtle1 to the nearest of alive_turtles, and says which it has caught."""

    def __init__(self):
        super().__init__("turtle_controller")
        self.pose, self.alive = None, {}
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.publisher = self.create_publisher(String, "caught_turtle", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.see, 10)
        self.create_subscription(String, "alive_turtles", self.hear, 10)
        self.create_timer(0.05, self.drive)

    def see(self, pose):
        """Keep where turtle1 is."""
        self.pose = pose

    def hear(self, message):
        """Keep which turtles live."""
        self.alive = json.loads(message.data)

    def drive(self):
        """Drive on to the nearest turtle."""
        twist = Twist()
        if self.pose is not None and self.alive:
            name = min(self.alive, key=self.distance)
            x, y = self.alive[name]
            turn = math.atan2(y - self.pose.y, x - self.pose.x) - self.pose.theta
            turn = math.remainder(turn, 2 * math.pi)
            if self.distance(name) < REACH_M:
                del self.alive[name]
                self.publisher.publish(String(data=name))
            else:
                twist.linear.x = 2.0 * self.distance(name) * max(0.0, math.cos(turn))
                twist.angular.z = 6.0 * turn
        self.velocity.publish(twist)

    def distance(self, name):
        """Return how far a turtle is."""
        x, y = self.alive[name]
        return math.hypot(x - self.pose.x, y - self.pose.y)


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(TurtleController())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
