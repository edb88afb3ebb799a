"""What of a message nobody has translated, or nobody could."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from grader.exercise.verdict import Verdict
from grader.message import Message
from grader.translations import catalogue
from tests import catalogues

#: Two words behind each other are somebody's sentence; a name, a type or a number is none.
_PROSE = re.compile(r"[a-z]{2,} [a-z]{2,}")


def holes(message: Message, language: str) -> list[str]:
    """The sentences of a message that a language lacks; the text itself where it is no sentence."""
    if message.text is not None:
        return [f"no sentence: {message.text}"] if message else []
    found = [] if message.is_row or not message else [message.key]
    found = [key for key in found if not all(catalogue(language).get(key) or [""])]
    within = [each for each in message.values.values() if isinstance(each, Message)]
    return found + [hole for each in within if each.text is None for hole in holes(each, language)]


def unknown(verdicts: Iterable[Verdict]) -> list[str]:
    """What of these verdicts could not be said in another language."""
    return sorted({text for verdict in verdicts for said in _texts(verdict) for text in _in(said)})


def _texts(verdict: Verdict) -> Iterator[Message]:
    yield from (verdict.title, verdict.rationale, verdict.help)
    yield from (item.note for item in verdict.evidence)
    yield from (item.text for item in verdict.expected)


def _in(message: Message) -> Iterator[str]:
    if message.text is not None:
        yield message.text
        return
    if message and not message.is_row and message.key not in catalogues.sentences():
        yield message.key
    for value in message.values.values():
        if isinstance(value, Message) and value.text is None:
            yield from _in(value)
        elif not isinstance(value, int | float) and _PROSE.search(str(value)):
            yield str(value)
