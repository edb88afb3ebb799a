"""Strict JSON, and dataclasses as JSON and back; strictly, because it may be a stranger's.

The annotations of a dataclass define what is accepted: `str`, `int`, `float`, `bool`, `datetime`
(with its zone), `Path`, `Literal`, `tuple[T, ...]`, `tuple[T, T]`, `NamedTuple`, `Mapping[str, T]`,
`T | None`, dataclasses (of several, the one that has such keys), and `Annotated`: with `Bounds`,
and with functions that get a value and return the value to keep, or raise ValueError. A class with
a form of its own has `serialise` and `parse`, as `Message` has; bounds may replace these.
"""

from __future__ import annotations

import json
import math
import types
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from datetime import datetime
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    NamedTuple,
    NoReturn,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator, ValidationError

_Number = TypeVar("_Number", int, float)
Made = TypeVar("Made")

#: Metadata of a field: not written where it has its default; never written.
SPARSE, UNSTORED = {"is_sparse": True}, {"is_stored": False}


class Bounds(NamedTuple):
    """The bounds of a value and all within it.

    Attributes:
        characters, entries: the longest text, and list.
        number: the absolute value of a whole number is below this.
        clean: returns the text to keep; None keeps it as it is.
        may_lack: whether a field that has a default may be absent.
        write, read: take the place of a class's own `serialise` and `parse`; None for these.
    """

    characters: float = 2000
    entries: float = 5000
    number: float = 2**53
    clean: Callable[[str], str] | None = None
    may_lack: bool = False
    write: Callable[[Any], Any] | None = None
    read: Callable[[Any], Any] | None = None


_IN_WORDS = {
    **{int: "a whole number", float: "a number", str: "a text", bool: "true or false"},
    dict: "an object",
}
STRANGERS = Bounds()
#: Of a file of ours, which is bounded as a whole.
OURS = Bounds(math.inf, math.inf, math.inf, may_lack=True)


def loads(text: str) -> Any:
    """Parse JSON, without NaN and infinite numbers, which Python accepts.

    Raises:
        ValueError: it is no JSON, or a number in it is not finite.
        RecursionError: it is nested too deeply.
    """
    return json.loads(
        text, parse_constant=_refuse, parse_float=_finite(float), parse_int=_finite(int)
    )


def first_error(package: str, name: str, data: object) -> ValidationError | None:
    """Return what does not follow NAME.schema.json of a package, beside its modules."""
    from jsonschema.exceptions import best_match  # here: what is only written is not validated

    found: ValidationError | None = best_match(_validator(package, name).iter_errors(data))
    return found


@cache
def _validator(package: str, name: str) -> Draft202012Validator:
    import jsonschema

    text = (files(package) / f"{name}.schema.json").read_text(encoding="utf-8")
    return jsonschema.Draft202012Validator(json.loads(text))


def to_json(value: Any, bounds: Bounds = STRANGERS) -> Any:
    """Convert to JSON that `from_json` accepts: what is longer is cut."""
    if hasattr(value, "serialise"):
        return bounds.write(value) if bounds.write else value.serialise()
    if is_dataclass(value):
        return {
            name: to_json(found, part.bounds or bounds)
            for name, part in _parts(value.__class__).items()
            if not part.is_left_out(found := getattr(value, name))
        }
    if isinstance(value, tuple | list):
        return [to_json(each, bounds) for each in _first(value, bounds.entries)]
    if isinstance(value, Mapping):
        return {name: to_json(each, bounds) for name, each in value.items()}
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, Path):
        return str(value)
    return _first(value, bounds.characters) if isinstance(value, str) else value


def from_json(kind: type[Made], data: Any, bounds: Bounds = STRANGERS) -> Made:
    """Make a dataclass from JSON data."""
    made: Made = _value(kind, data, bounds)
    return made


def line(value: Any) -> bytes:
    """Serialise a dataclass in one line, for other processes and small files; see `of_line`."""
    data = to_json(value, OURS)
    return json.dumps(data, separators=(",", ":")).encode("ascii") + b"\n"


def of_line(kind: type[Made], data: bytes, bounds: Bounds = OURS) -> Made:
    """Parse a dataclass that `line` has written."""
    try:
        return from_json(kind, loads(data.decode("ascii")), bounds)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def not_negative(number: Any) -> Any:
    """For `Annotated`: a count, or a time [s]."""
    if not 0 <= number < math.inf:
        raise ValueError(f"expected 0 or more, found {number!r:.80}")
    return number


def above_zero(number: Any) -> float:
    """For `Annotated`: a rate, or a limit."""
    if not 0 < number < math.inf:
        raise ValueError(f"expected a number above 0, found {number!r:.80}")
    return float(number)


