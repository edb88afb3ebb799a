"""Messages of ROS's classes to bytes and to plain data, and back; for what runs beside ROS.

Bytes are CDR by a class's SLOT_TYPES, as Jazzy's rosidl_typesupport_fastrtps_c has it: a wstring is
its UTF-16 units in four bytes each, an empty message is one byte. Nothing of ROS is imported but
the classes of fields. `bag_types` reads recordings, by definitions.
"""

from __future__ import annotations

import array
import importlib
import math
import re
import struct
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from grader.ros.cdr import NUMBERS, CdrReader, CdrWriter, Number

_UNIT: Final = np.dtype("<u4")


def value_type(slot: Any) -> Any:
    """Return the type of a field's values: of an array, of its elements."""
    return getattr(slot, "value_type", slot)


def number_of(slot: Any) -> Number | None:
    """Return how an array or a sequence of numbers is stored; None for anything else."""
    return NUMBERS.get(getattr(getattr(slot, "value_type", None), "typename", ""))


def members(kind: Any) -> list[tuple[str, Any]]:
    """Return the names and types of a class's fields."""
    return list(zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True))


def module_of(slot: Any) -> str:
    """Return the module in which the generators put a class: 'std_msgs.msg._string'."""
    name = re.sub("(.)([A-Z][a-z]+)", r"\1_\2", slot.name.partition("_")[0])
    name = re.sub("([a-z0-9])([A-Z])", r"\1_\2", name).lower()
    return f"{'.'.join(slot.namespaces)}._{name}"


#: Namespaces and name of a message -> its class.
_INSTALLED: Final[dict[tuple[str, ...], Any]] = {}


def installed(slot: Any) -> Any:
    """Return the installed class of a message."""
    key = (*slot.namespaces, slot.name)
    if key not in _INSTALLED:
        _INSTALLED[key] = getattr(importlib.import_module(module_of(slot)), slot.name)
    return _INSTALLED[key]


def is_made(kind: Any) -> bool:
    """Whether a class was made by `classes`, and not compiled."""
    return hasattr(type(kind), "_find")


def member_class(owner: Any, slot: Any) -> Any:
    """Return the class of a field of a class, made or installed."""
    return getattr(type(owner), "_find", installed)(slot)


# Bytes -----------------------------------------------------------------------------------------


def serialise(message: Any) -> bytes:
    """Return the bytes of a message."""
    out = CdrWriter()
    try:
        _write_message(out, type(message), message)
    except (struct.error, TypeError, AttributeError, LookupError, OverflowError) as error:
        raise ValueError(f"{type(message).__name__} cannot be serialised: {error}") from error
    return out.message()


def deserialise(data: bytes, kind: Any) -> Any:
    """Return the message of a class that bytes are; more bytes behind it do not matter."""
    try:
        return _read_message(CdrReader(data), kind)
    except AssertionError as error:
        raise ValueError(f"expected {kind.__name__}: {error}") from None


def _bounded(slot: Any, count: int) -> None:
    if count > getattr(slot, "maximum_size", count):
        raise ValueError(f"expected at most {slot.maximum_size} values, found {count}")


def _write_message(out: CdrWriter, kind: Any, message: Any) -> None:
    if type(message) is not kind:
        raise TypeError(f"expected {kind.__name__}, found {type(message).__name__}")
    for name, slot in members(kind):
        _write(out, kind, slot, getattr(message, name))
    if not kind.SLOT_TYPES:
        out.number("B", 0)


def _write(out: CdrWriter, kind: Any, slot: Any, value: Any) -> None:
    if hasattr(slot, "value_type"):
        if not hasattr(slot, "size"):
            _bounded(slot, len(value))
            out.number("I", len(value))
        elif len(value) != slot.size:
            raise ValueError(f"expected {slot.size} values, found {len(value)}")
        number = number_of(slot)
        if number is not None:
            out.array(value, number.dtype)
        else:
            for each in value:
                _write(out, kind, slot.value_type, each)
    elif hasattr(slot, "namespaces"):
        _write_message(out, member_class(kind, slot), value)
    elif hasattr(slot, "typename"):
        if slot.typename in NUMBERS:
            out.number(NUMBERS[slot.typename].code, value)
        else:
            out.number("B", value[0] if slot.typename == "octet" else bool(value))
    else:
        _bounded(slot, len(value))
        if "WString" in type(slot).__name__:
            units = np.frombuffer(str(value).encode("utf-16-le"), "<u2")
            out.number("I", len(units))
            out.array(units, _UNIT)
        else:
            out.text(str(value).partition("\0")[0], "strict")  # where a string of C ends


