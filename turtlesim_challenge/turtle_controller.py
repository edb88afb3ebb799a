"""The reference controller: draw a spiral in four colours and stop near the edge.

It does three things, each in one method: it drives (`drive`, twice a second), it watches the pose
(`watch`, 62.5 times a second), and it changes the pen when the turtle enters another quarter of
the window (`set_pen`).
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

try:
    from turtlesim.msg import Pose
    from turtlesim.srv import SetPen
except ImportError:  # from ROS 2 Kilted on
    from turtlesim_msgs.msg import Pose
    from turtlesim_msgs.srv import SetPen

CENTRE = 5.544445  # metres; the window is 11.088889 m wide and high
EDGE = 0.5  # stop when a wall is nearer than this, in metres
FAR = 2 * CENTRE - EDGE

PEN_COLORS = {  # quadrant -> red, green, blue
    1: (255, 255, 255),
    2: (255, 0, 0),
    3: (0, 255, 0),
    4: (0, 0, 255),
}


def quadrant(x: float, y: float) -> int:
    """Number the quarters of the window as in mathematics: I is top right, then left around."""
    if y >= CENTRE:
        return 1 if x >= CENTRE else 2
    return 3 if x < CENTRE else 4


class TurtleController(Node):
    """Drives turtle1 along a spiral."""

    def __init__(self) -> None:
        super().__init__("turtle_controller")
        self.speed = 0.0
        self.quadrant = 0  # none yet
        self.stopped = False
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.pen.wait_for_service()
        self.create_subscription(Pose, "/turtle1/pose", self.watch, 10)
        self.create_timer(0.5, self.drive)

    def drive(self) -> None:
        """Go round at a constant rate, a little faster each time: the circle opens to a spiral."""
        if self.stopped:
            return
        self.speed += 0.05
        twist = Twist()
        twist.linear.x = self.speed
        twist.angular.z = 1.0
        self.velocity.publish(twist)

    def watch(self, pose: Pose) -> None:
        """Stop near the edge; otherwise choose the pen of the quadrant that the turtle is in."""
        if self.stopped:
            return
        if not (EDGE < pose.x < FAR and EDGE < pose.y < FAR):
            self.stopped = True
            self.velocity.publish(Twist())
            self.get_logger().info(f"Stopped near the edge at ({pose.x:.2f}, {pose.y:.2f})")
        elif quadrant(pose.x, pose.y) != self.quadrant:
            self.quadrant = quadrant(pose.x, pose.y)
            self.set_pen(*PEN_COLORS[self.quadrant])

    def set_pen(self, r: int, g: int, b: int) -> None:
        """Ask for another colour; the answer holds nothing, so nobody waits for it."""
        self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3, off=0))


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(TurtleController())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
