"""Inputs of a program are told from those of others; beyond rules they end what they moved."""

from dataclasses import replace

import pytest

from grader.scenes.cast.trace import CastTrace
from grader.scenes.subject import Rules
from grader.scenes.turtlesim.rules import INPUTS, within
from grader.scenes.turtlesim.trace import TurtleTrace
from tests.grader.driving import drive, twist
from tests.grader.exercise.expect.traces import event, sent
from turtlesim_py.world.arena import TICK_NS

RULES = Rules(("spawn", "kill", "turtle1/set_pen"), ("turtle2",))
SPAWN = '{"tick": 1, "op": "spawn", "x": 3, "y": 3, "theta": 0, "name": "turtle2"}'
SCENARIO = '{"ticks": 60, "events": [' + SPAWN + "]}"


def acted(act, rules=RULES, cast=None):
    """Where each turtle's way ends, and what went beyond, where something is done in tick 30."""

    def controller(tick, pose, arena):
        if tick == 1:
            arena.spawn(3.0, 3.0, 0.0, "turtle2")
        if tick == 30:
            act(arena)

    trace = TurtleTrace.of(drive(controller, ticks=60).trace)
    seen, beyond = within(trace, cast, rules)
    assert seen.events == trace.events
    ends = {name: int(way.ticks[-1]) for name, way in seen.trajectories.items()}
    return ends, [(name, time_ns) for time_ns, name in beyond]


@pytest.mark.parametrize(
    ("act", "name", "ended"),
    [
        (
            lambda a: a.teleport_absolute("turtle2", 1, 1, 0),
            "/turtle2/teleport_absolute",
            "turtle2",
        ),
        (lambda a: a.teleport_relative("turtle1", 1, 0), "/turtle1/teleport_relative", "turtle1"),
        (lambda a: a.rotate_absolute("turtle2", 1, "id"), "/turtle2/rotate_absolute", "turtle2"),
        (lambda a: twist(a, 0.0), "/turtle1/cmd_vel", "turtle1"),
        (lambda a: a.kill("turtle1"), "/kill", "turtle1"),
        (lambda a: a.kill("turtle2"), "/kill", "turtle2"),
        (lambda a: a.reset(), "/reset", "turtle1 turtle2"),
        (lambda a: a.set_pen("turtle2", 0, 0, 0, 1, 0), "/turtle2/set_pen", ""),
        (lambda a: a.clear(), "/clear", ""),
    ],
)
def test_what_an_exercise_does_not_allow_ends_the_way_of_what_it_moved(act, name, ended):
    ends, beyond = acted(act)
    assert beyond == [(name, 30 * TICK_NS)]
    assert ends == {turtle: 29 if turtle in ended else 60 for turtle in ("turtle1", "turtle2")}


def allowed(arena):
    arena.set_pen("turtle1", 0, 0, 0, 1, 0)
    arena.command("turtle2", (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    arena.spawn(1.0, 1.0, 0.0, "turtle3")
    arena.kill("turtle3")
    arena.kill("turtle4")  # is refused


def test_what_it_allows_ends_nothing():
    ends, beyond = acted(allowed)
    assert beyond == []
    assert {ends["turtle1"], ends["turtle2"]} == {60}


def test_a_command_of_a_peer_is_none_of_the_program_s_and_one_more_like_it_is():
    kind = "geometry_msgs/msg/Twist"
    zero = dict.fromkeys("xyz", 0.0)
    values = {"linear": {**zero, "x": 1.0}, "angular": {**zero, "z": 1.0}}
    its = sent(0.4, "/turtle1/cmd_vel", kind, node="/peer", **values)
    cast = CastTrace(60, (its,), (), ("/peer",))
    assert acted(lambda arena: twist(arena, 1.0), cast=cast)[1] == []
    for more in (1.0, 0.5):
        both = acted(lambda arena, x=more: (twist(arena, 1.0), twist(arena, x)), cast=cast)
        assert both[1] == [("/turtle1/cmd_vel", 30 * TICK_NS)]
    own = replace(cast, messages=(its._replace(node="/node"),))
    assert acted(lambda arena: twist(arena, 1.0), cast=own)[1]


def test_what_peers_call_and_the_scenario_does_is_none_of_the_program_s():
    rules = Rules((), (), SCENARIO)
    call = {"id": "a", "type": "", "sent_ns": 1}
    kill = event("call", service="/kill", request={"name": "turtle2"}, **call)
    turn = event("goal", action="/turtle1/rotate_absolute", goal={"theta": 1.0}, **call)
    cast = CastTrace(60, (), (kill, turn), ("/peer",))

    def act(arena):
        arena.kill("turtle2")
        arena.rotate_absolute("turtle1", 1.0, "id")

    assert acted(act, rules, cast)[1] == []
    assert [name for name, _ in acted(act, rules)[1]] == ["/kill", "/turtle1/rotate_absolute"]
    # one of the scenario is not the program's to kill
    may = rules._replace(may=INPUTS)
    assert [name for name, _ in acted(act, may)[1]] == ["/kill"]
