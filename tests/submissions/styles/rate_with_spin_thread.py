"""create_rate in the main thread, rclpy.spin in another, and service calls that wait."""

import threading

import rclpy
from spiral import CMD_VEL, POSE, SET_PEN, Pose, SetPen, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
seen = {"pose": None}
node.create_subscription(Pose, POSE, lambda pose: seen.update(pose=pose), 10)
velocity = node.create_publisher(Twist, CMD_VEL, 10)
pen = node.create_client(SetPen, SET_PEN)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
pen.wait_for_service()
rate = node.create_rate(20)
spiral = Spiral()
turn = 0
while rclpy.ok():
    pose = seen["pose"]
    if pose is not None:
        if spiral.is_outside(pose):
            velocity.publish(Twist())
            break
        if request := spiral.pen(pose):
            pen.call(request)
    if turn % 10 == 0:
        velocity.publish(spiral.command())
    turn += 1
    rate.sleep()
threading.Event().wait()
