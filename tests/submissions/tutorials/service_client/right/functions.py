import sys

import rclpy
from example_interfaces.srv import AddTwoInts

a = int(sys.argv[1])
b = int(sys.argv[2])

rclpy.init(args=sys.argv)
node = rclpy.create_node("client")
client = node.create_client(AddTwoInts, "add_two_ints")
client.wait_for_service()
future = client.call_async(AddTwoInts.Request(a=a, b=b))
while not future.done():
    rclpy.spin_once(node)
node.get_logger().info(f"Result of add_two_ints: for {a} + {b} = {future.result().sum}")
rclpy.shutdown()
