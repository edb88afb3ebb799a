import rclpy
from action_tutorials_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Client(Node):
    def __init__(self):
        super().__init__("fibonacci_client")
        self.client = ActionClient(self, Fibonacci, "fibonacci")

    async def compute(self, order):
        goal = Fibonacci.Goal()
        goal.order = order
        handle = await self.client.send_goal_async(goal, feedback_callback=self.tell)
        if not handle.accepted:
            return
        response = await handle.get_result_async()
        self.get_logger().info(f"Result: {list(response.result.sequence)}")

    def tell(self, message):
        self.get_logger().info(f"Received feedback: {list(message.feedback.partial_sequence)}")


def main():
    rclpy.init()
    node = Client()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    node.client.wait_for_server()
    executor.spin_until_future_complete(executor.create_task(node.compute(10)))
    rclpy.shutdown()


if __name__ == "__main__":
    main()
