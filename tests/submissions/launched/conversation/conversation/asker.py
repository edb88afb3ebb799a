"""Waits for a service, asks it three times, and ends."""

import rclpy
from example_interfaces.srv import AddTwoInts


def main():
    rclpy.init()
    node = rclpy.create_node("asker")
    client = node.create_client(AddTwoInts, "add")
    print("there" if client.service_is_ready() else "not yet")
    client.wait_for_service()
    for number in range(3):
        answer = client.call_async(AddTwoInts.Request(a=number, b=number))
        rclpy.spin_until_future_complete(node, answer)
        print(answer.result().sum)
    node.destroy_node()
    rclpy.shutdown()
