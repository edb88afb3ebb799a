"""Two hundred commands a tick, two thousand at once, and strings longer than any socket takes."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_msgs.msg import String
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
chatter = node.create_publisher(String, "/chatter", 10)
setter = node.create_client(SetParameters, "/turtlesim/set_parameters")
heard = []
node.create_subscription(String, "/chatter", lambda m: heard.append(len(m.data)), 5)
count = 0


def drive(linear, angular):
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    velocity.publish(twist)


def tell(future):
    answer = str(future.result())
    print(count, len(answer), answer[:100], answer[-50:], flush=True)


def on_pose(pose):
    global count
    count += 1
    if count <= 10:
        for number in range(200):
            drive(number / 100, count / 10)
            if number % 50 == 0:
                chatter.publish(String(data="x" * count))
    if count == 20:
        print(len(heard), heard)
        for number in range(2000):
            drive(0.5, number / 2000)
        chatter.publish(String(data="y" * 300_000))
        for length in (10, 300_000):
            value = ParameterValue(type=4, string_value="z" * length)
            parameter = Parameter(name="w" * length, value=value)
            request = SetParameters.Request(parameters=[parameter])
            setter.call_async(request).add_done_callback(tell)
        drive(1.0, 0.7)
    if count == 25:
        print(len(heard), heard[-3:], node.get_clock().now().nanoseconds)


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
rclpy.spin(node)
