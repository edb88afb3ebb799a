"""The classes of types that a cast speaks, and their definitions; in the simulator's process."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from grader.ros.definitions import Definitions, is_installed, slot_of
from grader.ros.messages import members, value_type

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
            if name not in self._texts and not is_installed(slot_of(name)):
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
