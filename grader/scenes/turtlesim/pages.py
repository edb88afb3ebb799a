"""The pages of runs: one plays them afterwards; the simulator's own, read-only, shows them live.

The first is one file, without network, and with one script. It has the line of code behind each
call, and the first difference of two runs. The submission's process counts the messages that it
sends by a name, the simulator those that arrive. Where the counts agree, each belongs to its line;
else only the line of the first is known.
"""

from __future__ import annotations

import base64
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, ClassVar

from grader.recording.observations import End
from grader.scenes.live import LivePage
from grader.scenes.playback import PLAYER, Playback, PlayedRun, render_page
from grader.scenes.turtlesim.replay import animate
from grader.scenes.turtlesim.trace import SPRITE, TurtleTrace
from turtlesim_py.live.feed import MOST_CALLS
from turtlesim_py.world import picture
from turtlesim_py.world.arena import DEFAULT_BACKGROUND
from turtlesim_py.world.canvas import Canvas, Pen
from turtlesim_py.world.events import Event, to_json
from turtlesim_py.world.turtle import TICK_S

#: Services of the node, not of a turtle.
_OF_THE_NODE = frozenset(("clear", "reset", "spawn", "kill"))


def render(playback: Playback) -> str:
    data = {
        "tick_s": TICK_S,
        "sprites": {SPRITE: base64.b64encode(picture.sprite(SPRITE).tobytes()).decode()},
        "sprite": SPRITE,
        "runs": [_run(run) for run in playback.runs],
        "other": None if playback.other is None else _other(playback, playback.other),
    }
    return render_page(playback, PLAYER / "player.html", data)


def _run(run: PlayedRun) -> dict[str, Any]:
    animation = animate(TurtleTrace.of(run.trace), run.start)
    return {
        "title": run.title,
        "outcome": run.outcome,
        **animation,
        **with_lines(animation["calls"], run.sent),
    }


def _other(playback: Playback, other: Playback) -> dict[str, Any]:
    traces = zip(playback.runs, other.runs, strict=False)
    return {
        "title": other.title,
        "summary": other.summary,
        "runs": [_run(run) for run in other.runs],
        "differences": [
            first_difference(TurtleTrace.of(one.trace), TurtleTrace.of(two.trace))
            for one, two in traces
        ],
    }


def with_lines(calls: Sequence[Mapping[str, Any]], ends: Sequence[End]) -> dict[str, Any]:
    """Return `{"calls", "lines"}`: each call has its `line`, an index, where that is known."""
    by_name = defaultdict(list)
    for index, call in enumerate(calls):
        by_name[_name(call)].append(index)
    known: dict[int, int] = {}
    lines: dict[tuple[str, int, str], int] = {}  # without their functions: a line is one
    for end in ends:
        where = [burst.line for burst in end.sent for _ in range(min(burst.times, len(calls) + 1))]
        came = by_name[end.name]
        # the simulator has missed some, or another process sends by this name too
        surely = where if end.used == len(came) else where[:1]
        for index, line in zip(came, surely, strict=False):
            place = end.lines[line]
            key = (place.file, place.line, place.text)
            known[index] = lines.setdefault(key, len(lines))
    return {
        "calls": [
            {**call, "line": known[index]} if index in known else call
            for index, call in enumerate(calls)
        ],
        "lines": [{"file": file, "line": line, "text": text} for file, line, text in lines],
    }


def _name(call: Mapping[str, Any]) -> str:
    """Return the topic or service that a call came by; '' where it came by none."""
    if call["op"] in _OF_THE_NODE:
        return f"/{call['op']}"
    return f"/{call['turtle']}/{call['op']}" if "turtle" in call else ""


def first_difference(mine: TurtleTrace, other: TurtleTrace) -> dict[str, Any] | None:
    """Return the first tick whose inputs differ, with these; None where none does.

    `{"tick", "mine": [...], "other": [...]}`, with the inputs of that tick as JSON.
    """
    first, second = mine.by_tick(), other.by_tick()
    for tick in sorted(first.keys() | second.keys()):
        one, two = _inputs(first.get(tick, ())), _inputs(second.get(tick, ()))
        if one != two:
            return {"tick": tick, "mine": one, "other": two}
    return None


def _inputs(events: Iterable[Event]) -> list[dict[str, Any]]:
    """Return inputs as JSON, without the ids of goals, which are random."""
    found = map(to_json, events)
    return [{key: each[key] for key in each if key not in ("id", "tick")} for each in found]


class TurtlesimPage(LivePage):
    """The arena of a run in another process, from the news of its `Feed`: paint and turtles."""

    ABOUT: ClassVar = {"node": "/turtlesim", "namespace": "/", "interfaces": "turtlesim"}

    def _start(self) -> Mapping[str, Any]:
        self._canvas = Canvas()
        self._state: dict[str, Any] = {"tick": 0, "background": DEFAULT_BACKGROUND, "turtles": []}
        return {**self._state, "drawn": [None], "calls": []}

    def _everything(self) -> tuple[Mapping[str, Any], Canvas]:
        return self._state, self._canvas.copy()

    def _nothing_new(self) -> Mapping[str, Any]:
        return {"tick": self._state["tick"], "drawn": [], "calls": []}

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        if not news:
            return
        drawn: list[Any] = []
        calls: list[Any] = []
        changed: dict[str, Any] = {}
        with self._lock:
            for each in news:
                for stroke in each["drawn"]:
                    self._draw(stroke)
                    if stroke is None:
                        drawn.clear()
                    drawn.append(stroke)
                calls += each["calls"]
                changed |= {key: each[key] for key in self._state if key in each}
            self._state |= changed
            self._tell({**changed, "drawn": drawn, "calls": calls[-MOST_CALLS:]})

    def _draw(self, stroke: Any) -> None:
        if stroke is None:
            self._canvas.clear()
            return
        color, numbers = stroke
        runs = list(zip(*[iter(numbers)] * 3, strict=True))
        self._canvas.paint(Pen(*color), runs)
