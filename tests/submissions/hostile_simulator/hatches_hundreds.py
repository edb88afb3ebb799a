"""Spawns hundreds of turtles, resets a hundred times, and drives them all into the wall."""

import rclpy
from geometry_msgs.msg import Twist
from std_srvs.srv import Empty
from turtlesim.srv import Kill, Spawn

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
spawn = node.create_client(Spawn, "/spawn")
kill = node.create_client(Kill, "/kill")
reset = node.create_client(Empty, "/reset")
for client in (spawn, kill, reset):
    client.wait_for_service()


def call(client, **request):
    future = client.call_async(client.srv_type.Request(**request))
    rclpy.spin_until_future_complete(node, future)
    return future.result()


names = [call(spawn, x=5.0, y=5.0, name=f"t{number}").name for number in range(100)]
print(sum(map(bool, names)))
for number in range(100):
    call(reset)
    call(spawn, x=5.0, y=5.0, name=f"r{number}")
drivers = [node.create_publisher(Twist, f"/t{number}/cmd_vel", 10) for number in range(40)]
for number in range(40):
    call(spawn, x=5.0, y=5.0, name=f"t{number}")
twist = Twist()
twist.linear.x = 1e308
while rclpy.ok():
    for driver in (velocity, *drivers):
        driver.publish(twist)
    rclpy.spin_once(node, timeout_sec=0.1)
