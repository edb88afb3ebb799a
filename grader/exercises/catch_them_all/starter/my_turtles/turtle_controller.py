"""Drive turtle1 to the nearest turtle, again and again. Fill in the TODOs."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose


class TurtleController(Node):
    """Drives turtle1 to the nearest turtle that lives."""

    def __init__(self):
        super().__init__("turtle_controller")
        self.pose = None
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.see, 10)
        self.create_timer(0.05, self.drive)
        # TODO 4: hear which turtles live, and where.

    def see(self, pose):
        """Keep where turtle1 is."""
        self.pose = pose

    def drive(self):
        """Called twenty times a second."""
        # TODO 5: turn to the nearest turtle, drive to it, and say when it is caught.
        self.velocity.publish(Twist())


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
