"""The page that shows a graded run live: the page of the simulator, read-only.

It needs the token, because a submission's process may have the same network and must not see
verdicts. There is no ROS graph behind the page, so a viewer cannot affect a run.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import Any

from grader.scenes.live import Grading, content_of
from grader.translations import current
from turtlesim_py.live.feed import MOST_CALLS, Deliver, News
from turtlesim_py.live.server import LiveServer, Settings
from turtlesim_py.world.arena import DEFAULT_BACKGROUND
from turtlesim_py.world.canvas import Canvas, Pen

_ABOUT = {"node": "/turtlesim", "namespace": "/", "interfaces": "turtlesim"}


class TurtlesimPage:
    """A `grader.scenes.live.LivePage`."""

    def __init__(self, port: int) -> None:
        """Serve the page; OSError: that is not possible, as where the port is in use."""
        settings = Settings(
            port,
            is_read_only=True,
            needs_token=True,
            has_graph=False,
            language=current(),  # that of the verdicts
        )
        self._server = LiveServer(settings, _ABOUT)
        self._mirror = Mirror(self._server.deliver)
        self._server.start(self._mirror)

    @property
    def address(self) -> str:
        """The address, with the token."""
        return self._server.address

    def await_viewer(self, patience_s: float) -> bool:
        """Wait for a viewer; return whether one has come."""
        return self._mirror.has_been_seen.wait(patience_s)

    def update(self, grading: Grading) -> None:
        """Show the state of the grading."""
        self._mirror.update(grading)

    def begin(self) -> None:
        """Show an empty window."""
        self._mirror.begin()

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Show the news of a run, in order."""
        self._mirror.hear(news)

    def close(self) -> None:
        """Disconnect all viewers."""
        self._server.stop()


class Mirror:
    """The arena of a run in another process, from its news: the paint, and the turtles.

    A `turtlesim_py.live.feed.Source` in place of `Feed`, which needs the arena itself; its methods
    may be called from any thread.

    Attributes:
        has_been_seen: set when the first viewer has come.
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
        """Deliver all of the arena to a viewer."""
        with self._lock:
            content = {**self._state, "grading": self._grading}
            self._deliver(News(content, self._canvas.copy(), viewer))
        self.has_been_seen.set()

    def begin(self) -> None:
        """Begin another run, with nothing painted."""
        with self._lock:
            self._start()
            self._deliver(News({**self._state, "drawn": [None], "calls": [], "begins": True}))

    def update(self, grading: Grading) -> None:
        """Deliver the state of the grading."""
        with self._lock:
            self._grading = content_of(grading)
            content = {"tick": self._state["tick"], "drawn": [], "calls": []}
            self._deliver(News({**content, "grading": self._grading}))

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
            self._deliver(News({**changed, "drawn": drawn, "calls": calls[-MOST_CALLS:]}))

    def _draw(self, stroke: Any) -> None:
        if stroke is None:
            self._canvas.clear()
            return
        color, numbers = stroke
        runs = list(zip(*[iter(numbers)] * 3, strict=True))
        self._canvas.paint(Pen(*color), runs)
