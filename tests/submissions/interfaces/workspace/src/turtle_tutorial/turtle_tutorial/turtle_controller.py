"""The spiral; beside driving it uses all interfaces of its own."""

import rclpy
from geometry_msgs.msg import Point, Twist
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen
from tutorial_interfaces.action import Fibonacci
from tutorial_interfaces.msg import Num, Sphere
from tutorial_interfaces.srv import AddThreeInts

MIDDLE = 5.544445
COLOURS = {1: (255, 255, 255), 2: (255, 0, 0), 3: (0, 255, 0), 4: (0, 0, 255)}


class TurtleController(Node):
    def __init__(self):
        super().__init__("turtle_controller")
        self.speed = 0.0
        self.quarter = 0
        self.commands = 0
        self.is_done = False
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)

        self.spheres = self.create_publisher(Sphere, "spheres", 10)
        self.create_subscription(Sphere, "spheres", self.on_sphere, 10)
        self.create_service(AddThreeInts, "add_three_ints", self.add)
        self.adder = self.create_client(AddThreeInts, "add_three_ints")
        self.counting = ActionServer(self, Fibonacci, "fibonacci", self.count)
        self.counter = ActionClient(self, Fibonacci, "fibonacci")
        self.create_timer(0.5, self.drive)

    def drive(self):
        if self.is_done:
            return
        self.commands += 1
        self.speed += 0.05
        twist = Twist()
        twist.linear.x = self.speed
        twist.angular.z = 1.0
        self.velocity.publish(twist)
        if self.commands == 2:
            request = AddThreeInts.Request(a=2, b=3, c=1)
            self.adder.call_async(request).add_done_callback(
                lambda done: self.get_logger().info(f"The sum is {done.result().sum}")
            )
        if self.commands == 4:
            self.counter.wait_for_server()
            goal = Fibonacci.Goal()
            goal.order = 7
            self.counter.send_goal_async(goal, self.on_feedback).add_done_callback(self.on_goal)
        if self.commands % 10 == 0:
            self.spheres.publish(
                Sphere(
                    center=Point(x=MIDDLE, y=MIDDLE),
                    radius=self.speed,
                    nums=[Num(num=self.commands)],
                )
            )

    def on_sphere(self, sphere):
        self.get_logger().info(f"Heard of a sphere of {sphere.radius:.2f} m: {sphere.nums}")

    def add(self, request, response):
        response.sum = request.a + request.b + request.c
        return response

    def count(self, handle):
        sequence = [0, 1]
        for _ in range(1, handle.request.order):
            sequence.append(sequence[-1] + sequence[-2])
            handle.publish_feedback(Fibonacci.Feedback(partial_sequence=sequence))
        handle.succeed()
        result = Fibonacci.Result()
        result.sequence = sequence
        return result

    def on_feedback(self, message):
        self.get_logger().info(f"So far: {list(message.feedback.partial_sequence)}")

    def on_goal(self, done):
        done.result().get_result_async().add_done_callback(
            lambda result: self.get_logger().info(f"All: {list(result.result().result.sequence)}")
        )

    def on_pose(self, pose):
        if self.is_done:
            return
        if not (0.5 < pose.x < 2 * MIDDLE - 0.5 and 0.5 < pose.y < 2 * MIDDLE - 0.5):
            self.is_done = True
            self.velocity.publish(Twist())
            return
        if pose.y >= MIDDLE:
            quarter = 1 if pose.x >= MIDDLE else 2
        else:
            quarter = 3 if pose.x < MIDDLE else 4
        if quarter != self.quarter:
            self.quarter = quarter
            r, g, b = COLOURS[quarter]
            self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3, off=0))


def main():
    rclpy.init()
    try:
        rclpy.spin(TurtleController())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
