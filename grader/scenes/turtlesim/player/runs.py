"""What the page shows of runs beside the animation: the lines behind calls, where runs differ.

The submission's process counts what it sends, the simulator what arrives. Where both are as many by
a name, the first is the first and the last the last; else only the first is known, if anything.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

from grader.recording.playback import Line, Sent
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.events import to_json

#: Services that are the node's own, and no turtle's.
_OF_THE_NODE = frozenset(("clear", "reset", "spawn", "kill"))


def with_lines(calls: Sequence[Mapping[str, Any]], sent: Sequence[Sent]) -> dict[str, Any]:
    """`{"calls", "lines"}`: the calls, with `line` where it is known, a number in the lines."""
    by_name = defaultdict(list)
    for index, call in enumerate(calls):
        by_name[_name(call)].append(index)
    known: dict[int, int] = {}
    lines: dict[Line, int] = {}
    for each in sent:
        where = [line for line, times in each.order for _ in range(min(times, len(calls) + 1))]
        came = by_name[each.name]
        # the simulator has missed something, or hears of somebody else, too
        surely = where if each.times == len(came) else where[:1]
        for index, line in zip(came, surely, strict=False):
            known[index] = lines.setdefault(each.lines[line], len(lines))
    return {
        "calls": [
            {**call, "line": known[index]} if index in known else call
            for index, call in enumerate(calls)
        ],
        "lines": [{"file": line.file, "line": line.line, "text": line.text} for line in lines],
    }


def _name(call: Mapping[str, Any]) -> str:
    """The topic or service that a call came by; '' for what is none."""
    if call["op"] in _OF_THE_NODE:
        return f"/{call['op']}"
    return f"/{call['turtle']}/{call['op']}" if "turtle" in call else ""


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
