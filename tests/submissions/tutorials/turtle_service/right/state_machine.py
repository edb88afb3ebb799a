"""A timer drives by a plan; the async callback awaits its end."""
import math
from enum import Enum, auto

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from turtle_exercise_interfaces.srv import DrawPolygon

PERIOD = 0.05


class State(Enum):
    IDLE = auto()
    DRIVING = auto()
    TURNING = auto()


class Machine(Node):
    def __init__(self):
        super().__init__("polygon_machine")
        self.state = State.IDLE
        self.steps = 0
        self.sides_left = 0
        self.sides = 0
        self.length = 0.0
        self.done = None
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_timer(PERIOD, self.tick)
        # in a group of its own: while the callback waits, the timer goes on
        group = MutuallyExclusiveCallbackGroup()
        self.create_service(DrawPolygon, "draw_polygon", self.serve, callback_group=group)

    def enter(self, state):
        self.state = state
        self.steps = 40

    def tick(self):
        twist = Twist()
        if self.state is State.IDLE:
            return
        if self.steps > 0:
            self.steps -= 1
            seconds = 40 * PERIOD
            if self.state is State.DRIVING:
                twist.linear.x = self.length / seconds
            else:
                twist.angular.z = -2 * math.pi / self.sides / seconds
        elif self.state is State.DRIVING:
            self.enter(State.TURNING)
        else:
            self.sides_left -= 1
            if self.sides_left:
                self.enter(State.DRIVING)
            else:
                self.state = State.IDLE
                self.done.set_result(True)
        self.pub.publish(twist)

    async def serve(self, request, response):
        if request.sides < 3:
            response.success = False
            response.message = "sides must be 3 or more"
            return response
        self.sides = self.sides_left = request.sides
        self.length = request.length
        self.done = Future()
        self.enter(State.DRIVING)
        response.success = await self.done
        response.message = "drawn"
        return response


def main():
    rclpy.init()
    machine = Machine()
    try:
        rclpy.spin(machine)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        machine.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
