"""Sentences for people: a key and values, rendered in the reader's language at the edges only.

A `Message` is no `str`: mypy or `format` reports where one would be rendered into a text too early.
Between processes and in files it is JSON.
"""

from __future__ import annotations

import math
import re
import reprlib
import string
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Union

Value = Union[str, int, float, "Message"]
#: A text that is shown as it is, or a message that is rendered.
Text = Union[str, "Message"]
#: How a value may be written: a name, and a format that cannot ask for a page of blanks.
_NAME = re.compile(r"[a-z_][a-z0-9_]*", re.IGNORECASE)
_FORMAT = re.compile(r"[+,]?[0-9]{0,2},?(\.[0-9]{1,2})?[a-zA-Z%]?")
#: The deepest nesting of messages: none that a check makes is deeper.
_DEEPEST = 12
#: The longest message that is parsed, in English [characters].
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
        key: the English sentence with names for its values, `It made {turns:.1f} turns.`; the key
            of the catalogues.
        values: the values of the names.
        many: the key for more than one, where the value `n` decides; '' for none.
        words: language -> the whole sentence there, where its author gives it with the key; it
            comes before any catalogue.
    """

    key: str = ""
    values: Mapping[str, Value] = field(default_factory=dict)
    many: str = ""
    words: Mapping[str, str] = field(default_factory=dict)

    def __bool__(self) -> bool:
        """Whether it is not empty."""
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

    @classmethod
    def of(cls, what: str | Message | Exception) -> Message:
        """Return a message as it is, that of an exception, or one of a text.

        The text is never translated: a name, code, a program's output.
        """
        if isinstance(what, Exception):
            is_message = len(what.args) == 1 and isinstance(what.args[0], Message)
            what = what.args[0] if is_message else str(what)
        if isinstance(what, Message):
            return what
        return cls(_KEY_OF_TEXT, {_TEXT: what}) if what else NOTHING

    @property
    def is_row(self) -> bool:
        """Whether it is a row of parts, each with a sentence of its own."""
        return bool(_ROW.fullmatch(self.key))

    @property
    def number_key(self) -> str:
        """The key for its number in English."""
        return self.many if self.many and self.values.get("n") != 1 else self.key

    @property
    def text(self) -> str | None:
        """Its text, if that is the same in every language; None for a sentence."""
        value = self.values.get(_TEXT)
        return value if self.key == _KEY_OF_TEXT and isinstance(value, str) else None

    def given(self, **values: Any) -> Message:
        """Return the message with values for some of its names."""
        made = {name: _value(value) for name, value in values.items()}
        return Message(self.key, {**self.values, **made}, self.many, self.words)

    def translated(self, language: str, text: str | None) -> Message:
        """Return the message with what its author says in a language; as it is without."""
        return replace(self, words={**self.words, language: text}) if text else self

    def map_texts(self, change: Callable[[str], str]) -> Message:
        """Return the message with each text among its values, and theirs, changed."""
        values = {name: _changed(value, change) for name, value in self.values.items()}
        return Message(self.key, values, self.many, self.words)

    def serialise(self) -> Any:
        """Return the message as JSON: a text as such, else its key, and all that is not empty."""
        if not self or self.text is not None:
            return self.text or ""
        values = {
            name: value.serialise() if isinstance(value, Message) else value
            for name, value in self.values.items()
        }
        rest = {"values": values, "many": self.many, "words": dict(self.words)}
        return {"key": self.key, **{name: part for name, part in rest.items() if part}}

    @classmethod
    def parse(
        cls, data: object, text: Callable[[Any], str] | None = None, depth: int = 0
    ) -> Message:
        """Parse a message from JSON.

        Args:
            text: checks a text of it, and returns the text to keep.

        Raises:
            ValueError: it is no message.
        """
        checked = text or _a_text
        if isinstance(data, str):
            return Message.of(checked(data))
        if not isinstance(data, dict) or "key" not in data or depth > _DEEPEST:
            raise ValueError(f"expected a message: a key with values; found {reprlib.repr(data)}")
        if unknown := data.keys() - {"key", "values", "many", "words"}:
            raise ValueError(f"expected a message: a key with values; found {sorted(unknown)}")

        def value(found: object) -> Value:
            if isinstance(found, dict):
                return cls.parse(found, text, depth + 1)
            if type(found) is int or type(found) is float:
                return found
            return checked(found)

        values, words = data.get("values", {}), data.get("words", {})
        if not isinstance(values, dict) or not isinstance(words, dict):
            raise ValueError("expected the values of a message by their names")
        made = cls(
            checked(data["key"]),
            {checked(name): value(found) for name, found in values.items()},
            checked(data.get("many", "")),
            {checked(language): checked(word) for language, word in words.items()},
        )
        try:
            fill(made.number_key, made.values, _in_english, _LONGEST)
        except (ArithmeticError, LookupError, TypeError, ValueError) as error:
            raise ValueError(f"expected values that fit a message's key: {error}") from None
        return made


def msg(key: str, many: str = "", /, **values: Any) -> Message:
    """Make a sentence: `msg("It made {turns:.1f} turns.", turns=2.5)`.

    Numbers are written as in the reader's language; numbers that are code are passed as texts.

    Args:
        many: the sentence for any `n` but 1: `msg("{n} pin", "{n} pins", n=3)`.
    """
    return Message(key, {name: _value(value) for name, value in values.items()}, many)


def in_context(english: str, context: str) -> Message:
    """Make a word that has several meanings in English: `in_context("left", "of a wall")`.

    Translators find it by both, as 'left (of a wall)'.
    """
    return Message(f"{english} ({context})", words={"en": english})


def authored(text: str) -> Message:
    """Make a message of an author's text, which a catalogue may know."""
    return Message(text.replace("{", "{{").replace("}", "}}"))


def joined(parts: Iterable[str | Message], between: str | Message = "") -> Message:
    """Join texts and messages, with `between` between each two."""
    row: list[str | Message] = []
    for part in parts:
        row += [between] if row and between else []
        if isinstance(part, Message) and part.is_row:
            row += [each for each in part.values.values() if isinstance(each, str | Message)]
        else:
            row.append(part)
    if len(row) == 1:
        return Message.of(row[0])
    values = {f"p{number}": _value(part) for number, part in enumerate(row) if part}
    return Message("".join(f"{{{name}}}" for name in values), values)


def series(items: Iterable[str | Message]) -> Message:
    """Join things as a series: 'a', 'a and b', 'a, b and c'."""
    *those, last = list(items) or [NOTHING]
    if not those:
        return Message.of(last)
    return msg("{those} and {last}", those=joined(those, ", "), last=last)


def chained(items: Iterable[str | Message]) -> Message:
    """Join things with "and" between each two: 'a and b and c'."""
    return joined(items, msg(" and "))


def fill(
    key: str,
    values: Mapping[str, Any],
    write: Callable[[Any, str], str] = format,
    most: float = math.inf,
) -> str:
    """Fill the values into a key.

    `{clause!u}` is a clause at the beginning of a sentence: it gets a capital, unless it is the
    name of a file.

    Args:
        write: formats a value by its format.
        most: the most characters; a value may occur in a key many times.

    Raises:
        ValueError: it names a missing value, is no valid key, or becomes too long.
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
    """Convert a value to one of JSON's, which has no numpy numbers, paths or infinite numbers."""
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


def _a_text(found: object) -> str:
    if not isinstance(found, str):
        raise ValueError(f"expected a text or a number in a message, found {reprlib.repr(found)}")
    return found


#: The empty message.
NOTHING = Message()
_EMPTY_TEXT = Message(_KEY_OF_TEXT, {_TEXT: ""})
