"""Have one turtle follow another. Fill in the four TODOs."""

import math  # noqa: F401  you will need it

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.time import Time  # noqa: F401  you will need it
from tf2_ros import Buffer, TransformException, TransformListener
from turtlesim.srv import Spawn


class Follower(Node):
    """Looks up where a frame is, and drives turtle2 there."""

    def __init__(self):
        super().__init__("turtle_tf2_frame_listener")
        self.target = "turtle1"  # TODO 1: declare the parameter target_frame, and take its value.
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(Twist, "turtle2/cmd_vel", 10)
        spawn = self.create_client(Spawn, "spawn")
        spawn.wait_for_service()
        # TODO 2: call it: turtle2 at (4, 2). Use call_async(): call() would wait for ever here.
        self.create_timer(1.0, self.follow)

    def follow(self):
        """Called each second: send a command that drives turtle2 to the target."""
        try:
            # TODO 3: look up where the target is for turtle2, with self.buffer.lookup_transform();
            #         Time() stands for the newest.
            pass
        except TransformException as error:
            self.get_logger().info(f"Not yet: {error}")
            return
        twist = Twist()
        # TODO 4: drive faster the farther the target is, and turn by the angle at which it lies,
        #         math.atan2(y, x).
        self.publisher.publish(twist)


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
