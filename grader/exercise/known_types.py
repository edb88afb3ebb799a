"""The types that are known when an exercise is read: what it says of messages has to fit them.

They are the exercise's own and those of installed packages; any other a hand-in may bring, and then
nothing is checked.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from grader.exercise.comparing import is_number, is_range
from grader.ros.fields import Field, parse
from grader.scenes.cast import script
from grader.system.expressions import ExpressionError, filled, is_pattern
from grader.system.yaml_file import Mistake
from grader.text.message import msg
from grader.text.strings import nearest

#: The parts of a definition, which lines of --- separate.
_PARTS: Final = {"request": 0, "response": 1, "goal": 0, "result": 1, "feedback": 2}
_WHOLE: Final = re.compile(r"u?int(8|16|32|64)|byte|char")
#: What a peer says, by its kind -> the part of the definition that it is, and the one whose fields
#: its expressions may use, with more names; None for what is no message, or for no such fields.
_SAID: Final[Mapping[str, Mapping[str, tuple[str | None, str | None, set[str]]]]] = {
    "publishers": {"message": ("", None, set()), "messages": ("", None, set())},
    "services": {"response": ("response", "request", {"request", "n"})},
    "calls": {"request": ("request", None, set())},
    "goals": {"goal": ("goal", None, set())},
    "actions": {
        "accepts": (None, "goal", {"goal"}),
        "feedback": ("feedback", "goal", {"goal", "n"}),
        "result": ("result", "goal", {"goal"}),
    },
}


class KnownTypes:
    """The fields of types.

    Args:
        definitions: the exercise's own types: 'my_interfaces/msg/Num' -> the definition.
    """

    def __init__(self, definitions: Mapping[str, str]) -> None:
        self._definitions = definitions

    def expect(self, name: str, at: tuple[str, ...]) -> None:
        """Expect a type of a known package to be there.

        Raises:
            Mistake: it is not.
        """
        package, kind, _ = name.split("/")
        known = [each for each in self._definitions if each.startswith(f"{package}/")]
        known = known or [*_installed(package, kind)]
        if not known or name in known:
            return
        near = ", ".join(nearest(name, known) or known[:3])
        raise Mistake(
            at, msg("{package} has no {type}; it has {near}", package=package, type=name, near=near)
        )

    def fields(self, name: str, part: str = "") -> dict[str, Field]:
        """Return the fields of a type by their names; none where it is not known.

        Args:
            part: of a service or an action: `request`, `response`, `goal`, `result`, `feedback`.
        """
        own = self._definitions.get(name)
        parts = parse(_definition(name) if own is None else own)[_PARTS.get(part, 0) :]
        return {field.name: field for field in next(iter(parts), []) if field.value is None}

    def check(
        self, values: Any, name: str, part: str, at: tuple[str, ...], *, is_expected: bool = False
    ) -> None:
        """Check the values of a message.

        Args:
            is_expected: whether they may be ranges and patterns.

        Raises:
            Mistake: it has no such field, or a value does not fit.
        """
        fields = self.fields(name, part)
        if not fields or values in (None, {}) or _is_open(values, is_expected=is_expected):
            return
        if not isinstance(values, Mapping):
            if len(fields) != 1:
                what = "expected values of {fields}, found {found}"
                raise Mistake(at, what, fields=", ".join(fields), found=repr(values)[:80])
            values = {next(iter(fields)): values}
        for field, value in values.items():
            here = (*at, str(field))
            if field not in fields:
                what = "{type} has no field {name}, only {fields}"
                words = {"type": name, "name": field, "fields": ", ".join(fields)}
                raise Mistake(here, what, **words)
            self._check(value, fields[field], name, here, is_expected=is_expected)

    def _check(
        self, value: Any, field: Field, within: str, at: tuple[str, ...], *, is_expected: bool
    ) -> None:
        """Check the value of a field of a type that stands in another."""
        if _is_open(value, is_expected=is_expected):
            return
        if field.array:
            if not isinstance(value, list):
                raise Mistake(at, "expected a list, found {found}", found=repr(value)[:80])
            for n, each in enumerate(value):
                element = field._replace(array="")
                self._check(each, element, within, (*at, str(n)), is_expected=is_expected)
            return
        base = field.base
        if base in ("string", "wstring"):
            fits, wanted = isinstance(value, str), msg("a text")
        elif base == "bool":
            fits, wanted = isinstance(value, bool), msg("true or false")
        elif base in ("float32", "float64") or (is_expected and _WHOLE.fullmatch(base)):
            fits, wanted = is_number(value), msg("a number")
        elif _WHOLE.fullmatch(base):
            bounds = np.iinfo("uint8" if base in ("byte", "char") else base)
            fits = type(value) is int and bounds.min <= value <= bounds.max
            words = {"low": str(bounds.min), "high": str(bounds.max)}
            wanted = msg("a whole number from {low} to {high}", **words)
        elif not isinstance(value, Mapping) and not is_expected:
            fits, wanted = False, msg("fields with values")
        else:
            self.check(value, _inner(field, within), "", at, is_expected=is_expected)
            return
        if not fits:
            what = "expected {wanted}, since it is a {type}; found {found}"
            raise Mistake(at, what, wanted=wanted, type=field.type, found=repr(value)[:80])

    def check_each(
        self,
        said: Iterable[Any],
        types: Sequence[str],
        part: str,
        at: tuple[str, ...],
        asked: str | None = None,
        *,
        is_expected: bool = False,
    ) -> None:
        """Check values of messages that may have one of several types.

        Args:
            asked: the part whose fields expressions may use: each is tried with an example.

        Raises:
            Mistake: one fits none of them.
        """
        for values in said:
            faults = []
            for each in types:
                fields = self._examples(each, asked) if asked else {}
                names = {"n": 1, "t": 0.5, **fields, asked or "": fields}
                tried = values
                with suppress(ExpressionError):  # else they need what only a run has
                    tried = filled(values, names)
                try:
                    self.check(tried, each, part, at, is_expected=is_expected)
                except Mistake as fault:
                    faults.append(fault)
            if len(faults) == len(types) > 0:
                raise faults[0]

    def _examples(self, name: str, part: str = "") -> dict[str, Any]:
        """Return a value of each field of a type."""
        fields = self.fields(name, part).values()
        return {field.name: self._example(field, name) for field in fields}

    def _example(self, field: Field, within: str) -> Any:
        if field.array:
            return [self._example(field._replace(array=""), within)] * (field.size or 3)
        if _WHOLE.fullmatch(field.base):
            return 1
        known = {"string": "a", "wstring": "a", "bool": True, "float32": 1.5, "float64": 1.5}
        found = known.get(field.base)
        return self._examples(_inner(field, within)) if found is None else found

    def check_names(
        self, said: Any, types: Iterable[str], part: str, more: set[str], at: tuple[str, ...]
    ) -> None:
        """Check that expressions use the fields of a part of a type, or some more names.

        Raises:
            Mistake: one uses another.
        """
        fields = [self.fields(each, part) for each in types]
        if all(fields):
            script.check_templates(said, more.union(*fields), at, has_patterns=True)


def check_cast(
    peers: Mapping[str, script.Peer], known: KnownTypes, end_s: float, keys: tuple[str, ...]
) -> None:
    """Check the types and the times of a cast, and what its peers say.

    Args:
        end_s: how long a run lasts [s].
        keys: of the cast.

    Raises:
        Mistake: a type is missing in its package, a value does not fit, or nobody sees the end.
    """
    for node, peer in peers.items():
        for kind in script.KINDS:
            for name, entry in getattr(peer, kind).items():
                at = (*keys, node, kind, name)
                for key in ("begin", "at"):
                    check_time(getattr(entry, key, 0.0), end_s, (*at, key))
                for each in getattr(entry, "types", ()):
                    known.expect(each, (*at, "type"))
                for key, (part, asked, more) in _SAID.get(kind, {}).items():
                    given = getattr(entry, key)
                    said = given if isinstance(given, tuple) else (given,)
                    if part is not None:
                        known.check_each(said, entry.types, part, (*at, key), asked)
                    if asked is not None:
                        known.check_names(given, entry.types, asked, more, (*at, key))
                parts = {"translation": "Vector3", "rotation": "Quaternion"}
                for key, of in parts.items() if kind == "frames" else ():
                    numbers = dict(zip("xyzw", getattr(entry, key), strict=False))
                    known.check_each([numbers], [f"geometry_msgs/msg/{of}"], "", (*at, key))


def check_time(time_s: Any, end_s: float, at: tuple[str, ...]) -> None:
    """Check that a time, or one of several, is in a run.

    Raises:
        Mistake: it is after the end.
    """
    for each in time_s if isinstance(time_s, tuple) else (time_s,):
        if each > end_s:
            raise Mistake(at, "{time:g} s is after the end of a run, {end:g} s",
                          time=each, end=end_s)  # fmt: skip


@cache
def _installed(package: str, kind: str) -> dict[str, Path]:
    """Return the types of a kind that an installed package has, and the files of their definitions.

    They are found as ament_index does, which is there beside ROS alone.
    """
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        files = sorted(Path(prefix, "share", package, kind).glob(f"*.{kind}"))
        if files:
            return {f"{package}/{kind}/{file.stem}": file for file in files}
    return {}


def _definition(name: str) -> str:
    """Return the definition of a type of an installed package; '' where there is none."""
    package, kind, _ = name.split("/")
    file = _installed(package, kind).get(name)
    return "" if file is None else file.read_text("utf-8", "replace")


def _inner(field: Field, within: str) -> str:
    """Return the type of a field of a type, which is no basic one."""
    package = field.package or within.partition("/")[0]
    return f"{package}/msg/{field.base.rpartition('/')[2]}"


def _is_open(value: Any, *, is_expected: bool) -> bool:
    """Whether a value is only known in the run, or says itself what may come."""
    if isinstance(value, str):
        return value.startswith("=") or (is_expected and is_pattern(value))
    return is_expected and is_range(value)
