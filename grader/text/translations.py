"""Messages rendered in a language: its sentences are in `languages/CODE.json`, by their keys.

A sentence that is not in a catalogue is shown in English. One about a number has a list of forms
there. `scripts/catalogues.py` collects the sentences, and says how they are translated.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any, Final

from grader.text.message import Message, fill, msg

#: Code -> the language's name for itself.
LANGUAGES: Final = {"en": "English", "fr": "français", "zh": "中文"}
ENGLISH: Final = "en"
#: The variables of POSIX for the language of messages; the first that is set counts.
_VARIABLES = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")

_POINT = re.compile(r"(?<=\d)\.(?=\d)")
_COMMA = re.compile(r"(?<=\d),(?=\d{3})")
#: Blanks after full-width punctuation: Chinese has none between sentences.
_BEHIND_FULL_WIDTH = re.compile("(?<=[\u3002\uff0c\uff1b\uff1a\uff1f\uff01\uff09]) ")
#: Between thousands: a narrow blank where no line is broken.
_THOUSANDS = "\N{NARROW NO-BREAK SPACE}"

_current = ENGLISH


def current() -> str:
    """Return the language of this process's user."""
    return _current


def use(language: str) -> None:
    """Choose the language of this process's user."""
    global _current
    if language not in LANGUAGES:
        raise ValueError(f"expected one of {', '.join(LANGUAGES)}, found {language!r}")
    _current = language


def of_environment(environment: Mapping[str, str] = os.environ) -> str:
    """Return the language of the user's locale; English where there is no catalogue for it."""
    first = next((found for name in _VARIABLES if (found := environment.get(name))), "")
    for wanted in first.split(":"):  # LANGUAGE may name several
        code = re.split("[-_.@]", wanted)[0].lower()
        if code in LANGUAGES:
            return code
    return ENGLISH


def tr(key: str, many: str = "", /, **values: Any) -> str:
    """Render a sentence in the language of this process's user; see `msg`."""
    return translate(msg(key, many, **values))


def translate(message: str | Message, language: str = "") -> str:
    """Render a message in a language, that of this process's user if none is given.

    A text stays as it is. What the catalogue lacks stays English.
    """
    language = language or current()
    if isinstance(message, str):
        return message
    if language == ENGLISH:
        return str(message)
    if language in message.words:
        return message.words[language]
    found = _translated(message, language)
    if not found and not message.is_row:
        return str(message)

    def write(value: Any, form: str) -> str:
        if isinstance(value, str | Message):
            return translate(value, language)
        return number(format(value, form), language)

    try:
        text = fill(found or message.number_key, message.values, write)
    except (ValueError, TypeError, LookupError, ArithmeticError):
        return str(message)  # of a file that somebody has changed: values that are not the key's
    return text if found else _BEHIND_FULL_WIDTH.sub("", text)


def number(text: str, language: str = "") -> str:
    """Convert a number in English notation to a language's: '4,210.5', '4 210,5'."""
    if (language or current()) != "fr":
        return text
    return _POINT.sub(",", _COMMA.sub(_THOUSANDS, text))


@cache
def catalogue(language: str) -> Mapping[str, str | list[str]]:
    """Load a catalogue: key -> sentence, or its forms for one and for more; empty for English."""
    if language == ENGLISH:
        return {}
    file = files("grader.text") / "languages" / f"{language}.json"
    sentences: dict[str, str | list[str]] = json.loads(file.read_text(encoding="utf-8"))
    return sentences


def _translated(message: Message, language: str) -> str:
    """Return the catalogue's sentence with names for its values; '' where it lacks it."""
    found = catalogue(language).get(message.key, "")
    if isinstance(found, str):
        return found
    n = message.values.get("n")
    is_one = isinstance(n, int | float) and n < 2  # French; Chinese has one form for all
    return found[0] if is_one else found[-1]
