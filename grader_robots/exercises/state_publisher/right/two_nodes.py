"""Two nodes in one process: one moves the joints, the other follows their stamps through the world."""

import math
import rclpy
from rclpy.executors import MultiThreadedExecutor, ExternalShutdownException
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import JointState
from geometry_msgs.msg import TransformStamped
import tf2_ros

class Odometry(Node):
    def __init__(self):
        super().__init__('odometry')
        self.br = tf2_ros.TransformBroadcaster(self)
        self.create_subscription(JointState, 'joint_states', self.on_state, 10)

    def on_state(self, msg):
        swivel = msg.position[msg.name.index('swivel')]
        a = -swivel / 3
        t = TransformStamped()
        t.header = msg.header
        t.header.frame_id = 'odom'
        t.child_frame_id = 'axis'
        t.transform.translation.x = 1.0 + 0.8 * math.cos(a)
        t.transform.translation.y = -2.0 + 0.8 * math.sin(a)
        t.transform.translation.z = 0.5
        yaw = a - math.pi / 2
        t.transform.rotation.z = math.sin(yaw / 2)
        t.transform.rotation.w = math.cos(yaw / 2)
        self.br.sendTransform(t)

class Joints(Node):
    def __init__(self):
        super().__init__('joints')
        self.pub = self.create_publisher(JointState, 'joint_states', 10)
        self.n = 0
        self.create_timer(0.025, self.step, callback_group=ReentrantCallbackGroup())

    def step(self):
        self.n += 1
        m = JointState()
        m.header.stamp = self.get_clock().now().to_msg()
        u = (self.n % 160) / 80
        tri = u if u <= 1 else 2 - u
        positions = {'swivel': math.radians(self.n), 'tilt': -0.4 * tri, 'periscope': 0.3 * tri}
        m.name, m.position = list(positions), list(positions.values())
        self.pub.publish(m)

def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(num_threads=4)
    nodes = [Joints(), Odometry()]
    for n in nodes:
        executor.add_node(n)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        for n in nodes:
            n.destroy_node()
        rclpy.try_shutdown()
