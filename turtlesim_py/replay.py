"""Plays a scenario on an arena and takes down what the original's recordings hold."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from turtlesim_py.world.arena import Arena
from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.events import (
    KINDS,
    Cancel,
    Clear,
    CmdVel,
    Event,
    EventError,
    GoalId,
    Kill,
    Reset,
    RotateAbsolute,
    SetParameter,
    SetPen,
    Snapshot,
    SnapshotNow,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
    from_json,
)
from turtlesim_py.world.floats import float32, json_number
from turtlesim_py.world.notices import GoalFeedback, GoalResult, LogLine, Notice
from turtlesim_py.world.parameters import BY_NAME, refusal
from turtlesim_py.world.trajectory import COLUMNS
from turtlesim_py.world.turtle import METER_PX, SIZE_M, TICK_S, Reading

INTERNAL_COLUMNS = ["tick", "pos_x", "pos_y_down", "orient", "lin_vel_x", "lin_vel_y", "ang_vel"]
#: Where the things of one tick stand in a recording: a goal's result reaches its client last.
ACTION_ORDER = {"accepted": 0, "cancel_response": 0, "feedback": 1, "result": 2}
#: Inputs that reach a turtle, if it is there.
TO_TURTLE = (CmdVel, SetPen, TeleportAbsolute, TeleportRelative, RotateAbsolute)
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


class Onlooker(Protocol):
    """Who wants to see a replay while it runs."""

    def begin(self, arena: Arena) -> None:
        """The arena, before the first tick; what is changed in it is where the replay begins."""

    def after_tick(self, arena: Arena, readings: Mapping[str, Reading]) -> None:
        """The arena after a tick, and what every turtle has published in it."""


def replay(scenario: dict[str, Any], onlooker: Onlooker | None = None) -> Replay:
    """Run a scenario from its first to its last tick.

    Raises:
        ScenarioError: an event is unknown, incomplete or outside the scenario's ticks.
    """
    return _Player(scenario, onlooker).play()


class _Player:
    """One replay: the arena, and the notes taken while it runs."""

    def __init__(self, scenario: dict[str, Any], onlooker: Onlooker | None) -> None:
        self.scenario = scenario
        self.onlooker = onlooker
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
        if self.onlooker is not None:
            self.onlooker.begin(self.arena)
        for tick in range(1, self.scenario["ticks"] + 1):
            self.tick = tick
            for index, event in by_tick[tick]:
                self._take(index, event)
            self._advance()
            for _, event in by_tick[tick]:
                if isinstance(event, Snapshot):
                    self._keep_drawing(event.name)
        return Replay(self._result(), self.arena, self.snapshots)

    def _events_by_tick(self) -> dict[int, list[tuple[int, Event]]]:
        ticks, events = self.scenario.get("ticks"), self.scenario.get("events", [])
        if type(ticks) is not int or ticks < 0 or not isinstance(events, list):
            raise ScenarioError(
                "a scenario needs 'ticks', a whole number from 0, and 'events', a list"
            )
        by_tick: dict[int, list[tuple[int, Event]]] = defaultdict(list)
        for index, words in enumerate(events):
            tick = words.get("tick") if isinstance(words, dict) else None
            if type(tick) is not int or not 1 <= tick <= ticks:
                raise ScenarioError(
                    f"event {index}: 'tick' must be from 1 to {ticks}, found {tick!r}"
                )
            try:
                by_tick[tick].append((index, from_json(words)))
            except EventError as error:
                known = f", {words['op']}" if words.get("op") in KINDS else ""
                raise ScenarioError(f"event {index} (tick {tick}{known}): {error}") from None
        return by_tick

    def _take(self, index: int, event: Event) -> None:
        # Nobody listens on the topics and services of a turtle that is not there.
        if isinstance(event, TO_TURTLE) and event.turtle not in self.arena.turtles:
            return
        try:
            answer = self._input(event)
        except ValueError as error:
            where = f"event {index} (tick {self.tick}, {event.op})"
            raise ScenarioError(f"{where}: {error}") from None
        if answer is not None:
            self.responses.append({"tick": self.tick, "event": index, **answer})

    def _input(self, event: Event) -> dict[str, Any] | None:
        """Hand an event to the arena; what its caller hears, if anything."""
        arena = self.arena
        match event:
            case CmdVel():
                arena.command(event.turtle, event.linear, event.angular)
            case SetPen(turtle=turtle, r=r, g=g, b=b, width=width, off=off):
                arena.set_pen(turtle, r, g, b, width, off)
            case TeleportAbsolute(turtle=turtle):
                place = (float32(value) for value in (event.x, event.y, event.theta))
                arena.teleport_absolute(turtle, *place)
            case TeleportRelative(turtle=turtle, linear=linear, angular=angular):
                arena.teleport_relative(turtle, float32(linear), float32(angular))
            case RotateAbsolute():
                self._rotate(event)
            case Cancel():
                return self._cancel(event.id)
            case Spawn():
                name = arena.spawn(event.x, event.y, event.theta, event.name)
                return {"response": {"callback_return": bool(name), "name": name}}
            case Kill(name=name):
                return {"response": {"callback_return": arena.kill(name)}}
            case Clear():
                arena.clear()
            case Reset():
                arena.reset()
            case SetParameter():
                return {"response": self._set_parameter(event)}
            case SnapshotNow(name=name):
                self._keep_drawing(name)
        return None

    def _rotate(self, event: RotateAbsolute) -> None:
        self._act(event.id, "accepted")
        self.known_goals.add(event.id)
        self.arena.rotate_absolute(event.turtle, float32(event.theta), event.id)

    def _cancel(self, goal_id: GoalId) -> dict[str, Any] | None:
        if goal_id not in self.known_goals:
            return {"client_exception": "Goal handle is not known to this client."}
        running = self.arena.cancel(goal_id)
        code = 0 if running else ERROR_GOAL_TERMINATED
        self._act(goal_id, "cancel_response", return_code=code, goals_canceling=int(running))
        return None

    def _set_parameter(self, event: SetParameter) -> dict[str, Any]:
        if event.name not in BY_NAME:
            text = f"parameter '{event.name}' cannot be set because it was not declared"
            return {"exception": text}
        reason = refusal(BY_NAME[event.name], event.value)
        if not reason:
            self.arena.set_parameter(event.name, event.value)  # type: ignore[arg-type]
        return {"successful": not reason, "reason": reason}

    def _keep_drawing(self, name: str) -> None:
        self.snapshots[name] = self.arena.canvas.copy()

    def _advance(self) -> None:
        readings = self.arena.tick()
        for name, ((*pose,), color) in readings.items():
            turtle = self.arena.turtles[name]
            self.published[name].append([self.tick, *map(json_number, pose), *color])
            inside = (turtle.x_m, turtle.y_down_m, turtle.heading_rad)
            speeds = (turtle.lin_x, turtle.lin_y, turtle.ang)
            self.internal[name].append([self.tick, *(json_number(v, 17) for v in inside + speeds)])
        for entry in self.action:
            if entry["type"] == "result":
                self.known_goals.discard(entry["id"])
        if self.onlooker is not None:
            self.onlooker.after_tick(self.arena, readings)

    def _listen(self, notice: Notice) -> None:
        match notice:
            case LogLine(severity, text):
                self.logs.append([self.tick, severity, "turtlesim", text])
            case GoalFeedback(_, goal_id, remaining):
                self._act(goal_id, "feedback", remaining=json_number(remaining))
            case GoalResult(_, goal_id, status, delta):
                self._act(goal_id, "result", status=status, delta=json_number(delta))

    def _act(self, goal_id: Any, kind: str, **more: Any) -> None:
        self.action.append({"tick": self.tick, "id": goal_id, "type": kind, **more})

    def _result(self) -> dict[str, Any]:
        self.action.sort(key=lambda a: (a["tick"], ACTION_ORDER[a["type"]]))
        return {
            "scenario": self.scenario,
            "tick_seconds": TICK_S,
            "columns": list(COLUMNS),
            "published": dict(self.published),
            "internal_columns": INTERNAL_COLUMNS,
            "internal": dict(self.internal),
            "responses": self.responses,
            "action": self.action,
            "logs": self.logs,
            "turtles_at_end": sorted(self.arena.turtles),
            "meter": json_number(METER_PX),
            "width_in_meters": json_number(SIZE_M),
            "height_in_meters": json_number(SIZE_M),
        }
