"""spin_once that never waits, the ROS clock for the rhythm, and busy waiting at the end."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.duration import Duration
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
poses = []
node.create_subscription(Pose, POSE, poses.append, 10)
velocity = node.create_publisher(Twist, CMD_VEL, 10)
spiral = Spiral()
last = node.get_clock().now()
while not spiral.done:
    rclpy.spin_once(node, timeout_sec=0)
    if node.get_clock().now() - last > Duration(seconds=PERIOD_S):
        last = node.get_clock().now()
        velocity.publish(spiral.command())
    if poses:
        spiral.is_outside(poses.pop())
velocity.publish(Twist())
while rclpy.ok():
    pass
