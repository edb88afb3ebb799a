"""The page that plays what was exchanged: one file, without network, and with one script."""

from __future__ import annotations

from pathlib import Path
from string import Template
from typing import Any, Final

from grader.cast import timeline
from grader.cast.trace import CastTrace
from grader.recording.playback import Playback, PlayedRun
from grader.scenes import joined
from grader.scenes.scene import STEP_NS
from grader.translations import current, tr

PAGE: Final = Path(__file__).with_name("page")


def render(playback: Playback) -> str:
    """Return the page, with a timeline of each run in it."""
    other = playback.other
    others = () if other is None else tuple((f"{other.title}: {r.title}", r) for r in other.runs)
    data = {
        "language": current(),
        "tick_s": STEP_NS / 1e9,
        "title": playback.title,
        "runs": [_run(*each) for each in (*((r.title, r) for r in playback.runs), *others)],
        "judged": [joined.judged(item, STEP_NS / 1e9) for item in playback.judged],
    }
    html = (PAGE / "replay.html").read_text(encoding="utf-8")
    folders = [PAGE, PAGE / "live", joined.PLAYER, joined.LIVE_PAGE]
    styles = (joined.PLAYER / "player.css", PAGE / "live" / "timeline.css")
    return joined.fill(
        Template(html),
        "replay",
        folders,
        data,
        style="".join(each.read_text(encoding="utf-8") for each in styles),
        title=playback.title,
        summary=playback.summary,
        noscript=tr("This page needs JavaScript. report.html, beside it, does not."),
    )


def _run(title: str, run: PlayedRun) -> dict[str, Any]:
    trace = run.trace
    assert isinstance(trace, CastTrace)
    return {
        **{"title": title, "outcome": run.outcome, "ticks": trace.ticks},
        **{"lanes": timeline.lanes(trace), "items": timeline.items(trace)},
    }
