import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.executors import ExternalShutdownException


def fibonacci(order):
    numbers = [0, 1]
    while len(numbers) <= order:
        numbers.append(sum(numbers[-2:]))
        yield numbers


def execute(handle):
    numbers = [0, 1]
    for numbers in fibonacci(handle.request.order):
        handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
    handle.succeed()
    return Fibonacci.Result(sequence=numbers)


rclpy.init()
node = rclpy.create_node("fibonacci")
server = ActionServer(node, Fibonacci, "/fibonacci", execute)
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
