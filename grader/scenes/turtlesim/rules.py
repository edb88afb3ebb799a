"""Which inputs of a run are the submission's, and which of these its exercise does not allow."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from grader.scenes.cast.trace import CastTrace
from grader.scenes.subject import Oversteps, Rules
from grader.scenes.turtlesim.messages import TWIST, of_input
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.system import strict_json
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.events import CmdVel, Event, Kill, Spawn, from_json

#: They change what is drawn, and where nothing is.
_HARMLESS: Final = ("clear", "set_pen")
_MOVING: Final = ("teleport_absolute", "teleport_relative", "rotate_absolute")
INPUTS: Final = (*_HARMLESS, "kill", "reset", "spawn", *_MOVING)


def within(
    trace: TurtleTrace, cast: CastTrace | None, rules: Rules
) -> tuple[TurtleTrace, Oversteps]:
    """Return the trace in which all that was moved against rules ends there, and how it was."""
    spawned = {each.name for each in _given(rules.setting) if isinstance(each, Spawn)}
    # one that is killed and spawned again has been teleported
    kept = {FIRST_TURTLE, *rules.drives, *spawned}
    allowed = {*rules.may, *(f"{each}/cmd_vel" for each in rules.drives)}
    beyond, ends = list[tuple[int, str]](), dict[str, int]()
    for name, target, event in own_inputs(trace, cast, rules.setting):
        is_kept = isinstance(event, Kill) and target in kept
        if not is_kept and allowed & {event.op, name[1:]}:
            continue
        beyond.append((event.tick * TICK_NS, name))
        for turtle in (target,) if target else trace.trajectories:
            if event.op not in _HARMLESS:
                ends.setdefault(turtle, event.tick)
    ways = {
        turtle: way[way.ticks < ends.get(turtle, trace.ticks + 1)]
        for turtle, way in trace.trajectories.items()
    }
    return replace(trace, trajectories=ways), beyond


def own_inputs(
    trace: TurtleTrace, cast: CastTrace | None, setting: str
) -> Iterator[tuple[str, str, Event]]:
    """Yield what neither the setting nor peers have sent: '/turtle1/cmd_vel', 'turtle1', event."""
    others = Counter([*map(_key, _given(setting)), *(() if cast is None else _of_peers(cast))])
    for event in trace.events:
        key = _key(event)
        others[key] -= 1
        if others[key] < 0 and event.op in (CmdVel.op, *INPUTS):
            yield *key[:2], event


def _given(setting: str) -> list[Event]:
    return [from_json(each) for each in strict_json.loads(setting or "{}").get("events", [])]


def _key(event: Event) -> tuple[str, str, object]:
    """Return what an input has in common with the message that it came by: name, turtle, values."""
    turtle = getattr(event, "turtle", "")
    values = of_input(event).data if isinstance(event, CmdVel) else None
    name = f"/{turtle}/{event.op}" if turtle else f"/{event.op}"
    return name, turtle or str(getattr(event, "name", "")), values


def _of_peers(cast: CastTrace) -> Iterator[tuple[str, str, object]]:
    """Yield the keys of what peers have sent."""
    for message in cast.messages:
        if cast.is_peer(message) and message.type == TWIST:
            yield message.topic, message.topic.split("/")[1], message.data
    for event in (*cast.of_kind("call"), *cast.of_kind("goal")):
        if "sent_ns" in event:
            name = str(event.get("service") or event["action"])
            of_turtle = name.split("/")[1] if name.count("/") > 1 else ""
            yield name, of_turtle or str(event.get("request", {}).get("name", "")), None
