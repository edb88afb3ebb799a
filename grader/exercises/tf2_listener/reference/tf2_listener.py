"""Have one turtle follow another."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, TransformException, TransformListener
from turtlesim.srv import Spawn


class Follower(Node):
    """Looks up where a frame is, and drives turtle2 there."""

    def __init__(self):
        super().__init__("turtle_tf2_frame_listener")
        self.target = self.declare_parameter("target_frame", "turtle1").value
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(Twist, "turtle2/cmd_vel", 10)
        spawn = self.create_client(Spawn, "spawn")
        spawn.wait_for_service()
        spawn.call_async(Spawn.Request(x=4.0, y=2.0, name="turtle2"))
        self.create_timer(1.0, self.follow)

    def follow(self):
        """Send a command that drives turtle2 to the target, as turtle2 sees it."""
        try:
            found = self.buffer.lookup_transform("turtle2", self.target, Time())
        except TransformException as error:
            self.get_logger().info(f"Not yet: {error}")
            return
        place = found.transform.translation
        twist = Twist()
        twist.linear.x = 0.5 * math.hypot(place.x, place.y)
        twist.angular.z = math.atan2(place.y, place.x)
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
