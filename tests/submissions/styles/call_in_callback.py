"""A service call that waits inside a callback, with callback groups that make that possible."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
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
pen = node.create_client(SetPen, SET_PEN, callback_group=ReentrantCallbackGroup())
spiral = Spiral()


def on_pose(pose):
    if spiral.done:
        return
    if spiral.is_outside(pose):
        velocity.publish(Twist())
    elif request := spiral.pen(pose):
        pen.call(request)


def on_timer():
    if not spiral.done:
        velocity.publish(spiral.command())


node.create_subscription(Pose, POSE, on_pose, 10, callback_group=MutuallyExclusiveCallbackGroup())
node.create_timer(PERIOD_S, on_timer, callback_group=MutuallyExclusiveCallbackGroup())
executor = MultiThreadedExecutor()
executor.add_node(node)
executor.spin()
