"""The page that shows a graded run live: the timeline as it grows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from grader.cast.replay import PAGE
from grader.scenes.live import LivePage


class TimelinePage(LivePage):
    """The items of a run in another process, by their ids."""

    PAGE: ClassVar = PAGE / "live"

    def _start(self) -> Mapping[str, Any]:
        self._shown: dict[str, Any] = {"lanes": [], "labels": {}}
        self._items: dict[str, Mapping[str, Any]] = {}
        self._time_s = 0.0
        return self._nothing_new()

    def _everything(self) -> tuple[Mapping[str, Any], None]:
        return {**self._nothing_new(), "items": [*self._items.values()], "begins": True}, None

    def _nothing_new(self) -> Mapping[str, Any]:
        return {"t": self._time_s, **self._shown, "items": []}

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Show what is new in a run."""
        changed: dict[str, Mapping[str, Any]] = {}
        with self._lock:
            for each in news:
                self._time_s = each["t"]
                self._shown = {name: each[name] for name in self._shown}
                changed.update((item["id"], item) for item in each["items"])
            self._items.update(changed)
            self._tell({**self._nothing_new(), "items": [*changed.values()]})
