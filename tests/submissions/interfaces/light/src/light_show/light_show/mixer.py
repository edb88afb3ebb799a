"""Shows two colours and what the light makes of them."""

import rclpy
from light_interfaces.msg import Light
from light_interfaces.srv import Mix
from rclpy.node import Node

RED = Light(name="red", colour=[255, 0, 0])
BLUE = Light(name="blue", colour=[0, 0, 255])


class Mixer(Node):
    def __init__(self):
        super().__init__("mixer")
        self.publisher = self.create_publisher(Light, "/light", 10)
        self.client = self.create_client(Mix, "/mix")
        self.to_show = [RED, BLUE]
        self.timer = self.create_timer(0.5, self.show)

    def show(self):
        if self.to_show:
            self.publisher.publish(self.to_show.pop(0))
            if not self.to_show:
                self.client.call_async(Mix.Request(one=RED, other=BLUE)).add_done_callback(
                    lambda future: self.publisher.publish(future.result().mixed)
                )


def main():
    rclpy.init()
    rclpy.spin(Mixer())


if __name__ == "__main__":
    main()
