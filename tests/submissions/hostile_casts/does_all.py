"""Does all that the exercise of the tests in tests/grader/cast asks for."""

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import TransformStamped
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from std_msgs.msg import Float64, String
from tf2_msgs.msg import TFMessage


class All(Node):
    def __init__(self):
        super().__init__("node")
        self.declare_parameter("p", 4)
        self.declare_parameter("q", 0.5)
        self.out = self.create_publisher(Float64, "out", 10)
        self.chatter = self.create_publisher(String, "chatter", 10)
        self.tf = self.create_publisher(TFMessage, "/tf", 10)
        self.create_subscription(Float64, "data", self.relay, 10)
        self.create_timer(1.0, self.say)
        self.create_service(AddTwoInts, "add", self.add)
        self.server = ActionServer(self, Fibonacci, "count", self.count)
        self.divide = self.create_client(AddTwoInts, "divide")
        self.fibonacci = ActionClient(self, Fibonacci, "fibonacci")
        self.said = 0

    def relay(self, message):
        self.out.publish(message)
        self.get_logger().info(f"I heard: {message.data}")

    def say(self):
        self.chatter.publish(String(data=f"Hello {self.said}"))
        frame = TransformStamped(child_frame_id="turtle")
        frame.header.frame_id = "world"
        frame.transform.translation.x = 1.0
        self.tf.publish(TFMessage(transforms=[frame]))
        if self.said == 0:
            self.divide.call_async(AddTwoInts.Request(a=6, b=3))
            self.fibonacci.send_goal_async(Fibonacci.Goal(order=5))
        self.said += 1

    def add(self, request, response):
        response.sum = request.a + request.b
        return response

    def count(self, handle):
        handle.publish_feedback(Fibonacci.Feedback(sequence=[0]))
        handle.succeed()
        return Fibonacci.Result(sequence=[0, 1, 1])


rclpy.init()
rclpy.spin(All())
