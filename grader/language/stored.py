"""Phrases in JSON: beside the English texts, by which they are found again.

`{"It made 2.5 turns.": {"key": "It made {turns:.1f} turns.", "values": {"turns": 2.5}}}`
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar, cast

from grader.language.phrase import Phrase, each_text

#: Phrases in phrases: none that a check makes is deeper.
_DEEPEST = 12
#: Phrases, texts and numbers in all: a usual result has some hundred.
_MOST = 20_000
#: Fields that hold sentences. Others hold names, which stay as they are in every language.
SENTENCES = frozenset(
    ("title", "rationale", "help", "note", "text", "curve", "cause", "flags", "message", "notes")
)
_KEYS = frozenset(("text", "key", "many", "words", "values", "parts"))
T = TypeVar("T")


def phrases_in(value: Any) -> dict[str, dict[str, Any]]:
    """All phrases of a dataclass, list or dictionary, by their English texts."""
    found: dict[str, dict[str, Any]] = {}
    _collect(value, found)
    return dict(sorted(found.items()))


def restored(value: T, phrases: Mapping[str, Any]) -> T:
    """The same value with phrases in place of the texts that `phrases_in` has found.

    Raises:
        ValueError: what is told of one is no phrase.
    """
    if not phrases:
        return value
    try:
        if not isinstance(phrases, Mapping):
            raise ValueError("expected sentences with what they are made of")
        if _size(phrases) > _MOST:
            raise ValueError(f"expected at most {_MOST} values in all")
        made = {text: phrase(text, data) for text, data in phrases.items()}
    except ValueError as error:
        raise ValueError(f"is damaged: its phrases: {error}") from None
    return cast(T, each_text(value, lambda text, field: _found(text, field, made)))


def _found(text: str, field: str, made: Mapping[str, Phrase]) -> str:
    return made.get(text, text) if not field or field in SENTENCES else text


def phrase(text: str, data: Any, depth: int = 0) -> Phrase:
    """A phrase as JSON tells of it.

    Raises:
        ValueError: it is none.
    """
    if not isinstance(data, dict) or depth > _DEEPEST:
        raise ValueError("expected a phrase: a key with values, or parts")
    if ("key" in data) == ("parts" in data) or data.keys() - _KEYS:
        raise ValueError(f"expected a phrase: a key with values, or parts; found {data!r:.80}")
    listed, named = data.get("parts", []), data.get("values", {})
    if not isinstance(listed, list) or not isinstance(named, dict):
        raise ValueError("expected a list of parts, or values by their names")
    parts = [_part(part, depth) for part in listed]
    values = {name: _value(value, depth) for name, value in named.items()}
    key, many = data.get("key", ""), data.get("many", "")
    if not isinstance(key, str) or not isinstance(many, str):
        raise ValueError("expected texts as keys of a phrase")
    words = data.get("words", {})
    if not isinstance(words, dict) or not all(isinstance(word, str) for word in words.values()):
        raise ValueError("expected texts as the words of a phrase, by languages")
    return Phrase(text, key, values, many, parts, words)


def _part(data: Any, depth: int) -> str:
    value = _value(data, depth)
    if not isinstance(value, str):
        raise ValueError("expected a text as a part of a phrase")
    return value


def _value(data: Any, depth: int) -> Any:
    if isinstance(data, dict):
        text = data.get("text")
        if not isinstance(text, str):
            raise ValueError("expected the text of a phrase within a phrase")
        return phrase(text, data, depth + 1)
    if isinstance(data, str | int | float):
        return data
    raise ValueError(f"expected a text or a number in a phrase, found {data!r}")


def _collect(value: Any, found: dict[str, dict[str, Any]]) -> None:
    if isinstance(value, Phrase):
        found[str(value)] = _data(value)
    elif isinstance(value, Mapping):
        _collect(list(value.values()), found)
    elif isinstance(value, list | tuple):
        for item in value:
            _collect(item, found)
    elif is_dataclass(value) and not isinstance(value, type):
        _collect([getattr(value, field.name) for field in fields(value)], found)


def _data(value: Phrase) -> dict[str, Any]:
    if value.parts:
        return {"parts": [_inner(part) for part in value.parts]}
    data: dict[str, Any] = {"key": value.key}
    if value.words:
        data["words"] = dict(value.words)
    if value.many:
        data["many"] = value.many
    if value.values:
        data["values"] = {name: _inner(item) for name, item in value.values.items()}
    return data


def _inner(value: Any) -> Any:
    if isinstance(value, Phrase):
        return {"text": str(value), **_data(value)}
    if isinstance(value, str):
        return str(value)
    value = value.item() if hasattr(value, "item") else value  # numpy's numbers are none of JSON's
    return value if isinstance(value, int | float) and math.isfinite(value) else str(value)


def _size(phrases: Mapping[str, Any]) -> int:
    """How many values there are in all, as far as that matters."""
    count, waiting = 0, [phrases]
    while waiting and count <= _MOST:
        value: Any = waiting.pop()
        count += 1
        if isinstance(value, Mapping):
            waiting += value.values()
        elif isinstance(value, list):
            waiting += value
    return count
