import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


def add(request, response):
    response.sum = request.a + request.b
    return response


def main(args=None):
    rclpy.init(args=args)
    node = Node('service')
    node.create_service(AddTwoInts, 'add_two_ints', add)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
