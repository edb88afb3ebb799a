"""The action: a goal with feedback, one that is cancelled, one that a command ends."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from turtlesim.action import RotateAbsolute

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
rotate = ActionClient(node, RotateAbsolute, "/turtle1/rotate_absolute")
assert rotate.wait_for_server(timeout_sec=1.0)
feedback = []


def now():
    return f"{node.get_clock().now().nanoseconds / 1e9 % 1000:.3f}"


def wait(future):
    rclpy.spin_until_future_complete(node, future, timeout_sec=20.0)
    return future.result()


def start(theta):
    goal = RotateAbsolute.Goal(theta=theta)
    handle = wait(rotate.send_goal_async(goal, feedback_callback=feedback.append))
    print(now(), "accepted", handle.accepted)
    return handle


def end(handle, result):
    answer = wait(result)
    print(now(), answer.status, answer.result, len(feedback), handle.status)


def spin(seconds):
    end = node.get_clock().now().nanoseconds + int(seconds * 1e9)
    while node.get_clock().now().nanoseconds < end:
        rclpy.spin_once(node, timeout_sec=0.05)


first = start(1.0)
end(first, first.get_result_async())
second = start(-2.0)
spin(0.3)
print(now(), wait(second.cancel_goal_async()).return_code)
end(second, second.get_result_async())
third = start(3.0)
result = third.get_result_async()
spin(0.3)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
end(third, result)
fourth, fifth = start(0.0), start(1.5)
end(fourth, fourth.get_result_async())
end(fifth, fifth.get_result_async())
