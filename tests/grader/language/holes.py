"""What of a text nobody has translated."""

from __future__ import annotations

from grader.language.catalogue import knows
from grader.language.phrase import Phrase


def holes(text: str, language: str) -> list[str]:
    """The sentences of a text that a language lacks; the text itself where it is no phrase."""
    if not isinstance(text, Phrase):
        return [f"no phrase: {text}"] if text else []
    inner = [each for each in (*text.parts, *text.values.values()) if isinstance(each, Phrase)]
    found = [text.key] if text.key and not knows(language, text.key, text.many) else []
    return found + [hole for each in inner for hole in holes(each, language)]
