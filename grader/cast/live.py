"""The page that shows a graded run live: the timeline as it grows; viewers can only watch.

It is served as the turtles' page is (`turtlesim_py.live.server`), with the same token.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from grader.cast.replay import PAGE
from grader.scenes.live import Grading, content_of
from grader.translations import current
from turtlesim_py.live.feed import News
from turtlesim_py.live.server import LiveServer, Settings


class TimelinePage:
    """A `grader.scenes.live.LivePage`, and a `turtlesim_py.live.feed.Source` of its server."""

    def __init__(self, port: int) -> None:
        """Serve the page; OSError: that is not possible, as where the port is in use."""
        settings = Settings(
            port,
            is_read_only=True,
            needs_token=True,
            has_graph=False,
            language=current(),  # that of the verdicts
            page=PAGE / "live",
        )
        self.is_watched = False
        self._has_been_seen = threading.Event()
        self._lock = threading.Lock()
        self._grading: Mapping[str, Any] = {}
        self._lanes: list[str] = []
        self._items: dict[str, Mapping[str, Any]] = {}
        self._time_s = 0.0
        self._server = LiveServer(settings, {})
        self._deliver: Callable[[News], None] = self._server.deliver
        self._server.start(self)

    @property
    def address(self) -> str:
        """The address, with the token."""
        return self._server.address

    def await_viewer(self, patience_s: float) -> bool:
        """Wait for a viewer; return whether one has come."""
        return self._has_been_seen.wait(patience_s)

    def ask(self, viewer: object) -> None:
        """Deliver all to a viewer."""
        with self._lock:
            content = {**self._state(), "items": [*self._items.values()], "begins": True}
            self._deliver(News({**content, "grading": self._grading}, viewer=viewer))
        self._has_been_seen.set()

    def update(self, grading: Grading) -> None:
        """Show the state of the grading."""
        with self._lock:
            self._grading = content_of(grading)
            self._deliver(News({**self._state(), "items": [], "grading": self._grading}))

    def begin(self) -> None:
        """Show nothing, before a run."""
        with self._lock:
            self._lanes, self._items, self._time_s = [], {}, 0.0
            self._deliver(News({**self._state(), "items": [], "begins": True}))

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Show what is new in a run."""
        changed: dict[str, Mapping[str, Any]] = {}
        with self._lock:
            for each in news:
                self._time_s, self._lanes = each["t"], each["lanes"]
                changed.update((item["id"], item) for item in each["items"])
            self._items.update(changed)
            self._deliver(News({**self._state(), "items": [*changed.values()]}))

    def close(self) -> None:
        """Stop serving; open pages keep their content."""
        self._server.stop()

    def _state(self) -> dict[str, Any]:
        return {"t": self._time_s, "lanes": self._lanes}
