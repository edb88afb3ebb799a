import rclpy
from rclpy.parameter import Parameter

rclpy.init()
node = rclpy.create_node("minimal_param_node")
param = node.declare_parameter("my_parameter", "world")
print("starts with", param.value)


def tick():
    node.get_logger().info("Hello %s!" % node.get_parameter("my_parameter").value)
    node.set_parameters([Parameter("my_parameter", value="world")])


timer = node.create_timer(1, tick)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
