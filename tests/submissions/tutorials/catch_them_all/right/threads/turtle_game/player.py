import json
import math
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import String
from turtlesim.msg import Pose


class Player(Node):
    def __init__(self):
        super().__init__("player")
        self.pose = None
        self.turtles = {}
        self.eaten = set()
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)
        self.create_subscription(String, "turtles", self.on_turtles, 10)
        self.cmd = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.eat = self.create_publisher(String, "eaten", 10)

    def on_pose(self, pose):
        self.pose = pose

    def on_turtles(self, msg):
        self.turtles = json.loads(msg.data)

    def send(self, v, w):
        twist = Twist()
        twist.linear.x = float(v)
        twist.angular.z = float(w)
        self.cmd.publish(twist)

    def way(self, place):
        return math.dist(place, (self.pose.x, self.pose.y))

    def error(self, place):
        angle = math.atan2(place[1] - self.pose.y, place[0] - self.pose.x) - self.pose.theta
        return (angle + math.pi) % (2 * math.pi) - math.pi

    def turn_to(self, place):
        while abs(self.error(place)) > 0.1:
            self.send(0, 4 * self.error(place))
            time.sleep(0.02)

    def drive_to(self, place):
        while self.way(place) > 0.4:
            self.send(2.5, 4 * self.error(place))
            time.sleep(0.02)
        self.send(0, 0)

    def play(self):
        while rclpy.ok():
            here = {k: v for k, v in self.turtles.items() if k not in self.eaten}
            if self.pose is None or not here:
                time.sleep(0.1)
                continue
            name = min(here, key=lambda each: self.way(here[each]))
            self.turn_to(here[name])
            self.drive_to(here[name])
            self.eat.publish(String(data=name))
            self.eaten.add(name)


def main():
    rclpy.init()
    player = Player()
    thread = threading.Thread(target=rclpy.spin, args=(player,), daemon=True)
    thread.start()
    try:
        player.play()
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()
    thread.join()


if __name__ == "__main__":
    main()
