from threading import Thread

import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node('minimal_publisher')
    pub = node.create_publisher(String, 'topic', 10)
    Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    rate = node.create_rate(2)
    i = 0
    try:
        while rclpy.ok():
            msg = String()
            msg.data = f'Hello World: {i}'
            node.get_logger().info(f'Publishing: "{msg.data}"')
            pub.publish(msg)
            i += 1
            rate.sleep()
    except KeyboardInterrupt:
        pass
