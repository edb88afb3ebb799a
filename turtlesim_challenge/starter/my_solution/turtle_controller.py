"""Draw a spiral in four colours and stop near the edge.

As it stands, the node starts, listens and does nothing. Fill in the three TODOs. In the folder that
holds package.xml:
Try it:      python3 -m my_solution.turtle_controller     (with a turtlesim running)
Judge it:    grader run .
"""

import rclpy
from geometry_msgs.msg import Twist  # noqa: F401  you will need it in drive()
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen  # noqa: F401  you will need it in watch()


class TurtleController(Node):
    """Drives turtle1 along a spiral."""

    def __init__(self):
        super().__init__("turtle_controller")
        # TODO 1: create a publisher of Twist on /turtle1/cmd_vel
        #         and a client of the service /turtle1/set_pen (type SetPen).
        self.create_subscription(Pose, "/turtle1/pose", self.watch, 10)
        self.create_timer(0.5, self.drive)

    def drive(self):
        """Called twice a second."""
        # TODO 2: publish a Twist: angular.z constant (1.0), linear.x a little larger
        #         each time (0.05, 0.10, 0.15, ...). Once stopped, drive no more.

    def watch(self, pose: Pose):
        """Called with every pose of the turtle: pose.x and pose.y go from 0 to 11.09 metres."""
        # TODO 3: near an edge (half a metre from it, say), stop: publish an empty Twist.
        #         On entering another quarter of the window, call set_pen once with its colour.
        #         Any four will do that an eye tells apart: white, red, green and blue, say.


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
