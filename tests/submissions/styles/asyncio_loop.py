"""asyncio in the main thread, rclpy.spin in another."""

import asyncio
import contextlib
import threading

import rclpy
from spiral import CMD_VEL, PERIOD_S, POSE, Pose, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, CMD_VEL, 10)
spiral = Spiral()


async def drive():
    outside = asyncio.Event()
    loop = asyncio.get_running_loop()

    def on_pose(pose):
        if not spiral.done and spiral.is_outside(pose):
            loop.call_soon_threadsafe(outside.set)

    node.create_subscription(Pose, POSE, on_pose, 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    while not outside.is_set():
        velocity.publish(spiral.command())
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(outside.wait(), PERIOD_S)
    velocity.publish(Twist())
    await asyncio.sleep(100)


asyncio.run(drive())
