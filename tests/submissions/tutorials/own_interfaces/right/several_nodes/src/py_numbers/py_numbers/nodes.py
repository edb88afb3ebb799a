"""A node that sends, a node that serves, and one that uses the Sphere."""

import rclpy
from geometry_msgs.msg import Point
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from tutorial_interfaces.msg import Num, Sphere
from tutorial_interfaces.srv import AddThreeInts


class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.numbers = iter(range(1_000_000))
        self.publisher = self.create_publisher(Num, "topic", 10)
        self.create_timer(0.5, self.send)

    def send(self):
        self.publisher.publish(Num(num=next(self.numbers)))


class Adder(Node):
    def __init__(self):
        super().__init__("adder")
        self.create_service(AddThreeInts, "add_three_ints", self.add)

    async def add(self, request, response):
        response.sum = sum((request.a, request.b, request.c))
        return response


class Spheres(Node):
    def __init__(self):
        super().__init__("spheres")
        self.publisher = self.create_publisher(Sphere, "sphere", 10)
        self.create_timer(1.0, self.send)

    def send(self):
        self.publisher.publish(Sphere(center=Point(x=1.0, y=2.0, z=3.0), radius=0.5))


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    nodes = [Counter(), Adder(), Spheres()]
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()
