import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, TransformException, TransformListener
from turtlesim.srv import Spawn


class TfListener(Node):
    def __init__(self):
        super().__init__('turtle_tf2_frame_listener')
        self.target_frame = self.declare_parameter('target_frame', 'turtle1').value
        self.tf_buffer = Buffer()
        self.tf_listener = TransformListener(self.tf_buffer, self)
        self.publisher = self.create_publisher(Twist, 'turtle2/cmd_vel', 1)
        client = self.create_client(Spawn, 'spawn')
        client.wait_for_service()
        self.spawned = client.call_async(Spawn.Request(name='turtle2', x=4.0, y=2.0))
        self.create_timer(1.0, self.on_timer)

    def on_timer(self):
        if not self.spawned.done():
            return
        try:
            transform = self.tf_buffer.lookup_transform('turtle2', self.target_frame, Time())
        except TransformException as error:
            self.get_logger().info(str(error))
            return
        to = transform.transform.translation
        message = Twist()
        message.linear.x = 0.5 * math.hypot(to.x, to.y)
        message.angular.z = math.atan2(to.y, to.x)
        self.publisher.publish(message)


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(TfListener())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
