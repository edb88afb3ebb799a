"""Every service of the simulator, several turtles, parameters; prints what it is told and when."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from std_srvs.srv import Empty
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative

rclpy.init()
node = rclpy.create_node("controller")
seen = {}


def now():
    return f"{node.get_clock().now().nanoseconds / 1e9 % 1000:.3f}"


def call(kind, service, **fields):
    client = node.create_client(kind, service)
    assert client.wait_for_service(timeout_sec=1.0), service
    answer = client.call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, answer, timeout_sec=1.0)
    print(now(), service, answer.result(), flush=True)
    node.destroy_client(client)
    return answer.result()


def watch(turtle):
    node.create_subscription(Pose, f"/{turtle}/pose", lambda pose: seen.update({turtle: pose}), 1)
    node.create_subscription(
        Color, f"/{turtle}/color_sensor", lambda color: seen.update({turtle + " color": color}), 1
    )
    return node.create_publisher(Twist, f"/{turtle}/cmd_vel", 10)


def drive(publisher, seconds, speed=1.0):
    twist = Twist()
    twist.linear.x = speed
    publisher.publish(twist)
    end = node.get_clock().now().nanoseconds + int(seconds * 1e9)
    while node.get_clock().now().nanoseconds < end:
        rclpy.spin_once(node, timeout_sec=0.05)
    for name in sorted(seen):
        print(now(), name, seen[name], flush=True)


first = watch("turtle1")
drive(first, 0.5)
call(SetPen, "/turtle1/set_pen", r=255, width=5)
call(TeleportAbsolute, "/turtle1/teleport_absolute", x=2.0, y=3.0, theta=1.0)
call(TeleportRelative, "/turtle1/teleport_relative", linear=1.0, angular=0.5)
name = call(Spawn, "/spawn", x=8.0, y=8.0, theta=0.0, name="").name
second = watch(name)
drive(second, 0.5, 2.0)
call(Spawn, "/spawn", x=1.0, y=1.0, theta=0.0, name=name)
call(Kill, "/kill", name=name)
drive(second, 0.3)
call(Spawn, "/spawn", x=1.0, y=1.0, theta=0.0, name=name)
drive(second, 0.3)
call(Kill, "/kill", name="nobody")
call(Empty, "/clear")
drive(first, 0.5)
call(GetParameters, "/turtlesim/get_parameters", names=["background_r", "holonomic"])
value = ParameterValue(type=2, integer_value=7)
call(
    SetParameters,
    "/turtlesim/set_parameters",
    parameters=[Parameter(name="background_r", value=value)],
)
call(GetParameters, "/turtlesim/get_parameters", names=["background_r"])
call(Empty, "/reset")
drive(first, 0.5)
