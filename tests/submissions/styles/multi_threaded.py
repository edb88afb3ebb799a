"""MultiThreadedExecutor, reentrant callbacks, one of them async, and a future to begin with."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
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


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        group = ReentrantCallbackGroup()
        self.spiral = Spiral()
        self.answers = 0
        self.velocity = self.create_publisher(Twist, CMD_VEL, 10)
        self.pen = self.create_client(SetPen, SET_PEN, callback_group=group)
        self.create_subscription(Pose, POSE, self.on_pose, 10, callback_group=group)
        self.create_timer(PERIOD_S, self.on_timer, callback_group=group)

    def on_timer(self):
        if not self.spiral.done:
            self.velocity.publish(self.spiral.command())

    async def on_pose(self, pose):
        if self.spiral.done:
            return
        if self.spiral.is_outside(pose):
            self.velocity.publish(Twist())
            self.get_logger().info(f"{self.answers} answers")
        elif request := self.spiral.pen(pose):
            await self.pen.call_async(request)
            self.answers += 1


def main():
    rclpy.init()
    node = Controller()
    first = node.pen.call_async(SetPen.Request(r=255, g=255, b=255, width=3))
    rclpy.spin_until_future_complete(node, first)
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    executor.spin()


main()
