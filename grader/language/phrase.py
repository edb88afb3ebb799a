"""A sentence that remembers what it was made of, so that it can be said in another language.

It is the English text, wherever a text is wanted. Its key is the English sentence with names for
its values, `It made {turns:.1f} turns.`, and is what translators find in the catalogues.
"""

from __future__ import annotations

import re
import string
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any, Self

#: How a value may be written: a name, and a format that cannot ask for a page of blanks.
_NAME = re.compile(r"[a-z_][a-z0-9_]*", re.IGNORECASE)
_FORMAT = re.compile(r"[+,]?[0-9]{0,2},?(\.[0-9]{1,2})?[a-zA-Z%]?")


class Phrase(str):
    """A text that knows its parts.

    Attributes:
        key: the sentence with names for values; '' for a row of parts.
        values: what the names stand for; each a text, a number, or a phrase again.
        many: the key for more than one, where the value `n` decides; '' for none.
        parts: instead of a key: texts and phrases, one behind the other.
        words: language -> how its author says it there; what it has comes before any catalogue.
    """

    key: str
    many: str
    values: Mapping[str, Any]
    parts: tuple[str, ...]
    words: Mapping[str, str]

    def __new__(
        cls,
        english: str,
        key: str = "",
        values: Mapping[str, Any] | None = None,
        many: str = "",
        parts: Sequence[str] = (),
        words: Mapping[str, str] | None = None,
    ) -> Self:
        """A text as it is in English, and what it is made of."""
        made = super().__new__(cls, english)
        made.key, made.many = key, many
        made.values, made.parts = dict(values or {}), tuple(parts)
        made.words = dict(words or {})
        return made

    def __deepcopy__(self, memo: object) -> Self:
        """Itself: it does not change."""
        return self

    def __add__(self, other: str) -> Phrase:
        """With a text behind it."""
        return joined([self, other])

    def __radd__(self, other: str) -> Phrase:
        """With a text before it."""
        return joined([other, self])

    def strip(self, *chars: Any) -> str:
        """The same where there is nothing to strip."""
        text = super().strip(*chars)
        return self if len(text) == len(self) else text


def marked(key: str) -> str:
    """A key that is filled elsewhere: what stands in quotes here is found for the catalogues."""
    return key


def say(key: str, /, **values: Any) -> Phrase:
    """A sentence: `say("It made {turns:.1f} turns.", turns=2.5)`.

    Numbers are written as the reader's language writes them; what is code is given as a text.
    """
    return Phrase(fill(key, values), key, values)


def say_many(one: str, many: str, n: float, /, **values: Any) -> Phrase:
    """A sentence about `{n}` things: `say_many("{n} pin", "{n} pins", 3)`."""
    values = {"n": n, **values}
    return Phrase(fill(one if n == 1 else many, values), one, values, many)


def authored(text: str, words: Mapping[str, str] | None = None) -> Phrase:
    """What an exercise's author has written, with its words in other languages, if there are some.

    Args:
        words: language -> text. In a language that is left out, a catalogue may know the text.
    """
    return Phrase(text, text.replace("{", "{{").replace("}", "}}"), words=words)


def joined(parts: Sequence[str], between: str = "") -> Phrase:
    """Texts one behind the other, with the same between each two."""
    row: list[str] = []
    for part in parts:
        if row and between:
            row.append(between)
        row += part.parts if isinstance(part, Phrase) and part.parts else [part]
    return Phrase("".join(row), parts=row)


def listed(items: Sequence[str]) -> str:
    """Some things in one row: 'a', 'a and b', 'a, b and c'."""
    if len(items) < 2:
        return items[0] if items else ""
    return say("{those} and {last}", those=joined(items[:-1], ", "), last=items[-1])


def chained(items: Sequence[str]) -> Phrase:
    """Some things with a word between each two: 'a and b and c'."""
    return joined(items, say(" and "))


def fill(key: str, values: Mapping[str, Any], write: Callable[[Any, str], str] = format) -> str:
    """A key with its values in their places.

    `{clause!u}` is a clause with which a sentence begins: with a capital, where it is no file's
    name.

    Args:
        write: makes a text of a value and its format.

    Raises:
        ValueError: it names what is not there, or is no sentence with values.
    """
    made = []
    for before, name, form, conversion in string.Formatter().parse(key):
        made.append(before)
        if name is None:
            continue
        if name not in values or not _NAME.fullmatch(name) or not _FORMAT.fullmatch(form or ""):
            raise ValueError(f"no value for {{{name}:{form}}} in {key!r}")
        value = values[name]
        text = repr(value) if conversion == "r" else write(value, form or "")
        made.append(_as_beginning(text) if conversion == "u" else text)
    return "".join(made)


def reason(error: Exception) -> str:
    """What an exception says; the phrase itself, where it was raised with nothing but one."""
    is_phrase = len(error.args) == 1 and isinstance(error.args[0], Phrase)
    return error.args[0] if is_phrase else str(error)


def each_text(value: Any, change: Callable[[str, str], str], field: str = "") -> Any:
    """A dataclass, row or dictionary with each of its texts changed; keys stay.

    Args:
        change: makes a text of a text, and of the name of the dataclass's field that holds it: ''
            where none does.
    """
    if isinstance(value, str):
        return change(value, field)
    if isinstance(value, Mapping):
        return {key: each_text(item, change, field) for key, item in value.items()}
    if isinstance(value, list | tuple):
        items = [each_text(item, change, field) for item in value]
        return type(value)(*items) if hasattr(value, "_fields") else type(value)(items)
    if is_dataclass(value) and not isinstance(value, type):
        of = {each.name: getattr(value, each.name) for each in fields(value)}
        return replace(value, **{n: each_text(item, change, n) for n, item in of.items()})
    return value


def _as_beginning(clause: str) -> str:
    return clause if "." in clause.partition(" ")[0] else clause[:1].upper() + clause[1:]
