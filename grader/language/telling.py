"""Say a phrase in a language, with its numbers and dates."""

from __future__ import annotations

import re
from numbers import Real
from typing import Any

from grader.language.catalogue import ENGLISH, catalogue, knows, spoken
from grader.language.phrase import Phrase, each_text, fill, say, say_many

_POINT = re.compile(r"(?<=\d)\.(?=\d)")
_COMMA = re.compile(r"(?<=\d),(?=\d{3})")
_BEHIND_FULL_WIDTH = re.compile("(?<=[\u3002\uff0c\uff1b\uff1a\uff1f\uff01\uff09]) ")
#: Between thousands: a narrow blank where no line is broken.
_THOUSANDS = "\N{NARROW NO-BREAK SPACE}"


def tell(key: str, /, **values: Any) -> str:
    """A sentence in the language of this process's user, at once; see `say`."""
    return told(say(key, **values))


def tell_many(one: str, many: str, n: float, /, **values: Any) -> str:
    """The same about so many things; see `say_many`."""
    return told(say_many(one, many, n, **values))


def told(text: str, language: str = "") -> str:
    """A text in a language, that of this process's user if none is given.

    A text that is no phrase is looked up as it is. What the catalogue does not know stays English.
    """
    language = language or spoken()
    if language == ENGLISH:
        return str(text)
    if not isinstance(text, Phrase):
        return catalogue(language).gettext(text) if text else text
    if language in text.words:
        return text.words[language]
    if text.parts:
        return _close_up("".join(told(part, language) for part in text.parts))
    if not knows(language, text.key, text.many):
        return str(text)
    found = catalogue(language)
    try:
        n = int(text.values.get("n", 0)) if text.many else 0
        key = found.ngettext(text.key, text.many, n) if text.many else found.gettext(text.key)
        return fill(key, text.values, lambda value, form: _written(value, form, language))
    except (ValueError, TypeError, LookupError, ArithmeticError):
        return str(text)  # of a file that somebody has changed: values that are not the key's


def in_language(value: Any, language: str = "") -> Any:
    """A dataclass, list or dictionary with each of its phrases said in a language.

    A text that is no phrase stays as it is: it may be a name, a status or a student's own.
    """
    language = language or spoken()
    if language == ENGLISH:
        return value
    return each_text(
        value, lambda text, _: told(text, language) if isinstance(text, Phrase) else text
    )


def number(text: str, language: str = "") -> str:
    """A number that is written in English, as a language writes it: '4,210.5', '4 210,5'."""
    if (language or spoken()) != "fr":
        return text
    return _POINT.sub(",", _COMMA.sub(_THOUSANDS, text))


def _close_up(text: str) -> str:
    """Without blanks behind full-width punctuation: where English parts sentences, nothing is."""
    return _BEHIND_FULL_WIDTH.sub("", text)


def _written(value: Any, form: str, language: str) -> str:
    if isinstance(value, str):
        return told(value, language)
    text = format(value, form)
    return number(text, language) if isinstance(value, Real) else text
