import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn


class Adder(LifecycleNode):
    def on_configure(self, state):
        self.srv = self.create_service(AddTwoInts, "add_two_ints", self.add)
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state):
        self.destroy_service(self.srv)
        return TransitionCallbackReturn.SUCCESS

    def add(self, request, response):
        response.sum = request.a + request.b
        return response


rclpy.init()
adder = Adder("adder")
adder.trigger_configure()
adder.trigger_activate()
try:
    rclpy.spin(adder)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
