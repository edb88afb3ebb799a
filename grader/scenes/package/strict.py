"""Dataclasses as JSON and back, strictly: what a stranger's process could have written is data.

A dataclass says by its annotations what is taken: `str`, `int`, `bool`, `tuple[T, ...]`,
`T | None`, and dataclasses. A text has `LONGEST` characters at most, or what the field says by
`longest(...)`; a list has `MOST` entries.
"""

from __future__ import annotations

import types
from dataclasses import field, fields, is_dataclass
from functools import cache
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

LONGEST = 2000
MOST = 5000
Made = TypeVar("Made")


def longest(characters: int) -> Any:
    """A field for a tuple of longer texts."""
    return field(default=(), metadata={"longest": characters})


def to_json(value: Any) -> Any:
    """As `from_json` takes it: what is longer than that is cut."""
    return _cut(value, LONGEST)


def _cut(value: Any, most: int) -> Any:
    if is_dataclass(value):
        parts = _fields(value.__class__)
        return {name: _cut(getattr(value, name), longest) for name, (_, longest) in parts.items()}
    if isinstance(value, tuple):
        return [_cut(each, most) for each in value[:MOST]]
    return value[:most] if isinstance(value, str) else value


def from_json(kind: type[Made], data: Any) -> Made:
    """The dataclass that data means.

    Raises:
        ValueError: it has another form, or something in it is longer than it may be.
    """
    made: Made = _value(kind, data, LONGEST)
    return made


def _value(kind: Any, data: Any, most: int) -> Any:
    if is_dataclass(kind):
        return _object(kind, data)
    if isinstance(kind, types.UnionType):
        (wanted,) = (each for each in get_args(kind) if each is not type(None))
        return None if data is None else _value(wanted, data, most)
    if get_origin(kind) is tuple:
        if not isinstance(data, list | tuple) or len(data) > MOST:
            raise ValueError(f"expected a list of {MOST} at most, found {data!r:.80}")
        return tuple(_value(get_args(kind)[0], each, most) for each in data)
    if type(data) is not kind:
        raise ValueError(f"expected {kind.__name__}, found {data!r:.80}")
    if kind is str and len(data) > most:
        raise ValueError(f"expected {most} characters at most, found {len(data)}")
    if kind is int and not -(2**53) < data < 2**53:
        raise ValueError(f"expected a number below 2 to the 53, found {data!r:.80}")
    return data


def _object(kind: Any, data: Any) -> Any:
    parts = _fields(kind)
    if not isinstance(data, dict) or data.keys() != parts.keys():
        raise ValueError(f"expected an object of {', '.join(parts)}, found {data!r:.80}")
    return kind(**{name: _value(parts[name][0], data[name], parts[name][1]) for name in parts})


@cache
def _fields(kind: Any) -> dict[str, tuple[Any, int]]:
    """Name -> what it is, and how long its texts may be."""
    hints = get_type_hints(kind)
    return {
        each.name: (hints[each.name], each.metadata.get("longest", LONGEST))
        for each in fields(kind)
    }
