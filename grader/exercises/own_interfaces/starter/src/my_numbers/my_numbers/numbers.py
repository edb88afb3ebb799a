"""Send numbers and add them, with interfaces of your own. Fill in the TODOs."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tutorial_interfaces.msg import Num  # noqa: F401  you will need it


class Numbers(Node):
    """Publishes Num, serves AddThreeInts."""

    def __init__(self):
        super().__init__("numbers")
        # TODO 3: publish a Num on topic twice a second, from 0.
        # TODO 4: serve add_three_ints, with AddThreeInts of tutorial_interfaces.srv.


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
