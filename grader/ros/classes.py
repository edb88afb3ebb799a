"""Classes of messages, services and actions, as rosidl_generator_py (Jazzy) writes them.

Same fields, checks of assigned values and words. Without functions that convert them rclpy's C
refuses to serialise their messages.
"""

from __future__ import annotations

import array
import math
import os
from collections import UserList, UserString
from collections.abc import Callable, Sequence, Set
from copy import copy
from functools import partial
from typing import Any, Final

import numpy as np
import rosidl_parser.definition as idl

from grader.ros.cdr import NUMBERS
from grader.ros.messages import members, module_of, number_of, value_type

#: The class of a field's type; asked when a message is made.
Find = Callable[[Any], Any]
#: Whether a value is one, and what it must be.
Condition = tuple[Callable[[Any], bool], str]
#: Makes a class's type support (`handles`); in virtual time only.
make_support: Callable[[Any], Any] | None = None
#: The generator's own bounds; the first is not quite the greatest float32.
_GREATEST: Final = {"float": 3.402823466e38, "double": 1.7976931348623157e308}
_PYTHON: Final = {"boolean": bool, "octet": bytes, "float": float, "double": float}


def described(slot: Any) -> str:
    """Return a type as `_fields_and_field_types` has it: 'sequence<int32, 3>'."""
    value = value_type(slot)
    if isinstance(value, idl.BasicType):
        text = value.typename
    elif isinstance(value, idl.NamespacedType):
        text = f"{value.namespaces[0]}/{value.name}"
    else:
        text = "wstring" if isinstance(value, idl.AbstractWString) else "string"
        text += f"<{value.maximum_size}>" if value.has_maximum_size() else ""
    if isinstance(slot, idl.Array):
        return f"{text}[{slot.size}]"
    if isinstance(slot, idl.AbstractSequence):
        text += f", {slot.maximum_size}" if slot.has_maximum_size() else ""
        return f"sequence<{text}>"
    return str(text)


def parts(element: Any) -> list[Any]:
    """Return the messages of a message, a service or an action."""
    if isinstance(element, idl.Message):
        return [element]
    if isinstance(element, idl.Service):
        return [element.request_message, element.response_message, element.event_message]
    services = parts(element.send_goal_service) + parts(element.get_result_service)
    return [element.goal, element.result, element.feedback, *services, element.feedback_message]


def classes_of(element: Any, find: Find) -> dict[str, Any]:
    """Make the classes of an interface, by the names in their module.

    Args:
        element: a Message, Service or Action of `rosidl_parser.definition`, with default values as
            Python's; empty messages have no member.
    """
    module = module_of(parts(element)[0].structure.namespaced_type)
    made: dict[str, Any] = {}

    def make(name: str, own: dict[str, Any], meta: dict[str, Any] | None = None) -> None:
        def import_type_support(cls: Any) -> None:
            cls._TYPE_SUPPORT = make_support and make_support(made[name])

        meta = {
            "__module__": module,
            "__import_type_support__": classmethod(import_type_support),
            "_TYPE_SUPPORT": None,
            "_find": staticmethod(find),
            **(meta or {}),
        }
        made[f"Metaclass_{name}"] = metaclass = type(f"Metaclass_{name}", (type,), meta)
        made[name] = metaclass(name, (), {"__module__": module, "__qualname__": name, **own})

    for message in parts(element):
        make(message.structure.namespaced_type.name, *_message(message, find))
    if isinstance(element, idl.Message):
        return made
    services = [element]
    if isinstance(element, idl.Action):
        services = [element.send_goal_service, element.get_result_service]
    for name in (service.namespaced_type.name for service in services):
        own = {part: made[f"{name}_{part}"] for part in ("Request", "Response", "Event")}
        make(name, own | {"__init__": _refuse})
    if isinstance(element, idl.Action):
        name = element.namespaced_type.name
        own_msg, own_srv = ["action_msgs", "msg"], ["action_msgs", "srv"]
        inner = {
            "SendGoalService": made[f"{name}_SendGoal"],
            "GetResultService": made[f"{name}_GetResult"],
            "FeedbackMessage": made[f"{name}_FeedbackMessage"],
            "CancelGoalService": find(idl.NamespacedType(own_srv, "CancelGoal")),
            "GoalStatusMessage": find(idl.NamespacedType(own_msg, "GoalStatusArray")),
            "__module__": module,
            "__qualname__": f"{name}.Impl",
        }
        own = {part: made[f"{name}_{part}"] for part in ("Goal", "Result", "Feedback")}
        make(name, own | {"Impl": type("Impl", (), inner), "__init__": _refuse})
    return made


