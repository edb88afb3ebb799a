"""Sentences for people: a key and values, rendered in the reader's language at the edges only.

A `Message` is no `str`: wherever one would be lost in a text before its time, mypy or `format`
says so. Between processes and in files it is JSON.
"""

from __future__ import annotations

import math
import re
import reprlib
import string
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Union

Value = Union[str, int, float, "Message"]
#: What is shown as it is, or rendered.
Text = Union[str, "Message"]
#: How a value may be written: a name, and a format that cannot ask for a page of blanks.
_NAME = re.compile(r"[a-z_][a-z0-9_]*", re.IGNORECASE)
_FORMAT = re.compile(r"[+,]?[0-9]{0,2},?(\.[0-9]{1,2})?[a-zA-Z%]?")
#: Messages in messages: none that a check makes is deeper.
_DEEPEST = 12
#: Of a message that is read, as it is in English [characters].
_LONGEST = 1_000_000
#: The key of a text that is the same in every language, and the name of its value.
_TEXT = "text"
#: The key of a row of parts.
_ROW = re.compile(r"(\{p\d+\})+")
_KEY_OF_TEXT = f"{{{_TEXT}}}"


@dataclass(frozen=True)
class Message:
    """A sentence that can be rendered in any language.

    Attributes:
        key: the English sentence with names for its values, `It made {turns:.1f} turns.`; what
            translators find in the catalogues.
        values: what the names stand for.
        many: the key for more than one, where the value `n` decides; '' for none.
        words: language -> the whole sentence there, where its author gives it with the key; it
            comes before any catalogue.
    """

    key: str = ""
    values: Mapping[str, Value] = field(default_factory=dict)
    many: str = ""
    words: Mapping[str, str] = field(default_factory=dict)

    def __bool__(self) -> bool:
        """Whether it says anything."""
        return bool(self.key) and self != _EMPTY_TEXT

    def __hash__(self) -> int:
        """Equal messages have equal hashes."""
        return hash((self.key, tuple(sorted(self.values.items(), key=lambda item: item[0]))))

    def __str__(self) -> str:
        """The sentence in English."""
        if "en" in self.words:
            return self.words["en"]
        return fill(self.number_key, self.values, _in_english)

    def __format__(self, spec: str) -> str:
        """Refused: it would be English for ever.

        Raises:
            TypeError: always.
        """
        raise TypeError(f"a message within a text is lost; render or join it: {self.key!r}")

    def __html__(self) -> str:
        """Refused, as in a text: a template renders it.

        Raises:
            TypeError: always.
        """
        raise TypeError(f"a message in a page is lost; render it: {self.key!r}")

    @property
    def is_row(self) -> bool:
        """Whether it is parts one behind the other, which have their own sentences."""
        return bool(_ROW.fullmatch(self.key))

    @property
    def number_key(self) -> str:
        """The key for its number in English."""
        return self.many if self.many and self.values.get("n") != 1 else self.key

    @property
    def text(self) -> str | None:
        """The text that it is in every language; None for a sentence."""
        value = self.values.get(_TEXT)
        return value if self.key == _KEY_OF_TEXT and isinstance(value, str) else None

    def given(self, **values: Any) -> Message:
        """The message with values for some of its names."""
        made = {name: _value(value) for name, value in values.items()}
        return Message(self.key, {**self.values, **made}, self.many, self.words)

    def map_texts(self, change: Callable[[str], str]) -> Message:
        """The message with each text among its values, and theirs, changed."""
        values = {name: _changed(value, change) for name, value in self.values.items()}
        return Message(self.key, values, self.many, self.words)

    def serialise(self) -> Any:
        """The message as JSON: a text as such, else its key, and what else is not empty."""
        if not self or self.text is not None:
            return self.text or ""
        values = {name: _serialised(value) for name, value in self.values.items()}
        rest = {"values": values, "many": self.many, "words": dict(self.words)}
        return {"key": self.key, **{name: part for name, part in rest.items() if part}}

    @classmethod
    def parse(
        cls, data: object, text: Callable[[Any], str] | None = None, depth: int = 0
    ) -> Message:
        """Return the message that JSON means.

        Args:
            text: holds a text of it against bounds, and returns what is taken of it.

        Raises:
            ValueError: it means none.
        """
        take = text or _a_text
        if isinstance(data, str):
            return plain_text(take(data))
        if not isinstance(data, dict) or "key" not in data or depth > _DEEPEST:
            raise ValueError(f"expected a message: a key with values; found {reprlib.repr(data)}")
        if unknown := data.keys() - {"key", "values", "many", "words"}:
            raise ValueError(f"expected a message: a key with values; found {sorted(unknown)}")

        def value(found: object) -> Value:
            if isinstance(found, dict):
                return cls.parse(found, text, depth + 1)
            if type(found) is int or type(found) is float:
                return found
            return take(found)

        values, words = data.get("values", {}), data.get("words", {})
        if not isinstance(values, dict) or not isinstance(words, dict):
            raise ValueError("expected the values of a message by their names")
        made = cls(
            take(data["key"]),
            {take(name): value(found) for name, found in values.items()},
            take(data.get("many", "")),
            {take(language): take(word) for language, word in words.items()},
        )
        try:
            fill(made.number_key, made.values, _in_english, _LONGEST)
        except (ArithmeticError, LookupError, TypeError, ValueError) as error:
            raise ValueError(f"expected values that fit a message's key: {error}") from None
        return made


