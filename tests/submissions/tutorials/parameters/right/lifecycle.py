import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.parameter import Parameter


class MinimalParam(LifecycleNode):
    def on_configure(self, state):
        if not self.has_parameter("my_parameter"):
            self.declare_parameter("my_parameter", "world")
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.timer = self.create_timer(1.0, self.greet)
        return super().on_activate(state)

    def greet(self):
        self.get_logger().info(f"Hello {self.get_parameter('my_parameter').value}!")
        self.set_parameters([Parameter("my_parameter", value="world")])


rclpy.init()
node = MinimalParam("minimal_param_node")
node.trigger_configure()
node.trigger_activate()
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
