import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


def spin(node):
    try:
        rclpy.spin(node)
    except ExternalShutdownException:
        pass


def main():
    rclpy.init()
    node = Node("minimal_publisher")
    pub = node.create_publisher(String, "topic", 10)
    thread = threading.Thread(target=spin, args=(node,), daemon=True)
    thread.start()

    rate = node.create_rate(2)
    number = 0
    try:
        while rclpy.ok():
            rate.sleep()
            msg = String()
            msg.data = "Hello World: {}".format(number)
            pub.publish(msg)
            node.get_logger().info('Publishing: "{}"'.format(msg.data))
            number = number + 1
    except (KeyboardInterrupt, rclpy.exceptions.ROSInterruptException):
        pass
    rclpy.try_shutdown()
    thread.join()


if __name__ == "__main__":
    main()
