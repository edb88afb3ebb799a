import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, qos_profile_sensor_data
from std_msgs.msg import Float32


class SensorRelay(Node):
    def __init__(self):
        super().__init__("sensor_relay")
        self.create_subscription(Float32, "scan", self.on_scan, qos_profile_sensor_data)
        latched = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
        self.latest = self.create_publisher(Float32, "latest", latched)

    def on_scan(self, msg):
        self.latest.publish(Float32(data=msg.data))
        self.get_logger().info(f"{msg.data}")


def main():
    rclpy.init()
    try:
        rclpy.spin(SensorRelay())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
