"""The page that plays runs: one file, without network, and with one script."""

from __future__ import annotations

import base64
from string import Template
from typing import Any

from grader.recording.playback import Playback, PlayedRun
from grader.scenes import joined
from grader.scenes.turtlesim.player import runs
from grader.scenes.turtlesim.player.replay import animate
from grader.scenes.turtlesim.trace import SPRITE, TurtleTrace
from grader.translations import current, tr
from turtlesim_py.world import picture
from turtlesim_py.world.turtle import TICK_S


def render(playback: Playback) -> str:
    """Return the page, with an animation of each run in it.

    Raises:
        RecordingError: a run cannot be played.
    """
    data = {
        "language": current(),
        "tick_s": TICK_S,
        "sprites": {SPRITE: base64.b64encode(picture.sprite(SPRITE).tobytes()).decode()},
        "sprite": SPRITE,
        "title": playback.title,
        "runs": [_run(run) for run in playback.runs],
        "judged": [joined.judged(item, TICK_S) for item in playback.judged],
        "other": None if playback.other is None else _other(playback, playback.other),
    }
    return joined.fill(
        Template((joined.PLAYER / "player.html").read_text(encoding="utf-8")),
        "player",
        [joined.PLAYER, joined.LIVE_PAGE],
        data,
        style=(joined.PLAYER / "player.css").read_text(encoding="utf-8"),
        title=playback.title,
        summary=playback.summary,
        noscript=tr("This page needs JavaScript. report.html, beside it, does not."),
    )


def _run(run: PlayedRun) -> dict[str, Any]:
    animation = animate(TurtleTrace.of(run.trace), run.start)
    return {
        "title": run.title,
        "outcome": run.outcome,
        **animation,
        **runs.with_lines(animation["calls"], run.sent),
    }


def _other(playback: Playback, other: Playback) -> dict[str, Any]:
    traces = zip(playback.runs, other.runs, strict=False)
    return {
        "title": other.title,
        "summary": other.summary,
        "runs": [_run(run) for run in other.runs],
        "differences": [
            runs.first_difference(TurtleTrace.of(one.trace), TurtleTrace.of(two.trace))
            for one, two in traces
        ],
    }
