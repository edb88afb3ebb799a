"""Incompatible qualities of service: what is said of them, and that nothing arrives."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import QoSDurabilityPolicy as Durability
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from std_msgs.msg import String
from turtlesim.msg import Color, Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
LASTING = QoSProfile(depth=4, durability=Durability.TRANSIENT_LOCAL)


def now():
    return f"{node.get_clock().now().nanoseconds / 1e9 % 1000:.4f}"


def spin(seconds):
    end = node.get_clock().now().nanoseconds + int(seconds * 1e9)
    while node.get_clock().now().nanoseconds < end:
        rclpy.spin_once(node, timeout_sec=0.02)


def events(name):
    return SubscriptionEventCallbacks(
        incompatible_qos=lambda e: print(
            now(), name, "unfit", e.total_count, e.total_count_change, flush=True
        ),
        matched=lambda e: print(now(), name, "match", e.total_count, e.current_count, flush=True),
    )


def publisher_events(name):
    return PublisherEventCallbacks(
        incompatible_qos=lambda e: print(now(), name, "unfit", e.total_count, flush=True),
        matched=lambda e: print(now(), name, "match", e.total_count, e.current_count, flush=True),
    )


twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
heard = []
node.create_subscription(Pose, "/turtle1/pose", heard.append, LASTING)
spin(0.2)
print(now(), "default", len(heard), flush=True)
node.create_subscription(
    Color, "/turtle1/color_sensor", heard.append, LASTING, event_callbacks=events("color")
)
node.create_subscription(Pose, "/turtle1/pose", lambda p: None, 10, event_callbacks=events("pose"))
unheard = node.create_publisher(
    Twist, "/turtle1/cmd_vel", qos_profile_sensor_data, event_callbacks=publisher_events("best")
)
twist.linear.x = 2.0
unheard.publish(twist)
spin(0.2)
print(now(), len(heard), unheard.get_subscription_count(), flush=True)
own = node.create_publisher(String, "own", 10, event_callbacks=publisher_events("own"))
first = node.create_subscription(String, "own", heard.append, 10, event_callbacks=events("first"))
second = node.create_subscription(String, "own", heard.append, LASTING)
own.publish(String(data="a"))
spin(0.2)
node.destroy_subscription(first)
node.destroy_subscription(second)
spin(0.2)
node.create_subscription(String, "own", heard.append, 10)
spin(0.1)
print(now(), len(heard), flush=True)
