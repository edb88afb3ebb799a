"""The page that plays what was exchanged: one file, without network, and with one script."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from grader.cast import timeline
from grader.cast.trace import CastTrace
from grader.recording.playback import Playback, PlayedRun
from grader.scenes import joined
from grader.scenes.scene import STEP_NS

PAGE: Final = Path(__file__).with_name("page")


def render(playback: Playback) -> str:
    """Return the page, with a timeline of each run in it."""
    other = playback.other
    others = () if other is None else tuple((f"{other.title}: {r.title}", r) for r in other.runs)
    data = {"runs": [_run(*each) for each in (*((r.title, r) for r in playback.runs), *others)]}
    live = PAGE / "live"
    return joined.render(
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
