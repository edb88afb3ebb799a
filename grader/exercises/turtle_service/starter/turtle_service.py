"""Have a turtle draw the polygon that a caller asks for. Fill in the four TODOs."""

import math  # noqa: F401  you will need it
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtle_exercise_interfaces.srv import DrawPolygon  # noqa: F401  you will need it

PERIOD_S = 0.1  # from one command to the next; without any, a turtle stops after a second


class PolygonServer(Node):
    """Serves draw_polygon."""

    def __init__(self):
        super().__init__("polygon_server")
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        # TODO 1: create the service draw_polygon, of type DrawPolygon, that calls draw().

    def draw(self, request, response):
        """Called with each request: request.sides and request.length."""
        # TODO 2: fewer than three sides are no polygon: say so in response.message, and return
        #         the response with success false.
        # TODO 3: drive each side, and turn in each corner.
        response.success = True
        return response

    def drive(self, way: float, turn: float):
        """Drive a way [m] or make a turn [rad], in two seconds, and stop."""
        twist = Twist()
        # TODO 4: which speeds are these? Set twist.linear.x [m/s] and twist.angular.z [rad/s].
        for _ in range(round(2.0 / PERIOD_S)):
            self.publisher.publish(twist)
            time.sleep(PERIOD_S)
        self.publisher.publish(Twist())


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(PolygonServer())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
