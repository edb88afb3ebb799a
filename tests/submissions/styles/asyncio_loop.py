"""asyncio in the main thread, rclpy.spin in another."""

import asyncio
import contextlib
import threading

import rclpy
from geometry_msgs.msg import Twist
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
spiral = Spiral()


async def drive():
    outside = asyncio.Event()
    loop = asyncio.get_running_loop()

    def on_pose(pose):
        if not spiral.done and spiral.is_outside(pose):
            loop.call_soon_threadsafe(outside.set)

    node.create_subscription(Pose, POSE, on_pose, 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    while not outside.is_set():
        velocity.publish(spiral.command())
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(outside.wait(), PERIOD_S)
    velocity.publish(Twist())
    await asyncio.sleep(100)


asyncio.run(drive())
