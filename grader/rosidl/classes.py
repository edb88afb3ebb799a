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

from grader.rosidl.cdr import installed, members, module_of, number_of, value_type

#: The class of a field's type; asked when a message is made.
Find = Callable[[Any], Any]
#: Whether a value is one, and what it must be.
Condition = tuple[Callable[[Any], bool], str]
#: Makes a class's type support (`handles`); in virtual time only.
make_support: Callable[[Any], Any] | None = None
#: The generator's own bounds; the first is not quite the greatest float32.
_GREATEST: Final = {"float": 3.402823466e38, "double": 1.7976931348623157e308}
_PYTHON: Final = {"boolean": bool, "octet": bytes, "float": float, "double": float}


# Types -----------------------------------------------------------------------------------------


def python_type(value: Any) -> Any:
    """Return the Python type of a value that is no message."""
    is_text = isinstance(value, idl.AbstractGenericString)
    return str if is_text else _PYTHON.get(value.typename, int)


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
    if isinstance(slot, idl.BoundedSequence):
        return f"sequence<{text}, {slot.maximum_size}>"
    return f"sequence<{text}>" if isinstance(slot, idl.AbstractSequence) else text


def parts(element: Any) -> list[Any]:
    """Return the messages of a message, a service or an action."""
    if isinstance(element, idl.Message):
        return [element]
    if isinstance(element, idl.Service):
        return [element.request_message, element.response_message, element.event_message]
    services = parts(element.send_goal_service) + parts(element.get_result_service)
    return [element.goal, element.result, element.feedback, *services, element.feedback_message]


def type_hash(kind: Any) -> str:
    """Return the hash of a message, a service or an action, made or compiled: RIHS01, of REP-2011.

    Takes a tenth of a second the first time, for what it imports.
    """
    import rosidl_generator_type_description as rihs

    find = getattr(type(kind), "_find", installed)
    add = {idl.Message: rihs.add_msg, idl.Service: rihs.add_srv, idl.Action: rihs.add_action}
    known: dict[str, Any] = {}
    waiting = [kind]
    while waiting:
        element = _element(waiting.pop())
        add[type(element)](element, known)
        for each in parts(element):
            for value in (value_type(member.type) for member in each.structure.members):
                if isinstance(value, idl.NamespacedType) and rihs.to_type_name(value) not in known:
                    waiting.append(find(value))
    own = rihs.to_type_name(_named(kind))
    described = {
        name: rihs.serialize_individual_type_description(each.namespaced_type, each.members)
        for name, each in known.items()
    }
    return str(rihs.calculate_type_hash(rihs.extract_full_type_description(own, described)))


def _named(kind: Any) -> Any:
    return idl.NamespacedType(kind.__module__.split(".")[:2], kind.__name__)


def _element(kind: Any) -> Any:
    """Return what a class was made of, but for constants and defaults."""
    if hasattr(kind, "Request"):
        return idl.Service(_named(kind), *map(_element, (kind.Request, kind.Response)))
    if hasattr(kind, "Goal"):
        return idl.Action(_named(kind), *map(_element, (kind.Goal, kind.Result, kind.Feedback)))
    filler = idl.Member(idl.BasicType("uint8"), "structure_needs_at_least_one_member")
    fields = [idl.Member(slot, name) for name, slot in members(kind)]
    return idl.Message(idl.Structure(_named(kind), fields or [filler]))


# Classes ---------------------------------------------------------------------------------------


def classes_of(element: Any, find: Find) -> dict[str, Any]:
    """Make the classes of an interface, by the names in their module.

    Args:
        element: a Message, Service or Action of `rosidl_parser.definition`. A member's annotation
            `default` has its default value as Python's; empty messages have no member.
    """
    first = parts(element)[0].structure.namespaced_type
    made: dict[str, Any] = {}

    def make(name: str, meta: dict[str, Any], own: dict[str, Any]) -> None:
        def import_type_support(cls: Any) -> None:
            cls._TYPE_SUPPORT = make_support and make_support(made[name])

        meta |= {
            "__module__": module_of(first),
            "__import_type_support__": classmethod(import_type_support),
            "_TYPE_SUPPORT": None,
            "_find": staticmethod(find),
        }
        own |= {"__module__": module_of(first), "__qualname__": name}
        made[f"Metaclass_{name}"] = type(f"Metaclass_{name}", (type,), meta)
        made[name] = made[f"Metaclass_{name}"](name, (), own)

    def make_service(service: Any) -> None:
        name = service.namespaced_type.name
        own = {part: made[f"{name}_{part}"] for part in ("Request", "Response", "Event")}
        make(name, {}, own | {"__init__": _refusing("Service")})

    for message in parts(element):
        make(message.structure.namespaced_type.name, *_message(message, find))
    if isinstance(element, idl.Service):
        make_service(element)
    elif isinstance(element, idl.Action):
        make_service(element.send_goal_service)
        make_service(element.get_result_service)
        name = element.namespaced_type.name
        inner = {
            "SendGoalService": made[f"{name}_SendGoal"],
            "GetResultService": made[f"{name}_GetResult"],
            "FeedbackMessage": made[f"{name}_FeedbackMessage"],
            "CancelGoalService": find(idl.NamespacedType(["action_msgs", "srv"], "CancelGoal")),
            "GoalStatusMessage": find(
                idl.NamespacedType(["action_msgs", "msg"], "GoalStatusArray")
            ),
            "__module__": module_of(first),
            "__qualname__": f"{name}.Impl",
        }
        own = {part: made[f"{name}_{part}"] for part in ("Goal", "Result", "Feedback")}
        own |= {"Impl": type("Impl", (), inner), "__init__": _refusing("Action")}
        make(name, {}, own)
    return made


