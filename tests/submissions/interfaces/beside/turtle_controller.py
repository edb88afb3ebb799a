"""An action server that drives; its own client asks it to."""

import threading

import rclpy
from custom_action_interfaces.action import Drive
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

CENTRE = 5.544445
PENS = [(255, 255, 255), (255, 0, 0), (0, 255, 0), (0, 0, 255)]


class Driver(Node):
    def __init__(self):
        super().__init__("turtle_controller")
        group = ReentrantCallbackGroup()
        self.pose, self.quarter, self.crossed = None, None, 0
        self.at_edge = threading.Event()
        self.twists = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10, callback_group=group)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen", callback_group=group)
        self.server = ActionServer(self, Drive, "drive", self.drive, callback_group=group)
        self.client = ActionClient(self, Drive, "drive", callback_group=group)

    def on_pose(self, pose):
        self.pose = pose
        if self.at_edge.is_set():
            return
        if not all(0.5 < at < 2 * CENTRE - 0.5 for at in (pose.x, pose.y)):
            self.at_edge.set()
            self.twists.publish(Twist())
            return
        right, above = pose.x >= CENTRE, pose.y >= CENTRE
        quarter = (0 if right else 1) if above else (3 if right else 2)
        if quarter != self.quarter:
            self.quarter, self.crossed = quarter, self.crossed + 1
            r, g, b = PENS[quarter]
            self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3))

    def drive(self, goal):
        start, speed, told = self.get_clock().now(), 0.0, 0
        rate = self.create_rate(2)
        while not self.at_edge.is_set() and self.crossed < goal.request.quarters:
            speed += 0.05
            twist = Twist()
            twist.linear.x, twist.angular.z = speed, 1.0
            self.twists.publish(twist)
            if self.crossed > told:
                told = self.crossed
                goal.publish_feedback(Drive.Feedback(crossed=told))
            rate.sleep()
        goal.succeed()
        return Drive.Result(seconds=(self.get_clock().now() - start).nanoseconds / 1e9)

    def ask(self):
        self.client.wait_for_server()
        goal = self.client.send_goal_async(Drive.Goal(quarters=1000), feedback_callback=self.tell)
        goal.add_done_callback(lambda f: f.result().get_result_async().add_done_callback(self.end))

    def tell(self, message):
        self.get_logger().info(f"crossed {message.feedback.crossed}")

    def end(self, future):
        print("driven for", future.result().result.seconds, "s")


def main():
    rclpy.init()
    node = Driver()
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    node.ask()
    executor.spin()


if __name__ == "__main__":
    main()
