"""An async callback that awaits futures which a timer sets."""
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from turtle_exercise_interfaces.srv import DrawPolygon


class PolygonDrawer(Node):
    def __init__(self):
        super().__init__("polygon_drawer")
        self.group = ReentrantCallbackGroup()
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.service = self.create_service(
            DrawPolygon, "draw_polygon", self.draw, callback_group=self.group
        )

    async def pause(self, seconds):
        future = Future()
        timer = self.create_timer(
            seconds, lambda: future.done() or future.set_result(None), callback_group=self.group
        )
        await future
        timer.cancel()
        self.destroy_timer(timer)

    async def drive(self, linear, angular, seconds):
        command = Twist()
        command.linear.x = linear
        command.angular.z = angular
        for _ in range(5):
            self.publisher.publish(command)
            await self.pause(seconds / 5)
        self.publisher.publish(Twist())
        await self.pause(0.2)

    async def draw(self, request, response):
        if request.sides < 3:
            response.success = False
            response.message = f"{request.sides} sides make no polygon"
            return response
        for _ in range(request.sides):
            await self.drive(request.length / 2, 0.0, 2.0)
            await self.drive(0.0, math.radians(360 / request.sides), 1.0)
        response.success = True
        response.message = "done"
        return response


def main():
    rclpy.init()
    node = PolygonDrawer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
