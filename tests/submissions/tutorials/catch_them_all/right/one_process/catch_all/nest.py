from random import randint

from geometry_msgs.msg import PoseStamped
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import String
from turtlesim.srv import Kill, Spawn


class Nest(Node):
    """Puts turtles on the field; each is announced once on /new_turtle."""

    def __init__(self):
        super().__init__("nest")
        self.on_field = 0
        group = ReentrantCallbackGroup()
        self.spawn_srv = self.create_client(Spawn, "/spawn", callback_group=group)
        self.kill_srv = self.create_client(Kill, "/kill", callback_group=group)
        self.new = self.create_publisher(PoseStamped, "/new_turtle", 20)
        self.create_subscription(String, "/reached", self.reached, 20)
        self.create_timer(1.0, self.tick)

    async def tick(self):
        if self.on_field >= 10 or not self.spawn_srv.service_is_ready():
            return
        self.on_field += 1
        request = Spawn.Request(x=float(randint(1, 10)), y=float(randint(1, 10)))
        answer = await self.spawn_srv.call_async(request)
        message = PoseStamped()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = answer.name
        message.pose.position.x = request.x
        message.pose.position.y = request.y
        self.new.publish(message)

    async def reached(self, message):
        await self.kill_srv.call_async(Kill.Request(name=message.data))
        self.on_field -= 1
        self.get_logger().info(f"{message.data} is gone")
