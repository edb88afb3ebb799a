import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSPresetProfiles, QoSProfile
from std_msgs.msg import Float32

LATCHED = QoSProfile(depth=1, reliability=1, durability=1)


class SensorRelay(Node):
    def __init__(self):
        super().__init__("sensor_relay")
        self.pub = self.create_publisher(Float32, "latest", LATCHED)
        self.sub = self.create_subscription(
            Float32,
            "scan",
            self.relay,
            QoSPresetProfiles.SENSOR_DATA.value,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def relay(self, scan):
        self.pub.publish(scan)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(SensorRelay())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
