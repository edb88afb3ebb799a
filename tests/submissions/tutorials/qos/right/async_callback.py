import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float32


class Relay(Node):
    def __init__(self):
        super().__init__("sensor_relay")
        self.out = self.create_publisher(
            Float32,
            "latest",
            QoSProfile(
                depth=1,
                durability=DurabilityPolicy.TRANSIENT_LOCAL,
                reliability=ReliabilityPolicy.RELIABLE,
            ),
        )
        self.create_subscription(
            Float32, "scan", self.hear, QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        )

    async def hear(self, msg):
        await self.send(msg.data)

    async def send(self, value):
        self.out.publish(Float32(data=value))


rclpy.init()
try:
    rclpy.spin(Relay())
except (KeyboardInterrupt, ExternalShutdownException):
    pass
