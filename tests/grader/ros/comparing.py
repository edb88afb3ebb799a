"""Compares made classes with those that rosidl_generator_py has written and a compiler built."""

import array
from collections import UserList, UserString
from functools import partial

import numpy as np
import rosidl_parser.definition as idl
from rclpy.serialization import deserialize_message, serialize_message

from grader.ros.classes import whole_range
from grader.ros.messages import (
    deserialise,
    member_class,
    members,
    number_of,
    serialise,
    value_type,
)

#: What no field, or not every field, takes.
WRONG = (
    *(None, 1, -1, 0, 2.5, 10**20, -(10**20), 1e39, float("inf"), float("nan"), True, "", "x"),
    *("é" * 300, b"a", b"ab", b"", bytearray(b"a"), memoryview(b"a"), (), (1, 2, 3), [1], [-1]),
    *([2.5, -3, 10**20], ["s"], ["x" * 300] * 2, [b"a"], [True, False], [None], [[1]], {1}, {1: 2}),
    *([1] * 300, range(3), object, UserString("x"), UserList([1, 2]), UserList(["x"])),
    *(array.array("i", [1]), array.array("d", [1.0] * 9), array.array("B", b"abc")),
    *(np.zeros(3), np.zeros(3, np.int8), np.zeros(300, np.float32), np.zeros((2, 2))),
    *(np.int32(3), np.float32(3), np.bool_(True)),
)
TEXTS = "abcé z\t雪🐢'\"\\"


def parts(kind):
    """Everything that is a class of messages in a class of an interface."""
    if hasattr(kind, "SLOT_TYPES"):
        yield "", kind
        return
    names = ("Request", "Response", "Event", "Goal", "Result", "Feedback", "Impl")
    names += ("SendGoalService", "GetResultService", "FeedbackMessage")
    names += ("CancelGoalService", "GoalStatusMessage")
    yield "", kind
    for name in names:
        if hasattr(kind, name):
            for path, part in parts(getattr(kind, name)):
                yield f"{name}.{path}", part


def random_message(kind, rng):
    return kind(**{name: random_value(kind, slot, rng) for name, slot in members(kind)})


def random_value(kind, slot, rng):
    if isinstance(slot, idl.AbstractNestedType):
        most = min(4, getattr(slot, "maximum_size", 4))
        count = slot.size if isinstance(slot, idl.Array) else rng.randint(0, most)
        values = [random_value(kind, slot.value_type, rng) for _ in range(count)]
        number = number_of(slot)
        if number is None:
            return values
        if isinstance(slot, idl.Array):
            return np.array(values, number.dtype)
        return array.array(number.code, values)
    if isinstance(slot, idl.NamespacedType):
        return random_message(member_class(kind, slot), rng)
    if isinstance(slot, idl.AbstractGenericString):
        text = "".join(rng.choice(TEXTS) for _ in range(rng.randint(0, 6)))
        return text[: getattr(slot, "maximum_size", 6)]
    if slot.typename == "boolean":
        return rng.random() < 0.5
    if slot.typename == "octet":
        return bytes([rng.randrange(256)])
    if slot.typename == "float":
        return float(np.float32(rng.uniform(-1e3, 1e3)))
    if slot.typename == "double":
        return rng.uniform(-1e300, 1e300)
    return rng.choice([*whole_range(slot.typename), rng.randint(*whole_range(slot.typename))])


def remade(message, kind):
    """The message as one of another class with the same fields."""

    def value(found, slot):
        inner = value_type(slot)
        if isinstance(inner, idl.NamespacedType):
            own = member_class(kind, inner)
            return (
                [remade(each, own) for each in found] if inner is not slot else remade(found, own)
            )
        return found

    return kind(**{name: value(getattr(message, name), slot) for name, slot in members(kind)})


def outcome(call):
    try:
        return repr(call())
    except Exception as error:
        # pytest adds lines to assertions in a module that is called _self_test
        return f"{type(error).__name__}: {error}".partition("\n")[0]


def assigned(message, name, value):
    setattr(message, name, value)
    return getattr(message, name)


def _attributes(kind):
    names = [name for name in dir(type(kind)) if name.isupper() and not name.startswith("_")]
    return {
        **{f"class {name}": repr(getattr(kind, name)) for name in names},
        **{name: repr(getattr(kind(), name)) for name in names},
        **{f"type {name}": type(getattr(kind, name)).__name__ for name in names},
    }


def differences(real, made, rng, compared):
    """What differs between two classes of an interface, but for those compared before."""
    of_real, of_made = list(parts(real)), list(parts(made))
    yield from unequal("parts", [path for path, _ in of_real], [path for path, _ in of_made])
    for (path, one), (_, other) in zip(of_real, of_made, strict=True):
        if one in compared:
            continue
        compared.add(one)
        for each in _differences(one, other, rng):
            yield (path, *each)


def unequal(what, one, other):
    if one != other:
        yield what, str(one)[:300], str(other)[:300]


def _differences(real, made, rng):
    for name in ("__name__", "__qualname__", "__module__"):
        yield from unequal(name, getattr(real, name), getattr(made, name))
        yield from unequal(f"meta {name}", getattr(type(real), name), getattr(type(made), name))
    if not hasattr(real, "SLOT_TYPES"):
        if not hasattr(real, "SendGoalService"):  # an action's Impl
            yield from unequal("instance", outcome(real), outcome(made))
        return
    for name in ("_fields_and_field_types", "SLOT_TYPES", "__slots__", "__hash__"):
        yield from unequal(name, getattr(real, name), getattr(made, name))
    fields = [kind.get_fields_and_field_types() for kind in (real, made)]
    yield from unequal("fields", *fields)
    yield from unequal("order", *map(list, fields))
    yield from unequal("attributes", _attributes(real), _attributes(made))
    yield from unequal("default", repr(real()), repr(made()))
    yield from unequal("is equal", real() == real(), made() == made())
    yield from unequal(
        "fields of wrong names", *(outcome(lambda k=k: k(a_=1)) for k in (real, made))
    )
    for _ in range(3):
        message = random_message(real, rng)
        again = remade(message, made)
        yield from unequal("repr", repr(message), repr(again))
        data, own = serialize_message(message), serialise(again)
        # the compiled ones of bounded size have a tail of leftovers
        yield from unequal("shorter", False, len(data) < len(own))
        yield from unequal("made by theirs", message, deserialize_message(own, real))
        yield from unequal("made by ours", again, deserialise(data, made))
        yield from unequal("compiled by ours", message, deserialise(own, real))
        yield from unequal("ours of theirs", own, serialise(message))
        yield from unequal("theirs again", own, serialise(deserialise(data, made)))
        other = random_message(real, rng)
        equal = [message == other, again == remade(other, made)]
        yield from unequal("equality", *equal)
    for checked in (True, False):
        both = [kind(check_fields=checked) for kind in (real, made)]
        for name in fields[0]:
            for value in WRONG:
                found = [outcome(partial(assigned, each, name, value)) for each in both]
                if found[0] != found[1]:
                    yield (f"{name} = {value!r:.40}", *found)
    for name, slot in members(real):
        for value in WRONG if number_of(slot) is not None else WRONG[:1]:
            found = [outcome(partial(k, **{name: value})) for k in (real, made)]
            if found[0] != found[1]:
                yield (f"({name}={value!r:.40})", *found)
