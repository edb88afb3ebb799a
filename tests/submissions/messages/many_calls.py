"""Many calls at once: 50 pens, two clients of a service, one destroyed, calls from a thread."""

import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import Empty
from turtlesim.msg import Color
from turtlesim.srv import SetPen, TeleportAbsolute, TeleportRelative

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
executor = MultiThreadedExecutor(2)
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()


def now():
    return f"{time.time() % 1000:.4f}"


def drive(linear, angular=0.0):
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    velocity.publish(twist)


colors = []


def on_color(color):
    if not colors or colors[-1] != color.r:
        colors.append(color.r)


node.create_subscription(Color, "/turtle1/color_sensor", on_color, 10)
pen = node.create_client(SetPen, "/turtle1/set_pen")
pen2 = node.create_client(SetPen, "/turtle1/set_pen")
print(now(), pen.wait_for_service(), pen2.service_is_ready())
drive(1.0, 0.2)
done = []
futures = []
for i in range(50):
    future = pen.call_async(SetPen.Request(r=i, width=2))
    future.add_done_callback(lambda f, i=i: done.append((i, now())))
    futures.append(future)
time.sleep(0.3)
print(now(), len(done), done[:3], done[-3:])
drive(1.0, 0.2)
for i in range(10):
    pen.call_async(SetPen.Request(r=100 + i, width=2)).add_done_callback(
        lambda f, i=i: print(now(), "first", i, flush=True)
    )
    pen2.call_async(SetPen.Request(r=120 + i, width=2)).add_done_callback(
        lambda f, i=i: print(now(), "second", i, flush=True)
    )
time.sleep(0.2)
gone = pen2.call_async(SetPen.Request(r=200, width=9))
gone2 = pen2.call_async(SetPen.Request(r=201, width=9))
node.destroy_client(pen2)
time.sleep(0.2)
print(now(), gone.done(), gone2.done(), gone.cancelled())
drive(1.0, 0.2)
for i in range(5):
    print(now(), pen.call(SetPen.Request(r=i, width=2)), flush=True)
jump = node.create_client(TeleportAbsolute, "/turtle1/teleport_absolute")
step = node.create_client(TeleportRelative, "/turtle1/teleport_relative")
clear = node.create_client(Empty, "/clear")
asked = [
    jump.call_async(TeleportAbsolute.Request(x=2.0, y=2.0, theta=0.1)),
    step.call_async(TeleportRelative.Request(linear=1.0, angular=0.2)),
    clear.call_async(Empty.Request()),
    jump.call_async(TeleportAbsolute.Request(x=3.0, y=3.0, theta=0.2)),
    step.call_async(TeleportRelative.Request(linear=1.0, angular=0.2)),
]
drive(1.0, 0.4)
while not all(f.done() for f in asked):
    time.sleep(0.001)
print(now(), [f.result() for f in asked])
answer = pen.call_async(SetPen.Request(r=5))
pen.remove_pending_request(answer)
time.sleep(0.1)
print(answer.done())


def elsewhere():
    for i in range(3):
        print(now(), "thread", pen.call(SetPen.Request(r=30 + i)), flush=True)


threads = [threading.Thread(target=elsewhere) for _ in range(3)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
drive(0.5)
time.sleep(0.5)
print(now(), colors)
node.destroy_node()
rclpy.shutdown()