def _refuse(self: Any) -> None:
    what = "Service" if hasattr(self, "Request") else "Action"
    raise NotImplementedError(f"{what} classes can not be instantiated")


def _message(message: idl.Message, find: Find) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the attributes of a message's class, and of its metaclass."""
    # constants and defaults may be changed in place: each is a new copy
    makers = {constant.name: partial(copy, constant.value) for constant in message.constants}
    fields, firsts = {}, []
    for member in message.structure.members:
        name, fields[member.name], code = member.name, member.type, None
        if member.has_annotation("default"):
            first = partial(copy, member.get_annotation_value("default")["value"])
            makers[f"{name.upper()}__DEFAULT"] = first
        else:
            first = _first(member.type, find)
            if (number := number_of(member.type)) and isinstance(member.type, idl.AbstractSequence):
                code = number.code
        firsts.append((name, first, code))
    # which C cannot call
    converters = ("CREATE_ROS_MESSAGE", "CONVERT_FROM_PY", "CONVERT_TO_PY", "DESTROY_ROS_MESSAGE")
    return {
        **{name: maker() for name, maker in makers.items()},
        "__doc__": f"Message class '{message.structure.namespaced_type.name}'.",
        "__slots__": [*(f"_{name}" for name in fields), "_check_fields"],
        "_fields_and_field_types": {name: described(slot) for name, slot in fields.items()},
        "SLOT_TYPES": tuple(fields.values()),
        "__init__": _constructor(message.structure.namespaced_type.name, firsts),
        "__repr__": _repr,
        "__eq__": _equal,
        "get_fields_and_field_types": classmethod(lambda cls: copy(cls._fields_and_field_types)),
        **{name: _property(name, slot, find) for name, slot in fields.items()},
    }, {
        **{f"_{name}": "none" for name in converters},
        **{name: property(partial(_call, maker)) for name, maker in makers.items()},
    }


def _call(maker: Callable[[], Any], cls: Any) -> Any:
    return maker()


def _first(slot: Any, find: Find) -> Any:
    """Return what makes a field's value where none is given."""
    if isinstance(slot, idl.AbstractSequence):
        return list
    if isinstance(slot, idl.Array):
        if (number := number_of(slot)) is not None:
            return partial(np.zeros, slot.size, dtype=number.dtype)
        one = _first(slot.value_type, find)
        return lambda: [one() for _ in range(slot.size)]
    if isinstance(slot, idl.NamespacedType):
        return lambda: find(slot)()
    return partial(bytes, 1) if _python_type(slot) is bytes else _python_type(slot)


def _python_type(value: Any) -> Any:
    is_text = isinstance(value, idl.AbstractGenericString)
    return str if is_text else _PYTHON.get(value.typename, int)


def _constructor(name: str, firsts: list[tuple[str, Any, str | None]]) -> Callable[..., None]:
    """Return `__init__`, by each field's name, what makes its value, and its array's code."""
    are_checked = os.getenv("ROS_PYTHON_CHECK_FIELDS", "") == "1"

    def construct(self: Any, **kwargs: Any) -> None:
        self._check_fields = kwargs.get("check_fields", are_checked)
        if self._check_fields:
            wrong = sorted(key for key in kwargs if "_" + key not in self.__slots__)
            assert not wrong, f"Invalid arguments passed to constructor: {', '.join(wrong)}"
        for name, first, code in firsts:
            value = kwargs[name] if name in kwargs else first()
            setattr(self, name, array.array(code, value) if code else value)

    construct.__name__, construct.__qualname__ = "__init__", f"{name}.__init__"
    return construct


def _repr(self: Any) -> str:
    args = []
    for name, slot in members(type(self)):
        value = getattr(self, name)
        text = repr(value)
        if number_of(slot) is not None and isinstance(slot, idl.AbstractSequence):
            text = text[len("array('X', ") : -1] if len(value) else "[]"
        args.append(f"{name}={text}")
    package = type(self).__module__.rpartition(".")[0]
    return f"{package}.{type(self).__name__}({', '.join(args)})"


def _equal(self: Any, other: Any) -> bool:
    if not isinstance(other, self.__class__):
        return False
    for name, slot in members(type(self)):
        differs = getattr(self, name) != getattr(other, name)
        if any(differs) if number_of(slot) and isinstance(slot, idl.Array) else differs:
            return False
    return True


# What a field may be assigned ------------------------------------------------------------------


