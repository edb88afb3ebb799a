"""Pass on the newest value of a sensor. Fill in the two TODOs."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: F401  you need them
from std_msgs.msg import Float32


class SensorRelay(Node):
    """Hears scan, sends latest."""

    def __init__(self):
        super().__init__("sensor_relay")
        # TODO 1: create a publisher of Float32 on latest: reliable, transient local, depth 1.
        # TODO 2: create a subscription to scan that calls relay(). Its publisher may be best
        #         effort: a subscription that asks for more hears nothing.

    def relay(self, message: Float32):
        """Called with each value: pass it on."""
        self.publisher.publish(message)


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(SensorRelay())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
