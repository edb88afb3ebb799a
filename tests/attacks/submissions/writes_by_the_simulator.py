"""Has the simulator, which nothing confines, write pictures and make folders in the home."""

import known
import rclpy
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_srvs.srv import Empty, Trigger
from tools import attempt

rclpy.init()
node = rclpy.create_node("attacker")


def call(kind, name, request):
    client = node.create_client(kind, name)
    if client.wait_for_service(timeout_sec=0.5):
        rclpy.spin_until_future_complete(node, client.call_async(request), timeout_sec=1.0)


for folder in (f"{known.HOME}/pictures", known.HOME, f"{known.OUT}", "~/pictures", "/tmp/pictures"):
    value = ParameterValue(type=4, string_value=folder)
    with attempt():
        request = SetParameters.Request(parameters=[Parameter(name="canvas_folder", value=value)])
        call(SetParameters, "/turtlesim/set_parameters", request)
    for kind in (Trigger, Empty):
        with attempt():
            call(kind, "/turtlesim/save_canvas", kind.Request())
