"""A coroutine that the executor runs."""

import sys

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


async def ask(node, client, a, b):
    response = await client.call_async(AddTwoInts.Request(a=a, b=b))
    node.get_logger().info(f"Result of add_two_ints: for {a} + {b} = {response.sum}")


def main(args=None):
    rclpy.init(args=args)
    numbers = [int(text) for text in rclpy.utilities.remove_ros_args(sys.argv)[1:]]
    node = Node("client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    client.wait_for_service()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    task = executor.create_task(ask, node, client, *numbers)
    executor.spin_until_future_complete(task)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
