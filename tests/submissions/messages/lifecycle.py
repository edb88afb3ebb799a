"""A lifecycle node that configures and activates itself, and drives for three seconds."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.lifecycle import LifecycleNode


class Driver(LifecycleNode):
    def __init__(self):
        super().__init__("driver")
        self.velocity = self.create_lifecycle_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_timer(0.5, self.drive)
        self.driven = 0

    def drive(self):
        self.driven += 1
        if self.driven < 6:
            twist = Twist()
            twist.linear.x = 1.0
            self.velocity.publish(twist)


rclpy.init()
node = Driver()
node.trigger_configure()
node.trigger_activate()
rclpy.spin(node)
