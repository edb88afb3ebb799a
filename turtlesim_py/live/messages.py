"""ROS messages as JSON and back, as rosbridge has them, and what a type is made of.

Bytes (`uint8[]`, `byte[]`) are base64 text; what is no finite number is null, since JSON has none.
"""

from __future__ import annotations

import base64
import binascii
import math
import re
from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any, NamedTuple

#: 'geometry_msgs/msg/Twist', or as ROS 1 and rosbridge write it, 'geometry_msgs/Twist'.
_TYPE = re.compile(r"([a-z][a-z0-9_]*)/(?:(msg|srv|action)/)?([A-Za-z][A-Za-z0-9_]*)")
_ARRAY = re.compile(r"(?P<of>.+)\[(?P<length>\d*)\]|sequence<(?P<items>.+?)(?:, (?P<most>\d+))?>")
_TEXT = re.compile(r"w?string(<(?P<most>\d+)>)?")
_BYTES = frozenset(("uint8", "octet", "byte", "char"))
_FLOATS = frozenset(("float", "double", "float32", "float64", "long double"))
_INTS = {f"{sign}int{bits}": (sign, bits) for sign in ("", "u") for bits in (8, 16, 32, 64)}
#: A number that a stranger sends may have so many items in a list.
MOST_ITEMS = 100_000


class NoSuchType(ValueError):
    """A type that is not installed here."""


class NotThere(ValueError):
    """What a viewer has named is not in the graph, or cannot be in any."""


class Unfit(ValueError):
    """A value does not fit a field; the text says which, what was found and what was expected."""


class Field(NamedTuple):
    """A field of a message: `kind` is its type without the array, `length` -1 where it is none."""

    name: str
    kind: str
    length: int


def find(name: str, kind: str) -> Any:
    """The class of a type.

    Args:
        kind: 'msg', 'srv' or 'action'.

    Raises:
        NoSuchType: there is none of this name.
    """
    match = _TYPE.fullmatch(name)
    if match is None or match[2] not in (None, kind):
        raise NoSuchType(f"{name!r:.80} is no type; expected one like 'geometry_msgs/{kind}/Name'")
    if not _is_of_interfaces(match[1], kind):
        raise NoSuchType(f"the type {name!r:.80} is not installed here")
    try:
        return getattr(import_module(f"{match[1]}.{kind}"), match[3])
    except (ImportError, AttributeError):
        raise NoSuchType(f"the type {name!r:.80} is not installed here") from None


def _is_of_interfaces(package: str, kind: str) -> bool:
    """Whether a package has a folder of such types: another one would be imported for its name."""
    found = PathFinder.find_spec(package)
    places = found.submodule_search_locations if found is not None else None
    return any((Path(place) / kind / "__init__.py").is_file() for place in places or ())


def fields_of(message_type: Any) -> list[Field]:
    """The fields of a message type, in order."""
    return [_field(*each) for each in message_type.get_fields_and_field_types().items()]


def _field(name: str, text: str) -> Field:
    match = _ARRAY.fullmatch(text)
    if match is None:
        return Field(name, text, -1)
    length = int(match["length"]) if match["length"] else 0
    return Field(name, match["of"] or match["items"], length)


# ROS to JSON --------------------------------------------------------------------------------------


def to_json(message: Any) -> dict[str, Any]:
    """What a message says."""
    return {f.name: _told(getattr(message, f.name), f) for f in fields_of(message)}


def _told(value: Any, field: Field) -> Any:
    if field.length < 0:
        return _one_told(value)
    if field.kind in _BYTES:
        data = b"".join(value) if isinstance(value, list) else bytes(value)
        return base64.b64encode(data).decode("ascii")
    return [_one_told(item) for item in value]


def _one_told(value: Any) -> Any:
    if hasattr(value, "get_fields_and_field_types"):
        return to_json(value)
    if isinstance(value, bytes):
        return value[0] if value else 0
    if isinstance(value, str | bool):
        return value
    number = value.item() if hasattr(value, "item") else value
    return number if math.isfinite(number) else None


