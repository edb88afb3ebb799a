"""Pages that play runs: what they show, and one file each.

The modules of a page are one script, which alone may run there.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from pathlib import Path
from string import Template
from typing import Any, Final

import turtlesim_py
from grader.recording.observations import End
from grader.recording.subject import Start, Trace
from grader.text.translations import catalogue, current, tr

#: Modules that several pages share: of the page that plays runs, and of the live page.
PLAYER: Final = Path(__file__).parent / "turtlesim" / "page"
LIVE_PAGE: Final = Path(turtlesim_py.__file__).parent / "live" / "page"


@dataclass(frozen=True)
class JudgedCheck:
    """The verdict of a check, as shown.

    Attributes:
        title: what it asks for.
        status: `passed`, `failed` or `not_judged`; on a live page, `waiting` before that.
        word: the same for people, with its points.
        rationale, help: what was found, and a hint.
        moments: where to see it, each as the script reads it: `number`, of those of all checks,
            `run`, 0 for the nominal one, `tick`, `x` and `y` [m], None for nowhere, and `text`.
    """

    title: str
    status: str
    word: str
    rationale: str
    help: str
    moments: tuple[Mapping[str, Any], ...]


@dataclass(frozen=True)
class PlayedRun:
    """A run.

    Attributes:
        title: 'Nominal run', 'Varied run 1'.
        outcome: how it ended, in a word or two.
        sent: what has sent, one for a name at most, as the submission's process has reported.
        start: where it began; None for the usual place.
    """

    title: str
    outcome: str
    trace: Trace
    start: Start | None = None
    sent: tuple[End, ...] = ()


@dataclass(frozen=True)
class Playback:
    """The runs that are played, and their judgement.

    Attributes:
        title: name and score, in a line.
        summary: the diagnosis, in a line; '' where nothing was judged.
        runs: the nominal one, and the varied ones.
        judged: the verdicts, in the order of the checks.
        other: to compare with.
    """

    title: str
    summary: str
    runs: tuple[PlayedRun, ...]
    judged: tuple[JudgedCheck, ...] = ()
    other: Playback | None = None


def render_page(
    playback: Playback,
    page: Path,
    data: dict[str, Any],
    folders: Sequence[Path] = (),
    styles: Sequence[Path] = (),
) -> str:
    """Return the page that plays runs, in one file.

    Args:
        page: its main part; the module of the same name is the one that runs.
        data: of this scene, for the script; `tick_s` is the length of a tick [s].
        folders: that modules are searched in, one after another, before those that pages share.
        styles: besides the one that they share.
    """
    script = join_modules(page.stem, [*folders, PLAYER, LIVE_PAGE])
    html = whole_html(page)
    data = {
        "language": current(),
        "title": playback.title,
        **data,
        "judged": [vars(check) for check in playback.judged],
        "sentences": _sentences(f"{script} {html}", current()),
    }
    style = (each.read_text(encoding="utf-8") for each in (PLAYER / "player.css", *styles))
    return Template(html).substitute(
        digest=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
        lang=current(),
        style="".join(style),
        data=_in_html(data),
        script=script,
        title=escape(playback.title),
        summary=escape(playback.summary),
        noscript=escape(tr("This page needs JavaScript. report.html, beside it, does not.")),
    )


def whole_html(page: Path) -> str:
    """Return the template of a page: its main part, with those that all pages have."""
    frame, transport, judged, main = (
        path.read_text(encoding="utf-8")
        for path in (*(PLAYER / f"{name}.html" for name in ("frame", "transport", "judged")), page)
    )
    return frame.replace("$main", main).replace("$transport", transport).replace("$judged", judged)


def _in_html(data: Any) -> str:
    """Serialise as JSON that an HTML parser cannot mistake for markup."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return text.translate({ord(sign): f"\\u{ord(sign):04x}" for sign in "<>&"})


@cache
def _sentences(page: str, language: str) -> dict[str, str]:
    """Return the translation of each English sentence of a page; the others stay English."""
    source = " ".join(page.split())
    file = LIVE_PAGE / f"{language}.json"
    shared = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    texts = ((key, text) for key, text in catalogue(language).items() if isinstance(text, str))
    return {key: text for key, text in texts if key in source} | shared


_IMPORT = re.compile(r'^import \{ ([\w, ]+) \} from "\./(\w+)\.js";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async function|function|class|const) (\w+))", re.MULTILINE)


def join_modules(entry: str, folders: Sequence[Path]) -> str:
    """Return a script that runs a JavaScript module, after all that it imports.

    Only a few forms of import and export are parsed here; a served page loads the same files as
    they are.

    Args:
        folders: that modules are searched in, one after another.
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
