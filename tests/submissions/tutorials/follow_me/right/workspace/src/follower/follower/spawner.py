"""ros2 run follower spawner NAME X Y"""
import sys

import rclpy
from rclpy.utilities import remove_ros_args
from turtlesim.srv import Spawn


def main():
    rclpy.init()
    name, x, y = remove_ros_args(sys.argv)[1:4]
    node = rclpy.create_node("spawner")
    client = node.create_client(Spawn, "/spawn")
    client.wait_for_service()
    future = client.call_async(Spawn.Request(name=name, x=float(x), y=float(y)))
    future.add_done_callback(lambda f: node.get_logger().info(f"{f.result().name} is there"))
    rclpy.spin_until_future_complete(node, future)
    rclpy.shutdown()
