import math
from functools import partial

import rclpy
import rclpy.node
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.qos import qos_profile_sensor_data
from turtlesim.msg import Pose
from turtlesim.srv import Kill


class Catcher(rclpy.node.Node):
    """Sees each turtle by its own pose topic, and kills it when it is there."""

    def __init__(self):
        super().__init__("catcher")
        self.me = None
        self.prey = {}
        self.subs = {}
        self.killing = None
        self.kill = self.create_client(Kill, "/kill")
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Pose, "pose", self.i_am, qos_profile_sensor_data)
        self.create_timer(0.5, self.look_around)
        self.create_timer(0.05, self.hunt)

    def i_am(self, pose):
        self.me = pose

    def look_around(self):
        for topic, types in self.get_topic_names_and_types():
            name = topic.split("/")[1]
            if types != ["turtlesim/msg/Pose"] or name == "turtle1" or name in self.subs:
                continue
            self.subs[name] = self.create_subscription(Pose, topic, partial(self.it_is, name), 10)

    def it_is(self, name, pose):
        self.prey[name] = pose

    def hunt(self):
        if self.me is None or self.killing is not None or not self.prey:
            self.cmd.publish(Twist())
            return
        name, pose = min(self.prey.items(), key=lambda item: self.way(item[1]))
        if self.way(pose) <= 0.5:
            self.killing = name
            future = self.kill.call_async(Kill.Request(name=name))
            future.add_done_callback(self.killed)
            return
        to = math.atan2(pose.y - self.me.y, pose.x - self.me.x)
        off = math.remainder(to - self.me.theta, math.tau)
        cmd = Twist()
        cmd.linear.x = 2.0 if abs(off) < 0.3 else 0.0
        cmd.angular.z = math.copysign(min(2.0, 4 * abs(off)), off)
        self.cmd.publish(cmd)

    def way(self, pose):
        return math.hypot(pose.x - self.me.x, pose.y - self.me.y)

    def killed(self, _):
        self.destroy_subscription(self.subs.pop(self.killing))
        self.prey.pop(self.killing)
        self.killing = None


def main():
    try:
        rclpy.init()
        rclpy.spin(Catcher())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
