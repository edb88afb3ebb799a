import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose


class Driver(Node):
    def __init__(self):
        super().__init__("turtle_controller")
        self.speed = 0.0
        self.stopped = False
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.watch, 10)
        self.create_timer(0.5, self.drive)

    def drive(self):
        if self.stopped:
            return
        self.speed += 0.1
        twist = Twist()
        twist.linear.x = self.speed
        twist.angular.z = 1.0
        self.velocity.publish(twist)

    def watch(self, pose):
        if not self.stopped and not (0.5 < pose.x < 10.5 and 0.5 < pose.y < 10.5):
            self.stopped = True
            self.velocity.publish(Twist())


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Driver())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
