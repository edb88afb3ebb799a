import json
import random
import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from turtlesim.srv import Kill, Spawn

lock = threading.Lock()
alive = {}


def main():
    rclpy.init()
    node = Node("spawner")
    pause = node.declare_parameter("pause", 1.0).value
    spawn = node.create_client(Spawn, "/spawn")
    kill = node.create_client(Kill, "/kill")
    pub = node.create_publisher(String, "turtles", 10)

    def on_eaten(msg):
        with lock:
            alive.pop(msg.data, None)
        kill.call_async(Kill.Request(name=msg.data))

    def tell():
        with lock:
            pub.publish(String(data=json.dumps(alive)))

    node.create_subscription(String, "eaten", on_eaten, 10)
    node.create_timer(0.25, tell)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()

    spawn.wait_for_service()
    while rclpy.ok():
        if len(alive) < 10:
            x, y = random.random() * 9 + 1, random.random() * 9 + 1
            name = spawn.call(Spawn.Request(x=x, y=y)).name
            with lock:
                alive[name] = (x, y)
            print("spawned", name)
        time.sleep(pause)


if __name__ == "__main__":
    main()
