"""Sends numbers, texts, requests and goals that no expression can use."""

import math

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.action import ActionClient
from rclpy.node import Node
from std_msgs.msg import Float64, String
from tf2_msgs.msg import TFMessage

rclpy.init()
node = Node("node", start_parameter_services=False)
MOST = 2**63 - 1


def get(_, response):
    odd = [ParameterValue(type=99), ParameterValue(type=8, double_array_value=[math.nan, math.inf])]
    response.values = odd * 50
    return response


node.create_service(GetParameters, "/node/get_parameters", get)
node.create_service(SetParameters, "/node/set_parameters", lambda _, response: response)
out = node.create_publisher(Float64, "out", 10)
for number in (math.nan, math.inf, -math.inf, 1e308, 5e-324, -0.0):
    out.publish(Float64(data=number))
chatter = node.create_publisher(String, "chatter", 10)
for text in ("/(/", "/.*/", "{n}", "\x1b[2J ::error:: [red] \u202e", "\ud83d", "a\0b"):
    try:
        chatter.publish(String(data=text))
        node.get_logger().info(text)
    except (UnicodeError, ValueError) as error:
        print(error)
for data in (b"", b"\0\1\0\0", b"\0\1\0\0\xff\xff\xff\xff", b"\0\1\0\0\2\0\0\0\xff\xff"):
    chatter.publish(data)
frame = TransformStamped(child_frame_id="\x1b[2J" * 999)
frame.transform.translation.x = math.nan
node.create_publisher(TFMessage, "/tf", 10).publish(TFMessage(transforms=[frame] * 99))
divide = node.create_client(AddTwoInts, "divide")
divide.wait_for_service()
for a, b in ((6, 0), (MOST, 1), (-MOST, -1), (MOST, -MOST)):
    divide.call_async(AddTwoInts.Request(a=a, b=b))
slow = node.create_client(AddTwoInts, "slow")
slow.wait_for_service()
slow.call_async(AddTwoInts.Request(a=MOST, b=MOST))
fibonacci = ActionClient(node, Fibonacci, "fibonacci")
fibonacci.wait_for_server()
for order in (0, -(2**31), 5):
    fibonacci.send_goal_async(Fibonacci.Goal(order=order))
rclpy.spin(node)
