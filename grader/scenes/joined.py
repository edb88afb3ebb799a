"""Pages that are one file: their modules joined into one script, which alone may run in them."""

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
from typing import Any, Final

import turtlesim_py
from grader.recording.playback import JudgedCheck, Moment
from grader.translations import catalogue, current

#: Modules that several pages share: of the page that plays runs, and of the live page.
PLAYER: Final = Path(__file__).parent / "turtlesim" / "player" / "page"
LIVE_PAGE: Final = Path(turtlesim_py.__file__).parent / "live" / "page"


def fill(
    page: Template,
    entry: str,
    folders: Sequence[Path],
    data: dict[str, Any],
    *,
    style: str,
    **texts: str,
) -> str:
    """Return a page with its script, its data and its texts.

    Args:
        entry: the module that the script begins with.
        folders: that modules are searched in, one after another.
        data: for the script; gets the page's `sentences`.
    """
    script = join_modules(entry, folders)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    data = {**data, "sentences": _sentences(f"{script} {page.template}", current())}
    return page.substitute(
        digest=digest,
        lang=current(),
        style=style,
        data=_in_html(data),
        script=script,
        **{name: escape(text) for name, text in texts.items()},
    )


def judged(item: JudgedCheck, tick_s: float) -> dict[str, Any]:
    """Return a verdict as the script reads it."""
    return {**vars(item), "moments": [_moment(each, tick_s) for each in item.moments]}


def _moment(item: Moment, tick_s: float) -> dict[str, Any]:
    x, y = item.place or (None, None)
    tick = round(item.time_s / tick_s)
    return {"number": item.number, "run": item.run, "tick": tick, "x": x, "y": y, "text": item.text}


def _in_html(data: Any) -> str:
    """Serialise as JSON that an HTML parser cannot mistake for markup."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for letter in "<>&":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


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