def _refusing(what: str) -> Callable[[Any], None]:
    def refuse(self: Any) -> None:
        raise NotImplementedError(f"{what} classes can not be instantiated")

    return refuse


def _message(message: idl.Message, find: Find) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the attributes of a message's metaclass and of its class."""
    fields = {member.name: member.type for member in message.structure.members}
    # a default may be changed in place: it is made anew
    makers = {constant.name: partial(copy, constant.value) for constant in message.constants}
    firsts: dict[str, Callable[[], Any]] = {}
    codes = {}  # of sequences that are made of whatever is given
    for member in message.structure.members:
        if member.has_annotation("default"):
            default = member.get_annotation_value("default")
            firsts[member.name] = makers[f"{member.name.upper()}__DEFAULT"] = partial(copy, default)
        else:
            firsts[member.name] = _first(member.type, find)
            number = number_of(member.type)
            if number is not None and isinstance(member.type, idl.AbstractSequence):
                codes[member.name] = number.code
    names = ("_CREATE_ROS_MESSAGE", "_CONVERT_FROM_PY", "_CONVERT_TO_PY", "_DESTROY_ROS_MESSAGE")
    # which C cannot call
    meta = dict.fromkeys(names, "none") | {name: _constant(maker) for name, maker in makers.items()}
    return meta, {
        **{name: maker() for name, maker in makers.items()},
        "__doc__": f"Message class '{message.structure.namespaced_type.name}'.",
        "__slots__": [*(f"_{name}" for name in fields), "_check_fields"],
        "_fields_and_field_types": {name: described(slot) for name, slot in fields.items()},
        "SLOT_TYPES": tuple(fields.values()),
        "__init__": _constructor(firsts, codes),
        "__repr__": _repr,
        "__eq__": _equal,
        "get_fields_and_field_types": classmethod(lambda cls: copy(cls._fields_and_field_types)),
        **{name: _property(name, slot, find) for name, slot in fields.items()},
    }


def _constant(maker: Callable[[], Any]) -> property:
    return property(lambda cls: maker())


def _first(slot: Any, find: Find) -> Callable[[], Any]:
    """Return what makes a field's value where none is given."""
    if isinstance(slot, idl.AbstractSequence):
        return list
    if isinstance(slot, idl.Array):
        number = number_of(slot)
        if number is not None:
            return partial(np.zeros, slot.size, dtype=number.dtype)
        one = _first(slot.value_type, find)
        return lambda: [one() for _ in range(slot.size)]
    if isinstance(slot, idl.NamespacedType):
        return lambda: find(slot)()
    kind: Callable[[], Any] = python_type(slot)
    return partial(bytes, 1) if kind is bytes else kind


def _constructor(
    firsts: dict[str, Callable[[], Any]], codes: dict[str, str]
) -> Callable[..., None]:
    are_checked = os.getenv("ROS_PYTHON_CHECK_FIELDS", "") == "1"

    def construct(self: Any, **kwargs: Any) -> None:
        self._check_fields = kwargs.get("check_fields", are_checked)
        if self._check_fields:
            wrong = sorted(key for key in kwargs if "_" + key not in self.__slots__)
            assert not wrong, f"Invalid arguments passed to constructor: {', '.join(wrong)}"
        for name, first in firsts.items():
            value = kwargs[name] if name in kwargs else first()
            setattr(self, name, array.array(codes[name], value) if name in codes else value)

    return construct


