#!/usr/bin/env python3
import math
import random
from functools import partial

import rclpy
from rclpy.node import Node
from turtlesim.srv import Kill, Spawn

from my_robot_interfaces.msg import Turtle, TurtleArray
from my_robot_interfaces.srv import CatchTurtle


class TurtleSpawnerNode(Node):

    def __init__(self):
        super().__init__('turtle_spawner')
        self.declare_parameter('spawn_period', 2.0)
        self.declare_parameter('turtle_name_prefix', 'turtle')
        self.prefix_ = self.get_parameter('turtle_name_prefix').value
        self.counter_ = 1
        self.alive_turtles_ = []

        self.spawn_client_ = self.create_client(Spawn, 'spawn')
        self.kill_client_ = self.create_client(Kill, 'kill')
        self.alive_turtles_publisher_ = self.create_publisher(
            TurtleArray, 'alive_turtles', 10)
        self.catch_turtle_service_ = self.create_service(
            CatchTurtle, 'catch_turtle', self.callback_catch_turtle)
        self.spawn_timer_ = self.create_timer(
            self.get_parameter('spawn_period').value, self.spawn_new_turtle)

    def callback_catch_turtle(self, request, response):
        self.call_kill_service(request.name)
        response.success = True
        return response

    def publish_alive_turtles(self):
        msg = TurtleArray()
        msg.turtles = self.alive_turtles_
        self.alive_turtles_publisher_.publish(msg)

    def spawn_new_turtle(self):
        self.counter_ += 1
        name = self.prefix_ + str(self.counter_)
        x = random.uniform(0.0, 11.0)
        y = random.uniform(0.0, 11.0)
        theta = random.uniform(0.0, 2 * math.pi)
        self.call_spawn_service(name, x, y, theta)

    def call_spawn_service(self, name, x, y, theta):
        while not self.spawn_client_.wait_for_service(1.0):
            self.get_logger().warn('Waiting for spawn service...')

        request = Spawn.Request()
        request.name = name
        request.x = x
        request.y = y
        request.theta = theta
        future = self.spawn_client_.call_async(request)
        future.add_done_callback(
            partial(self.callback_call_spawn, request=request))

    def callback_call_spawn(self, future, request):
        response = future.result()
        if response.name != '':
            self.get_logger().info('New turtle: ' + response.name)
            new_turtle = Turtle()
            new_turtle.name = response.name
            new_turtle.x = request.x
            new_turtle.y = request.y
            new_turtle.theta = request.theta
            self.alive_turtles_.append(new_turtle)
            self.publish_alive_turtles()

    def call_kill_service(self, name):
        while not self.kill_client_.wait_for_service(1.0):
            self.get_logger().warn('Waiting for kill service...')

        request = Kill.Request()
        request.name = name
        future = self.kill_client_.call_async(request)
        future.add_done_callback(partial(self.callback_call_kill, name=name))

    def callback_call_kill(self, future, name):
        for i, turtle in enumerate(self.alive_turtles_):
            if turtle.name == name:
                del self.alive_turtles_[i]
                self.publish_alive_turtles()
                break


def main(args=None):
    rclpy.init(args=args)
    node = TurtleSpawnerNode()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
