"""A call that blocks, in a callback group of its own."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from tf2_ros import Buffer, TransformException, TransformListener
from turtlesim.srv import Spawn


class Listener(Node):
    def __init__(self):
        super().__init__("turtle_tf2_frame_listener")
        self.declare_parameter("target_frame", "turtle1")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.spawner = self.create_client(
            Spawn, "spawn", callback_group=MutuallyExclusiveCallbackGroup()
        )
        self.pub = self.create_publisher(Twist, "turtle2/cmd_vel", 10)
        self.is_there = False
        self.create_timer(1.0, self.step, callback_group=MutuallyExclusiveCallbackGroup())

    def step(self):
        if not self.is_there:
            self.spawner.wait_for_service()
            self.spawner.call(Spawn.Request(name="turtle2", x=4.0, y=2.0))
            self.is_there = True
            return
        try:
            t = self.buffer.lookup_transform(
                "turtle2", self.get_parameter("target_frame").value, rclpy.time.Time()
            )
        except TransformException:
            return
        twist = Twist()
        x, y = t.transform.translation.x, t.transform.translation.y
        twist.linear.x = 0.5 * math.dist((0, 0), (x, y))
        twist.angular.z = math.atan2(y, x)
        self.pub.publish(twist)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Listener())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
