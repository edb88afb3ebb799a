"""Replay a scripted run without ROS: inputs by tick in, trace and pictures out.

    python -m turtlesim_py.scenario FILE.json --out DIR

A scenario is a JSON object `{name, description, ticks, events: [{tick, op, ...}]}`, alone or under
the key `scenario` of a larger one. Tick k (1, 2, ...) takes the events with `tick == k`, in the
order in which they are listed, and then updates every turtle once. Not-a-number and the
infinities are the strings "nan", "inf" and "-inf".

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
from pathlib import Path
from typing import Any

from turtlesim_py.png import save_png
from turtlesim_py.replay import Replay, ScenarioError, replay
from turtlesim_py.world import picture


def read(path: Path) -> dict[str, Any]:
    """Read a scenario file.

    Raises:
        ScenarioError: it cannot be read, is not JSON, or holds no scenario.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ScenarioError(f"cannot read {path}: {error.strerror}") from None
    except ValueError as error:
        raise ScenarioError(f"{path} is not JSON: {error}") from None
    if isinstance(data, dict):
        data = data.get("scenario", data)
    if not isinstance(data, dict) or "ticks" not in data:
        raise ScenarioError(
            f"{path} holds no scenario: expected an object with 'ticks' and 'events'"
        )
    scenario = {"name": path.stem, **data}
    events = scenario.get("events")
    snapshots = filter(_is_snapshot, events if isinstance(events, list) else ())
    names = [scenario["name"], *(event["name"] for event in snapshots)]
    for name in names:
        if not isinstance(name, str) or not name or Path(name).name != name:
            raise ScenarioError(f"{path}: {name!r} is no name for a file")
    return scenario


def _is_snapshot(event: object) -> bool:
    return isinstance(event, dict) and "name" in event and "snapshot" in str(event.get("op"))


def write(outcome: Replay, folder: Path) -> list[Path]:
    """Write NAME.json, NAME.path.png, NAME.png (the window) and the snapshots; return the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    name = outcome.result["scenario"]["name"]
    trace = folder / f"{name}.json"
    trace.write_text(json.dumps(outcome.result), encoding="utf-8")
    written = [trace]
    for canvas, suffix in [
        (outcome.arena.canvas, "path"),
        *((canvas, f"{snapshot}.path") for snapshot, canvas in outcome.snapshots.items()),
    ]:
        written.append(folder / f"{name}.{suffix}.png")
        save_png(canvas.rgba(), written[-1])
    written.append(folder / f"{name}.png")
    arena = outcome.arena
    save_png(picture.render(arena.canvas, arena.background, arena.sprites()), written[-1])
    return written


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
