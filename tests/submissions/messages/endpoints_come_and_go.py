"""Makes and destroys subscriptions, publishers and clients while the turtle drives on."""

import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from std_srvs.srv import Empty
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, SetPen, Spawn

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
spinner = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
spinner.start()


def now():
    return f"{time.time() % 1000:.4f}"


class Heard:
    """Counts what a subscription hears and remembers its first and last message."""

    def __init__(self, kind, topic, depth=10):
        self.name, self.count, self.first, self.last = topic, 0, None, None
        self.subscription = node.create_subscription(kind, topic, self.hear, depth)

    def hear(self, message):
        self.count += 1
        self.first = self.first or (now(), message)
        self.last = (now(), message)

    def end(self):
        node.destroy_subscription(self.subscription)
        print(now(), self.name, self.count, self.first, self.last, flush=True)


def drive(linear, angular=0.0):
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    velocity.publish(twist)


def call(kind, service, **fields):
    client = node.create_client(kind, service)
    print(now(), service, client.wait_for_service(1.0), client.call(kind.Request(**fields)))
    node.destroy_client(client)


drive(1.0, 0.3)
time.sleep(0.4)
pose = Heard(Pose, "/turtle1/pose")
time.sleep(0.101)
color = Heard(Color, "/turtle1/color_sensor")
time.sleep(0.203)
pose.end()
time.sleep(0.05)
again = Heard(Pose, "/turtle1/pose", 1)
second = Heard(Pose, "/turtle2/pose")
time.sleep(0.1)
spare = node.create_publisher(Twist, "/turtle2/cmd_vel", 10)
print(now(), spare.get_subscription_count(), second.subscription.get_publisher_count())
drive(1.0, -0.3)
time.sleep(0.0333)
call(Spawn, "/spawn", x=2.0, y=2.0, theta=0.5, name="turtle2")
print(now(), spare.get_subscription_count(), second.subscription.get_publisher_count())
late = Heard(Color, "/turtle2/color_sensor")
twist = Twist()
twist.linear.x = 2.0
spare.publish(twist)
time.sleep(0.5)
call(SetPen, "/turtle2/set_pen", r=9, g=8, b=7, width=4)
time.sleep(0.05)
node.destroy_publisher(spare)
time.sleep(0.3)
call(Kill, "/kill", name="turtle2")
time.sleep(0.2)
second.end()
late.end()
drive(1.5, 1.0)
time.sleep(0.25)
call(Empty, "/reset")
time.sleep(0.1)
drive(-0.5)
time.sleep(0.4)
for _ in range(20):
    passing = Heard(Pose, "/turtle1/pose")
    time.sleep(0.021)
    passing.end()
unused = [node.create_client(Empty, "/clear") for _ in range(5)]
time.sleep(0.1)
unused[2].call(Empty.Request())
for client in unused:
    node.destroy_client(client)
drive(1.0)
time.sleep(0.7)
again.end()
color.end()
