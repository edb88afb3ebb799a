"""An action server and its client in a process: goals that succeed, abort and are cancelled."""

import threading
import time

import rclpy
from action_msgs.msg import GoalStatusArray
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import qos_profile_action_status_default
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
group = ReentrantCallbackGroup()
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)


def now():
    return f"{time.time() % 1000:.4f}"


def execute(handle):
    for step in range(10):
        if handle.is_cancel_requested:
            handle.canceled()
            return RotateAbsolute.Result(delta=float(step))
        twist = Twist()
        twist.linear.x, twist.angular.z = 0.5, handle.request.theta
        velocity.publish(twist)
        handle.publish_feedback(RotateAbsolute.Feedback(remaining=10.0 - step))
        time.sleep(0.05)
    if handle.request.theta > 2.0:
        handle.abort()
    else:
        handle.succeed()
    return RotateAbsolute.Result(delta=handle.request.theta)


def on_goal(request):
    return GoalResponse.REJECT if request.theta < 0.0 else GoalResponse.ACCEPT


server = ActionServer(
    node, RotateAbsolute, "turn", execute, goal_callback=on_goal,
    cancel_callback=lambda handle: CancelResponse.ACCEPT, callback_group=group,
    result_timeout=1,
)  # fmt: skip
client = ActionClient(node, RotateAbsolute, "turn", callback_group=group)
statuses = []
node.create_subscription(
    GoalStatusArray, "turn/_action/status",
    lambda m: statuses.append((now(), [s.status for s in m.status_list])),
    qos_profile_action_status_default, callback_group=group,
)  # fmt: skip
poses = []
node.create_subscription(Pose, "/turtle1/pose", poses.append, 10, callback_group=group)
executor = MultiThreadedExecutor(6)
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
feedback = []


def hear(message):
    feedback.append((now(), message.feedback.remaining))


def wait(future):
    while not future.done():
        time.sleep(0.01)
    return future.result()


print(now(), client.wait_for_server(1.0), client.server_is_ready())
one = wait(client.send_goal_async(RotateAbsolute.Goal(theta=0.5), feedback_callback=hear))
print(now(), one.accepted, one.status)
print(now(), wait(one.get_result_async()), len(feedback), feedback[:2], feedback[-1:])
two = wait(client.send_goal_async(RotateAbsolute.Goal(theta=3.0)))
print(now(), wait(two.get_result_async()))
print(now(), wait(client.send_goal_async(RotateAbsolute.Goal(theta=-1.0))).accepted)
several = [client.send_goal_async(RotateAbsolute.Goal(theta=i / 10)) for i in range(3)]
handles = [wait(future) for future in several]
time.sleep(0.12)
print(now(), wait(handles[1].cancel_goal_async()))
print(now(), [wait(h.get_result_async()) for h in handles])
print(now(), wait(handles[1].cancel_goal_async()))
time.sleep(2.0)
print(now(), wait(one.get_result_async()))
print(now(), [h.status for h in handles], statuses)
server.destroy()
print(now(), client.server_is_ready(), len(poses))
late = []
node.create_subscription(
    GoalStatusArray, "turn/_action/status", late.append, qos_profile_action_status_default
)
time.sleep(0.1)
print(late)
