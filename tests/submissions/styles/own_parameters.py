"""Asks itself for a parameter through the graph, for each command."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.srv import GetParameters
from rclpy.duration import Duration
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
node.declare_parameter("growth", 0.1)
velocity = node.create_publisher(Twist, CMD_VEL, 10)
ask = node.create_client(GetParameters, "/controller/get_parameters")
assert ask.wait_for_service(timeout_sec=5)
spiral = Spiral()
for _ in range(20):
    answer = ask.call_async(GetParameters.Request(names=["growth"]))
    rclpy.spin_until_future_complete(node, answer, timeout_sec=2.0)
    spiral.growth = answer.result().values[0].double_value
    velocity.publish(spiral.command())
    end = node.get_clock().now() + Duration(seconds=0.5)
    while node.get_clock().now() < end:
        rclpy.spin_once(node, timeout_sec=0.01)
velocity.publish(Twist())
end = node.get_clock().now() + Duration(seconds=10)
while node.get_clock().now() < end:
    rclpy.spin_once(node, timeout_sec=0.1)
