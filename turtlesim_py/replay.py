"""Plays a scenario on an arena and takes down what the original's recordings hold."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field
from typing import Any

from turtlesim_py.world.arena import Arena
from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.events import Event, GoalFeedback, GoalResult, LogLine
from turtlesim_py.world.floats import float32
from turtlesim_py.world.parameters import BY_NAME, refusal
from turtlesim_py.world.turtle import METER_PX, SIZE_M, TICK_S

COLUMNS = ["tick", "x", "y", "theta", "linear_velocity", "angular_velocity", "r", "g", "b"]
INTERNAL_COLUMNS = ["tick", "pos_x", "pos_y_down", "orient", "lin_vel_x", "lin_vel_y", "ang_vel"]
#: Where the things of one tick stand in a recording: a goal's result reaches its client last.
ACTION_ORDER = {"accepted": 0, "cancel_response": 0, "feedback": 1, "result": 2}
#: Inputs that reach a turtle, if it is there.
_TURTLE_OPS = {"cmd_vel", "set_pen", "teleport_absolute", "teleport_relative", "rotate_absolute"}
#: What a cancel request answers for a goal that is not running any more.
ERROR_GOAL_TERMINATED = 3


class ScenarioError(Exception):
    """The scenario cannot be replayed; the text says which part and why."""


@dataclass
class Replay:
    """What came of a scenario.

    Attributes:
        result: JSON-ready: published, internal, responses, action, logs, turtles_at_end, ...
        arena: the world after the last tick.
        snapshots: name -> a copy of the canvas.
    """

    result: dict[str, Any]
    arena: Arena
    snapshots: dict[str, Canvas] = field(default_factory=dict)


def number(value: float, digits: int = 9) -> float | int | str:
    """A value as the recordings write it: `digits` significant digits, NaN and inf as strings."""
    if not math.isfinite(value):
        return "nan" if math.isnan(value) else ("inf" if value > 0 else "-inf")
    rounded = float(f"{value:.{digits}g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < 1e15 else rounded


def replay(scenario: dict[str, Any]) -> Replay:
    """Run a scenario from its first to its last tick.

    Raises:
        ScenarioError: an event is unknown, incomplete or outside the scenario's ticks.
    """
    return _Player(scenario).play()


class _Player:
    """One replay: the arena, and the notes taken while it runs."""

    def __init__(self, scenario: dict[str, Any]) -> None:
        self.scenario = scenario
        self.tick = 0
        self.logs: list[list[Any]] = [
            [0, "INFO", "turtlesim", "Starting turtlesim with node name /turtlesim"]
        ]
        self.action: list[dict[str, Any]] = []
        self.responses: list[dict[str, Any]] = []
        self.known_goals: set[Any] = set()
        self.published: dict[str, list[list[Any]]] = defaultdict(list)
        self.internal: dict[str, list[list[Any]]] = defaultdict(list)
        self.snapshots: dict[str, Canvas] = {}
        self.arena = Arena((self._listen,))

    def play(self) -> Replay:
        by_tick = self._events_by_tick()
        for tick in range(1, self.scenario["ticks"] + 1):
            self.tick = tick
            for index, event in by_tick[tick]:
                self._take(index, event)
            self._advance()
            for _, event in by_tick[tick]:
                if event["op"] == "snapshot":
                    self._snapshot(event)
        return Replay(self._result(), self.arena, self.snapshots)

    def _events_by_tick(self) -> dict[int, list[tuple[int, dict[str, Any]]]]:
        ticks, events = self.scenario.get("ticks"), self.scenario.get("events", [])
        if type(ticks) is not int or ticks < 0 or not isinstance(events, list):
            raise ScenarioError(
                "a scenario needs 'ticks', a whole number from 0, and 'events', a list"
            )
        by_tick: dict[int, list[tuple[int, dict[str, Any]]]] = defaultdict(list)
        for index, event in enumerate(events):
            tick = event.get("tick") if isinstance(event, dict) else None
            if type(tick) is not int or not 1 <= tick <= ticks:
                raise ScenarioError(
                    f"event {index}: 'tick' must be from 1 to {ticks}, found {tick!r}"
                )
            by_tick[tick].append((index, event))
        return by_tick

    def _take(self, index: int, event: dict[str, Any]) -> None:
        op = event.get("op")
        handler = getattr(self, f"_on_{op}", None)
        if handler is None:
            raise ScenarioError(f"event {index} (tick {self.tick}): unknown op {op!r}")
        # Nobody listens on the topics and services of a turtle that is not there.
        turtle = event.get("turtle", "turtle1")
        if op in _TURTLE_OPS and turtle not in self.arena.turtles:
            return
        try:
            answer = handler(event, turtle)
        except KeyError as missing:
            raise ScenarioError(
                f"event {index} (tick {self.tick}, {op}): no field {missing}"
            ) from None
        except (TypeError, ValueError) as error:
            raise ScenarioError(f"event {index} (tick {self.tick}, {op}): {error}") from None
        if answer is not None:
            self.responses.append({"tick": self.tick, "event": index, **answer})

    def _on_cmd_vel(self, event: dict[str, Any], turtle: str) -> None:
        lx, ly, lz = map(float, event["linear"])
        ax, ay, az = map(float, event["angular"])
        self.arena.command(turtle, (lx, ly, lz), (ax, ay, az))

    def _on_set_pen(self, event: dict[str, Any], turtle: str) -> None:
        self.arena.set_pen(turtle, *(int(event[k]) for k in ("r", "g", "b", "width", "off")))

    def _on_teleport_absolute(self, event: dict[str, Any], turtle: str) -> None:
        x, y, theta = (float32(float(event[k])) for k in ("x", "y", "theta"))
        self.arena.teleport_absolute(turtle, x, y, theta)

    def _on_teleport_relative(self, event: dict[str, Any], turtle: str) -> None:
        linear, angular = (float32(float(event[k])) for k in ("linear", "angular"))
        self.arena.teleport_relative(turtle, linear, angular)

    def _on_rotate_absolute(self, event: dict[str, Any], turtle: str) -> None:
        goal_id = event["id"]
        self._act(goal_id, "accepted")
        self.known_goals.add(goal_id)
        self.arena.rotate_absolute(turtle, float32(float(event["theta"])), goal_id)

    def _on_cancel(self, event: dict[str, Any], _: str) -> dict[str, Any] | None:
        goal_id = event["id"]
        if goal_id not in self.known_goals:
            return {"client_exception": "Goal handle is not known to this client."}
        running = self.arena.cancel(goal_id)
        code = 0 if running else ERROR_GOAL_TERMINATED
        self._act(goal_id, "cancel_response", return_code=code, goals_canceling=int(running))
        return None

    def _on_spawn(self, event: dict[str, Any], _: str) -> dict[str, Any]:
        x, y, theta = (float(event[k]) for k in ("x", "y", "theta"))
        name = self.arena.spawn(x, y, theta, event["name"])
        return {"response": {"callback_return": bool(name), "name": name}}

    def _on_kill(self, event: dict[str, Any], _: str) -> dict[str, Any]:
        return {"response": {"callback_return": self.arena.kill(event["name"])}}

    def _on_clear(self, _event: dict[str, Any], _: str) -> None:
        self.arena.clear()

    def _on_reset(self, _event: dict[str, Any], _: str) -> None:
        self.arena.reset()

    def _on_param(self, event: dict[str, Any], _: str) -> dict[str, Any]:
        name = event["name"]
        value: Any = float(event["value"]) if event.get("double") else event["value"]
        if name not in BY_NAME:
            text = f"parameter '{name}' cannot be set because it was not declared"
            return {"response": {"exception": text}}
        reason = refusal(BY_NAME[name], value)
        if not reason:
            self.arena.set_parameter(name, value)
        return {"response": {"successful": not reason, "reason": reason}}

    def _on_snapshot(self, event: dict[str, Any], _: str) -> None:
        """Taken after the tick; see play."""

    def _on_snapshot_now(self, event: dict[str, Any], _: str) -> None:
        self._snapshot(event)

    def _snapshot(self, event: dict[str, Any]) -> None:
        self.snapshots[event["name"]] = self.arena.canvas.copy()

    def _advance(self) -> None:
        for name, ((*pose,), color) in self.arena.tick().items():
            turtle = self.arena.turtles[name]
            self.published[name].append([self.tick, *map(number, pose), *color])
            inside = (turtle.x_m, turtle.y_down_m, turtle.heading_rad)
            speeds = (turtle.lin_x, turtle.lin_y, turtle.ang)
            self.internal[name].append([self.tick, *(number(v, 17) for v in inside + speeds)])
        for entry in self.action:
            if entry["type"] == "result":
                self.known_goals.discard(entry["id"])

    def _listen(self, event: Event) -> None:
        match event:
            case LogLine(severity, text):
                self.logs.append([self.tick, severity, "turtlesim", text])
            case GoalFeedback(_, goal_id, remaining):
                self._act(goal_id, "feedback", remaining=number(remaining))
            case GoalResult(_, goal_id, status, delta):
                self._act(goal_id, "result", status=status, delta=number(delta))

    def _act(self, goal_id: Any, kind: str, **more: Any) -> None:
        self.action.append({"tick": self.tick, "id": goal_id, "type": kind, **more})

    def _result(self) -> dict[str, Any]:
        self.action.sort(key=lambda a: (a["tick"], ACTION_ORDER[a["type"]]))
        return {
            "scenario": self.scenario,
            "tick_seconds": TICK_S,
            "columns": COLUMNS,
            "published": dict(self.published),
            "internal_columns": INTERNAL_COLUMNS,
            "internal": dict(self.internal),
            "responses": self.responses,
            "action": self.action,
            "logs": self.logs,
            "turtles_at_end": sorted(self.arena.turtles),
            "meter": number(METER_PX),
            "width_in_meters": number(SIZE_M),
            "height_in_meters": number(SIZE_M),
        }
