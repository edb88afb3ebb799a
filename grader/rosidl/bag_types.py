"""Message types by the definitions in a bag: their hashes there, and messages as plain data.

Needs no ROS, so that recordings are read anywhere, and is imported quickly. `definitions` knows the
whole language, by ROS's own parser.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

import numpy as np

from grader.rosidl.cdr import NUMBERS, CdrReader, Number

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
#: A type with its bounds, a name, and of a constant its value.
_LINE: Final = re.compile(
    r"([A-Za-z][\w/]*)(?:<=(\d+))?(\[(?:<=)?(\d*)\])?[ \t]+([A-Za-z]\w*)[ \t]*(?:=[ \t]*(.*))?"
)
#: What every definition may use.
_ALWAYS: Final = {
    f"builtin_interfaces/msg/{name}": "int32 sec\nuint32 nanosec\n" for name in ("Time", "Duration")
}
#: How many messages may be within each other.
_DEEPEST: Final = 64
_Read = Callable[[CdrReader], Any]
_ReadMany = Callable[[CdrReader, int], list[Any]]


class _Field(NamedTuple):
    """A field of a message.

    Attributes:
        base: its type without bounds: 'float64', 'geometry_msgs/msg/Point'.
        longest: the bound of a string; 0 for none.
        array: '', '[]', '[3]' or '[<=3]'.
        size: that number; 0 for none.
    """

    name: str
    base: str
    longest: int = 0
    array: str = ""
    size: int = 0

    def line(self) -> str:
        """Return its line in a definition."""
        bound = f"<={self.longest}" if self.longest else ""
        return f"{_short(self.base)}{bound}{self.array} {self.name}\n"

    def described(self) -> dict[str, Any]:
        number = _BOUNDED_STRING if self.longest else _IDS.get(self.base, 1)
        if self.array:
            number += _BOUNDED if "<" in self.array else _ARRAY if self.size else _UNBOUNDED
        facts = {"type_id": number, "capacity": self.size, "string_capacity": self.longest}
        nested = "" if self.base in _IDS else self.base
        return {"name": self.name, "type": {**facts, "nested_type_name": nested}}


#: What stands for the fields of an empty message.
_NO_FIELDS: Final = (_Field("structure_needs_at_least_one_member", "uint8"),)


class BagTypes:
    """The types of a bag; methods raise ValueError where a definition is missing or damaged.

    Args:
        texts: type, 'std_msgs/msg/String' -> its definition; also of the types of its fields.
    """

    def __init__(self, texts: Mapping[str, str]) -> None:
        self._texts = {**_ALWAYS, **texts}
        #: type -> the lines of its constants, and its fields
        self._parsed: dict[str, tuple[list[str], list[_Field]]] = {}
        self._readers: dict[str, _Read] = {}

    def definition(self, kind: str) -> str:
        """Return the definition of a type and of all in it, as readers of bags expect them."""
        made: list[str] = []
        for name in self._within(kind, {}):
            constants, fields = self._parse(name)
            lines = "".join([*constants, *(field.line() for field in fields)])
            made.append(f"MSG: {_short(name)}\n{lines}" if made else lines)
        return f"{'=' * 80}\n".join(made)

    def type_hash(self, kind: str) -> str:
        """Return the hash of a type: RIHS01, of REP 2016."""
        types = {
            name: {
                "type_name": name,
                "fields": [each.described() for each in self._parse(name)[1] or _NO_FIELDS],
            }
            for name in sorted(self._within(kind, {}))
        }
        first, others = types.pop(kind), list(types.values())
        whole = {"type_description": first, "referenced_type_descriptions": others}
        return f"RIHS01_{hashlib.sha256(json.dumps(whole).encode()).hexdigest()}"

    def values(self, data: bytes, kind: str) -> Any:
        """Return a message, in CDR, as plain data: objects with fields, lists, numbers, texts."""
        return self._reader(kind, 0)(CdrReader(data))

    def _parse(self, kind: str) -> tuple[list[str], list[_Field]]:
        if kind not in self._parsed:
            if kind not in self._texts:
                raise ValueError(f"there is no definition of {kind}")
            constants, fields = self._parsed[kind] = [], []
            lines = (line.partition("#")[0].strip() for line in self._texts[kind].splitlines())
            for line in filter(None, lines):
                if (found := _LINE.match(line)) is None:
                    raise ValueError(f"{kind}: expected a type and a name, found {line!r:.80}")
                base, longest, array, size, name, value = found.groups()
                if value is not None:
                    constants.append(f"{base} {name}={value}\n")
                    continue
                if base not in _IDS:
                    package = base if "/" in base else kind
                    base = f"{package.split('/')[0]}/msg/{base.split('/')[-1]}"
                bounds = int(longest or 0), array or "", int(size or 0)
                fields.append(_Field(name, base, *bounds))
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

    def _field_reader(self, field: _Field, depth: int) -> _Read:
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
