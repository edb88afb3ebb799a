"""Cleans text for display: a submission may print, raise and name anything."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from difflib import get_close_matches
from functools import cache
from itertools import islice
from typing import Any, TypeVar

from grader.text.message import Message, Text, joined, msg

Cleaned = TypeVar("Cleaned")
_ESCAPE_SEQUENCES = re.compile(
    r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)?|[@-Z\\^_])"
)
_BLANKS = re.compile(r"\s+")
_LINE_BREAKS = re.compile(r"\r\n?|[\u2028\u2029]")
#: Control characters (XML 1.0 has none of them), breaks of a line or paragraph, halves of
#: characters, non-characters, and the marks that turn the direction of the text behind them.
_CONTROLS = r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff\ufffe\uffff\u202a-\u202e\u2066-\u2069]"
_REPLACEMENT = "\ufffd"

#: Commands that the runners of GitHub and Azure obey in the output of a step, in any case of
#: letters: words at the start of a line after `::`, and words anywhere after `##[` or `##vso[`. In
#: a narrow terminal any word may come to the start of a line.
_COMMANDS = re.compile(r"^([^\S\n]*)::|##(?=\[|vso\[)", re.MULTILINE | re.IGNORECASE)
_COMMANDS_WRAPPED = re.compile(r"::(?=[a-z-]+[ :])|##(?=\[|vso\[)", re.IGNORECASE)
#: A text within another value has so many characters at most.
_MOST_WITHIN = 1_000_000
#: A name is compared with so many others of this length at most: the time grows with its cube.
_MOST_NAMES, _LONGEST_NAME = 200, 100


def without_controls(text: str, sign: str = _REPLACEMENT, keep: str = "") -> str:
    """Replace by `sign` each character that breaks a terminal, a log or XML.

    Args:
        keep: those of them that stay.
    """
    return _controls_but(keep).sub(lambda _: sign, text)


@cache
def _controls_but(keep: str) -> re.Pattern[str]:
    return re.compile(f"(?![{re.escape(keep)}]){_CONTROLS}") if keep else re.compile(_CONTROLS)


def plain(value: Cleaned, limit: int | None = None) -> Cleaned:
    r"""Remove colours, control characters and commands for a runner of CI.

    `\n` is the only line break of the result.

    Args:
        value: a text, a message, or JSON or a dataclass with texts.
        limit: texts are cut to this many characters first; a text alone is not without it, and
            those within other values to a million.
    """
    made: Any = value
    if isinstance(value, str):
        cut = value if limit is None else clip(value, limit)
        text = _LINE_BREAKS.sub("\n", _ESCAPE_SEQUENCES.sub("", cut))
        return _COMMANDS.sub(_spaced, without_controls(text, keep="\t\n"))  # type: ignore[return-value]
    limit = _MOST_WITHIN if limit is None else limit
    if isinstance(value, Message):
        made = value.map_texts(lambda text: plain(text, limit))
    elif isinstance(value, Mapping):
        made = {plain(key, limit): plain(item, limit) for key, item in value.items()}
    elif isinstance(value, list | tuple):
        made = type(value)(plain(item, limit) for item in value)
    elif is_dataclass(value) and not isinstance(value, type):
        parts = {each.name: plain(getattr(value, each.name), limit) for each in fields(value)}
        made = replace(value, **parts)
    return made  # type: ignore[no-any-return]


def _spaced(command: re.Match[str]) -> str:
    return f"{command[1]}: :" if command[0].endswith(":") else "# #"


def for_terminal(text: str) -> str:
    """Clean a text for printing, however it is wrapped; do not parse it for colours afterwards."""
    return _COMMANDS_WRAPPED.sub(lambda match: " ".join(match[0]), plain(text))


def one_line(text: Cleaned) -> Cleaned:
    """Replace every run of white space by one space; in a message also around an empty value."""
    made: Any = text
    if isinstance(text, Message):
        made = text.map_texts(lambda each: _BLANKS.sub(" ", each))
        line = one_line(str(made))
        return made if str(made) == line else Message.of(line)  # type: ignore[return-value]
    return " ".join(made.split())  # type: ignore[return-value]


def clip(text: str, limit: int, *, keeps_end: bool = False) -> str:
    """Cut a text to `limit` characters.

    Args:
        keeps_end: cut the middle out, of about so many characters, with a note.
    """
    if len(text) <= limit:
        return text
    if not keeps_end:
        return text[: limit - 1] + "…"
    half = limit // 2
    left_out = len(text) - 2 * half
    return f"{text[:half]}\n[… {left_out} characters left out …]\n{text[-half:]}"


def _clip_inside(text: str, limit: int) -> str:
    """Cut the middle out of a text of one line that has more than `limit` characters."""
    if len(text) <= limit:
        return text
    half = (limit - 1) // 2
    return f"{text[: limit - 1 - half]}…{text[-half:]}"


def shown(text: object, limit: int = 300) -> str:
    """Return a stranger's text or name as a sentence has it: one line of `limit` characters."""
    return _clip_inside(one_line(plain(_clip_inside(str(text), 4 * limit))), limit)


def listed(names: Iterable[Text], limit: int = 10) -> Message:
    """Join names of strangers as in "a, b, c and 4 more"."""
    every = list(names)
    first = joined([shown(n) if isinstance(n, str) else n for n in every[:limit]], ", ")
    if len(every) <= limit:
        return first
    return msg("{names} and {n:,} more", names=first, n=len(every) - limit)


def nearest(wanted: str, names: Iterable[str], most: int = 3) -> list[str]:
    """Pick the names that `wanted` may have meant: a typing error or another case; best first."""
    if len(wanted) > _LONGEST_NAME:
        return []
    some = islice((name for name in names if len(name) <= _LONGEST_NAME), _MOST_NAMES)
    by_folded = {name.casefold(): name for name in reversed(list(some))}
    return [by_folded[name] for name in get_close_matches(wanted.casefold(), by_folded, most)]


def points(value: float) -> str:
    """Format points for people: two decimals at most, 12.5, 30."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def number(value: float) -> float | int:
    """Round a number for JSON: two decimals at most, and an int where it is whole."""
    rounded = round(value, 2)
    return int(rounded) if float(rounded).is_integer() else rounded


def place(x: float, y: float) -> Message:
    """Format a place in the window [m]: '(5.54, 7.20)'."""
    known = math.isfinite(x) and math.isfinite(y)
    return msg("({x:.2f}, {y:.2f})", x=x, y=y) if known else msg("an unknown place")
