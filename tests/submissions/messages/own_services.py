"""Own services, topics and nodes in a process, one of them named like the simulator's."""

import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Empty, SetBool, Trigger
from turtlesim.msg import Pose


def now():
    return f"{time.time() % 1000:.4f}"


class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.create_service(Trigger, "drive", self.on_drive)
        self.create_service(SetBool, "slow", self.on_slow)
        self.create_service(Empty, "/clear", self.on_clear)
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.words = self.create_publisher(String, "words", 10)
        self.count = 0

    def on_drive(self, request, response):
        self.count += 1
        twist = Twist()
        twist.linear.x, twist.angular.z = 1.0, self.count / 10
        self.velocity.publish(twist)
        self.words.publish(String(data=f"driving {self.count} {now()}"))
        response.success, response.message = True, f"{self.count} {now()}"
        return response

    def on_slow(self, request, response):
        time.sleep(0.2)
        response.success, response.message = request.data, now()
        return response

    def on_clear(self, request, response):
        print(now(), "own clear", flush=True)
        return response


class Asker(Node):
    def __init__(self):
        super().__init__("asker")
        group = ReentrantCallbackGroup()
        self.drive = self.create_client(Trigger, "drive", callback_group=group)
        self.slow = self.create_client(SetBool, "slow", callback_group=group)
        self.clear = self.create_client(Empty, "/clear", callback_group=group)
        self.create_subscription(String, "words", self.on_word, 10, callback_group=group)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10, callback_group=group)
        self.create_timer(0.5, self.on_timer, callback_group=group)
        self.turns = 0
        self.poses = 0

    def on_pose(self, pose):
        self.poses += 1

    def on_word(self, word):
        print(now(), word.data, self.poses, flush=True)

    def on_timer(self):
        self.turns += 1
        if self.turns <= 4:
            print(now(), self.drive.call(Trigger.Request()), flush=True)
            print(now(), self.slow.call(SetBool.Request(data=self.turns > 2)), flush=True)
        if self.turns == 2:
            future = self.clear.call_async(Empty.Request())
            future.add_done_callback(lambda f: print(now(), "cleared", f.result(), flush=True))
        if self.turns == 4:
            several = [self.drive.call_async(Trigger.Request()) for _ in range(5)]
            while not all(f.done() for f in several):
                time.sleep(0.01)
            print(now(), [f.result().message for f in several], flush=True)
        if self.turns == 6:
            print(self.clear.service_is_ready(), self.poses, flush=True)
            raise SystemExit


rclpy.init()
server, asker = Server(), Asker()
first = SingleThreadedExecutor()
first.add_node(server)
threading.Thread(target=first.spin, daemon=True).start()
second = MultiThreadedExecutor(3)
second.add_node(asker)
second.spin()
