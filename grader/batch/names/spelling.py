r"""How names are spelled: letters without accents and escapes, and the words of a text.

`Zoë` is the same in one character or two; so are letters in an escape of JSON, Python, HTML, an
address or git: `Zo\u00eb`, `Zo&euml;`, `Zo%C3%AB`.
"""

from __future__ import annotations

import html
import re
import unicodedata
from collections.abc import Iterator
from functools import lru_cache
from typing import Final

#: Letters that people spell otherwise than by leaving out the accent.
_SPELLED: Final = str.maketrans(
    {"ß": "ss", "æ": "ae", "ø": "o", "ł": "l", "đ": "d", "œ": "oe", "ı": "i"}
    | {"ẞ": "SS", "Æ": "AE", "Ø": "O", "Ł": "L", "Đ": "D", "Œ": "OE"}
)
#: One escaped character; the bytes are those of UTF-8, or one of Latin-1.
_ESCAPE: Final = re.compile(
    r"\\{1,8}u[0-9a-fA-F]{4}"
    r"|&(?:[a-zA-Z]{2,8}\d{0,2}|#\d{1,6}|#[xX][0-9a-fA-F]{1,6});"
    r"|%[2-7][0-9a-fA-F]|%[c-fC-F][0-9a-fA-F](?:%[89abAB][0-9a-fA-F]){1,3}|%[c-fC-F][0-9a-fA-F]"
    r"|\\{1,8}x[c-fC-F][0-9a-fA-F](?:\\{1,8}x[89abAB][0-9a-fA-F]){1,3}"
    r"|\\{1,8}x[c-fC-F][0-9a-fA-F]"
    r"|\\3[0-7]{2}(?:\\2[0-7]{2}){1,3}"
)
WORD: Final = re.compile(r"[^\W_]+")
PIECE: Final = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^\Wa-zA-Z\d_]+")
#: From here on scripts have no blanks between words.
_FIRST_UNSPACED: Final = "\u2e80"


def folded(text: str) -> str:
    """Return a text without accents and case."""
    return unaccented(text).casefold()


def composed(text: str) -> str:
    """Return a text as ids are compared: one character a letter, without case and outer blanks."""
    return unicodedata.normalize("NFC", text).strip().casefold()


def unescaped(text: str) -> str:
    """Return a text with the characters that its escapes stand for."""
    return _ESCAPE.sub(lambda match: _decoded(match[0]) or match[0], text)


def words_of(text: str) -> list[str]:
    """Return the words of a text, folded, in order; `ZoeNode2` is three."""
    return [
        piece.casefold() for word in WORD.findall(unaccented(text)) for piece in PIECE.findall(word)
    ]


def is_unspaced(word: str) -> bool:
    """Whether a word is of a script that has no blanks between words."""
    return any(sign >= _FIRST_UNSPACED for sign in word)


def with_places(text: str) -> tuple[str, list[int] | None]:
    """Return a text without accents and escapes, and where each of its characters was.

    The list has one number more, the length of the text; None where nothing has moved.
    """
    if text.isascii() and not _ESCAPE.search(text):
        return text, None
    found = [(letter, start) for sign, start in _signs(text) for letter in _letters(sign)]
    return "".join(letter for letter, _ in found), [*(start for _, start in found), len(text)]


def _signs(text: str) -> Iterator[tuple[str, int]]:
    """Yield the characters of a text, an escape as what it stands for, and where each begins."""
    at = 0
    for match in _ESCAPE.finditer(text):
        decoded = _decoded(match[0])
        if decoded is None:  # no character: a word like any other
            continue
        yield from zip(text[at : match.start()], range(at, match.start()), strict=True)
        yield decoded, match.start()
        at = match.end()
    yield from zip(text[at:], range(at, len(text)), strict=True)


def _decoded(escape: str) -> str | None:
    """Return the character that an escape stands for; None where it is none."""
    if escape.lstrip("\\").startswith("u"):
        return chr(int(escape[-4:], 16))
    if escape.startswith("&"):
        found = html.unescape(escape)
        return found if len(found) == 1 else None
    is_octal = escape.startswith("\\3")
    digits = re.findall(r"[0-9a-fA-F]{3}" if is_octal else r"[0-9a-fA-F]{2}", escape)
    data = bytes(int(each, 8 if is_octal else 16) for each in digits)
    try:
        return data.decode("utf-8" if len(data) > 1 or data < b"\x80" else "latin-1")
    except ValueError:
        return None


@lru_cache(maxsize=4096)
def _letters(sign: str) -> str:
    """Return a character without its accents; '' for an accent alone."""
    return unaccented(sign)


def unaccented(text: str) -> str:
    """Return a text without accents."""
    if text.isascii():
        return text
    made = unicodedata.normalize("NFKD", text.translate(_SPELLED))
    accents = {ord(sign): None for sign in set(made) if unicodedata.combining(sign)}
    return made.translate(accents) if accents else made
