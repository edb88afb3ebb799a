"""Message types by the definitions in a bag: their hashes there, and messages as plain data.

Needs no ROS, so that recordings are read anywhere, and is imported quickly.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from itertools import chain
from typing import Any, Final

import numpy as np

from grader.ros.cdr import NUMBERS, CdrReader, CdrWriter, Number
from grader.ros.fields import Field, lines, parse

#: Basic type -> how it is stored; None for a string.
_STORED: Final[dict[str, Number | None]] = {
    **{name: number for name, number in NUMBERS.items() if "int" in name},
    **{"float32": NUMBERS["float"], "float64": NUMBERS["double"], "string": None},
    **{"char": NUMBERS["uint8"], "byte": NUMBERS["uint8"], "bool": Number("?", np.dtype("?"))},
}
#: Basic type -> its number in a description of types; 1 is another message (REP 2016).
_IDS: Final = {
    **{"int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8},
    **{"uint64": 9, "float32": 10, "float64": 11, "char": 3, "bool": 15, "byte": 16, "string": 17},
}
#: ... of a string with a bound; what is added for arrays, sequences with a bound, and without.
_BOUNDED_STRING, _ARRAY, _BOUNDED, _UNBOUNDED = 21, 48, 96, 144
#: ROS's own types of scenes' bags, Jazzy's: where ROS is not sourced there may be no share/ to ask.
OF_ROS: Final = {
    "builtin_interfaces/msg/Duration": "int32 sec\nuint32 nanosec\n",
    "builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/msg/Float64": "float64 data\n",
    "std_msgs/msg/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "std_msgs/msg/String": "string data\n",
    "geometry_msgs/msg/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    "geometry_msgs/msg/Transform": "Vector3 translation\nQuaternion rotation\n",
    "geometry_msgs/msg/TransformStamped": "std_msgs/Header header\nstring child_frame_id\n"
    "Transform transform\n",
    "geometry_msgs/msg/Twist": "Vector3 linear\nVector3 angular\n",
    "geometry_msgs/msg/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "rcl_interfaces/msg/Log": "uint8 DEBUG=10\nuint8 INFO=20\nuint8 WARN=30\nuint8 ERROR=40\n"
    "uint8 FATAL=50\nbuiltin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\n"
    "string file\nstring function\nuint32 line\n",
    "sensor_msgs/msg/Image": "std_msgs/Header header\nuint32 height\nuint32 width\n"
    "string encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n",
    "sensor_msgs/msg/JointState": "std_msgs/Header header\nstring[] name\nfloat64[] position\n"
    "float64[] velocity\nfloat64[] effort\n",
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms\n",
    "turtlesim/msg/Color": "uint8 r\nuint8 g\nuint8 b\n",
    "turtlesim/msg/Pose": "float32 x\nfloat32 y\nfloat32 theta\nfloat32 linear_velocity\n"
    "float32 angular_velocity\n",
}
#: How many messages may be within each other.
_DEEPEST: Final = 64
_Read = Callable[[CdrReader], Any]
_ReadMany = Callable[[CdrReader, int], list[Any]]


def description(kind: str, text: str) -> list[Any]:
    """Return the fields of a definition as REP 2016 describes them, whatever their types hold."""
    return [
        _described(_qualified(line, kind)) if isinstance(line, Field) else line
        for line in lines(text)
        if isinstance(line, str) or line.value is None
    ]


def _qualified(field: Field, kind: str) -> Field:
    """Return a field of a type with the whole name of its own type."""
    if field.base in _IDS:
        return field
    package = field.package or kind.partition("/")[0]
    return field._replace(base=f"{package}/msg/{field.base.rpartition('/')[2]}")


def _described(field: Field) -> dict[str, Any]:
    number = _BOUNDED_STRING if field.longest else _IDS.get(field.base, 1)
    if field.array:
        number += _BOUNDED if "<" in field.array else _ARRAY if field.size else _UNBOUNDED
    facts = {"type_id": number, "capacity": field.size, "string_capacity": field.longest}
    nested = "" if field.base in _IDS else field.base
    return {"name": field.name, "type": {**facts, "nested_type_name": nested}}


#: What stands for the fields of an empty message.
_NO_FIELDS: Final = (Field("structure_needs_at_least_one_member", "uint8"),)


class BagTypes:
    """The types of a bag; methods raise ValueError where a definition is missing or damaged.

    Args:
        texts: type, 'my_interfaces/msg/Num' -> its definition; also of the types of its fields.
            Some of ROS's own need none.
    """

    def __init__(self, texts: Mapping[str, str]) -> None:
        self._texts = {**OF_ROS, **texts}
        #: type -> the lines of its constants, and its fields
        self._parsed: dict[str, tuple[list[str], list[Field]]] = {}
        self._readers: dict[str, _Read] = {}

    def definition(self, kind: str) -> str:
        """Return the definition of a type and of all in it, as readers of bags expect them."""
        made: list[str] = []
        for name in self._within(kind, {}):
            constants, fields = self._parse(name)
            text = "".join([*constants, *(f"{_short(f.type)} {f.name}\n" for f in fields)])
            made.append(f"MSG: {_short(name)}\n{text}" if made else text)
        return f"{'=' * 80}\n".join(made)

    def type_hash(self, kind: str) -> str:
        """Return the hash of a type: RIHS01, of REP 2016."""
        types = {
            name: {
                "type_name": name,
                "fields": [_described(each) for each in self._parse(name)[1] or _NO_FIELDS],
            }
            for name in sorted(self._within(kind, {}))
        }
        first, others = types.pop(kind), list(types.values())
        whole = {"type_description": first, "referenced_type_descriptions": others}
        return f"RIHS01_{hashlib.sha256(json.dumps(whole).encode()).hexdigest()}"

    def values(self, data: bytes, kind: str) -> Any:
        """Return a message, in CDR, as plain data: objects with fields, lists, numbers, texts."""
        return self._reader(kind, 0)(CdrReader(data))

    def data(self, kind: str, values: Mapping[str, Any]) -> bytes:
        """Return the CDR of a message of plain data, which has all its fields."""
        out = CdrWriter()
        self._write(out, Field("", kind), values)
        return out.message()

    def _write(self, out: CdrWriter, field: Field, value: Any) -> None:
        number = _STORED.get(field.base)
        if field.array:
            if "<" in field.array or not field.size:
                out.number("I", len(value))
            if number is not None:
                out.array(value, number.dtype)
            else:
                for each in value:
                    self._write(out, field._replace(array=""), each)
        elif field.base not in _IDS:
            for inner in self._parse(field.base)[1]:
                self._write(out, inner, value[inner.name])
        elif number is None:
            out.text(value)
        else:
            out.number(number.code, value)

    def _parse(self, kind: str) -> tuple[list[str], list[Field]]:
        if kind not in self._parsed:
            if kind not in self._texts:
                raise ValueError(f"there is no definition of {kind}")
            constants, fields = self._parsed[kind] = [], []
            for each in chain(*parse(self._texts[kind])):
                if each.value is not None:
                    constants.append(f"{each.base} {each.name}={each.value}\n")
                else:
                    fields.append(_qualified(each, kind))
        return self._parsed[kind]

    def _within(self, kind: str, found: dict[str, None]) -> dict[str, None]:
        """Return a type and all types in it, in the order in which they are met."""
        if kind not in found:
            found[kind] = None
            for field in self._parse(kind)[1]:
                if field.base not in _IDS:
                    self._within(field.base, found)
        return found

    def _reader(self, kind: str, depth: int) -> _Read:
        if depth > _DEEPEST:
            raise ValueError(f"expected at most {_DEEPEST} messages within each other")
        if kind not in self._readers:
            fields = self._parse(kind)[1]
            names = [field.name for field in fields]
            readers = [self._field_reader(field, depth) for field in fields or _NO_FIELDS]
            self._readers[kind] = lambda read: dict(
                zip(names, [one(read) for one in readers], strict=False)
            )
        return self._readers[kind]

    def _field_reader(self, field: Field, depth: int) -> _Read:
        if field.base not in _IDS:
            one, many = _one_by_one(self._reader(field.base, depth + 1))
        elif (number := _STORED[field.base]) is None:
            one, many = _one_by_one(CdrReader.text)
        else:
            one, many = _numbers(*number)
        if not field.array:
            return one
        if field.size and "<" not in field.array:
            return lambda read: many(read, field.size)
        return lambda read: many(read, read.count())


def _numbers(code: str, dtype: np.dtype[Any]) -> tuple[_Read, _ReadMany]:
    """Return what reads one number, and what reads several."""
    return lambda read: read.number(code), lambda read, count: read.array(count, dtype).tolist()


def _one_by_one(one: _Read) -> tuple[_Read, _ReadMany]:
    return one, lambda read, count: [one(read) for _ in range(count)]


def _short(kind: str) -> str:
    """Return a type's name as it stands in a definition: 'std_msgs/String'."""
    return kind.replace("/msg/", "/")
