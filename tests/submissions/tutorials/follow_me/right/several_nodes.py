import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import Spawn


class Hatchery(Node):
    """Spawns a turtle, then has nothing more to do."""

    def __init__(self, name):
        super().__init__('hatchery')
        self.name = name
        self.client = self.create_client(Spawn, '/spawn')
        self.timer = self.create_timer(0.2, self.try_it)

    async def try_it(self):
        if not self.client.service_is_ready():
            return
        self.timer.cancel()
        response = await self.client.call_async(Spawn.Request(x=8.0, y=8.0, name=self.name))
        self.get_logger().info('Hello, %s!' % response.name)


class Eyes(Node):
    """Knows where a turtle is."""

    def __init__(self, name):
        super().__init__(f'eyes_on_{name}')
        self.pose = None
        self.create_subscription(Pose, f'/{name}/pose', self.look, 10)

    def look(self, pose):
        self.pose = pose


class Legs(Node):
    """Drives its own turtle after the leader."""

    def __init__(self, name, leader, own):
        super().__init__(f'legs_of_{name}')
        self.leader, self.own = leader, own
        self.publisher = self.create_publisher(Twist, f'/{name}/cmd_vel', 10)
        self.create_timer(0.05, self.step)

    def step(self):
        a, b = self.leader.pose, self.own.pose
        if a is None or b is None:
            return
        goal = complex(a.x, a.y) - complex(math.cos(a.theta), math.sin(a.theta))
        way = (goal - complex(b.x, b.y)) * complex(math.cos(b.theta), -math.sin(b.theta))
        twist = Twist()
        twist.linear.x = 2.5 * way.real
        twist.angular.z = 8.0 * way.imag
        self.publisher.publish(twist)


def main():
    rclpy.init()
    eyes = [Eyes('turtle1'), Eyes('turtle2')]
    executor = SingleThreadedExecutor()
    for node in (*eyes, Hatchery('turtle2'), Legs('turtle2', *eyes)):
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
