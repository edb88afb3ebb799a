import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float32


class SensorRelay(Node):

    def __init__(self):
        super().__init__('sensor_relay')
        scan_qos = QoSProfile(
            depth=10,
            reliability=ReliabilityPolicy.BEST_EFFORT)
        latest_qos = QoSProfile(
            history=HistoryPolicy.KEEP_LAST,
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher_ = self.create_publisher(Float32, 'latest', latest_qos)
        self.subscription = self.create_subscription(
            Float32,
            'scan',
            self.listener_callback,
            latest_qos)

    def listener_callback(self, msg):
        self.publisher_.publish(msg)


def main(args=None):
    rclpy.init(args=args)

    sensor_relay = SensorRelay()

    rclpy.spin(sensor_relay)

    sensor_relay.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
