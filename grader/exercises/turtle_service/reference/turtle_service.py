"""Have a turtle draw the polygon that a caller asks for."""

import math
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtle_exercise_interfaces.srv import DrawPolygon

PERIOD_S = 0.1  # from one command to the next; without any, a turtle stops after a second


class PolygonServer(Node):
    """Serves draw_polygon."""

    def __init__(self):
        super().__init__("polygon_server")
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_service(DrawPolygon, "draw_polygon", self.draw)

    def draw(self, request, response):
        """Draw the polygon, then answer."""
        if request.sides < 3:
            response.success = False
            response.message = f"A polygon has three sides or more, not {request.sides}."
            return response
        for _ in range(request.sides):
            self.drive(request.length, 0.0)
            self.drive(0.0, 2 * math.pi / request.sides)
        response.success = True
        response.message = f"Drew {request.sides} sides of {request.length} m."
        return response

    def drive(self, way: float, turn: float):
        """Drive a way [m] or make a turn [rad], in two seconds, and stop."""
        twist = Twist()
        twist.linear.x = way / 2.0
        twist.angular.z = turn / 2.0
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
