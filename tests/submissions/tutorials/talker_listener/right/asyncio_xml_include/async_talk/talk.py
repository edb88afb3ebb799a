import asyncio

import rclpy
from std_msgs.msg import String


async def talk(node):
    publisher = node.create_publisher(String, 'topic', 10)
    i = 0
    while rclpy.ok():
        text = f'Hello World: {i}'
        publisher.publish(String(data=text))
        node.get_logger().info(f'Publishing: "{text}"')
        i += 1
        await asyncio.sleep(0.5)


async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.0)
        await asyncio.sleep(0.01)


async def both(node):
    await asyncio.gather(talk(node), spin(node))


def main():
    rclpy.init()
    asyncio.run(both(rclpy.create_node('minimal_publisher')))
