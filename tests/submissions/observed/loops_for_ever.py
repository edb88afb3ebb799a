"""A loop without end in a callback; what it calls takes some of the time."""

import rclpy
from rclpy.node import Node


def add(numbers):
    total = 0
    for number in numbers:
        total += number
    return total


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.create_timer(0.1, self.work)

    def work(self):
        numbers = list(range(20))
        while add(numbers) > 0:
            if numbers:
                numbers = numbers[::-1]


rclpy.init()
rclpy.spin(Controller())
