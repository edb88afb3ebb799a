"""can_transform instead of an exception, and a callback for the answer."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import Buffer, TransformListener
from turtlesim.srv import Spawn


class Listener(Node):
    def __init__(self):
        super().__init__("turtle_tf2_frame_listener")
        self.target_frame = self.declare_parameter("target_frame", "turtle1").value
        self.tf_buffer = Buffer()
        self.tf_listener = TransformListener(self.tf_buffer, self)
        self.pub = self.create_publisher(Twist, "turtle2/cmd_vel", 1)
        spawner = self.create_client(Spawn, "spawn")
        while not spawner.wait_for_service(timeout_sec=1.0):
            self.get_logger().info("waiting for /spawn")
        request = Spawn.Request(name="turtle2", x=4.0, y=2.0)
        spawner.call_async(request).add_done_callback(self.on_spawned)

    def on_spawned(self, future):
        self.get_logger().info(f"{future.result().name} is there")
        self.timer = self.create_timer(1.0, self.follow)

    def follow(self):
        now = rclpy.time.Time()
        if not self.tf_buffer.can_transform("turtle2", self.target_frame, now):
            return
        position = self.tf_buffer.lookup_transform(
            "turtle2", self.target_frame, now
        ).transform.translation
        twist = Twist()
        twist.linear.x = 0.5 * (position.x**2 + position.y**2) ** 0.5
        twist.angular.z = math.atan2(position.y, position.x)
        self.pub.publish(twist)


def main():
    rclpy.init()
    try:
        rclpy.spin(Listener())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
