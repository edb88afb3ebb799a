"""Recorded runs of the original, replayed in lockstep through a real node over DDS."""

import pytest
from geometry_msgs.msg import Twist, Vector3
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import SetPen, TeleportAbsolute, TeleportRelative

from tests import golden_runs
from tests.graph import wait_for_arrival
from turtlesim_py.ros.node import TurtlesimNode
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.floats import json_number

#: Those with one turtle for the whole run and one event a tick. Recorded events go straight into
#: the original's handlers; two in a tick may come in another order through topics and services.
NAMES = [
    "arc",
    "holonomic_on",
    "huge_velocity",
    "inf_linear",
    "nan_angular",
    "pen_off_on",
    "straight",
    "teleport_pen",
    "teleport_relative",
    "theta_norm",
    "timeout",
    "wall_east",
]
PREFIX = "/lockstep/turtle1"
STATUS = {4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}


class Lockstep:
    """A node that ticks when it is told, and a client that waits for what each tick brings."""

    def __init__(self, graph):
        self.graph = graph
        self.node = TurtlesimNode(["--ros-args", "-r", "__ns:=/lockstep"])
        self.ticks = 0
        self.action = []
        self.poses = graph.listen(Pose, f"{PREFIX}/pose")
        self.colors = graph.listen(Color, f"{PREFIX}/color_sensor")
        self._velocity = graph.publisher(Twist, f"{PREFIX}/cmd_vel")
        self._rotation = graph.action(RotateAbsolute, f"{PREFIX}/rotate_absolute")

    def tick(self, event=None):
        """Let an event arrive, then tick; the row that a recording has for this tick."""
        self.ticks += 1
        future = event and getattr(self, f"on_{event['op']}")(event)
        self.node.tick(self.ticks * TICK_NS)
        if future is not None:
            self.graph.done(future)
        self.graph.until(lambda: len(self.poses) == len(self.colors) == self.ticks, "a tick")
        pose, color = self.poses[-1], self.colors[-1]
        values = (pose.x, pose.y, pose.theta, pose.linear_velocity, pose.angular_velocity)
        return [self.ticks, *map(json_number, values), color.r, color.g, color.b]

    def on_cmd_vel(self, event):
        linear, angular = (
            Vector3(**dict(zip("xyz", map(float, event[key]), strict=True)))
            for key in ("linear", "angular")
        )
        self._velocity.publish(Twist(linear=linear, angular=angular))
        (reader,) = (s for s in self.node.subscriptions if s.topic_name == f"{PREFIX}/cmd_vel")
        wait_for_arrival(reader)

    def on_set_pen(self, event):
        fields = {key: event[key] for key in ("r", "g", "b", "width", "off")}
        return self._ask(SetPen, f"{PREFIX}/set_pen", **fields)

    def on_teleport_absolute(self, event):
        fields = {key: float(event[key]) for key in ("x", "y", "theta")}
        return self._ask(TeleportAbsolute, f"{PREFIX}/teleport_absolute", **fields)

    def on_teleport_relative(self, event):
        fields = {key: float(event[key]) for key in ("linear", "angular")}
        return self._ask(TeleportRelative, f"{PREFIX}/teleport_relative", **fields)

    def on_param(self, event):
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=event["value"])
        parameters = [Parameter(name=event["name"], value=value)]
        name = "/lockstep/turtlesim/set_parameters"
        return self._ask(SetParameters, name, parameters=parameters)

    def on_rotate_absolute(self, event):
        goal_id = event["id"]

        def on_feedback(message):
            self._note(goal_id, "feedback", remaining=json_number(message.feedback.remaining))

        def on_acceptance(future):
            self._note(goal_id, "accepted")
            future.result().get_result_async().add_done_callback(on_result)

        def on_result(future):
            status, delta = STATUS[future.result().status], future.result().result.delta
            self._note(goal_id, "result", status=status, delta=json_number(delta))

        goal = RotateAbsolute.Goal(theta=float(event["theta"]))
        sent = self._rotation.send_goal_async(goal, feedback_callback=on_feedback)
        (server,) = (w for w in self.node.waitables if hasattr(w, "action_type"))
        wait_for_arrival(server)
        sent.add_done_callback(on_acceptance)
        return sent

    def _ask(self, kind, name, **fields):
        future = self.graph.ask(kind, name, **fields)
        (service,) = (s for s in self.node.services if s.service_name == name)
        wait_for_arrival(service)
        return future

    def _note(self, goal_id, kind, **more):
        self.action.append({"id": goal_id, "type": kind, **more})


@pytest.fixture
def lockstep(graph):
    lockstep = Lockstep(graph)
    yield lockstep
    lockstep.node.destroy_node()


@pytest.mark.parametrize("name", NAMES)
def test_the_published_messages_are_the_recorded_ones(lockstep, name):
    recorded = golden_runs.load(name)
    events = {event["tick"]: event for event in recorded["scenario"]["events"]}
    assert len(events) == len(recorded["scenario"]["events"])
    for row in recorded["published"]["turtle1"]:
        assert lockstep.tick(events.get(row[0])) == row


def test_the_client_of_the_action_hears_what_was_recorded(lockstep):
    recorded = golden_runs.load("rotate_abs")
    events = {event["tick"]: event for event in recorded["scenario"]["events"]}
    for row in recorded["published"]["turtle1"]:
        assert lockstep.tick(events.get(row[0])) == row
    expected = [{k: v for k, v in entry.items() if k != "tick"} for entry in recorded["action"]]
    lockstep.graph.until(lambda: len(lockstep.action) == len(expected), "the last of it")
    # what comes by different topics and services may overtake each other
    for goal_id in {entry["id"] for entry in expected}:
        for kind in ("accepted", "feedback", "result"):
            theirs = [e for e in expected if (e["id"], e["type"]) == (goal_id, kind)]
            assert [e for e in lockstep.action if (e["id"], e["type"]) == (goal_id, kind)] == theirs
