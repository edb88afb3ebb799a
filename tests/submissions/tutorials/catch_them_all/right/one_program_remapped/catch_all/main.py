import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

from .hunter import Hunter
from .nest import Nest


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    for node in (Nest(), Hunter()):
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
