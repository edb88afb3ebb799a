"""Cleans text for display: a submission may print, raise and name anything."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from difflib import SequenceMatcher, get_close_matches
from functools import cache
from itertools import islice
from typing import Any

from grader.text.message import Message, Text, joined, msg, plain_text

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
#: Letters that people spell otherwise than by leaving out the accent.
_SPELLED = str.maketrans(
    {"ß": "ss", "æ": "ae", "ø": "o", "ł": "l", "đ": "d", "œ": "oe", "ı": "i"}
    | {"ẞ": "SS", "Æ": "AE", "Ø": "O", "Ł": "L", "Đ": "D", "Œ": "OE"}
)
#: So alike two names have to be, 0 to 1, for one to be a misspelling of the other.
_ALIKE = 0.85
#: Words of a name that are shorter are no misspellings of each other: last_x, last_y.
_SHORT = 3
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


def plain(text: str) -> str:
    r"""Remove colours, control characters and commands for a runner of CI.

    `\n` is the only line break of the result.
    """
    text = without_controls(_LINE_BREAKS.sub("\n", _ESCAPE_SEQUENCES.sub("", text)), keep="\t\n")
    return _COMMANDS.sub(lambda match: f"{match[1]}: :" if match[0].endswith(":") else "# #", text)


def for_terminal(text: str) -> str:
    """Clean a text for printing, however it is wrapped; do not parse it for colours afterwards."""
    return _COMMANDS_WRAPPED.sub(lambda match: " ".join(match[0]), plain(text))


def plain_all(value: Any, limit: int = 1_000_000) -> Any:
    """Make each text of a value plain, which is JSON or a dataclass.

    Args:
        limit: texts are cut to this many characters first.
    """
    if isinstance(value, str):
        return plain(clip(value, limit))
    if isinstance(value, Message):
        return value.map_texts(lambda text: plain(clip(text, limit)))
    if isinstance(value, Mapping):
        return {plain(clip(key, limit)): plain_all(item, limit) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(plain_all(item, limit) for item in value)
    if is_dataclass(value) and not isinstance(value, type):
        texts = {
            field.name: plain_all(getattr(value, field.name), limit) for field in fields(value)
        }
        return replace(value, **texts)
    return value


def unaccented(text: str) -> str:
    """Return a text with its letters without accents, in their case: `Zoe` for `Zoë`."""
    if text.isascii():
        return text
    made = unicodedata.normalize("NFKD", text.translate(_SPELLED))
    return "".join(sign for sign in made if not unicodedata.combining(sign))


def one_line(text: str) -> str:
    """Replace every run of white space by one space."""
    return " ".join(text.split())


def in_one_line(message: Message) -> Message:
    """Replace every run of white space in a message by one space, also around an empty value."""
    made = message.map_texts(lambda text: _BLANKS.sub(" ", text))
    shown = one_line(str(made))
    return made if str(made) == shown else plain_text(shown)


def clip(text: str, limit: int) -> str:
    """Cut a text to `limit` characters."""
    return text if len(text) <= limit else text[: limit - 1] + "…"


def clip_inside(text: str, limit: int) -> str:
    """Cut the middle out of a text of one line that has more than `limit` characters."""
    if len(text) <= limit:
        return text
    half = (limit - 1) // 2
    return f"{text[: limit - 1 - half]}…{text[-half:]}"


def clip_middle(text: str, limit: int) -> str:
    """Cut the middle out of a text that has more than about `limit` characters, with a note."""
    if len(text) <= limit:
        return text
    half = limit // 2
    left_out = len(text) - 2 * half
    return f"{text[:half]}\n[… {left_out} characters left out …]\n{text[-half:]}"


def shown(text: object, limit: int = 300) -> str:
    """Return a stranger's text or name as a sentence has it: one line of `limit` characters."""
    return clip_inside(one_line(plain(clip_inside(str(text), 4 * limit))), limit)


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


def misspelt(name: str, other: str) -> bool:
    """Whether one name is a misspelling of the other."""
    one, two = name.lower().split("_"), other.lower().split("_")
    if "".join(one) == "".join(two):
        return True
    if any(c.isdigit() for c in name + other):
        return False
    if len(one) == len(two):
        others = [pair for pair in zip(one, two, strict=True) if pair[0] != pair[1]]
        if any(min(map(len, pair)) < _SHORT for pair in others):
            return False
    alike = SequenceMatcher(None, name, other)  # the first two take little time, and are as sure
    return min(alike.real_quick_ratio(), alike.quick_ratio()) >= _ALIKE and alike.ratio() >= _ALIKE


def place(x: float, y: float) -> Message:
    """Format a place in the window [m]: '(5.54, 7.20)'."""
    known = math.isfinite(x) and math.isfinite(y)
    return msg("({x:.2f}, {y:.2f})", x=x, y=y) if known else msg("an unknown place")
