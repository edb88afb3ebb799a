import rclpy
from std_msgs.msg import String

texts = []


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('minimal_subscriber')
    node.create_subscription(String, 'topic', lambda msg: texts.append(msg.data), 10)
    try:
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=0.1)
            while texts:
                node.get_logger().info('I heard: "%s"' % texts.pop(0))
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()
