"""A right solution as a machine of two states, whose pens stand in a table by signs."""

from enum import Enum, auto
from math import copysign

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class State(Enum):
    DRIVING = auto()
    PARKED = auto()


class Machine(Node):
    PENS = {
        (1.0, 1.0): {"r": 255, "g": 255, "b": 255},
        (-1.0, 1.0): {"r": 255, "g": 0, "b": 128},
        (-1.0, -1.0): {"r": 0, "g": 255, "b": 128},
        (1.0, -1.0): {"r": 0, "g": 64, "b": 255},
    }

    def __init__(self):
        Node.__init__(self, "machine")
        self._state = State.DRIVING
        self._pen = None
        self._t = 0.0
        self._service = self.create_client(SetPen, "/turtle1/set_pen")
        while not self._service.wait_for_service(timeout_sec=1.0):
            self.get_logger().warn("no pen yet")
        self._out = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self._in = self.create_subscription(Pose, "/turtle1/pose", self._hear, 10)
        self._clock_work = self.create_timer(0.4, self._beat)

    def _beat(self):
        match self._state:
            case State.DRIVING:
                self._t += 0.4
                self._out.publish(Twist(linear=Vector3(x=0.12 * self._t), angular=Vector3(z=1.1)))
            case State.PARKED:
                pass

    def _hear(self, p):
        if self._state is State.PARKED:
            return
        walls = [p.x, p.y, 11.0889 - p.x, 11.0889 - p.y]
        if any(w < 1.0 for w in walls):
            self._state = State.PARKED
            self._out.publish(Twist(linear=Vector3(), angular=Vector3()))
            return
        pen = (copysign(1, p.x - 5.5445), copysign(1, p.y - 5.5445))
        if pen == self._pen:
            return
        self._pen = pen
        self._service.call_async(SetPen.Request(width=2, off=0, **self.PENS[pen]))


def main(args=None):
    rclpy.init(args=args)
    machine = Machine()
    try:
        rclpy.spin(machine)
    finally:
        machine.destroy_node()


if __name__ == "__main__":
    main()
