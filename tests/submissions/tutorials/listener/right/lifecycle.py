import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import Node, State, TransitionCallbackReturn
from std_msgs.msg import String


class Ear(Node):
    def __init__(self):
        super().__init__("minimal_subscriber")
        self.is_active = False
        self.trigger_configure()
        self.trigger_activate()

    def on_configure(self, state: State):
        self.sub = self.create_subscription(String, "topic", self.hear, 10)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: State):
        self.is_active = True
        return super().on_activate(state)

    def hear(self, msg):
        if self.is_active:
            self.get_logger().info(f'I heard: "{msg.data}"')


rclpy.init()
try:
    rclpy.spin(Ear())
except (KeyboardInterrupt, ExternalShutdownException):
    pass
