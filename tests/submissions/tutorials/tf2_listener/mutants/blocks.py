# In the form of the ROS 2 tutorial's program.
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from tf2_ros import TransformException
from tf2_ros.buffer import Buffer
from tf2_ros.transform_listener import TransformListener
from turtlesim.srv import Spawn


class Follower(Node):

    def __init__(self):
        super().__init__('turtle_tf2_frame_listener')

        parameter = self.declare_parameter('target_frame', 'turtle1')
        self.target = parameter.get_parameter_value().string_value

        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)

        self.spawner = self.create_client(Spawn, 'spawn')
        self.is_service_ready = False
        self.is_spawned = False

        self.velocity = self.create_publisher(Twist, 'turtle2/cmd_vel', 1)
        self.timer = self.create_timer(1.0, self.on_timer)

    def on_timer(self):
        if not self.is_service_ready:
            if self.spawner.service_is_ready():
                request = Spawn.Request()
                request.name = 'turtle2'
                request.x = 4.0
                request.y = 2.0
                request.theta = 0.0
                self.answer = self.spawner.call(request)
                self.is_service_ready = True
            else:
                self.get_logger().info('Nobody can spawn a turtle yet')
        elif not self.is_spawned:
            if self.answer.done():
                self.get_logger().info(f'There is {self.answer.result().name}')
                self.is_spawned = True
            else:
                self.get_logger().info('The turtle is not there yet')
        else:
            self.follow()

    def follow(self):
        try:
            found = self.buffer.lookup_transform('turtle2', self.target, rclpy.time.Time())
        except TransformException as error:
            self.get_logger().info(f'No way from turtle2 to {self.target}: {error}')
            return

        x = found.transform.translation.x
        y = found.transform.translation.y
        command = Twist()
        command.angular.z = 1.0 * math.atan2(y, x)
        command.linear.x = 0.5 * math.sqrt(x ** 2 + y ** 2)
        self.velocity.publish(command)


def main():
    rclpy.init()
    follower = Follower()
    try:
        rclpy.spin(follower)
    except KeyboardInterrupt:
        pass

    rclpy.shutdown()


if __name__ == '__main__':
    main()