def _property(name: str, slot: Any, find: Find) -> property:
    own, number, is_array = f"_{name}", number_of(slot), isinstance(slot, idl.Array)
    conditions = _of_one(slot, find) if value_type(slot) is slot else _of_many(slot, find)
    stored: Any = np.ndarray if is_array else array.array
    words = f"The '{name}' {'numpy.ndarray' if is_array else 'array.array'}() must have "

    def put(self: Any, value: Any) -> None:
        is_stored = self._check_fields and number is not None and isinstance(value, stored)
        if is_stored:
            for holds, what in _of_stored(slot):
                assert holds(value), words + what
        elif self._check_fields:
            for holds, what in conditions:
                assert holds(value), f"The '{name}' field must be {what}"
        if number is not None and not is_stored:
            as_array, code = partial(np.array, dtype=number.dtype), number.code
            value = as_array(value) if is_array else array.array(code, value)
        setattr(self, own, value)

    return property(lambda self: getattr(self, own), put, doc=f"Message field '{name}'.")


def _of_stored(slot: Any) -> list[Condition]:
    """Return the conditions of an array that is stored as it is."""
    code, dtype = NUMBERS[slot.value_type.typename]
    if isinstance(slot, idl.Array):
        of_dtype, size = f"the dtype of 'numpy.{dtype.name}'", f"a size of {slot.size}"
        return [(lambda v: v.dtype == dtype, of_dtype), (lambda v: v.size == slot.size, size)]
    most = getattr(slot, "maximum_size", math.inf)
    of_code, size = f"the type code of '{code}'", f"a size <= {most}"
    return [(lambda v: v.typecode == code, of_code), (lambda v: len(v) <= most, size)]


def whole_range(typename: str) -> tuple[int, int]:
    """Return the least and the greatest value of a type of integers."""
    bits = int(typename.lstrip("uint"))
    return (0, 2**bits - 1) if typename[0] == "u" else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _in_range(value: Any, form: str) -> Condition:
    """Return whether a number is in the range of its type; no words for what has none."""
    typename = getattr(value, "typename", "octet")
    if typename in ("boolean", "octet"):
        return lambda each: True, ""
    if (most := _GREATEST.get(typename)) is not None:
        words = f"{typename} in [{-most:{form}}, {most:{form}}]"
        return lambda each: not (each < -most or each > most) or math.isinf(each), words
    low, high = whole_range(typename)
    words = f"{'unsigned ' if low == 0 else ''}integer in [{low}, {high}]"
    return lambda each: each >= low and each <= high, words


def _of_one(slot: Any, find: Find) -> list[Condition]:
    """Return the conditions of a single value."""
    if isinstance(slot, idl.NamespacedType):
        words = f"a sub message of type '{slot.name}'"
        return [(lambda value: isinstance(value, find(slot)), words)]
    if (most := getattr(slot, "maximum_size", None)) is not None:
        text, words = (str, UserString), f"string value not longer than {most}"
        return [(lambda value: isinstance(value, text) and len(value) <= most, words)]
    kind = _python_type(slot)
    if kind is bytes:
        octets, words = (bytes, bytearray), "of type 'bytes' or 'ByteString' with length 1"
        return [(lambda value: isinstance(value, octets) and len(value) == 1, words)]
    fits, limits = _in_range(slot, "")
    of_kind = (lambda value: isinstance(value, kind), f"of type '{kind.__name__}'")
    return [of_kind, (fits, f"{'an' if kind is int else 'a'} {limits}")]


def _of_many(slot: Any, find: Find) -> list[Condition]:
    """Return the condition of an array or a sequence: one after the other, as there."""
    value = value_type(slot)
    is_message = isinstance(value, idl.NamespacedType)
    kind: Any = None if is_message else _python_type(value)
    most, size = getattr(slot, "maximum_size", None), getattr(slot, "size", None)
    longest, (fits, limits) = getattr(value, "maximum_size", None), _in_range(value, "f")
    words = "a set or sequence"
    if slot.has_maximum_size():
        words += f" with length {size}" if most is None else f" with length <= {most}"
    if longest is not None:
        words += f" and each string value not longer than {longest}"
    words += f" and each value of type '{value.name if is_message else kind.__name__}'"
    words += f" and each {limits}" if limits else ""

    def holds(values: Any) -> bool:
        of_kind = find(value) if is_message else kind
        return (
            isinstance(values, (Sequence, Set, UserList))
            and not isinstance(values, (str, UserString))
            and (longest is None or all(len(each) <= longest for each in values))
            and (most is None or len(values) <= most)
            and (size is None or len(values) == size)
            and all(isinstance(each, of_kind) for each in values)
            and all(map(fits, values))
        )

    return [(holds, words)]
