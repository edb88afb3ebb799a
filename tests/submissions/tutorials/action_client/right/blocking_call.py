"""send_goal, which blocks, while a thread spins."""

import threading

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def spin(executor):
    try:
        executor.spin()
    except ExternalShutdownException:
        pass


def main():
    rclpy.init()
    node = Node("fibonacci_client")
    client = ActionClient(node, Fibonacci, "fibonacci")
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    thread = threading.Thread(target=spin, args=(executor,), daemon=True)
    thread.start()

    def on_feedback(msg):
        node.get_logger().info(f"Received feedback: {msg.feedback.sequence}")

    client.wait_for_server()
    answer = client.send_goal(Fibonacci.Goal(order=10), feedback_callback=on_feedback)
    node.get_logger().info(f"Result: {answer.result.sequence}")
    rclpy.shutdown()
    thread.join()


if __name__ == "__main__":
    main()
