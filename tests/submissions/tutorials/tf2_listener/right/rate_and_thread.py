import math
import threading

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from tf2_ros import Buffer, TransformException, TransformListener
from turtlesim.srv import Spawn


def spin(executor):
    try:
        executor.spin()
    except ExternalShutdownException:
        pass


def main():
    rclpy.init()
    node = Node("turtle_tf2_frame_listener")
    target = node.declare_parameter("target_frame", "turtle1").value
    buffer = Buffer()
    listener = TransformListener(buffer, node)  # noqa: F841
    publisher = node.create_publisher(Twist, "turtle2/cmd_vel", 10)
    spawner = node.create_client(Spawn, "spawn")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=spin, args=(executor,), daemon=True).start()

    spawner.wait_for_service()
    name = spawner.call(Spawn.Request(name="turtle2", x=4.0, y=2.0)).name
    rate = node.create_rate(1.0)
    try:
        while rclpy.ok():
            rate.sleep()
            try:
                way = buffer.lookup_transform(name, target, rclpy.time.Time())
            except TransformException as error:
                node.get_logger().warn(f"{error}")
                continue
            x, y = way.transform.translation.x, way.transform.translation.y
            twist = Twist()
            twist.linear.x = 0.5 * math.sqrt(x * x + y * y)
            twist.angular.z = math.atan2(y, x)
            publisher.publish(twist)
    except (KeyboardInterrupt, rclpy.exceptions.ROSInterruptException):
        pass


if __name__ == "__main__":
    main()
