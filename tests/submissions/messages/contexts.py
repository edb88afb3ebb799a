"""Two contexts, shutting down and starting again, and what is no longer possible then."""

import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import Empty
from turtlesim.msg import Pose


def drive(publisher, linear, angular=0.0):
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    publisher.publish(twist)


def attempt(what, function, *args):
    try:
        print(what, function(*args), flush=True)
    except BaseException as error:
        print(what, type(error).__name__, str(error)[:100], flush=True)


rclpy.init()
context = Context()
rclpy.init(context=context)
first = rclpy.create_node("first")
second = rclpy.create_node("second", context=context)
heard = {1: [], 2: []}
first.create_subscription(Pose, "/turtle1/pose", heard[1].append, 10)
second.create_subscription(Pose, "/turtle1/pose", heard[2].append, 10)
publisher = first.create_publisher(Twist, "/turtle1/cmd_vel", 10)
other = second.create_publisher(Twist, "/turtle1/cmd_vel", 10)
drive(publisher, 1.0)
executor = SingleThreadedExecutor(context=context)
executor.add_node(second)
for _ in range(20):
    executor.spin_once(timeout_sec=0.1)
    rclpy.spin_once(first, timeout_sec=0.1)
print(len(heard[1]), len(heard[2]), publisher.get_subscription_count())
drive(other, 1.0, 0.5)
rclpy.shutdown()
attempt("publish", drive, publisher, 1.0)

attempt("count", publisher.get_subscription_count)
attempt("graph", first.get_node_names)
attempt("create", rclpy.create_node, "third")
attempt("spin", rclpy.spin_once, first)
drive(other, 1.0, -0.5)
for _ in range(20):
    executor.spin_once(timeout_sec=0.1)
knows_itself = "second" in second.get_node_names()
print(len(heard[1]), len(heard[2]), knows_itself, other.get_subscription_count())
rclpy.init()
again = rclpy.create_node("again")
publisher = again.create_publisher(Twist, "/turtle1/cmd_vel", 10)
more = []
again.create_subscription(Pose, "/turtle1/pose", more.append, 10)
drive(publisher, 0.5, 1.0)
for _ in range(30):
    rclpy.spin_once(again, timeout_sec=0.1)
print(len(more), more[0].x, more[-1].x, publisher.get_subscription_count())
clear = again.create_client(Empty, "/clear")
answer = clear.call_async(Empty.Request())
rclpy.spin_until_future_complete(again, answer, timeout_sec=1.0)
print(answer.result())
again.destroy_node()
attempt("destroyed", drive, publisher, 1.0)
rclpy.shutdown(context=context)
attempt("other", drive, other, 1.0)
rclpy.try_shutdown()
time.sleep(0.2)
