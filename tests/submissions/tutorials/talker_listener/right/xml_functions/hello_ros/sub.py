import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("minimal_subscriber")
    log = node.get_logger()
    node.create_subscription(String, "/topic", lambda msg: log.info(f'I heard: "{msg.data}"'), 1)
    rclpy.spin(node)
