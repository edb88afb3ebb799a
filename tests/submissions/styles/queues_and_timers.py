"""queue, threading.Timer, Event and Condition, a ThreadPoolExecutor, datetime.now."""

import datetime
import queue
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

CMD_VEL, POSE, SET_PEN = "/turtle1/cmd_vel", "/turtle1/pose", "/turtle1/set_pen"
PERIOD_S = 0.5
COLORS = {1: (255, 255, 255), 2: (255, 0, 0), 3: (0, 255, 0), 4: (0, 0, 255)}


class Spiral:
    """Says what to send, given what was seen."""

    def __init__(self, growth=0.1):
        self.growth = growth
        self.speed = 0.0
        self.quadrant = None
        self.done = False

    def command(self):
        """The next command, due every half second."""
        self.speed += self.growth
        twist = Twist()
        twist.linear.x = self.speed
        twist.angular.z = 1.0
        return twist

    def is_outside(self, pose):
        """Whether it is time to stop; from then on `done`."""
        self.done = self.done or not (0.5 < pose.x < 10.5 and 0.5 < pose.y < 10.5)
        return self.done

    def pen(self, pose):
        """A request for set_pen, if the quadrant is another one."""
        quadrant = (1 if pose.x >= 5.544445 else 2) if pose.y >= 5.544445 else 0
        quadrant = quadrant or (3 if pose.x < 5.544445 else 4)
        if quadrant == self.quadrant:
            return None
        self.quadrant = quadrant
        r, g, b = COLORS[quadrant]
        return SetPen.Request(r=r, g=g, b=b, width=3, off=0)


rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, CMD_VEL, 10)
poses = queue.Queue()
node.create_subscription(Pose, POSE, poses.put, 10)
threading.Thread(target=lambda: rclpy.spin(node), daemon=True).start()
late, sent = threading.Event(), threading.Condition()
threading.Timer(30.0, late.set).start()
pool = ThreadPoolExecutor(2)
spiral = Spiral()
last = datetime.datetime.now()


def send(twist):
    time.sleep(0.1)
    velocity.publish(twist)
    with sent:
        sent.notify()


while not late.is_set() and not spiral.done:
    try:
        pose = poses.get(timeout=0.05)
    except queue.Empty:
        continue
    spiral.is_outside(pose)
    if (datetime.datetime.now() - last).total_seconds() >= 0.5:
        last = datetime.datetime.now()
        pool.submit(send, spiral.command())
        with sent:
            sent.wait(timeout=1.0)
velocity.publish(Twist())
pool.shutdown()
time.sleep(10)
