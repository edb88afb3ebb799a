"""The page that shows a graded run live: the page of the simulator, read-only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from grader.scenes.live import LivePage
from turtlesim_py.live.feed import MOST_CALLS
from turtlesim_py.world.arena import DEFAULT_BACKGROUND
from turtlesim_py.world.canvas import Canvas, Pen


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
        """Apply changes of a `Feed`, and deliver them as one."""
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
