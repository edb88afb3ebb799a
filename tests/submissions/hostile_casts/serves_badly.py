"""Never answers, answers twice, sends feedback without end, and destroys what a peer talks to."""

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Float64


class Bad(Node):
    def __init__(self):
        super().__init__("node")
        self.make()
        self.create_subscription(Float64, "data", self.got, 10)
        self.server = ActionServer(self, Fibonacci, "count", self.count)

    def make(self):
        self.out = self.create_publisher(Float64, "out", 10)
        self.slow = self.create_client(AddTwoInts, "slow")
        self.add = self.create_service(AddTwoInts, "add", self.answer)
        self.fibonacci = ActionClient(self, Fibonacci, "fibonacci")

    def got(self, message):
        self.destroy_publisher(self.out)
        self.destroy_client(self.slow)
        self.destroy_service(self.add)
        self.fibonacci.destroy()
        self.make()
        self.out.publish(message)
        self.slow.call_async(AddTwoInts.Request(a=1, b=1))
        self.fibonacci.send_goal_async(Fibonacci.Goal(order=0))

    async def answer(self, request, response):
        await Future()
        return response

    def count(self, handle):
        for _ in range(300):
            handle.publish_feedback(Fibonacci.Feedback(sequence=[0] * 1000))
        if handle.request.order == 3:
            self.server.destroy()
        handle.succeed()
        return Fibonacci.Result(sequence=[0, 1, 1])


rclpy.init()
rclpy.spin(Bad())
