"""Spawns in a coroutine, with await, and awaits the transform as well."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import Buffer, TransformListener
from turtlesim.srv import Spawn


class Listener(Node):
    def __init__(self):
        super().__init__("turtle_tf2_frame_listener")
        self.target = self.declare_parameter("target_frame", "turtle1").value
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.group = ReentrantCallbackGroup()
        self.spawner = self.create_client(Spawn, "spawn", callback_group=self.group)
        self.pub = self.create_publisher(Twist, "turtle2/cmd_vel", 10)
        self.start = self.create_timer(0.2, self.spawn, callback_group=self.group)

    async def spawn(self):
        if not self.spawner.service_is_ready():
            return
        self.start.cancel()
        await self.spawner.call_async(Spawn.Request(name="turtle2", x=4.0, y=2.0, theta=0.0))
        self.create_timer(1.0, self.drive, callback_group=self.group)

    async def drive(self):
        t = await self.buffer.lookup_transform_async("turtle2", self.target, rclpy.time.Time())
        x, y = t.transform.translation.x, t.transform.translation.y
        twist = Twist()
        twist.linear.x = 0.5 * math.hypot(x, y)
        twist.angular.z = math.atan2(y, x)
        self.pub.publish(twist)


def main():
    rclpy.init()
    try:
        rclpy.spin(Listener())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