# JSON to ROS --------------------------------------------------------------------------------------


def from_json(message_type: Any, said: object, where: str = "") -> Any:
    """The message that JSON says; fields that are left out keep their defaults.

    Raises:
        Unfit: it says none.
    """
    if not isinstance(said, Mapping):
        raise Unfit(f"{where or 'the message'}: expected fields, found {_found(said)}")
    message = message_type()
    fields = {field.name: field for field in fields_of(message_type)}
    for name, value in said.items():
        if name not in fields:
            there = ", ".join(fields) or "none"
            raise Unfit(f"{where or 'the message'}: no field {name!s:.60}; there are {there}")
        if value is not None:
            path = f"{where}.{name}" if where else name
            try:
                setattr(message, name, _read(value, fields[name], path))
            except AssertionError:  # ROS's own check: a bound of the type
                raise Unfit(
                    f"{path}: {_found(value)} is not what {fields[name].kind} holds"
                ) from None
    return message


def _read(value: object, field: Field, path: str) -> Any:
    if field.length < 0:
        return _one_read(value, field.kind, path)
    if isinstance(value, str) and field.kind in _BYTES:
        value = _from_base64(value, path)
    if not isinstance(value, Sequence) or isinstance(value, str):
        raise Unfit(f"{path}: expected a list, found {_found(value)}")
    if len(value) > MOST_ITEMS or (field.length and len(value) != field.length):
        most = field.length or f"{MOST_ITEMS:,} at most"
        raise Unfit(f"{path}: expected {most} items, found {len(value):,}")
    return [_one_read(item, field.kind, f"{path}[{n}]") for n, item in enumerate(value)]


def _from_base64(text: str, path: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except binascii.Error:
        raise Unfit(f"{path}: expected base64, found {_found(text)}") from None


def _one_read(value: object, kind: str, path: str) -> Any:
    if "/" in kind:
        return from_json(find(kind, "msg"), value, path)
    if kind == "boolean" or kind == "bool":
        if isinstance(value, bool):
            return value
        raise Unfit(f"{path}: expected true or false, found {_found(value)}")
    text = _TEXT.fullmatch(kind)
    if text:
        if isinstance(value, str) and len(value) <= int(text["most"] or len(value)):
            return value
        raise Unfit(f"{path}: expected a text, found {_found(value)}")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Unfit(f"{path}: expected a number, found {_found(value)}")
    return _number(value, kind, path)


def _number(value: float, kind: str, path: str) -> Any:
    if kind in _FLOATS:
        try:
            return float(value)
        except OverflowError:
            raise Unfit(f"{path}: expected a number, found one too large") from None
    sign, bits = _INTS.get(kind, ("u", 8))
    low, high = (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    if value != value or not low <= value <= high or value != int(value):
        raise Unfit(f"{path}: expected a whole number from {low} to {high}, found {value!r:.40}")
    return bytes([int(value)]) if kind in ("octet", "byte") else int(value)


def _found(value: object) -> str:
    return f"{value!r:.60}"


# Types --------------------------------------------------------------------------------------------


def typedefs(message_type: Any, name: str) -> list[dict[str, Any]]:
    """What a type is made of, and what those are made of, as rosapi's message_details tells it."""
    found: dict[str, dict[str, Any]] = {}
    pending = [(name, message_type)]
    while pending:
        type_name, made = pending.pop(0)
        if type_name in found:
            continue
        fields = fields_of(made)
        found[type_name] = {
            "type": type_name,
            "fieldnames": [field.name for field in fields],
            "fieldtypes": [field.kind for field in fields],
            "fieldarraylen": [field.length for field in fields],
        }
        pending += [(f.kind, find(f.kind, "msg")) for f in fields if "/" in f.kind]
    return list(found.values())
