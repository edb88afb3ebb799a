import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor


def run(node_class, args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    node = node_class()
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
