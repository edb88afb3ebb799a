"""Spins in a thread; main() spawns and drives, as a script."""
import math
import threading
import time
from collections import deque

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import Spawn


class Turtles(Node):
    def __init__(self):
        super().__init__("breadcrumbs")
        self.trail = deque()
        self.here = None
        self.lock = threading.Lock()
        self.create_subscription(Pose, "/turtle1/pose", self.on_leader, 10)
        self.create_subscription(Pose, "/turtle2/pose", self.on_own, 10)
        self.velocity = self.create_publisher(Twist, "/turtle2/cmd_vel", 10)
        self.client = self.create_client(Spawn, "/spawn")

    def on_leader(self, pose):
        """Drops a crumb every 10 cm, and keeps one metre of them."""
        with self.lock:
            if not self.trail or math.hypot(
                    pose.x - self.trail[-1].x, pose.y - self.trail[-1].y) > 0.1:
                self.trail.append(pose)
            while len(self.trail) > 10:
                self.trail.popleft()

    def on_own(self, pose):
        self.here = pose

    def drive(self):
        with self.lock:
            if not self.trail or self.here is None:
                return
            crumb = self.trail[0]
        dx, dy = crumb.x - self.here.x, crumb.y - self.here.y
        turn = math.remainder(math.atan2(dy, dx) - self.here.theta, 2 * math.pi)
        twist = Twist()
        if math.hypot(dx, dy) > 0.15:
            twist.linear.x = 4.0 * math.hypot(dx, dy) * max(0.0, math.cos(turn))
            twist.angular.z = 5.0 * turn
        self.velocity.publish(twist)


def main():
    rclpy.init()
    node = Turtles()
    spinner = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    spinner.start()
    while not node.client.service_is_ready():
        time.sleep(0.2)
    node.client.call(Spawn.Request(x=2.0, y=5.0, theta=0.0, name="turtle2"))
    rate = node.create_rate(20)
    try:
        while rclpy.ok():
            node.drive()
            rate.sleep()
    except KeyboardInterrupt:
        pass
    rclpy.shutdown()
    spinner.join()


if __name__ == "__main__":
    main()
