import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String


class Ear(Node):
    def __init__(self):
        super().__init__('ear')
        self.create_subscription(String, 'speech', self.hear, qos_profile_sensor_data)

    async def hear(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')


def main():
    rclpy.init()
    rclpy.spin(Ear())
