import math

from geometry_msgs.msg import PoseStamped, Twist
from rclpy.node import Node
from std_msgs.msg import String
from turtlesim.msg import Pose


class Hunter(Node):
    """Goes to the turtles, first come, first served."""

    def __init__(self):
        super().__init__("hunter")
        self.me = Pose()
        self.todo = []
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.reached = self.create_publisher(String, "/reached", 20)
        self.create_subscription(PoseStamped, "/new_turtle", self.todo.append, 20)
        self.create_subscription(Pose, "pose", self.moved, 10)
        self.create_timer(1 / 30, self.step)

    def moved(self, pose):
        self.me = pose

    def step(self):
        cmd = Twist()
        if self.todo:
            goal = self.todo[0].pose.position
            dx, dy = goal.x - self.me.x, goal.y - self.me.y
            # in the frame of turtle1
            ahead = dx * math.cos(self.me.theta) + dy * math.sin(self.me.theta)
            left = -dx * math.sin(self.me.theta) + dy * math.cos(self.me.theta)
            if math.hypot(ahead, left) < 0.3:
                self.reached.publish(String(data=self.todo.pop(0).header.frame_id))
            else:
                cmd.angular.z = 5 * math.atan2(left, ahead)
                cmd.linear.x = min(3.0, max(0.0, 3 * ahead))
        self.cmd.publish(cmd)
