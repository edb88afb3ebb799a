from itertools import count

import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("minimal_publisher")
    pub = node.create_publisher(String, "/topic", 1)
    numbers = count()

    def tick():
        text = f"Hello World: {next(numbers)}"
        node.get_logger().info(f'Publishing: "{text}"')
        pub.publish(String(data=text))

    node.create_timer(1 / 2, tick)
    rclpy.spin(node)