def _value(kind: Any, data: Any, bounds: Bounds) -> Any:
    origin, args = get_origin(kind), get_args(kind)
    if origin is Annotated:
        made = _value(args[0], data, _bounds(kind) or bounds)
        for check in filter(callable, args[1:]):
            made = check(made)
        return made
    if kind is Any:  # plain data, of ours
        return data
    if origin in (Union, types.UnionType):
        if data is None and type(None) in args:
            return None
        wanted = [each for each in args if each is not type(None)]
        fitting = (
            [each for each in wanted if _fits(each, data, bounds)] if len(wanted) > 1 else wanted
        )
        if len(fitting) != 1:
            raise ValueError(f"expected one of {len(wanted)} objects, found {data!r:.80}")
        return _value(fitting[0], data, bounds)
    if origin is Literal:
        if type(data) is not str or data not in args:
            raise ValueError(f"expected one of {', '.join(args)}, found {data!r:.80}")
        return data
    if origin is tuple:
        return _list(args, data, bounds)
    if origin in (Mapping, dict):
        texts = _is(data, dict)
        return {_value(args[0], n, bounds): _value(args[1], d, bounds) for n, d in texts.items()}
    if hasattr(kind, "_fields"):
        return kind(*_list(_kinds(kind), data, bounds))
    if hasattr(kind, "parse"):
        if bounds.read:
            return bounds.read(data)
        return kind.parse(data, lambda text: _scalar(str, text, bounds))
    if is_dataclass(kind):
        return _object(kind, data, bounds)
    return _scalar(kind, data, bounds)


def _scalar(kind: Any, data: Any, bounds: Bounds) -> Any:
    if kind is float and type(data) is int:
        return data
    if kind is int and type(data) is float and data.is_integer():  # a whole number, in JSON
        data = int(data)
    if kind is Path:
        return Path(_scalar(str, data, bounds))
    if kind is datetime:
        made = datetime.fromisoformat(_scalar(str, data, bounds))
        if made.utcoffset() is None:
            raise ValueError(f"expected a time with its zone, found {data!r:.80}")
        return made
    _is(data, kind)
    if kind is str and len(data) > bounds.characters:
        raise ValueError(f"expected {bounds.characters} characters at most, found {len(data)}")
    if kind is int and abs(data) >= bounds.number:
        raise ValueError(f"expected a number below {bounds.number}, found {data!r:.80}")
    return bounds.clean(data) if kind is str and bounds.clean else data


def _list(args: tuple[Any, ...], data: Any, bounds: Bounds) -> tuple[Any, ...]:
    if not isinstance(data, list | tuple) or len(data) > bounds.entries:
        raise ValueError(f"expected a list of {bounds.entries} at most, found {data!r:.80}")
    kinds = args[:1] * len(data) if args[-1] is ... else args
    if len(kinds) != len(data):
        raise ValueError(f"expected a list of {len(kinds)}, found {data!r:.80}")
    return tuple(_value(kind, each, bounds) for kind, each in zip(kinds, data, strict=True))


def _object(kind: Any, data: Any, bounds: Bounds) -> Any:
    parts = _parts(kind)
    if not _fits(kind, data, bounds):
        unknown = sorted(data.keys() - parts.keys()) if isinstance(data, dict) else data
        raise ValueError(f"expected an object of {', '.join(parts)}, found {unknown or data!r:.80}")
    made = {}
    for name in data:
        try:
            made[name] = _value(parts[name].kind, data[name], bounds)
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
    return kind(**made)


def _fits(kind: Any, data: Any, bounds: Bounds) -> bool:
    """Whether an object of a dataclass has keys like these."""
    parts = {name: part for name, part in _parts(kind).items() if part.is_stored}
    lacks = bounds.may_lack
    needed = {name for name, part in parts.items() if part.default is MISSING or not lacks}
    return isinstance(data, dict) and needed <= data.keys() <= parts.keys()


class _Part(NamedTuple):
    """The definition of a field of a dataclass."""

    kind: Any
    default: Any
    bounds: Bounds | None
    is_sparse: bool
    is_stored: bool

    def is_left_out(self, value: object) -> bool:
        return not self.is_stored or (self.is_sparse and value == self.default)


@cache
def _kinds(named_tuple: Any) -> tuple[Any, ...]:
    return tuple(get_type_hints(named_tuple).values())


@cache
def _parts(kind: Any) -> dict[str, _Part]:
    hints = get_type_hints(kind, include_extras=True)
    return {
        each.name: _Part(
            *(hints[each.name], _default(each), _bounds(hints[each.name])),
            *(each.metadata.get("is_sparse", False), each.metadata.get("is_stored", True)),
        )
        for each in fields(kind)
    }


def _default(field: Field[Any]) -> Any:
    return field.default if field.default_factory is MISSING else field.default_factory()


def _bounds(kind: Any) -> Bounds | None:
    return next(_all_bounds(kind), None)


def _all_bounds(kind: Any) -> Iterator[Bounds]:
    for each in get_args(kind):
        if isinstance(each, Bounds):
            yield each
        else:
            yield from _all_bounds(each)


def _first(value: Any, most: float) -> Any:
    return value if len(value) <= most else value[: int(most)]


def _is(data: Any, kind: type[Any]) -> Any:
    if type(data) is not kind:
        raise ValueError(f"expected {_IN_WORDS.get(kind, kind.__name__)}, found {data!r:.80}")
    return data


def _finite(make: Callable[[str], _Number]) -> Callable[[str], _Number]:
    def parse(text: str) -> _Number:
        if not math.isfinite(float(text)):
            _refuse(text)
        return make(text)

    return parse


def _refuse(text: str) -> NoReturn:
    raise ValueError(f"damaged, {text:.20} is no number in JSON")
