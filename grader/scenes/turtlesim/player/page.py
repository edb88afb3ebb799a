"""The page that plays runs: one file, without network, whose only script is our own."""

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
from grader.scenes.turtlesim.player.film import film
from grader.scenes.turtlesim.trace import SPRITE, TurtleTrace
from grader.translations import catalogue, current, tr
from turtlesim_py.world import picture
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
        "language": current(),
        "sentences": _sentences(current()),
        "tick_s": TICK_S,
        "sprites": {SPRITE: base64.b64encode(picture.sprite(SPRITE).tobytes()).decode()},
        "sprite": SPRITE,
        "title": playback.title,
        "runs": [_run(take) for take in playback.runs],
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


def _run(take: PlayedRun) -> dict[str, Any]:
    made = film(TurtleTrace.of(take.trace), take.start)
    return {
        "title": take.title,
        "outcome": take.outcome,
        **made,
        **runs.with_lines(made["calls"], take.sent),
    }


def _judged(item: JudgedCheck) -> dict[str, Any]:
    return {**vars(item), "moments": [_moment(each) for each in item.moments]}


def _other(playback: Playback, other: Playback) -> dict[str, Any]:
    traces = zip(playback.runs, other.runs, strict=False)
    return {
        "title": other.title,
        "summary": other.summary,
        "runs": [_run(take) for take in other.runs],
        "differences": [
            runs.first_difference(TurtleTrace.of(one.trace), TurtleTrace.of(two.trace))
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
    source = " ".join((_script() + (_PAGE / "player.html").read_text(encoding="utf-8")).split())
    file = _LIVE_PAGE / f"{language}.json"
    shared = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    own = ((key, said) for key, said in catalogue(language).items() if isinstance(said, str))
    return {key: said for key, said in own if key in source} | shared


@cache
def _script() -> str:
    return join_modules("player", [_PAGE, _LIVE_PAGE])


@cache
def _template() -> Template:
    return Template((_PAGE / "player.html").read_text(encoding="utf-8"))


def _moment(item: Moment) -> dict[str, Any]:
    """As the page's script reads it, which counts ticks."""
    x, y = item.place or (None, None)
    tick = round(item.time_s / TICK_S)
    return {"number": item.number, "run": item.run, "tick": tick, "x": x, "y": y, "text": item.text}


_IMPORT = re.compile(r'^import \{ ([\w, ]+) \} from "\./(\w+)\.js";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async function|function|class|const) (\w+))", re.MULTILINE)


def join_modules(entry: str, folders: Sequence[Path]) -> str:
    """A script that runs the JavaScript module of this name, after all that it imports.

    Modules are written with the few forms of import and export that are read here; a page that is
    served loads the same files as they are.

    Args:
        folders: where modules are looked for, one after another.

    Raises:
        ValueError: a module is in none of them, or written otherwise.
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
