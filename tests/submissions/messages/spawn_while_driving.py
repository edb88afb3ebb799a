"""Asks for turtles and kills them asynchronously between poses, and resets while it drives."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_srvs.srv import Empty
from turtlesim.msg import Pose
from turtlesim.srv import Kill, Spawn


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.others = self.create_publisher(Twist, "/a/cmd_vel", 10)
        self.clients_ = {
            "spawn": self.create_client(Spawn, "/spawn"),
            "kill": self.create_client(Kill, "/kill"),
            "reset": self.create_client(Empty, "/reset"),
        }
        self.count = 0
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)
        self.subs = []

    def ask(self, what, request):
        future = self.clients_[what].call_async(request)
        future.add_done_callback(lambda f: print(self.count, what, f.result(), flush=True))

    def on_pose(self, pose):
        self.count += 1
        if self.count == 5:
            self.drive(1.0, 0.5)
        if self.count == 20:
            self.ask("spawn", Spawn.Request(x=1.0, y=1.0, theta=0.0, name="a"))
        if self.count == 30:
            self.subs.append(self.create_subscription(Pose, "/a/pose", self.on_other, 5))
            self.ask("spawn", Spawn.Request(x=3.0, y=1.0, theta=0.0, name="b"))
            self.ask("spawn", Spawn.Request(x=3.0, y=1.0, theta=0.0, name="a"))
        if self.count == 40:
            twist = Twist()
            twist.linear.x = 1.0
            self.others.publish(twist)
        if self.count == 60:
            self.ask("kill", Kill.Request(name="a"))
            self.ask("spawn", Spawn.Request(x=5.0, y=1.0, theta=1.0, name="a"))
        if self.count == 61:
            twist = Twist()
            twist.linear.x = 1.0
            self.others.publish(twist)
        if self.count == 90:
            self.ask("reset", Empty.Request())
        if self.count == 92:
            self.drive(1.0, 0.0)
        if self.count == 150:
            self.ask("kill", Kill.Request(name="turtle1"))
            print("killed", pose.x)
            self.create_timer(0.5, self.end)

    def end(self):
        print("end", self.count)
        raise SystemExit

    def on_other(self, pose):
        print(self.count, pose, flush=True)

    def drive(self, linear, angular):
        twist = Twist()
        twist.linear.x, twist.angular.z = linear, angular
        self.velocity.publish(twist)


rclpy.init()
rclpy.spin(Controller())
