"""Send numbers and add them, with interfaces of our own."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tutorial_interfaces.msg import Num
from tutorial_interfaces.srv import AddThreeInts


class Numbers(Node):
    """Publishes Num, serves AddThreeInts."""

    def __init__(self):
        super().__init__("numbers")
        self.publisher = self.create_publisher(Num, "topic", 10)
        self.count = 0
        self.create_timer(0.5, self.send)
        self.create_service(AddThreeInts, "add_three_ints", self.add)

    def send(self):
        """Send the next number."""
        self.publisher.publish(Num(num=self.count))
        self.count += 1

    def add(self, request, response):
        """Answer with the sum."""
        response.sum = request.a + request.b + request.c
        return response


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(Numbers())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
