import rclpy
from py_pubsub.listener import Listener
from py_pubsub.talker import Talker
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(Talker())
    executor.add_node(Listener())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
