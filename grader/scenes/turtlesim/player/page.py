"""The page that plays runs: one file, without network, whose only script is our own."""

from __future__ import annotations

import base64
import hashlib
import json
from functools import cache
from html import escape
from pathlib import Path
from string import Template
from typing import Any

import turtlesim_py
from grader.language.catalogue import spoken
from grader.language.telling import tell
from grader.scenes.playback import Judged, Playback, Take
from grader.scenes.turtlesim.player import modules, sources
from grader.scenes.turtlesim.player.differences import first_difference
from grader.scenes.turtlesim.player.film import film
from grader.scenes.turtlesim.trace import SPRITE, TurtleTrace
from turtlesim_py.world import sprites
from turtlesim_py.world.turtle import TICK_S

_PAGE = Path(__file__).with_name("page")
#: Where the window is drawn that the live page shows, too, and what both say.
_LIVE_PAGE = Path(turtlesim_py.__file__).parent / "live" / "page"


def render(playback: Playback) -> str:
    """The page, with films of all runs in it.

    Raises:
        RecordingError: a run cannot be played.
    """
    data = {
        "language": spoken(),
        "sentences": _sentences(spoken()),
        "tick_s": TICK_S,
        "sprites": {SPRITE: base64.b64encode(sprites.sprite(SPRITE).tobytes()).decode()},
        "sprite": SPRITE,
        "title": playback.title,
        "runs": [_run(take) for take in playback.takes],
        "judged": [_judged(item) for item in playback.judged],
        "other": None if playback.other is None else _other(playback, playback.other),
    }
    script = _script()
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return _template().substitute(
        digest=digest,
        lang=spoken(),
        noscript=escape(tell("This page needs JavaScript. report.html, beside it, does not.")),
        title=escape(playback.title),
        summary=escape(playback.summary),
        style=(_PAGE / "player.css").read_text(encoding="utf-8"),
        data=_in_html(data),
        script=script,
    )


def _run(take: Take) -> dict[str, Any]:
    made = film(TurtleTrace.of(take.trace), take.start)
    return {
        "title": take.title,
        "outcome": take.outcome,
        **made,
        **sources.of(made["calls"], take.sent),
    }


def _judged(item: Judged) -> dict[str, Any]:
    return {**vars(item), "moments": [vars(moment) for moment in item.moments]}


def _other(playback: Playback, other: Playback) -> dict[str, Any]:
    traces = zip(playback.takes, other.takes, strict=False)
    return {
        "title": other.title,
        "summary": other.summary,
        "runs": [_run(take) for take in other.takes],
        "differences": [
            first_difference(TurtleTrace.of(one.trace), TurtleTrace.of(two.trace))
            for one, two in traces
        ],
    }


def _in_html(data: Any) -> str:
    """JSON that no parser of HTML takes for anything else."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for letter in "<>&":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


@cache
def _sentences(language: str) -> dict[str, str]:
    """What the page says instead of each English sentence; what is not there stays English."""
    found: dict[str, str] = {}
    for folder in (_LIVE_PAGE, _PAGE):
        file = folder / f"{language}.json"
        found |= json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    return found


@cache
def _script() -> str:
    return modules.joined("player", [_PAGE, _LIVE_PAGE])


@cache
def _template() -> Template:
    return Template((_PAGE / "player.html").read_text(encoding="utf-8"))
