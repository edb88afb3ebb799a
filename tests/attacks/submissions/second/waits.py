import rclpy
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = rclpy.create_node("waits")
    node.create_subscription(Twist, "/mine", lambda twist: print("ACHIEVED a forgery"), 10)
    node.create_timer(0.1, lambda: None)
    rclpy.spin(node)
