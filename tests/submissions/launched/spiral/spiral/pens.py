import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

COLORS = {
    (True, True): (255, 255, 255),
    (False, True): (255, 0, 0),
    (False, False): (0, 255, 0),
    (True, False): (0, 0, 255),
}


class Pens(Node):
    def __init__(self):
        super().__init__("pen_node")
        self.declare_parameter("width", 3)
        self.quadrant = None
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_subscription(Pose, "pose", self.watch, 10)

    def watch(self, pose):
        quadrant = (pose.x >= 5.544445, pose.y >= 5.544445)
        if quadrant != self.quadrant:
            self.quadrant = quadrant
            r, g, b = COLORS[quadrant]
            width = self.get_parameter("width").value
            self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=width, off=0))


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Pens())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
