"""The page that plays runs: one file, without network, and with one script."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Sequence
from functools import cache
from html import escape
from pathlib import Path
from string import Template
from typing import Any

import turtlesim_py
from grader.recording.playback import JudgedCheck, Moment, Playback, PlayedRun
from grader.scenes.turtlesim.player import runs
from grader.scenes.turtlesim.player.replay import animate
from grader.scenes.turtlesim.trace import SPRITE, TurtleTrace
from grader.translations import catalogue, current, tr
from turtlesim_py.world import picture
from turtlesim_py.world.turtle import TICK_S

_PAGE = Path(__file__).with_name("page")
#: The modules and sentences that the live page has too: the window is drawn there.
_LIVE_PAGE = Path(turtlesim_py.__file__).parent / "live" / "page"


def render(playback: Playback) -> str:
    """Return the page, with an animation of each run in it.

    Raises:
        RecordingError: a run cannot be played.
    """
    data = {
        "language": current(),
        "sentences": _sentences(current()),
        "tick_s": TICK_S,
        "sprites": {SPRITE: base64.b64encode(picture.sprite(SPRITE).tobytes()).decode()},
        "sprite": SPRITE,
        "title": playback.title,
        "runs": [_run(run) for run in playback.runs],
        "judged": [_judged(item) for item in playback.judged],
        "other": None if playback.other is None else _other(playback, playback.other),
    }
    script = _script()
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return _template().substitute(
        digest=digest,
        lang=current(),
        noscript=escape(tr("This page needs JavaScript. report.html, beside it, does not.")),
        title=escape(playback.title),
        summary=escape(playback.summary),
        style=(_PAGE / "player.css").read_text(encoding="utf-8"),
        data=_in_html(data),
        script=script,
    )


def _run(run: PlayedRun) -> dict[str, Any]:
    animation = animate(TurtleTrace.of(run.trace), run.start)
    return {
        "title": run.title,
        "outcome": run.outcome,
        **animation,
        **runs.with_lines(animation["calls"], run.sent),
    }


def _judged(item: JudgedCheck) -> dict[str, Any]:
    return {**vars(item), "moments": [_moment(each) for each in item.moments]}


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


def _in_html(data: Any) -> str:
    """Serialise as JSON that an HTML parser cannot mistake for markup."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for letter in "<>&":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


@cache
def _sentences(language: str) -> dict[str, str]:
    """Return the translation of each English sentence of the page; the others stay English."""
    source = " ".join((_script() + (_PAGE / "player.html").read_text(encoding="utf-8")).split())
    file = _LIVE_PAGE / f"{language}.json"
    shared = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    texts = ((key, text) for key, text in catalogue(language).items() if isinstance(text, str))
    return {key: text for key, text in texts if key in source} | shared


@cache
def _script() -> str:
    return join_modules("player", [_PAGE, _LIVE_PAGE])


@cache
def _template() -> Template:
    return Template((_PAGE / "player.html").read_text(encoding="utf-8"))


def _moment(item: Moment) -> dict[str, Any]:
    """Return a moment as the page's script reads it, with its tick."""
    x, y = item.place or (None, None)
    tick = round(item.time_s / TICK_S)
    return {"number": item.number, "run": item.run, "tick": tick, "x": x, "y": y, "text": item.text}


_IMPORT = re.compile(r'^import \{ ([\w, ]+) \} from "\./(\w+)\.js";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async function|function|class|const) (\w+))", re.MULTILINE)


def join_modules(entry: str, folders: Sequence[Path]) -> str:
    """Return a script that runs a JavaScript module, after all that it imports.

    Only a few forms of import and export are parsed here; a served page loads the same files as
    they are.

    Args:
        folders: that modules are searched in, one after another.

    Raises:
        ValueError: a module is in none of them, or has another form of import or export.
    """
    parts = ['"use strict";', "const modules = {};"]
    _add(entry, folders, parts, [])
    return "\n".join(parts)


def _add(name: str, folders: Sequence[Path], parts: list[str], known: list[str]) -> None:
    if name in known:
        return
    known.append(name)
    file = next((f for folder in folders if (f := folder / f"{name}.js").is_file()), None)
    if file is None:
        raise ValueError(f"no module {name}.js in {', '.join(map(str, folders))}")
    text = file.read_text(encoding="utf-8")
    for imported in _IMPORT.finditer(text):
        _add(imported[2], folders, parts, known)
    exported = ", ".join(_EXPORT.findall(text))
    text = _EXPORT.sub("", _IMPORT.sub(r"const { \1 } = modules.\2;\n", text))
    other = re.search(r"^(import|export)\b.*", text, re.MULTILINE)
    if other or "</" in text or "<!--" in text:
        raise ValueError(f"{file}: cannot be joined: {other[0] if other else 'it has HTML in it'}")
    parts.append(f"modules.{name} = (() => {{\n{text}\nreturn {{ {exported} }};\n}})();")
