"""Callback groups and a MultiThreadedExecutor, so that a callback may wait for the pen."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

COLORS = {"I": (255, 255, 255), "II": (255, 0, 0), "III": (0, 0, 0), "IV": (0, 255, 0)}


class Controller(Node):
    """Drives with one group, looks with another, paints with a third."""

    def __init__(self) -> None:
        super().__init__("controller")
        self.linear_speed: float = 0.0
        self.quadrant: str = ""
        self.done: bool = False
        self.wheels = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.brush = self.create_client(
            SetPen, "/turtle1/set_pen", callback_group=ReentrantCallbackGroup()
        )
        self.create_subscription(
            Pose,
            "/turtle1/pose",
            self.look,
            10,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.create_timer(0.1, self.go, callback_group=MutuallyExclusiveCallbackGroup())

    def go(self) -> None:
        if not self.done:
            self.linear_speed += 0.05
            cmd = Twist()
            cmd.linear.x = self.linear_speed
            cmd.angular.z = 1.8
            self.wheels.publish(cmd)

    async def look(self, pose: Pose) -> None:
        if self.done:
            return
        if pose.x <= 1.0 or pose.x >= 10.0 or pose.y <= 1.0 or pose.y >= 10.0:
            self.done = True
            self.wheels.publish(Twist())
            return
        quadrant = self.name_of(pose.x - 5.5444, pose.y - 5.5444)
        if quadrant != self.quadrant:
            self.quadrant = quadrant
            r, g, b = COLORS[quadrant]
            await self.brush.call_async(SetPen.Request(r=r, g=g, b=b, width=5))

    def name_of(self, dx: float, dy: float) -> str:
        if dx >= 0 and dy >= 0:
            return "I"
        if dx < 0 and dy >= 0:
            return "II"
        if dx < 0:
            return "III"
        return "IV"


def main() -> None:
    rclpy.init()
    node = Controller()
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
