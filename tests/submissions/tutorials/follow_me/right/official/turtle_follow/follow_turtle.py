import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

from turtlesim.msg import Pose


class FollowTurtle(Node):

    def __init__(self):
        super().__init__('follow_turtle')
        self.pose1 = None
        self.pose2 = None
        self.create_subscription(Pose, 'turtle1/pose', self.pose1_callback, 10)
        self.create_subscription(Pose, 'turtle2/pose', self.pose2_callback, 10)
        self.publisher = self.create_publisher(Twist, 'turtle2/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.timer_callback)

    def pose1_callback(self, msg):
        self.pose1 = msg

    def pose2_callback(self, msg):
        self.pose2 = msg

    def timer_callback(self):
        if self.pose1 is None or self.pose2 is None:
            return
        dx = self.pose1.x - self.pose2.x
        dy = self.pose1.y - self.pose2.y
        distance = math.sqrt(dx ** 2 + dy ** 2)
        angle = math.atan2(dy, dx) - self.pose2.theta
        # to -pi ... pi
        angle = math.atan2(math.sin(angle), math.cos(angle))

        msg = Twist()
        if distance > 0.7:
            msg.linear.x = 2.0 * (distance - 0.7)
        msg.angular.z = 4.0 * angle
        self.publisher.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = FollowTurtle()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
