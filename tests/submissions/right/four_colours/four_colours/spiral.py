import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

WHITE = (255, 255, 255)
RED = (255, 0, 0)
BLACK = (0, 0, 0)
LIME = (100, 255, 0)


class Spiral(Node):
    def __init__(self):
        super().__init__("spiral")
        self._speed = 0.05
        self._turn = 1.0
        self._quadrant = -1
        self._stopped = False
        self._twist_pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self._pen_client = self.create_client(SetPen, "/turtle1/set_pen")
        self._pen_client.wait_for_service()
        self._pose_sub = self.create_subscription(Pose, "/turtle1/pose", self._on_pose, 10)
        self._timer = self.create_timer(0.5, self._on_timer)

    def _on_timer(self):
        if not self._stopped:
            self._speed *= 1.01
            self._speed += 0.05
            twist = Twist()
            twist.linear.x = self._speed
            twist.angular.z = self._turn
            self._twist_pub.publish(twist)

    def _on_pose(self, pose):
        if self._stopped:
            return
        near_left_or_right = pose.x < 0.8 or pose.x > 10.2
        near_bottom_or_top = pose.y < 0.8 or pose.y > 10.2
        if near_left_or_right or near_bottom_or_top:
            self._stopped = True
            self._twist_pub.publish(Twist())
            return
        quadrant = self._get_quadrant(pose.x, pose.y)
        if quadrant != self._quadrant:
            self._quadrant = quadrant
            if quadrant == 1:
                self._set_pen(WHITE)
            if quadrant == 2:
                self._set_pen(RED)
            if quadrant == 3:
                self._set_pen(BLACK)
            if quadrant == 4:
                self._set_pen(LIME)

    def _get_quadrant(self, x, y):
        if x > 5.54 and y > 5.54:
            return 1
        if x < 5.54 and y > 5.54:
            return 2
        if x < 5.54 and y < 5.54:
            return 3
        return 4

    def _set_pen(self, color):
        request = SetPen.Request()
        request.r = color[0]
        request.g = color[1]
        request.b = color[2]
        request.width = 3
        request.off = 0
        self._pen_client.call_async(request)


def main(args=None):
    rclpy.init(args=args)
    spiral = Spiral()
    rclpy.spin(spiral)
    spiral.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