def msg(key: str, /, **values: Any) -> Message:
    """A sentence: `msg("It made {turns:.1f} turns.", turns=2.5)`.

    Numbers are written as the reader's language writes them; what is code is given as a text.
    """
    return Message(key, {name: _value(value) for name, value in values.items()})


def msg_many(one: str, many: str, n: float, /, **values: Any) -> Message:
    """A sentence about `{n}` things: `msg_many("{n} pin", "{n} pins", 3)`."""
    return Message(one, {name: _value(v) for name, v in {"n": n, **values}.items()}, many)


def in_context(english: str, context: str) -> Message:
    """A word that English has for several things: `in_context("left", "of a wall")`.

    Translators find it by both, as 'left (of a wall)'.
    """
    return Message(f"{english} ({context})", words={"en": english})


def plain_text(text: str) -> Message:
    """A text that is the same in every language: a name, code, what a program printed."""
    return Message(_KEY_OF_TEXT, {_TEXT: text}) if text else NOTHING


def as_message(text: str | Message) -> Message:
    """A message, also of a text that nobody translates."""
    return text if isinstance(text, Message) else plain_text(text)


def authored(text: str, words: Mapping[str, str] | None = None) -> Message:
    """What an exercise's author has written, with its words in other languages, if there are some.

    Args:
        words: language -> text. In a language that is left out, a catalogue may know the text.
    """
    return Message(text.replace("{", "{{").replace("}", "}}"), words=dict(words or {}))


def joined(parts: Iterable[str | Message], between: str | Message = "") -> Message:
    """Texts and messages one behind the other, with the same between each two."""
    row: list[str | Message] = []
    for part in parts:
        row += [between] if row and between else []
        if isinstance(part, Message) and part.is_row:
            row += [each for each in part.values.values() if isinstance(each, str | Message)]
        else:
            row.append(part)
    if len(row) == 1:
        return as_message(row[0])
    values = {f"p{number}": _value(part) for number, part in enumerate(row) if part}
    return Message("".join(f"{{{name}}}" for name in values), values)


def listed(items: Iterable[str | Message]) -> Message:
    """Some things in one row: 'a', 'a and b', 'a, b and c'."""
    *those, last = list(items) or [NOTHING]
    if not those:
        return as_message(last)
    return msg("{those} and {last}", those=joined(those, ", "), last=last)


def chained(items: Iterable[str | Message]) -> Message:
    """Some things with a word between each two: 'a and b and c'."""
    return joined(items, msg(" and "))


def reason(error: Exception) -> Message:
    """What an exception says."""
    is_message = len(error.args) == 1 and isinstance(error.args[0], Message)
    return error.args[0] if is_message else plain_text(str(error))


def fill(
    key: str,
    values: Mapping[str, Any],
    write: Callable[[Any, str], str] = format,
    most: float = math.inf,
) -> str:
    """A key with its values in their places.

    `{clause!u}` is a clause with which a sentence begins: with a capital, where it is no file's
    name.

    Args:
        write: makes a text of a value and its format.
        most: characters there may be; a value may stand in a key many times.

    Raises:
        ValueError: it names what is not there, is no sentence with values, or becomes too long.
    """
    made, length = [], 0
    for before, name, form, conversion in string.Formatter().parse(key):
        made.append(before)
        if name is None:
            continue
        if name not in values or not _NAME.fullmatch(name) or not _FORMAT.fullmatch(form or ""):
            raise ValueError(f"no value for {{{name}:{form}}} in {key!r}")
        value = values[name]
        text = write(value, form or "")
        if conversion == "r" and isinstance(value, str | Message):
            text = repr(text)
        made.append(_as_beginning(text) if conversion == "u" else text)
        if (length := length + len(text)) > most:
            raise ValueError(f"more than {most} characters")
    return "".join(made)


def _in_english(value: Any, form: str) -> str:
    return str(value) if isinstance(value, str | Message) else format(value, form)


def _as_beginning(clause: str) -> str:
    return clause if "." in clause.partition(" ")[0] else clause[:1].upper() + clause[1:]


def _value(value: Any) -> Value:
    """A value as JSON has it: numpy's numbers, paths and what is not finite are none of JSON's."""
    value = value.item() if hasattr(value, "item") else value
    if isinstance(value, Message) and (not value or value.text is not None):
        return value.text or ""
    if isinstance(value, str | Message) or type(value) is int:
        return value
    return value if type(value) is float and math.isfinite(value) else str(value)


def _changed(value: Value, change: Callable[[str], str]) -> Value:
    if isinstance(value, Message):
        return value.map_texts(change)
    return change(value) if isinstance(value, str) else value


def _serialised(value: Value) -> Any:
    return value.serialise() if isinstance(value, Message) else value


def _a_text(found: object) -> str:
    if not isinstance(found, str):
        raise ValueError(f"expected a text or a number in a message, found {reprlib.repr(found)}")
    return found


#: Says nothing, where a sentence could stand.
NOTHING = Message()
_EMPTY_TEXT = Message(_KEY_OF_TEXT, {_TEXT: ""})
