# Turtle spiral, exercise 3
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class SpiralNode(Node):
    def __init__(self):
        super().__init__("spiral_node")
        self.speed = 0.0
        self.current_quadrant = None
        self.finished = False
        self.publisher_ = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.subscription = self.create_subscription(
            Pose, "/turtle1/pose", self.pose_callback, 10
        )
        self.pen_client = self.create_client(SetPen, "/turtle1/set_pen")
        self.timer = self.create_timer(0.1, self.timer_callback)

    def timer_callback(self):
        if self.finished:
            return
        # a little faster each time
        self.speed = self.speed + 0.04
        msg = Twist()
        msg.linear.x = self.speed
        msg.angular.z = 1.5
        self.publisher_.publish(msg)

    def pose_callback(self, msg):
        if self.finished:
            return
        # stop at the walls
        if msg.x < 1.0 or msg.x > 10.0 or msg.y < 1.0 or msg.y > 10.0:
            self.finished = True
            self.publisher_.publish(Twist())
            self.get_logger().info("Reached the edge, stopping")
            return
        # which quadrant?
        if msg.x >= 5.54 and msg.y >= 5.54:
            quadrant = 1
        elif msg.x < 5.54 and msg.y >= 5.54:
            quadrant = 2
        elif msg.x < 5.54 and msg.y < 5.54:
            quadrant = 3
        else:
            quadrant = 4
        if quadrant != self.current_quadrant:
            self.current_quadrant = quadrant
            self.change_pen(quadrant)

    def change_pen(self, quadrant):
        request = SetPen.Request()
        if quadrant == 1:
            request.r = 255
            request.g = 0
            request.b = 0
        elif quadrant == 2:
            request.r = 0
            request.g = 255
            request.b = 0
        elif quadrant == 3:
            request.r = 255
            request.g = 255
            request.b = 0
        else:
            request.r = 255
            request.g = 255
            request.b = 255
        request.width = 3
        request.off = 0
        self.pen_client.call_async(request)


def main(args=None):
    rclpy.init(args=args)
    node = SpiralNode()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
