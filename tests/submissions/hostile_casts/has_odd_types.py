"""Publishes what is no message, and several types on one topic, also the peer's."""

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.context import Context
from std_msgs.msg import Float64, String

rclpy.init()
others = Context()
rclpy.init(context=others)
node, other = rclpy.create_node("node"), rclpy.create_node("other", context=others)
feedback = node.create_publisher(Fibonacci.Impl.FeedbackMessage, "big", 10)
request = node.create_publisher(AddTwoInts.Request, "chatter", 10)
texts = other.create_publisher(String, "out", 10)
numbers = node.create_publisher(Float64, "out", 10)
data = other.create_publisher(String, "data", 10)


def say():
    feedback.publish(Fibonacci.Impl.FeedbackMessage())
    request.publish(AddTwoInts.Request())
    texts.publish(String(data="/(/"))
    numbers.publish(Float64(data=1.0))
    data.publish(String(data="x"))


node.create_timer(0.1, say)
rclpy.spin(node)
