"""Replays a scripted run without ROS: inputs by tick in, trace and pictures out.

    python -m turtlesim_py.scenario FILE.json --out DIR

A scenario is a JSON object `{name, description, ticks, events: [{tick, op, ...}]}`, alone or under
the key `scenario` of a larger one. Tick k (1, 2, ...) applies the events with `tick == k`, in the
order in which they are listed, and then updates every turtle once. Not-a-number and the
infinities are the strings "nan", "inf" and "-inf". With `start: {x, y, theta, speed, turn}` turtle1
begins elsewhere, and every turtle drives and turns so many times as fast as it is commanded.

| op | fields (`turtle` is turtle1 where absent) |
|---|---|
| cmd_vel | turtle, linear [x, y, z] m/s, angular [x, y, z] rad/s |
| set_pen | turtle, r, g, b, width, off |
| teleport_absolute | turtle, x, y [m], theta [rad] |
| teleport_relative | turtle, linear [m], angular [rad] |
| rotate_absolute, cancel | turtle, theta [rad], id; id |
| spawn, kill | x, y, theta, name; name |
| clear, reset | |
| param | name, value; double: true for a whole number that is meant as a double |
| snapshot, snapshot_now | name: keep the drawing after, or before, this tick |
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from PIL import Image

from turtlesim_py.world import events as kinds
from turtlesim_py.world import picture
from turtlesim_py.world.arena import BY_NAME, Arena, refusal
from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.events import Event, GoalFeedback, GoalResult, LogLine, Notice
from turtlesim_py.world.floats import float32, json_number
from turtlesim_py.world.trajectory import COLUMNS
from turtlesim_py.world.turtle import METER_PX, SIZE_M, TICK_S, Reading

INTERNAL_COLUMNS = ["tick", "pos_x", "pos_y_down", "orient", "lin_vel_x", "lin_vel_y", "ang_vel"]
#: The order of one tick's action messages in a recording: a goal's result reaches its client last.
ACTION_ORDER = {"accepted": 0, "cancel_response": 0, "feedback": 1, "result": 2}
#: What a cancel request answers for a goal that no longer runs.
ERROR_GOAL_TERMINATED = 3


class ScenarioError(Exception):
    """The scenario cannot be replayed; the text explains which part and why."""


@dataclass
class Replay:
    """The outcome of a scenario.

    Attributes:
        result: JSON-ready: published, internal, responses, action, logs, turtles_at_end, ...
        arena: the world after the last tick.
        snapshots: name -> a copy of the canvas.
    """

    result: dict[str, Any]
    arena: Arena
    snapshots: dict[str, Canvas] = field(default_factory=dict)


def replay(scenario: dict[str, Any]) -> Replay:
    """Run a scenario from its first to its last tick.

    Raises:
        ScenarioError: an event is unknown, incomplete or outside the scenario's ticks.
    """
    by_tick = events_by_tick(scenario)
    player = _Player()
    _begin(player.arena, scenario.get("start"))
    for tick in range(1, scenario["ticks"] + 1):
        player.play_tick(tick, by_tick[tick])
    return Replay({"scenario": scenario, **player.result()}, player.arena, player.snapshots)


def _begin(arena: Arena, start: object) -> None:
    """Begin elsewhere; with None, as usual."""
    if start is None:
        return
    needed, known = {"x", "y", "theta"}, {"x", "y", "theta", "speed", "turn"}
    if not isinstance(start, dict) or not needed <= start.keys() <= known:
        raise ScenarioError("'start' needs x, y and theta, and may have speed and turn")
    if any(type(value) not in (int, float) for value in start.values()):
        raise ScenarioError(f"'start' needs numbers, found {start!r:.60}")
    arena.begin_at(**start)


def events_by_tick(scenario: dict[str, Any]) -> dict[int, list[tuple[int, Event]]]:
    """Read the events; each with its place in the scenario.

    Raises:
        ScenarioError: one is unknown, incomplete or outside the scenario's ticks.
    """
    ticks, listed = scenario.get("ticks"), scenario.get("events", [])
    if type(ticks) is not int or ticks < 0 or not isinstance(listed, list):
        raise ScenarioError("a scenario needs 'ticks', a whole number from 0, and 'events', a list")
    by_tick: dict[int, list[tuple[int, Event]]] = defaultdict(list)
    for index, words in enumerate(listed):
        tick = words.get("tick") if isinstance(words, dict) else None
        if type(tick) is not int or not 1 <= tick <= ticks:
            raise ScenarioError(f"event {index}: 'tick' must be from 1 to {ticks}, found {tick!r}")
        try:
            by_tick[tick].append((index, kinds.from_json(words)))
        except kinds.EventError as error:
            known = f", {words['op']}" if words.get("op") in kinds.KINDS else ""
            raise ScenarioError(f"event {index} (tick {tick}{known}): {error}") from None
    return by_tick


def apply(arena: Arena, event: Event) -> object:
    """Apply an event to an arena; return the arena's answer.

    Raises:
        ValueError: it cannot be applied.
    """
    named = getattr(event, "turtle", None)
    if named is not None and named not in arena.turtles:
        return None  # the topics of a missing turtle have no subscriber
    match event:
        case kinds.CmdVel():
            arena.command(event.turtle, event.linear, event.angular)
        case kinds.SetPen(turtle=turtle, r=r, g=g, b=b, width=width, off=off):
            arena.set_pen(turtle, r, g, b, width, off)
        case kinds.TeleportAbsolute(turtle=turtle):
            place = (float32(value) for value in (event.x, event.y, event.theta))
            arena.teleport_absolute(turtle, *place)
        case kinds.TeleportRelative(turtle=turtle, linear=linear, angular=angular):
            arena.teleport_relative(turtle, float32(linear), float32(angular))
        case kinds.RotateAbsolute():
            arena.rotate_absolute(event.turtle, float32(event.theta), event.id)
        case kinds.Cancel():
            return arena.cancel(event.id)
        case kinds.Spawn():
            return arena.spawn(event.x, event.y, event.theta, event.name)
        case kinds.Kill(name=name):
            return arena.kill(name)
        case kinds.Clear():
            arena.clear()
        case kinds.Reset():
            arena.reset()
        case kinds.SetParameter(name=name) if not _wrong_parameter(event):
            arena.set_parameter(name, event.value)  # type: ignore[arg-type]
    return None


def _wrong_parameter(event: kinds.SetParameter) -> str:
    """Return why the original would not set a parameter; '' where it would."""
    if event.name not in BY_NAME:
        return f"parameter '{event.name}' cannot be set because it was not declared"
    return refusal(BY_NAME[event.name], event.value)


class _Player:
    """One replay: the arena, and its recording."""

    def __init__(self) -> None:
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
        self.arena = Arena((self._on_notice,))

    def play_tick(self, tick: int, inputs: list[tuple[int, Event]]) -> None:
        """Apply the inputs of a tick, and update the turtles."""
        self.tick = tick
        for index, event in inputs:
            try:
                answer = self._apply(event)
            except ValueError as error:
                where = f"event {index} (tick {tick}, {event.op})"
                raise ScenarioError(f"{where}: {error}") from None
            if answer is not None:
                self.responses.append({"tick": tick, "event": index, **answer})
        self._record(self.arena.tick())
        for _, event in inputs:
            if isinstance(event, kinds.Snapshot):
                self._keep_drawing(event.name)

    def _apply(self, event: Event) -> dict[str, Any] | None:
        """Apply an event, and return the answer to its caller, if there is one."""
        match event:
            case kinds.RotateAbsolute(turtle=turtle) if turtle in self.arena.turtles:
                self._record_action(event.id, "accepted")
                self.known_goals.add(event.id)
            case kinds.Cancel():
                return self._cancel(event.id)
            case kinds.SnapshotNow(name=name):
                self._keep_drawing(name)
        answer = apply(self.arena, event)
        match event:
            case kinds.Spawn():
                return {"response": {"callback_return": bool(answer), "name": answer}}
            case kinds.Kill():
                return {"response": {"callback_return": answer}}
            case kinds.SetParameter(name=name):
                wrong = _wrong_parameter(event)
                tried = {"successful": not wrong, "reason": wrong}
                return {"response": tried if name in BY_NAME else {"exception": wrong}}
        return None

    def _cancel(self, goal_id: kinds.GoalId) -> dict[str, Any] | None:
        if goal_id not in self.known_goals:
            return {"client_exception": "Goal handle is not known to this client."}
        running = self.arena.cancel(goal_id)
        code = 0 if running else ERROR_GOAL_TERMINATED
        self._record_action(
            goal_id, "cancel_response", return_code=code, goals_canceling=int(running)
        )
        return None

    def _keep_drawing(self, name: str) -> None:
        self.snapshots[name] = self.arena.canvas.copy()

    def _record(self, readings: Mapping[str, Reading]) -> None:
        for name, ((*pose,), color) in readings.items():
            turtle = self.arena.turtles[name]
            self.published[name].append([self.tick, *map(json_number, pose), *color])
            inside = (turtle.x_m, turtle.y_down_m, turtle.heading_rad)
            speeds = (turtle.lin_x, turtle.lin_y, turtle.ang)
            self.internal[name].append([self.tick, *(json_number(v, 17) for v in inside + speeds)])
        for entry in self.action:
            if entry["type"] == "result":
                self.known_goals.discard(entry["id"])

    def _on_notice(self, notice: Notice) -> None:
        match notice:
            case LogLine(severity, text):
                self.logs.append([self.tick, severity, "turtlesim", text])
            case GoalFeedback(_, goal_id, remaining):
                self._record_action(goal_id, "feedback", remaining=json_number(remaining))
            case GoalResult(_, goal_id, status, delta):
                self._record_action(goal_id, "result", status=status, delta=json_number(delta))

    def _record_action(self, goal_id: Any, kind: str, **more: Any) -> None:
        self.action.append({"tick": self.tick, "id": goal_id, "type": kind, **more})

    def result(self) -> dict[str, Any]:
        """Return all that was recorded, in the form of the original's recordings."""
        self.action.sort(key=lambda entry: (entry["tick"], ACTION_ORDER[entry["type"]]))
        return {
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


# Files ------------------------------------------------------------------------------------------


def read(path: Path) -> dict[str, Any]:
    """Read a scenario file.

    Raises:
        ScenarioError: it cannot be read, or holds no scenario.
    """
    try:
        return {"name": path.stem, **parse(path.read_text(encoding="utf-8"))}
    except OSError as error:
        raise ScenarioError(f"cannot read {path}: {error.strerror}") from None
    except (ValueError, ScenarioError) as error:
        raise ScenarioError(f"{path} holds no scenario: {error}") from None


def parse(text: str) -> dict[str, Any]:
    """Return the scenario that a text holds.

    Raises:
        ScenarioError: it is not JSON, or holds none.
    """
    try:
        data = json.loads(text)
    except ValueError as error:
        raise ScenarioError(str(error)) from None
    if isinstance(data, dict):
        data = data.get("scenario", data)
    if not isinstance(data, dict):
        raise ScenarioError(f"expected an object, found {data!r:.40}")
    return data


def write(outcome: Replay, folder: Path) -> list[Path]:
    """Write NAME.json, NAME.path.png, NAME.png (the window) and the snapshots; return the paths.

    Raises:
        ScenarioError: the scenario or a snapshot has a name that no file can have.
    """
    name, arena = outcome.result["scenario"]["name"], outcome.arena
    for one in (name, *outcome.snapshots):
        if not isinstance(one, str) or not one or Path(one).name != one:
            raise ScenarioError(f"{one!r} is no name for a file")
    folder.mkdir(parents=True, exist_ok=True)
    trace = folder / f"{name}.json"
    trace.write_text(json.dumps(outcome.result), encoding="utf-8")
    pictures = {
        f"{name}.path.png": arena.canvas.rgba(),
        **{f"{name}.{key}.path.png": kept.rgba() for key, kept in outcome.snapshots.items()},
        f"{name}.png": picture.render(arena.canvas, arena.background, arena.sprites()),
    }
    for file_name, pixels in pictures.items():
        Image.fromarray(pixels).save(folder / file_name, format="PNG")
    return [trace, *(folder / file_name for file_name in pictures)]


def main(argv: list[str] | None = None) -> int:
    """Command line; exit code 2 and one line where the file cannot be replayed."""
    parser = argparse.ArgumentParser(
        prog="python -m turtlesim_py.scenario",
        description="Replay a scripted turtlesim run without ROS.",
    )
    parser.add_argument("file", type=Path, metavar="FILE.json")
    parser.add_argument("--out", type=Path, default=Path(), metavar="DIR", help="default: here")
    args = parser.parse_args(argv)
    try:
        for path in write(replay(read(args.file)), args.out):
            print(path)
    except (ScenarioError, OSError) as error:
        print(f"scenario: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
