"""Namespaces, remapped names and private ones, also of an action's parts."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from std_msgs.msg import String
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

rclpy.init(
    args=[
        "--ros-args",
        "-r",
        "go:=/turtle1/cmd_vel",
        "-r",
        "turn:=/turtle1/rotate_absolute",
        "-r",
        "/lab/pen:=/turtle1/set_pen",
        "-r",
        "__ns:=/lab",
        "-r",
        "turn/_action/feedback:=/turtle1/rotate_absolute/_action/feedback",
    ]
)
node = rclpy.create_node("controller", cli_args=["--ros-args", "-r", "where:=/turtle1/pose"])
velocity = node.create_publisher(Twist, "go", 10)
poses = []
node.create_subscription(Pose, "where", poses.append, 10)
pen = node.create_client(SetPen, "pen")
action = ActionClient(node, RotateAbsolute, "turn")
private = node.create_publisher(String, "~/words", 10)
heard = []
node.create_subscription(String, "/lab/controller/words", heard.append, 10)
print(node.get_fully_qualified_name(), pen.wait_for_service(1.0), action.wait_for_server(1.0))
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
private.publish(String(data="hello"))
answer = pen.call_async(SetPen.Request(r=200, width=5))
rclpy.spin_until_future_complete(node, answer, timeout_sec=1.0)
for _ in range(20):
    rclpy.spin_once(node, timeout_sec=0.1)
print(answer.result(), len(poses), heard, pen.srv_name, velocity.topic_name)
goal = action.send_goal_async(RotateAbsolute.Goal(theta=0.5))
rclpy.spin_until_future_complete(node, goal, timeout_sec=1.0)
print(goal.result() and goal.result().accepted)
for _ in range(50):
    rclpy.spin_once(node, timeout_sec=0.1)
