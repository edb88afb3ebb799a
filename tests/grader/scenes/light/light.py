"""A light that hears light_interfaces/msg/Light on /light, and mixes two in /mix.

The types come from the exercise: the scene of a course that has its own.
"""

import hashlib
from dataclasses import dataclass

import numpy as np

from grader.recording.subject import BagMessage
from grader.ros.cdr import CdrReader
from grader.ros.messages import serialise
from grader.scenes.scene import STEP_NS, Introduction, Scene, Simulation, arrived
from grader.text.message import msg

SHOWN, MIXED, LIGHT = "/light", "/mixed", "light_interfaces/msg/Light"


@dataclass(frozen=True)
class LightTrace:
    """How long was recorded, and (tick, CDR, colour) of what was shown and mixed."""

    ticks: int
    shown: tuple = ()
    mixed: tuple = ()

    @property
    def duration_ns(self):
        return self.ticks * STEP_NS

    def sha256(self):
        return hashlib.sha256(repr((self.ticks, self.shown, self.mixed)).encode()).hexdigest()


def entry(tick, data):
    read = CdrReader(data)
    read.text()
    return tick, data, tuple(read.array(3, np.dtype("u1")).tolist())


class LightSimulation(Simulation):
    ticks = 0

    def __init__(self, limits):
        from light_interfaces.msg import Light
        from light_interfaces.srv import Mix
        from rclpy.node import Node

        super().__init__()
        self.node = Node("light", start_parameter_services=False, enable_rosout=False)
        self.subscription = self.node.create_subscription(Light, SHOWN, lambda _: None, 10)
        self.service = self.node.create_service(Mix, "/mix", lambda *_: None)
        self.limits, self.shown, self.mixed = limits, [], []

    def mix(self):
        handle, kind = self.service.handle, self.service.srv_type
        while (request := handle.service_take_request(kind.Request))[0] is not None:
            one, other = request[0].one, request[0].other
            mixed = kind.Response()
            mixed.mixed.name = f"{one.name}{other.name}"[:20]
            pairs = zip(one.colour.tolist(), other.colour.tolist(), strict=True)
            mixed.mixed.colour = [(a + b) // 2 for a, b in pairs]
            self.mixed.append(entry(self.ticks + 1, serialise(mixed.mixed)))
            self.service.send_response(mixed, request[1])

    def tick(self, now_ns=None):
        self.mix()
        for message in arrived(self.subscription):
            self.shown.append(entry(self.ticks + 1, serialise(message)))
        if not self.records:
            return ""
        self.ticks += 1
        return self.over(self.ticks, self.limits, bool(self.shown or self.mixed))

    def trace(self):
        return LightTrace(self.ticks, tuple(self.shown), tuple(self.mixed))


class Light(Scene):
    name = "light"
    thing, the_thing = msg("light"), msg("the light")
    introduction = Introduction(nodes=(("light", "/"),), topics=(SHOWN,), services=("/mix",))

    def simulate(self, limits, start, hooks, interfaces, setting):
        return LightSimulation(limits)

    def untouched(self, start):
        return LightTrace(0)

    def definitions_of(self, trace):
        return {LIGHT: "string<=20 name\nuint8[3] colour\n"}

    def to_messages(self, trace):
        found = [
            BagMessage(tick * STEP_NS, topic, LIGHT, data)
            for topic, entries in ((SHOWN, trace.shown), (MIXED, trace.mixed))
            for tick, data, _ in entries
        ]
        return sorted(found, key=lambda message: message.time_ns)

    def from_channels(self, channels, duration_ns):
        by_topic = {
            channel.topic: tuple(
                entry(int(time) // STEP_NS, data)
                for time, data in zip(channel.times_ns, channel.messages(), strict=True)
            )
            for channel in channels
        }
        ticks = duration_ns // STEP_NS
        return LightTrace(ticks, by_topic.get(SHOWN, ()), by_topic.get(MIXED, ()))


SCENE = Light()
