import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.declare_parameter("text", "Hi")
        self.declare_parameter("period", 1.0)
        self.pub = self.create_publisher(String, "chatter", 10)
        self.timer = self.create_timer(self.get_parameter("period").value, self.talk)
        self.n = 0

    def talk(self):
        text = self.get_parameter("text").get_parameter_value().string_value
        msg = String(data=f"{text}: {self.n}")
        self.n += 1
        self.get_logger().info(f'Publishing: "{msg.data}"')
        self.pub.publish(msg)


def main(args=None):
    try:
        rclpy.init(args=args)
        rclpy.spin(Talker())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
