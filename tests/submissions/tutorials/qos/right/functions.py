import rclpy
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from std_msgs.msg import Float32

rclpy.init()
node = rclpy.create_node("sensor_relay")

qos = QoSProfile(depth=1)
qos.reliability = rclpy.qos.ReliabilityPolicy.RELIABLE
qos.durability = rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL
publisher = node.create_publisher(Float32, "/latest", qos)

best_effort = QoSProfile(depth=5, reliability=QoSReliabilityPolicy.BEST_EFFORT)
node.create_subscription(Float32, "/scan", publisher.publish, best_effort)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
