"""Things that go without being destroyed, and things used after they are."""

import gc
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import String
from std_srvs.srv import Empty, Trigger
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()


def attempt(what, function, *args):
    try:
        print(what, function(*args), flush=True)
    except Exception as error:
        print(what, type(error).__name__, str(error)[:70], flush=True)


twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
other = rclpy.create_node("other")
other.create_service(Trigger, "/never", lambda q, a: a)
never = node.create_client(Trigger, "/never")
pending = never.call_async(Trigger.Request())
words = other.create_publisher(String, "words", 10)
hear = node.create_subscription(String, "words", lambda m: print("heard", m.data, flush=True), 10)
words.publish(String(data="one"))
time.sleep(0.1)
other.destroy_node()
attempt("publish", words.publish, String(data="two"))
print(pending.done(), never.service_is_ready(), hear.handle.get_publisher_count())
time.sleep(0.1)
pen = node.create_client(SetPen, "/turtle1/set_pen")
node.destroy_client(pen)
attempt("call", pen.call_async, SetPen.Request())
attempt("ready", pen.service_is_ready)
lost = rclpy.create_node("lost")
lost.create_subscription(Pose, "/turtle1/pose", print, 10)
print(node.count_subscribers("/turtle1/pose"))
del lost
gc.collect()
time.sleep(0.1)
print(node.count_subscribers("/turtle1/pose"))
node.destroy_publisher(velocity)
attempt("publish", velocity.publish, twist)
attempt("count", velocity.get_subscription_count)
again = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
again.publish(twist)
node.destroy_publisher(again)
time.sleep(0.5)
reset = node.create_client(Empty, "/reset")
reset.call_async(Empty.Request())
node.destroy_client(reset)
time.sleep(0.5)
