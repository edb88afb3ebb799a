import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def speak(node):
    publisher = node.create_publisher(String, 'topic', 10)
    i = 0
    while rclpy.ok():
        msg = String(data='Hello World: ' + str(i))
        publisher.publish(msg)
        node.get_logger().info('Publishing: "' + msg.data + '"')
        i += 1
        time.sleep(0.5)


def main():
    rclpy.init()
    node = rclpy.create_node('minimal_publisher')
    thread = threading.Thread(target=speak, args=(node,), daemon=True)
    thread.start()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
