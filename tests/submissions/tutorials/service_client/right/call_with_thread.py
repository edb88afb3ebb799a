"""The call that blocks, while another thread spins."""

import sys
import threading

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


def spin(executor):
    try:
        executor.spin()
    except ExternalShutdownException:
        pass


def main():
    rclpy.init()
    node = Node("client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    spinner = threading.Thread(target=spin, args=(executor,), daemon=True)
    spinner.start()

    while not client.wait_for_service(timeout_sec=0.5):
        node.get_logger().warn("The service is not there yet")
    request = AddTwoInts.Request()
    request.a, request.b = (int(text) for text in sys.argv[1:3])
    response = client.call(request)
    node.get_logger().info(
        f"Result of add_two_ints: for {request.a} + {request.b} = {response.sum}"
    )
    rclpy.shutdown()
    spinner.join()


if __name__ == "__main__":
    main()
