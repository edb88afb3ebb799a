"""Qualities of service between own endpoints: late joiners, depths, KEEP_ALL, events, counts."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.qos import QoSDurabilityPolicy as Durability
from rclpy.qos import QoSHistoryPolicy as History
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from std_msgs.msg import String
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
LASTING = Durability.TRANSIENT_LOCAL


def now():
    return f"{node.get_clock().now().nanoseconds / 1e9 % 1000:.4f}"


def spin(seconds):
    end = node.get_clock().now().nanoseconds + int(seconds * 1e9)
    while node.get_clock().now().nanoseconds < end:
        rclpy.spin_once(node, timeout_sec=0.02)


class Ear:
    def __init__(self, name, topic, qos, kind=String, **more):
        self.name, self.heard = name, []
        self.subscription = node.create_subscription(kind, topic, self.hear, qos, **more)

    def hear(self, message, info):
        clock = (info["source_timestamp"], info["received_timestamp"])
        self.heard.append(
            (
                message.data[:30] if hasattr(message, "data") else bytes(message)[:20],
                [f"{t % 10**12 / 1e9:.4f}" for t in clock],
                info.get("publication_sequence_number"),
                info.get("reception_sequence_number"),
            )
        )

    def tell(self):
        print(now(), self.name, len(self.heard), *self.heard, sep="\n    ", flush=True)


twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
lasting = node.create_publisher(String, "words", QoSProfile(depth=3, durability=LASTING))
everything = node.create_publisher(
    String, "all", QoSProfile(history=History.KEEP_ALL, depth=0, durability=LASTING)
)
for i in range(5):
    lasting.publish(String(data=f"word {i}"))
    everything.publish(String(data=f"all {i}"))
spin(0.1)
ears = [
    Ear("late", "words", QoSProfile(depth=10, durability=LASTING)),
    Ear("late, shallow", "words", QoSProfile(depth=1, durability=LASTING)),
    Ear("late, volatile", "words", 10),
    Ear("late, all", "all", QoSProfile(depth=10, durability=LASTING)),
    Ear("late, all, 2", "all", QoSProfile(depth=2, durability=LASTING)),
    Ear("late, raw", "words", QoSProfile(depth=10, durability=LASTING), raw=True),
]
spin(0.1)
for i in range(12):
    lasting.publish(String(data=f"more {i}"))
spin(0.1)
for ear in ears:
    ear.tell()
    node.destroy_subscription(ear.subscription)
ears = [Ear("again", "words", QoSProfile(depth=10, durability=LASTING))]
spin(0.1)
node.destroy_publisher(lasting)
ears.append(Ear("too late", "words", QoSProfile(depth=10, durability=LASTING)))
spin(0.1)
again = node.create_publisher(String, "words", QoSProfile(depth=3, durability=LASTING))
again.publish(String(data="reborn"))
spin(0.1)
for ear in ears:
    ear.tell()

plain = node.create_publisher(String, "plain", 10)
best = node.create_publisher(String, "best", qos_profile_sensor_data)
keep = QoSProfile(history=History.KEEP_ALL, depth=0)
ears = [
    Ear("plain 10", "plain", 10),
    Ear("plain 1", "plain", 1),
    Ear("plain best", "plain", qos_profile_sensor_data),
    Ear("plain all", "plain", keep),
    Ear("best, best", "best", qos_profile_sensor_data),
    Ear("best, reliable", "best", 10),
    Ear("plain lasting", "plain", QoSProfile(depth=4, durability=LASTING)),
]
for i in range(40):
    plain.publish(String(data=f"plain {i}"))
    best.publish(String(data=f"best {i}"))
spin(1.0)
for ear in ears:
    ear.tell()
poses = []


def hear(pose, info):
    poses.append(
        (
            round(pose.x, 3),
            info["publication_sequence_number"],
            info["source_timestamp"] % 10**11,
            info["received_timestamp"] % 10**11,
        )
    )


twist.angular.z = 0.3
velocity.publish(twist)
node.create_subscription(Pose, "/turtle1/pose", hear, qos_profile_sensor_data)
spin(0.3)
print(len(poses), poses)
print(node.count_publishers("best"), node.count_subscribers("plain"))
