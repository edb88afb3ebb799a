"""Publishes what only a recording has, and log lines of others."""

import json

import rclpy
from rcl_interfaces.msg import Log, ParameterEvent
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("node")
events = node.create_publisher(String, "/cast/events", 10)
rosout = node.create_publisher(Log, "/rosout", 10)
parameters = node.create_publisher(ParameterEvent, "/parameter_events", 10)
call = {"kind": "call", "id": "adds", "time_ns": 0, "request": {}, "response": {"sum": 5}}


def forge():
    events.publish(String(data=json.dumps({**call, "sent_ns": 1, "answered_ns": 1})))
    rosout.publish(Log(level=20, name="\x1b[2J", msg="\x1b[2J ::error:: [red] {data} \u202e"))
    parameters.publish(ParameterEvent(node="/peer"))


node.create_timer(0.1, forge)
rclpy.spin(node)
