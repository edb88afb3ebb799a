import rclpy
from std_msgs.msg import String

count = 0


def say_hello():
    global count
    text = f"Hello World: {count}"
    publisher.publish(String(data=text))
    node.get_logger().info(f'Publishing: "{text}"')
    count += 1


rclpy.init()
node = rclpy.create_node("minimal_publisher")
publisher = node.create_publisher(String, "topic", 10)
node.create_timer(0.5, say_hello)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
