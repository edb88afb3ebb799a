"""ROS messages to rosbridge's JSON and back: its own, since the simulator works without a grader.

Bytes (`uint8[]`, `byte[]`) are base64 text; what is no finite number is null, since JSON has none.
"""

from __future__ import annotations

import base64
import binascii
import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any, NamedTuple

#: 'geometry_msgs/msg/Twist', or as ROS 1 and rosbridge write it, 'geometry_msgs/Twist'.
_TYPE = re.compile(r"([a-z][a-z0-9_]*)/(?:(msg|srv|action)/)?([A-Za-z][A-Za-z0-9_]*)")
_ARRAY = re.compile(r"(?P<of>.+)\[(?P<length>\d*)\]|sequence<(?P<items>.+?)(?:, \d+)?>")
_TEXT = re.compile(r"w?string(<(?P<most>\d+)>)?")
_BYTES = frozenset(("uint8", "octet", "byte", "char"))
_FLOATS = frozenset(("float", "double", "float32", "float64", "long double"))
_INTS = {f"{sign}int{bits}": (sign, bits) for sign in ("", "u") for bits in (8, 16, 32, 64)}
#: The most items of a list from a viewer.
MOST_ITEMS = 100_000


class Rejected(ValueError):
    """A request of a viewer cannot be served; the text, which is the answer, explains why.

    Args:
        key: the text in English, with names in braces for its values; the page's catalogues have
            it in other languages.
    """

    def __init__(self, key: str, /, **values: object) -> None:
        self.key = key
        self.values = {name: str(value) for name, value in values.items()}
        super().__init__(key.format(**self.values))


def _misfit(key: str, path: str, value: object, **more: object) -> Rejected:
    """Return why a value does not fit a field, with the value as {found}."""
    return Rejected(key, field=path, found=f"{value!r:.60}", **more)


class Field(NamedTuple):
    """A field of a message: `kind` is its type without the array, `length` -1 where it is none."""

    name: str
    kind: str
    length: int


def find(name: str, kind: str) -> Any:
    """Return the class of a type; `kind` is 'msg', 'srv' or 'action'.

    Raises:
        Rejected: there is none of this name.
    """
    match = _TYPE.fullmatch(name)
    if match is None or match[2] not in (None, kind):
        raise Rejected(
            "{name} is no type; expected one like 'geometry_msgs/{kind}/Name'",
            name=f"{name!r:.80}",
            kind=kind,
        )
    if _is_of_interfaces(match[1], kind):
        with suppress(ImportError, AttributeError):
            return getattr(import_module(f"{match[1]}.{kind}"), match[3])
    raise Rejected("the type {name} is not installed here", name=f"{name!r:.80}")


def _is_of_interfaces(package: str, kind: str) -> bool:
    """Whether a package has a folder of such types: another one would be imported for its name."""
    found = PathFinder.find_spec(package)
    places = found.submodule_search_locations if found is not None else None
    return any((Path(place) / kind / "__init__.py").is_file() for place in places or ())


def fields_of(message_type: Any) -> list[Field]:
    """Return the fields of a message type, in order."""
    fields = []
    for name, text in message_type.get_fields_and_field_types().items():
        if match := _ARRAY.fullmatch(text):
            fields.append(Field(name, match["of"] or match["items"], int(match["length"] or 0)))
        else:
            fields.append(Field(name, text, -1))
    return fields


# ROS to JSON --------------------------------------------------------------------------------------


def to_json(message: Any) -> dict[str, Any]:
    return {f.name: _field_to_json(getattr(message, f.name), f) for f in fields_of(message)}


def _field_to_json(value: Any, field: Field) -> Any:
    if field.length < 0:
        return _item_to_json(value)
    if field.kind in _BYTES:
        data = b"".join(value) if isinstance(value, list) else bytes(value)
        return base64.b64encode(data).decode("ascii")
    return [_item_to_json(item) for item in value]


