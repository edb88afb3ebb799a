"""Has the simulator write pictures into a home that nobody has, and into a folder named here."""

import pathlib
import sys

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_srvs.srv import Trigger

ELSEWHERE = pathlib.Path(__file__).resolve().parent / "elsewhere"

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
setter = node.create_client(SetParameters, "/turtlesim/set_parameters")
saver = node.create_client(Trigger, "/turtlesim/save_canvas")
setter.wait_for_service()
saver.wait_for_service()


def call(client, **request):
    future = client.call_async(client.srv_type.Request(**request))
    rclpy.spin_until_future_complete(node, future)
    return future.result()


for folder in ("~nosuchuser/x", "\0", "/dev/full", "x" * 5000, str(ELSEWHERE)):
    value = ParameterValue(type=4, string_value=folder)
    result = call(setter, parameters=[Parameter(name="canvas_folder", value=value)]).results[0]
    answer = call(saver)
    print(result.successful, answer.success, pathlib.Path(answer.message).name)
print(all(call(saver).success for _ in range(200)))
sys.stdout.flush()
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
rclpy.spin_once(node, timeout_sec=1.5)
