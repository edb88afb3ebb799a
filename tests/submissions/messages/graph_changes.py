"""Asks what there is right after it has come and gone."""

import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from std_srvs.srv import Empty
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose
from turtlesim.srv import Kill, Spawn

rclpy.init()
node = rclpy.create_node("controller")


def now():
    return f"{node.get_clock().now().nanoseconds / 1e9 % 1000:.4f}"


def tell():
    print(now())
    print(" ", sorted(node.get_node_names_and_namespaces()))
    for names in (node.get_topic_names_and_types(), node.get_service_names_and_types()):
        print(" ", sorted((name, kinds) for name, kinds in names))
    for topic in ("/turtle1/pose", "/turtle2/pose", "/turtle2/cmd_vel", "/rosout", "/own"):
        print(
            " ",
            topic,
            node.count_publishers(topic),
            node.count_subscribers(topic),
            sorted(i.node_name for i in node.get_publishers_info_by_topic(topic)),
            sorted(
                (i.node_name, i.topic_type, i.qos_profile.depth, str(i.qos_profile.reliability))
                for i in node.get_subscriptions_info_by_topic(topic)
            ),
        )
    for name in ("turtlesim", "controller"):
        print(" ", sorted(node.get_publisher_names_and_types_by_node(name, "/")))
        print(" ", sorted(node.get_subscriber_names_and_types_by_node(name, "/")))
        print(" ", sorted(node.get_service_names_and_types_by_node(name, "/")))
        print(" ", sorted(node.get_client_names_and_types_by_node(name, "/")), flush=True)


def call(kind, service, **fields):
    client = node.create_client(kind, service)
    print(
        now(),
        client.service_is_ready(),
        client.wait_for_service(1.0),
        node.count_services(service),
        node.count_clients(service),
    )
    answer = client.call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, answer, timeout_sec=1.0)
    node.destroy_client(client)
    return answer.result()


tell()
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
other = node.create_publisher(Twist, "/turtle2/cmd_vel", 10)
hear = node.create_subscription(Pose, "/turtle2/pose", lambda p: None, 10)
print(
    now(),
    velocity.get_subscription_count(),
    other.get_subscription_count(),
    hear.get_publisher_count(),
)
action = ActionClient(node, RotateAbsolute, "/turtle1/rotate_absolute")
second = ActionClient(node, RotateAbsolute, "/turtle2/rotate_absolute")
print(now(), action.server_is_ready(), second.server_is_ready(), second.wait_for_server(0.2), now())
print(node.wait_for_node("/turtlesim", 1.0), node.wait_for_node("/nobody", 0.3), now())
tell()
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
print(call(Spawn, "/spawn", x=1.0, y=1.0, theta=0.0, name="turtle2"))
print(
    now(),
    velocity.get_subscription_count(),
    other.get_subscription_count(),
    hear.get_publisher_count(),
    second.server_is_ready(),
)
tell()
print(call(Kill, "/kill", name="turtle2"))
print(
    now(),
    velocity.get_subscription_count(),
    other.get_subscription_count(),
    hear.get_publisher_count(),
    second.server_is_ready(),
)
tell()
call(Empty, "/reset")
print(now(), velocity.get_subscription_count(), other.get_subscription_count())
own = rclpy.create_node("own", namespace="/mine")
server = own.create_service(Empty, "clear", lambda q, a: a)
client = node.create_client(Empty, "/mine/clear")
print(client.service_is_ready(), node.wait_for_node("/mine/own", 0.1))
own.destroy_service(server)
print(client.service_is_ready(), client.wait_for_service(0.2), now())
own.destroy_node()
node.destroy_publisher(other)
tell()
print(node.resolve_topic_name("x"), node.get_fully_qualified_name())
velocity.publish(twist)
time.sleep(0.3)
