"""Where two runs begin to differ."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.events import to_json


def first_difference(mine: TurtleTrace, other: TurtleTrace) -> dict[str, Any] | None:
    """The first tick in which not the same came in, and what did; None where all is the same.

    `{"tick", "mine": [...], "other": [...]}`, with the inputs of that tick as JSON.
    """
    first, second = _by_tick(mine), _by_tick(other)
    for tick in sorted(first.keys() | second.keys()):
        if first.get(tick, []) != second.get(tick, []):
            return {"tick": tick, "mine": first.get(tick, []), "other": second.get(tick, [])}
    return None


def _by_tick(trace: TurtleTrace) -> dict[int, list[Any]]:
    """Inputs by tick. Goals are told apart by ids that nobody chooses: these are left out."""
    found: dict[int, list[Any]] = defaultdict(list)
    for event in trace.events:
        words = to_json(event)
        found[event.tick].append({key: words[key] for key in words if key not in ("id", "tick")})
    return dict(found)
