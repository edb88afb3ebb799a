import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from std_msgs.msg import Float32


class SensorRelay(LifecycleNode):
    def on_configure(self, state):
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.latest = self.create_lifecycle_publisher(Float32, "latest", qos)
        self.create_subscription(
            Float32, "scan", lambda msg: self.latest.publish(msg), qos_profile_sensor_data
        )
        return TransitionCallbackReturn.SUCCESS


def main():
    rclpy.init()
    node = SensorRelay("sensor_relay")
    node.trigger_configure()
    node.trigger_activate()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