def _property(name: str, slot: Any, find: Find) -> property:
    own, number, is_array = f"_{name}", number_of(slot), isinstance(slot, idl.Array)
    conditions = _of_many(slot, find) if value_type(slot) is not slot else _of_one(slot, find)

    def get(self: Any) -> Any:
        return getattr(self, own)

    def put(self: Any, value: Any) -> None:
        if self._check_fields:
            if _is_stored(name, slot, value):
                setattr(self, own, value)
                return
            for holds, words in conditions:
                assert holds(value), f"The '{name}' field must be {words}"
        if number is not None and is_array:
            value = np.array(value, dtype=number.dtype)
        elif number is not None:
            value = array.array(number.code, value)
        setattr(self, own, value)

    return property(get, put, doc=f"Message field '{name}'.")


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


def _range(value: Any, form: str) -> Condition | None:
    """Return whether a number is in the range of its type."""
    if not isinstance(value, idl.BasicType) or value.typename in ("boolean", "octet"):
        return None
    if (most := _GREATEST.get(value.typename)) is not None:
        words = f"{value.typename} in [{-most:{form}}, {most:{form}}]"
        return lambda each: not (each < -most or each > most) or math.isinf(each), words
    low, high = whole_range(value.typename)
    words = f"{'unsigned ' if low == 0 else ''}integer in [{low}, {high}]"
    return lambda each: each >= low and each <= high, words


def whole_range(typename: str) -> tuple[int, int]:
    """Return the least and the greatest value of a type of integers."""
    bits = int(typename.lstrip("uint"))
    return (0, 2**bits - 1) if typename[0] == "u" else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _of_one(slot: Any, find: Find) -> list[Condition]:
    if isinstance(slot, idl.NamespacedType):
        words = f"a sub message of type '{slot.name}'"
        return [(lambda value: isinstance(value, find(slot)), words)]
    if (most := getattr(slot, "maximum_size", None)) is not None:
        texts, words = (str, UserString), f"string value not longer than {most}"
        return [(lambda value: isinstance(value, texts) and len(value) <= most, words)]
    kind = python_type(slot)
    if kind is bytes:
        octets, words = (bytes, bytearray), "of type 'bytes' or 'ByteString' with length 1"
        return [(lambda value: isinstance(value, octets) and len(value) == 1, words)]
    conditions: list[Condition] = [
        (lambda value: isinstance(value, kind), f"of type '{kind.__name__}'")
    ]
    if (fits := _range(slot, "")) is not None:
        conditions.append((fits[0], f"{'an' if kind is int else 'a'} {fits[1]}"))
    return conditions


def _of_many(slot: Any, find: Find) -> list[Condition]:
    """Return the condition of an array or a sequence: one after the other, as there."""
    value = value_type(slot)
    is_message = isinstance(value, idl.NamespacedType)
    kind: Any = None if is_message else python_type(value)
    most, size = getattr(slot, "maximum_size", None), getattr(slot, "size", None)
    longest, fits = getattr(value, "maximum_size", None), _range(value, "f")
    words = ["a set or sequence"]
    if slot.has_maximum_size():
        words.append(f"with length {size}" if most is None else f"with length <= {most}")
    if longest is not None:
        words.append(f"and each string value not longer than {longest}")
    words.append(f"and each value of type '{value.name if is_message else kind.__name__}'")
    words += [] if fits is None else [f"and each {fits[1]}"]

    def many(values: Any) -> bool:
        of_kind = find(value) if is_message else kind
        return (
            isinstance(values, (Sequence, Set, UserList))
            and not isinstance(values, (str, UserString))
            and (longest is None or all(len(each) <= longest for each in values))
            and (most is None or len(values) <= most)
            and (size is None or len(values) == size)
            and all(isinstance(each, of_kind) for each in values)
            and (fits is None or all(fits[0](each) for each in values))
        )

    return [(many, " ".join(words))]


def _is_stored(name: str, slot: Any, value: Any) -> bool:
    """Check an array that is stored as it is; False for any other value."""
    number = number_of(slot)
    if number is None:
        return False
    if isinstance(slot, idl.Array):
        if not isinstance(value, np.ndarray):
            return False
        where, dtype = f"The '{name}' numpy.ndarray() must have", f"numpy.{number.dtype.name}"
        assert value.dtype == number.dtype, f"{where} the dtype of '{dtype}'"
        assert value.size == slot.size, f"{where} a size of {slot.size}"
        return True
    if not isinstance(value, array.array):
        return False
    where, code = f"The '{name}' array.array() must have", number.code
    assert value.typecode == code, f"{where} the type code of '{code}'"
    if isinstance(slot, idl.BoundedSequence):
        most = slot.maximum_size
        assert len(value) <= most, f"{where} a size <= {most}"
    return True
