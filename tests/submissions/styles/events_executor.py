"""The same controller under rclpy's experimental EventsExecutor."""

import rclpy
from rclpy.experimental import EventsExecutor
from timer import Controller

rclpy.init()
executor = EventsExecutor()
executor.add_node(Controller())
executor.spin()
