"""The arena of a run as another process tells of it: what is painted, where the turtles are.

It stands for `turtlesim_py.live.feed.Feed` where the arena itself is out of reach.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from grader.scenes.live import Grading
from turtlesim_py.live.feed import MOST_CALLS, Change, Deliver, Whole
from turtlesim_py.world.arena import DEFAULT_BACKGROUND
from turtlesim_py.world.canvas import Canvas, Pen


class Mirror:
    """A `turtlesim_py.live.feed.Source`; its methods may be called from any thread.

    Attributes:
        has_been_seen: set when somebody looks for the first time.
    """

    def __init__(self, deliver: Deliver) -> None:
        self.is_watched = False
        self.has_been_seen = threading.Event()
        self._deliver = deliver
        self._lock = threading.Lock()
        self._grading: Mapping[str, Any] = {}
        self._start()

    def _start(self) -> None:
        self._canvas = Canvas()
        self._state: dict[str, Any] = {
            "tick": 0,
            "background": DEFAULT_BACKGROUND,
            "turtles": [],
        }

    def ask(self, viewer: object) -> None:
        """Have all of it delivered for a viewer."""
        with self._lock:
            content = {**self._state, "grading": self._grading}
            self._deliver(Whole(viewer, self._canvas.copy(), content))
        self.has_been_seen.set()

    def begin(self) -> None:
        """Another run begins: nothing is painted yet."""
        with self._lock:
            self._start()
            self._deliver(Change({**self._state, "drawn": [None], "calls": [], "begins": True}))

    def tell(self, grading: Grading) -> None:
        """Have viewers know what is known of the grading."""
        with self._lock:
            self._grading = _words(grading)
            content = {"tick": self._state["tick"], "drawn": [], "calls": []}
            self._deliver(Change({**content, "grading": self._grading}))

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Take up changes as `Feed` makes them, and hand them on as one."""
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
            self._deliver(Change({**changed, "drawn": drawn, "calls": calls[-MOST_CALLS:]}))

    def _draw(self, stroke: Any) -> None:
        if stroke is None:
            self._canvas.clear()
            return
        color, numbers = stroke
        runs = list(zip(*[iter(numbers)] * 3, strict=True))
        self._canvas.paint(Pen(*color), runs)


def _words(grading: Grading) -> Mapping[str, Any]:
    shown = ("status", "word", "title", "rationale", "help")
    checks = [{name: getattr(each, name) for name in shown} for each in grading.judged]
    told = {name: value for name, value in asdict(grading).items() if name != "judged"}
    return {**told, "checks": checks}
