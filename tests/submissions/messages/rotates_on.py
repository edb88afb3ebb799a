"""The simulator's action: late results, goals in a row, cancel of all, feedback while driving."""

import threading
import time

import rclpy
from action_msgs.msg import GoalInfo, GoalStatusArray
from action_msgs.srv import CancelGoal
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from rclpy.qos import qos_profile_action_status_default
from turtlesim.action import RotateAbsolute

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
action = ActionClient(node, RotateAbsolute, "/turtle1/rotate_absolute")
cancel = node.create_client(CancelGoal, "/turtle1/rotate_absolute/_action/cancel_goal")
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
feedback, statuses = [], []
hear = node.create_subscription(
    GoalStatusArray, "/turtle1/rotate_absolute/_action/status",
    lambda m: statuses.append((now(), [s.status for s in m.status_list])),
    qos_profile_action_status_default,
)  # fmt: skip


def now():
    return f"{time.time() % 1000:.4f}"


def wait(future):
    while not future.done():
        time.sleep(0.005)
    return future.result()


def goal(theta):
    return action.send_goal_async(
        RotateAbsolute.Goal(theta=theta), feedback_callback=lambda m: feedback.append(now())
    )


def drive(linear):
    twist = Twist()
    twist.linear.x = linear
    velocity.publish(twist)


print(action.wait_for_server(2.0), cancel.wait_for_service(2.0))
one = wait(goal(1.0))
time.sleep(1.5)
print(now(), len(feedback), feedback[:2], one.status)
print(now(), wait(one.get_result_async()))
drive(1.0)
time.sleep(0.2)
two = wait(goal(-2.0))
time.sleep(0.2)
drive(0.5)
time.sleep(0.2)
print(now(), wait(two.get_result_async()), len(feedback))
several = [goal(i / 3) for i in range(4)]
handles = [wait(f) for f in several]
print(now(), [h.accepted for h in handles])
time.sleep(0.1)
answer = wait(cancel.call_async(CancelGoal.Request(goal_info=GoalInfo())))
print(now(), answer.return_code, len(answer.goals_canceling))
print(now(), [wait(h.get_result_async()) for h in handles])
print(now(), wait(handles[0].cancel_goal_async()).return_code)
three = wait(goal(2.5))
result = three.get_result_async()
time.sleep(0.05)
asked = three.cancel_goal_async()
drive(0.3)
print(now(), wait(asked).return_code, wait(result))
node.destroy_subscription(hear)
late = []
node.create_subscription(
    GoalStatusArray, "/turtle1/rotate_absolute/_action/status", lambda m: late.append((now(), m)),
    qos_profile_action_status_default,
)  # fmt: skip
time.sleep(0.1)
print(now(), late and [s.status for s in late[-1][1].status_list], len(late), statuses)
four = wait(goal(0.0))
action.destroy()
time.sleep(0.3)
drive(0.2)
time.sleep(0.2)
print(now(), len(feedback), late and [s.status for s in late[-1][1].status_list], len(late))
