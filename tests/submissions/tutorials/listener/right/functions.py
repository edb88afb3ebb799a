import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("minimal_subscriber")
log = node.get_logger()
node.create_subscription(String, "/topic", lambda msg: log.info('I heard: "' + msg.data + '"'), 10)

while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=0.1)
