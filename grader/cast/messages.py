"""Messages of ROS out of plain data and back, in the simulator's process."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from grader.cast.script import interfaces_folder
from grader.rosidl.cdr import member_class, members, value_type
from grader.rosidl.definitions import Definitions

#: Basic types, where a definition has other names.
_BASIC: Final = {"boolean": "bool", "octet": "uint8", "float": "float32", "double": "float64"}


class NoType(LookupError):
    """There is no type of this name here."""


class Types:
    """The classes of types: those of an exercise and a hand-in, else installed ones.

    Args:
        texts: the definitions of the former, by names such as 'my_interfaces/msg/Num'.
        are_compiled: whether these can be imported as installed ones can.
    """

    def __init__(self, texts: Mapping[str, str], *, are_compiled: bool = False) -> None:
        self._texts = texts
        self._own = Definitions({} if are_compiled else texts)
        #: definitions of all messages that were asked for, and of their fields
        self.used: dict[str, str] = {}

    def find(self, name: str) -> Any:
        """Return the class of a type.

        Raises:
            NoType: there is none.
        """
        try:
            if name not in self._texts and not _is_installed(name):
                raise ImportError(name)  # else any module would be imported
            return self._own.type(name)
        except (ImportError, AttributeError) as error:
            raise NoType(f"there is no type {name}: {error}") from None

    def use(self, name: str) -> Any:
        """Return the class of a message, whose definition a recording is to have.

        Raises:
            NoType: there is none.
        """
        if name.split("/")[1] != "msg":  # a service's, on a topic
            raise NoType(f"{name} is no message")
        found = self.find(name)
        if name not in self.used:
            inner = [value_type(slot) for _, slot in members(found)]
            text = "".join(f"{_written(slot)} {field}\n" for field, slot in members(found))
            for each in inner:
                if hasattr(each, "namespaces"):
                    self.use("/".join((*each.namespaces, each.name)))
            self.used[name] = text
        return found


def _is_installed(name: str) -> bool:
    """Whether a package of interfaces is installed that may have a type."""
    package, kind, _ = name.split("/")
    return kind in ("msg", "srv", "action") and interfaces_folder(package, kind) is not None


def _written(slot: Any) -> str:
    """Return a field's type as readers of bags know it, which have no bounds and no wstring."""
    inner = value_type(slot)
    if hasattr(inner, "namespaces"):
        base = f"{inner.namespaces[0]}/{inner.name}"
    elif hasattr(inner, "typename"):
        base = _BASIC.get(inner.typename, inner.typename)
    elif "WString" not in type(inner).__name__:
        base = "string"
    elif inner is slot:
        return "uint32[]"  # as it is in CDR
    else:
        raise NoType("no reader of bags knows lists of wstring")
    return base if inner is slot else f"{base}[{getattr(slot, 'size', '')}]"


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
