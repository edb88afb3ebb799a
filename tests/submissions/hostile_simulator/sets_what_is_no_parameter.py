"""Sets parameters to values of types that ROS does not have, and to numbers that are none."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
each = node.create_client(SetParameters, "/turtlesim/set_parameters")
at_once = node.create_client(SetParametersAtomically, "/turtlesim/set_parameters_atomically")
each.wait_for_service()
at_once.wait_for_service()


def call(client, **request):
    future = client.call_async(client.srv_type.Request(**request))
    rclpy.spin_until_future_complete(node, future)
    print(future.result())


for kind in (10, 255):
    value = ParameterValue(type=kind, integer_value=7)
    parameters = [Parameter(name=name, value=value) for name in ("background_r", "nothing")]
    call(each, parameters=parameters)
    call(at_once, parameters=parameters)
for rate in (float("nan"), 5e-324, float("inf")):
    value = ParameterValue(type=3, double_value=rate)
    call(each, parameters=[Parameter(name="image_rate", value=value)])
call(each, parameters=[Parameter(name="\x1b[31m", value=value)])
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
rclpy.spin_once(node, timeout_sec=1.5)
