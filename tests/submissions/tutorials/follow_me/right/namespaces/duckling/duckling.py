import math

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import Spawn


class Duckling(Node):
    """Lives in the namespace of its turtle."""

    def __init__(self):
        super().__init__('duckling')
        leader = self.declare_parameter('leader', 'turtle1').value
        self.wanted = self.declare_parameter('wanted', 1.0).value
        rate = self.declare_parameter('rate', 10.0).value
        self.mother = self.me = None
        self.create_subscription(Pose, f'/{leader}/pose', lambda m: setattr(self, 'mother', m), 10)
        self.create_subscription(Pose, 'pose', lambda m: setattr(self, 'me', m), 10)
        self.cmd = self.create_publisher(Twist, 'cmd_vel', 10)
        self.spawn = self.create_client(Spawn, '/spawn', callback_group=ReentrantCallbackGroup())
        self.hatching = self.create_timer(
            0.5, self.hatch, callback_group=MutuallyExclusiveCallbackGroup())
        self.create_timer(1 / rate, self.walk, callback_group=MutuallyExclusiveCallbackGroup())

    def hatch(self):
        if self.mother is None:
            return
        self.hatching.cancel()
        name = self.get_namespace().strip('/')
        x, y = self.mother.x, self.mother.y
        answer = self.spawn.call(Spawn.Request(
            x=x + (1.0 if x < 5.5 else -1.0), y=y, theta=self.mother.theta, name=name))
        self.get_logger().info(f'{answer.name} hatched')

    def walk(self):
        if not (self.me and self.mother):
            return
        dx, dy = self.mother.x - self.me.x, self.mother.y - self.me.y
        bearing = math.remainder(math.atan2(dy, dx) - self.me.theta, math.tau)
        # the speed of mother, corrected
        speed = self.mother.linear_velocity + 1.5 * (math.hypot(dx, dy) - self.wanted)
        self.cmd.publish(Twist(
            linear=Vector3(x=max(0.0, speed * math.cos(bearing))),
            angular=Vector3(z=4.0 * bearing)))


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor()
    executor.add_node(Duckling())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