def _item_to_json(value: Any) -> Any:
    if hasattr(value, "get_fields_and_field_types"):
        return to_json(value)
    if isinstance(value, bytes):
        return value[0] if value else 0
    if isinstance(value, str | bool):
        return value
    number = value.item() if hasattr(value, "item") else value
    return number if math.isfinite(number) else None


# JSON to ROS --------------------------------------------------------------------------------------


def from_json(message_type: Any, content: object, where: str = "") -> Any:
    """Return the message that JSON describes; fields that are left out keep their defaults.

    Raises:
        Rejected: a value does not fit a field: which, what was found and what was expected.
    """
    if not isinstance(content, Mapping):
        if not where:
            raise Rejected("the message: expected fields, found {found}", found=f"{content!r:.60}")
        raise _misfit("{field}: expected fields, found {found}", where, content)
    message = message_type()
    fields = {field.name: field for field in fields_of(message_type)}
    for name, value in content.items():
        if name not in fields:
            there = {"name": f"{name!s:.60}", "fields": ", ".join(fields) or "none"}
            if not where:
                raise Rejected("the message: no field {name}; there are {fields}", **there)
            raise Rejected("{field}: no field {name}; there are {fields}", field=where, **there)
        if value is not None:
            path = f"{where}.{name}" if where else name
            try:
                setattr(message, name, _read_field(value, fields[name], path))
            except AssertionError:  # of ROS's setters: a bound of the type
                raise _misfit(
                    "{field}: {found} is not what {kind} holds", path, value, kind=fields[name].kind
                ) from None
    return message


def _read_field(value: object, field: Field, path: str) -> Any:
    if field.length < 0:
        return _read_item(value, field.kind, path)
    if isinstance(value, str) and field.kind in _BYTES:
        value = _from_base64(value, path)
    if not isinstance(value, Sequence) or isinstance(value, str):
        raise _misfit("{field}: expected a list, found {found}", path, value)
    found = {"field": path, "found": f"{len(value):,}"}
    if field.length and len(value) != field.length:
        raise Rejected("{field}: expected {n} items, found {found}", n=field.length, **found)
    if len(value) > MOST_ITEMS:
        most = f"{MOST_ITEMS:,}"
        raise Rejected("{field}: expected {n} items at most, found {found}", n=most, **found)
    return [_read_item(item, field.kind, f"{path}[{n}]") for n, item in enumerate(value)]


def _from_base64(text: str, path: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except binascii.Error:
        raise _misfit("{field}: expected base64, found {found}", path, text) from None


def _read_item(value: object, kind: str, path: str) -> Any:
    if "/" in kind:
        return from_json(find(kind, "msg"), value, path)
    if kind == "boolean" or kind == "bool":
        if isinstance(value, bool):
            return value
        raise _misfit("{field}: expected true or false, found {found}", path, value)
    if text := _TEXT.fullmatch(kind):
        if isinstance(value, str) and len(value) <= int(text["most"] or len(value)):
            return value
        raise _misfit("{field}: expected a text, found {found}", path, value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _misfit("{field}: expected a number, found {found}", path, value)
    return _number(value, kind, path)


def _number(value: float, kind: str, path: str) -> Any:
    if kind in _FLOATS:
        try:
            return float(value)
        except OverflowError:
            raise Rejected("{field}: expected a number, found one too large", field=path) from None
    sign, bits = _INTS.get(kind, ("u", 8))
    low, high = (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    if value != value or not low <= value <= high or value != int(value):
        raise _misfit(
            "{field}: expected a whole number from {low} to {high}, found {found}",
            path,
            value,
            low=low,
            high=high,
        )
    return bytes([int(value)]) if kind in ("octet", "byte") else int(value)


# Types --------------------------------------------------------------------------------------------


def typedefs(message_type: Any, name: str) -> list[dict[str, Any]]:
    """Return a type's fields, and those of their types, as rosapi's message_details does."""
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
