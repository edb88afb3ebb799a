"""A service call that waits inside a callback, with callback groups that make that possible."""

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from spiral import CMD_VEL, PERIOD_S, POSE, SET_PEN, Pose, SetPen, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, CMD_VEL, 10)
pen = node.create_client(SetPen, SET_PEN, callback_group=ReentrantCallbackGroup())
spiral = Spiral()


def on_pose(pose):
    if spiral.done:
        return
    if spiral.is_outside(pose):
        velocity.publish(Twist())
    elif request := spiral.pen(pose):
        pen.call(request)


def on_timer():
    if not spiral.done:
        velocity.publish(spiral.command())


node.create_subscription(Pose, POSE, on_pose, 10, callback_group=MutuallyExclusiveCallbackGroup())
node.create_timer(PERIOD_S, on_timer, callback_group=MutuallyExclusiveCallbackGroup())
executor = MultiThreadedExecutor()
executor.add_node(node)
executor.spin()
