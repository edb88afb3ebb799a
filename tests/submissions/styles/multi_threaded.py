"""MultiThreadedExecutor, reentrant callbacks, one of them async, and a future to begin with."""

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from spiral import CMD_VEL, PERIOD_S, POSE, SET_PEN, Pose, SetPen, Spiral, Twist


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        group = ReentrantCallbackGroup()
        self.spiral = Spiral()
        self.answers = 0
        self.velocity = self.create_publisher(Twist, CMD_VEL, 10)
        self.pen = self.create_client(SetPen, SET_PEN, callback_group=group)
        self.create_subscription(Pose, POSE, self.on_pose, 10, callback_group=group)
        self.create_timer(PERIOD_S, self.on_timer, callback_group=group)

    def on_timer(self):
        if not self.spiral.done:
            self.velocity.publish(self.spiral.command())

    async def on_pose(self, pose):
        if self.spiral.done:
            return
        if self.spiral.is_outside(pose):
            self.velocity.publish(Twist())
            self.get_logger().info(f"{self.answers} answers")
        elif request := self.spiral.pen(pose):
            await self.pen.call_async(request)
            self.answers += 1


def main():
    rclpy.init()
    node = Controller()
    first = node.pen.call_async(SetPen.Request(r=255, g=255, b=255, width=3))
    rclpy.spin_until_future_complete(node, first)
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    executor.spin()


main()
