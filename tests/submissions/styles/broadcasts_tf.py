"""As timer.py; besides it tells tf where the turtle is, and asks it where a carrot is.

The broadcaster is that of the tutorials (turtle_tf2_py). The carrot hangs two metres beside the
turtle.
"""

import math

import rclpy
from geometry_msgs.msg import TransformStamped, Twist
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster, TransformException
from tf2_ros.buffer import Buffer
from tf2_ros.transform_listener import TransformListener
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
        self.spiral = Spiral()
        self.velocity = self.create_publisher(Twist, CMD_VEL, 10)
        self.pen = self.create_client(SetPen, SET_PEN)
        self.create_subscription(Pose, POSE, self.on_pose, 10)
        self.create_timer(PERIOD_S, self.on_timer)
        self.buffer = Buffer(node=self)
        self.listener = TransformListener(self.buffer, self)
        self.broadcaster = TransformBroadcaster(self, qos=10)
        self.static_broadcaster = StaticTransformBroadcaster(self)
        carrot = TransformStamped()
        carrot.header.stamp = self.get_clock().now().to_msg()
        carrot.header.frame_id, carrot.child_frame_id = "turtle1", "carrot1"
        carrot.transform.translation.y = 2.0
        self.static_broadcaster.sendTransform(carrot)
        self.create_timer(2.0, self.on_carrot)

    def on_carrot(self):
        try:
            found = self.buffer.lookup_transform(
                "world", "carrot1", Time(), timeout=Duration(seconds=0.1)
            )
            move = found.transform.translation
            print(f"carrot at {move.x:.9f} {move.y:.9f}, {found.header.stamp}")
            self.buffer.lookup_transform("world", "carrot1", self.get_clock().now())
        except TransformException as problem:
            print(f"{type(problem).__name__}: {problem}")

    def broadcast(self, pose):
        turtle = TransformStamped()
        turtle.header.stamp = self.get_clock().now().to_msg()
        turtle.header.frame_id, turtle.child_frame_id = "world", "turtle1"
        turtle.transform.translation.x = pose.x
        turtle.transform.translation.y = pose.y
        turtle.transform.rotation.z = math.sin(pose.theta / 2)
        turtle.transform.rotation.w = math.cos(pose.theta / 2)
        self.broadcaster.sendTransform(turtle)

    def on_timer(self):
        if not self.spiral.done:
            self.velocity.publish(self.spiral.command())

    def on_pose(self, pose):
        self.broadcast(pose)
        if self.spiral.done:
            return
        if self.spiral.is_outside(pose):
            self.velocity.publish(Twist())
        elif request := self.spiral.pen(pose):
            self.pen.call_async(request)


def main():
    rclpy.init()
    rclpy.spin(Controller())


if __name__ == "__main__":
    main()