def _read_message(read: CdrReader, kind: Any) -> Any:
    message = kind(**{name: _read(read, kind, slot) for name, slot in members(kind)})
    if not kind.SLOT_TYPES:
        read.number("B")
    return message


def _read(read: CdrReader, kind: Any, slot: Any) -> Any:
    if hasattr(slot, "value_type"):
        number, size = number_of(slot), getattr(slot, "size", None)
        count = read.count() if size is None else size
        _bounded(slot, count)
        if number is None:
            return [_read(read, kind, slot.value_type) for _ in range(count)]
        numbers = read.array(count, number.dtype).astype(number.dtype)
        return array.array(number.code, numbers.tobytes()) if size is None else numbers
    if hasattr(slot, "namespaces"):
        return _read_message(read, member_class(kind, slot))
    if hasattr(slot, "typename"):
        if slot.typename in NUMBERS:
            return read.number(NUMBERS[slot.typename].code)
        byte: int = read.number("B")
        return bytes([byte]) if slot.typename == "octet" else byte != 0
    if "WString" in type(slot).__name__:
        units = read.array(read.count(), _UNIT)
        if (units > 0xFFFF).any():
            raise ValueError("expected UTF-16 in a wstring")
        text = units.astype("<u2").tobytes().decode("utf-16")
    else:
        text = read.text("replace").partition("\0")[0]
    _bounded(slot, len(text))
    return text


# Plain data -----------------------------------------------------------------------------------


def make(kind: Any, values: Any) -> Any:
    """Make a message of plain data: fields with values, or of its only field the value."""
    slots = dict(members(kind))
    if not isinstance(values, Mapping):
        if len(slots) != 1:
            raise ValueError(f"expected values of {', '.join(slots)}, found {values!r:.80}")
        values = {next(iter(slots)): values}
    if unknown := sorted(values.keys() - slots.keys()):
        raise ValueError(f"{kind.__name__} has no field {unknown[0]}, only {', '.join(slots)}")
    message = kind(check_fields=True)
    for name, value in values.items():
        try:
            setattr(message, name, _made(kind, slots[name], value))
        except (AssertionError, TypeError, OverflowError) as error:
            raise ValueError(f"{kind.__name__}.{name}: {error!s:.200}") from None
    return message


def _made(kind: Any, slot: Any, value: Any) -> Any:
    inner = value_type(slot)
    if inner is not slot:
        if not isinstance(value, (list, tuple)):
            raise TypeError(f"expected a list, found {value!r:.80}")
        return [_made(kind, inner, each) for each in value]
    if hasattr(inner, "namespaces"):
        if not isinstance(value, Mapping):
            raise TypeError(f"expected fields with values, found {value!r:.80}")
        return make(member_class(kind, inner), value)
    typename = getattr(inner, "typename", "")
    if typename in ("float", "double") and isinstance(value, int):
        return float(value)
    if typename == "octet" and isinstance(value, int):
        return value.to_bytes(1, "little")
    if isinstance(value, str):
        value.encode("utf-8")  # else no message can hold it
    return value


def plain(message: Any) -> dict[str, Any]:
    """Return the values of a message as plain data that fits JSON."""
    return {name: plain_value(getattr(message, name)) for name, _ in members(type(message))}


def plain_value(value: Any) -> Any:
    """Return a value of a message as plain data that fits JSON."""
    if hasattr(value, "SLOT_TYPES"):
        return plain(value)
    if isinstance(value, bytes):
        return value[0] if len(value) == 1 else list(value)
    if hasattr(value, "tolist"):
        return plain_value(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain_value(each) for each in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value
