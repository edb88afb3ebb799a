"""The pages that show what was exchanged: one plays it afterwards, one shows it live as it grows.

The first is one file, without network, and with one script.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Final

from grader.scenes.cast import timeline
from grader.scenes.cast.trace import CastTrace
from grader.scenes.live import LivePage
from grader.scenes.playback import Playback, PlayedRun, render_page
from grader.scenes.scene import STEP_NS

PAGE: Final = Path(__file__).with_name("page")


def render(playback: Playback) -> str:
    """Return the page, with a timeline of each run in it."""
    other = playback.other
    others = () if other is None else tuple((f"{other.title}: {r.title}", r) for r in other.runs)
    data = {"runs": [_run(*each) for each in (*((r.title, r) for r in playback.runs), *others)]}
    live = PAGE / "live"
    return render_page(
        playback, PAGE / "replay.html", data, STEP_NS / 1e9, [PAGE, live], [live / "timeline.css"]
    )


def _run(title: str, run: PlayedRun) -> dict[str, Any]:
    trace = run.trace
    assert isinstance(trace, CastTrace)
    return {
        **{"title": title, "outcome": run.outcome, "ticks": trace.ticks},
        **{"lanes": timeline.lanes(trace), "labels": timeline.labels(trace)},
        "items": timeline.items(trace),
    }


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
        changed: dict[str, Mapping[str, Any]] = {}
        with self._lock:
            for each in news:
                self._time_s = each["t"]
                self._shown = {name: each[name] for name in self._shown}
                changed.update((item["id"], item) for item in each["items"])
            self._items.update(changed)
            self._tell({**self._nothing_new(), "items": [*changed.values()]})
