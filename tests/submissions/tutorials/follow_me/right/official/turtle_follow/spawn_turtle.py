import rclpy
from rclpy.node import Node

from turtlesim.srv import Spawn


class SpawnTurtle(Node):

    def __init__(self):
        super().__init__('spawn_turtle')
        self.client = self.create_client(Spawn, 'spawn')
        while not self.client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info('service not available, waiting again...')

    def send_request(self):
        request = Spawn.Request()
        request.x = 2.0
        request.y = 2.0
        request.theta = 0.0
        request.name = 'turtle2'
        return self.client.call_async(request)


def main(args=None):
    rclpy.init(args=args)
    node = SpawnTurtle()
    future = node.send_request()
    rclpy.spin_until_future_complete(node, future)
    node.get_logger().info(f'Spawned {future.result().name}')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
