#!/usr/bin/env python3
import rclpy
from rclpy.node import Node

from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class PenSpiral(Node):

    def __init__(self):
        super().__init__('pen_spiral')
        self.cmd_vel = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.set_pen = self.create_client(SetPen, '/turtle1/set_pen')
        while not self.set_pen.wait_for_service(timeout_sec=1.0):
            self.get_logger().info('service not available, waiting again...')
        self.x = 5.5
        self.y = 5.5
        self.linear = 0.0
        self.region = 0
        self.stopped = False
        self.pose_sub = self.create_subscription(Pose, '/turtle1/pose', self.update_pose, 10)
        self.timer = self.create_timer(0.05, self.control_loop)

    def update_pose(self, msg):
        self.x = msg.x
        self.y = msg.y

    def control_loop(self):
        if self.stopped:
            return
        if self.x < 1.3 or self.x > 9.8 or self.y < 1.3 or self.y > 9.8:
            self.stop()
            return
        region = self.find_region()
        if region != self.region:
            self.region = region
            self.request_pen(region)
        vel_msg = Twist()
        vel_msg.linear.x = self.linear
        vel_msg.angular.z = 1.6
        self.cmd_vel.publish(vel_msg)
        self.linear += 0.02

    def stop(self):
        self.stopped = True
        vel_msg = Twist()
        vel_msg.linear.x = 0.0
        vel_msg.angular.z = 0.0
        self.cmd_vel.publish(vel_msg)
        self.get_logger().warn('Edge reached')

    def find_region(self):
        if self.x > 5.54 and self.y > 5.54:
            return 1
        elif self.x <= 5.54 and self.y > 5.54:
            return 2
        elif self.x <= 5.54 and self.y <= 5.54:
            return 3
        return 4

    def request_pen(self, region):
        req = SetPen.Request()
        req.r = 255 if region in (1, 2) else 0
        req.g = 255 if region in (1, 3) else 0
        req.b = 0
        req.width = 3
        req.off = 0
        future = self.set_pen.call_async(req)
        future.add_done_callback(self.pen_done)

    def pen_done(self, future):
        future.result()
        self.get_logger().info('pen changed')


def main(args=None):
    rclpy.init(args=args)
    node = PenSpiral()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        node.get_logger().info('bye')


if __name__ == '__main__':
    main()
