import rclpy
from action_tutorials_interfaces.action import Fibonacci
from rclpy.action import ActionClient

rclpy.init()
node = rclpy.create_node("fibonacci_client")
log = node.get_logger()
client = ActionClient(node, Fibonacci, "fibonacci")


def on_feedback(msg):
    log.info("Received feedback: " + str(msg.feedback.partial_sequence.tolist()))


while not client.wait_for_server(timeout_sec=1.0):
    log.info("No server yet")
future = client.send_goal_async(Fibonacci.Goal(order=10), feedback_callback=on_feedback)
rclpy.spin_until_future_complete(node, future)
handle = future.result()
if handle.accepted:
    future = handle.get_result_async()
    rclpy.spin_until_future_complete(node, future)
    log.info("Result: " + str(future.result().result.sequence.tolist()))
else:
    log.error("Refused")
node.destroy_node()
rclpy.shutdown()
