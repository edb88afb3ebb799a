"""Parses .msg, .srv and .action, and lets programs import the classes of a set of them.

The language is rosidl_adapter's, whose parser reads types and values; it names no lines, and some
lines keep it busy for ever. https://docs.ros.org/en/jazzy/Concepts/Basic/About-Interfaces.html
"""

from __future__ import annotations

import array
import ast
import codecs
import importlib
import importlib.machinery
import keyword
import math
import re
import sys
import warnings
from collections.abc import Mapping, Set
from contextlib import suppress
from itertools import chain
from pathlib import Path
from types import ModuleType
from typing import Any, Final, cast

import numpy as np
import rosidl_adapter.parser as adapter
import rosidl_parser.definition as idl

from grader.errors import SubmissionError
from grader.ros import uncompiled
from grader.ros.classes import classes_of, described, parts
from grader.ros.messages import installed, module_of, number_of, value_type
from grader.text.message import Message, msg

#: The longest line, and the longest definitions in all [characters].
LONGEST_LINE: Final = 2_000
LONGEST: Final = 300_000
#: How many messages may be within each other.
DEEPEST: Final = 32
#: The largest message before anything is assigned, ...
LARGEST: Final = 1 << 24
#: ... where what is no number in an array counts as so much, and an installed message [bytes].
VALUE: Final = 256
INSTALLED: Final = 1024
_TYPE: Final = re.compile(r"([a-z][a-z0-9]*(?:_[a-z0-9]+)*)/(msg|srv|action)/([A-Z][A-Za-z0-9]*)")
_NAME: Final = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_CONSTANT: Final = re.compile(r"[A-Z][A-Z0-9]*(_[A-Z0-9]+)*")
#: What a class of Jazzy calls its own.
_TAKEN: Final = (
    *("check_fields", "fields_and_field_types", "get_fields_and_field_types", "SLOT_TYPES"),
)
#: Words of C and C++, which colcon compiles, besides those of Python.
_OF_C: Final = (
    *("alignas", "alignof", "asm", "auto", "bool", "case", "catch", "char", "compl", "const"),
    *("constexpr", "decltype", "default", "delete", "do", "double", "enum", "explicit", "export"),
    *("extern", "float", "friend", "goto", "inline", "int", "long", "mutable", "namespace", "new"),
    *("noexcept", "nullptr", "operator", "private", "protected", "public", "register", "restrict"),
    *("short", "signed", "sizeof", "static", "struct", "switch", "template", "this", "throw"),
    *("typedef", "typeid", "typename", "union", "unsigned", "using", "virtual", "void", "volatile"),
)
#: Packages whose types stand in a definition without them; types of other languages.
_USUAL: Final = ("std_msgs", "geometry_msgs", "sensor_msgs", "builtin_interfaces", "nav_msgs")
_MEANT: Final = {
    **{"double": "float64", "float": "float32 or float64", "int": "int32 or int64"},
    **{"boolean": "bool", "str": "string", "text": "string", "list": "float64[] or such"},
    **{"long": "int64", "unsigned": "uint32", "integer": "int32"},
}
#: What stands between a file's lines of ---.
_PARTS: Final = {
    "msg": ("",),
    "srv": ("_Request", "_Response"),
    "action": ("_Goal", "_Result", "_Feedback"),
}
#: Names of basic types, where IDL has others.
_BASIC: Final = {
    **{"bool": "boolean", "byte": "octet", "char": "uint8"},
    **{"float32": "float", "float64": "double"},
}
#: What IDL's strings escape, of what rosidl_parser decodes.
_ESCAPES: Final = re.compile(r"\\[ntvbrfa\\'\"]|\\[0-7]{1,3}|\\x[0-9a-fA-F]{2}")


class Definitions:
    """The classes of definitions; on `sys.meta_path`, programs can import them.

    A definition with a mistake is left out, and what needs it. To import it is an ImportError that
    tells the mistake; the others can be imported.

    Args:
        texts: a type's name, `my_interfaces/msg/Num` -> its definition. Types of other packages are
            looked for among those that are installed.

    Attributes:
        errors: a type's name -> the mistake in its file.
    """

    def __init__(self, texts: Mapping[str, str]) -> None:
        self.errors: dict[str, SubmissionError] = {}
        #: of those whose mistake is another's: that one
        self._roots: dict[str, Message] = {}
        self._elements: dict[str, Any] = {}
        self._classes: dict[str, Mapping[str, Any]] = {}
        #: size of a message before anything is assigned, how many messages are within each other
        self._extents: dict[str, tuple[int, int]] = {}
        length = 0
        for name, text in texts.items():
            length += len(text)
            try:
                if length > LONGEST or max(map(len, text.splitlines()), default=0) > LONGEST_LINE:
                    what = msg(
                        "found more than {n:,} characters, or {line:,} in a line. Shorten your "
                        "definitions.",
                        **{"n": LONGEST, "line": LONGEST_LINE},
                    )
                    raise mistake(name, 0, what)
                self._elements[name] = parse(name, text)
            except SubmissionError as error:
                self.errors[name] = error
        for name in self._elements:
            with suppress(SubmissionError):
                self._extent(name)
        #: a module -> its types
        self._modules: dict[str, list[str]] = {}
        for name in filter(_TYPE.fullmatch, texts):
            package, kind, _ = name.split("/")
            self._modules |= {package: [], f"{package}.{kind}": []}
            if name in self._extents:
                self._modules.setdefault(module_of(slot_of(name)), []).append(name)

    def type(self, name: str) -> Any:
        """Return the class of a type, `my_interfaces/msg/Num`: of these, else an installed one."""
        return self.find(slot_of(name))

    def find(self, slot: Any) -> Any:
        """Return the class of a type in SLOT_TYPES."""
        name = "/".join((*slot.namespaces, slot.name.partition("_")[0]))
        return self._made(name)[slot.name] if name in self._extents else installed(slot)

    def _made(self, name: str) -> Mapping[str, Any]:
        if name not in self._classes:
            self._classes[name] = classes_of(self._elements[name], self.find)
        return self._classes[name]

    # as importlib has it -----------------------------------------------------------------------

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> Any:
        """Find a package of these, its `msg`, `srv` or `action`, or a module of one class."""
        if fullname not in self._modules:
            return None
        more: Any = {"origin": "definitions", "is_package": fullname.count(".") < 2}
        return importlib.machinery.ModuleSpec(fullname, cast("Any", self), **more)

    def create_module(self, spec: Any) -> None:
        """Leave that to Python."""

    def exec_module(self, module: ModuleType) -> None:
        """Fill a module with its classes; `my_interfaces.msg`, when they are asked for."""
        folder = module.__name__.replace(".", "/") + "/"
        for name in self._modules[module.__name__]:
            vars(module).update(self._made(name))

        def get(name: str) -> Any:
            of_type = folder + name.partition("_")[0]
            if error := self.errors.get(of_type):
                raise ImportError(str(error)) from error
            if name not in self._exported(of_type):
                raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
            found = importlib.import_module(module_of(slot_of(of_type)))
            return vars(module).setdefault(name, getattr(found, name))

        if folder.count("/") == 2:
            own = [self._exported(name) for name in self._extents if name.startswith(folder)]
            vars(module).update(__getattr__=get, __all__=list(chain(*own)))

    def _exported(self, name: str) -> list[str]:
        """Return what rosidl_generator_py's `my_interfaces.srv` has of a type; [] if it is none."""
        if name not in self._extents:
            return []
        names = (each.structure.namespaced_type.name for each in parts(self._elements[name]))
        of_services = (each for each in names if each.endswith(("_Request", "_Response", "_Event")))
        return [name.rpartition("/")[2], *of_services]

    # whether they hold together ----------------------------------------------------------------

    def _extent(self, name: str, within: tuple[str, ...] = ()) -> tuple[int, int]:
        """Return the extent of a definition."""
        if name in self.errors:
            raise self.errors[name]
        if name in self._extents:
            return self._extents[name]
        size, deep = VALUE, 1
        for field in _fields(self._elements[name]):
            try:
                one, inner = self._looked_up(value_type(field.type), (*within, name))
                if isinstance(field.type, idl.Array):
                    number = number_of(field.type)
                    one = field.type.size * (one if number is None else number.dtype.itemsize)
                elif field.type is not value_type(field.type):
                    one = VALUE
                size, deep = size + one, max(deep, inner + 1)
                if size > LARGEST or deep > DEEPEST:
                    raise SubmissionError(
                        "`{name}` makes messages too large: {n:,} bytes and {deep} messages within "
                        "each other are allowed. Use a smaller array, or a sequence.",
                        **{"name": field.name, "n": LARGEST, "deep": DEEPEST},
                    )
            except SubmissionError as error:
                line = field.get_annotation_value("line")
                self.errors[name] = mistake(name, line, error.message)
                if isinstance(root := error.message.values.get("why"), Message):
                    self._roots[name] = root
                raise self.errors[name] from None
        self._extents[name] = size, deep
        return size, deep

    def _looked_up(self, slot: Any, within: tuple[str, ...]) -> tuple[int, int]:
        """Return the extent of a value; raise SubmissionError, with what is wrong with its type."""
        if not (name := name_of(slot)):
            return VALUE, 0
        shown = described(slot)
        if name in within:
            raise SubmissionError("`{type}` contains itself. Remove the field.", type=shown)
        if name in self._elements or name in self.errors:
            try:
                return self._extent(name, within) if len(within) < DEEPEST else (VALUE, DEEPEST)
            except SubmissionError:
                why = self._roots.get(name, self.errors[name].message)
                what = msg("`{type}` has a mistake itself: {why}", type=shown, why=why)
                raise SubmissionError(what) from None
        if is_installed(slot):
            return INSTALLED, 1
        title = name.rpartition("/")[2]
        for package in _USUAL:
            if is_installed(idl.NamespacedType([package, "msg"], title)):
                meant = f"{package}/{title}"
                raise SubmissionError(
                    "`{type}` is not known. Write {meant}.", type=shown, meant=meant
                )
        raise SubmissionError(
            "`{type}` is not known. Check its name; a type of another package is written as "
            "geometry_msgs/Point.",
            type=shown,
        )


class UncompiledPackages:
    """On `sys.meta_path`, programs can import the packages of `uncompiled`."""

    def __init__(self) -> None:
        #: a package -> its definitions, parsed when it is first imported
        self._packages: dict[str, Definitions] = {}

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> Any:
        """Find such a package, or a module of one that was found here: that has no folder."""
        package, _, inner = fullname.partition(".")
        if path or not (inner or uncompiled.is_uncompiled(package)):
            return None
        if not inner and package not in self._packages:
            self._packages[package] = Definitions(uncompiled.texts(package))
        found = self._packages.get(package)
        return found and found.find_spec(fullname)


def slot_of(name: str) -> Any:
    """Return the type of a name, `my_interfaces/msg/Num`, as SLOT_TYPES has it."""
    *namespaces, last = name.split("/")
    return idl.NamespacedType(namespaces, last)


def name_of(slot: Any) -> str:
    """Return the name of a message's type, '' of any other."""
    return "/".join((*getattr(slot, "namespaces", ()), getattr(slot, "name", "")))


def is_installed(slot: Any) -> bool:
    """Whether the class of a type can be imported; nothing is imported to find out."""
    if slot.namespaces[-1] not in uncompiled.KINDS:
        return False
    module = Path(*module_of(slot).split(".")).with_suffix(".py")
    if any(Path(folder, module).is_file() for folder in sys.path):
        return True
    return name_of(slot) in uncompiled.texts(slot.namespaces[0])


def _fields(element: Any) -> list[idl.Member]:
    """Return the fields that stand in a definition."""
    members = [member for message in parts(element) for member in message.structure.members]
    return [member for member in members if member.has_annotation("line")]


# One file --------------------------------------------------------------------------------------


def mistake(name: str, line: int, what: Message) -> SubmissionError:
    """Return the error of a line of a type's file; of the whole file, if that is 0."""
    file = "{2}.{1}".format(*name.split("/")) if _TYPE.fullmatch(name) else name
    if not line:
        return SubmissionError("{file}: {what}", file=file, what=what)
    return SubmissionError("{file}, line {line}: {what}", file=file, line=str(line), what=what)


def parse(name: str, text: str) -> Any:
    """Parse a definition, by itself.

    Args:
        name: its type's, `my_interfaces/msg/Num`.

    Returns:
        A Message, Service or Action of `rosidl_parser.definition`, with what `classes_of` expects;
        a member's annotation `line` has its line.
    """
    named = _TYPE.fullmatch(name)
    if named is None or any(map(keyword.iskeyword, named.groups())):
        what = msg(
            "expected a name such as my_interfaces/msg/Num: in the package's name small letters, "
            "in the type's a capital first, then letters and digits; no word of Python's. Rename "
            "it."
        )
        raise mistake(name, 0, what)
    package, kind, _ = named.groups()
    if text.startswith("\ufeff"):
        what = msg("it begins with a mark that nobody sees (BOM). Save it as UTF-8 without one.")
        raise mistake(name, 1, what)
    lines, ends = text.splitlines(), _PARTS[kind]
    if lines.count("---") != len(ends) - 1:
        what = msg(
            "found {found} lines that are ---, expected {expected}; no spaces before or after.",
            **{"found": lines.count("---"), "expected": len(ends) - 1},
        )
        raise mistake(name, 0, what)
    made = [idl.Message(idl.Structure(slot_of(name + end))) for end in ends]
    at, names = 0, set[str]()
    for number, line in enumerate(lines, 1):
        if line == "---":
            at, names = at + 1, set()
        elif line := line.replace("\t", " ").partition("#")[0].rstrip():
            try:
                found = _parse_line(package, line, names)
            except SubmissionError as error:
                raise mistake(name, number, error.message) from None
            names.add(found.name)
            found.annotations.append(idl.Annotation("line", number))
            is_constant, message = isinstance(found, idl.Constant), made[at]
            (message.constants if is_constant else message.structure.members).append(found)
    if kind == "msg":
        return made[0]
    return (idl.Service if kind == "srv" else idl.Action)(slot_of(name), *made)


def _parse_line(package: str, line: str, taken: Set[str]) -> Any:
    """Return the field or the constant of a line."""
    kind, _, rest = line.partition(" ")
    name, is_constant, value = rest.lstrip().partition("=")
    if not is_constant:
        name, _, value = name.partition(" ")
    name, value = name.rstrip(), value.lstrip()
    if not (kind and name):
        what = msg("found `{line}`, expected a type and a name: int32 count.", line=line[:80])
        raise SubmissionError(what)
    pattern, example = (_CONSTANT, "MAX_SPEED") if is_constant else (_NAME, "max_speed")
    if is_constant and _NAME.fullmatch(name):
        raise SubmissionError(
            "`{line}` has a = between name and default: write {right}. A constant's name is "
            "written as MAX_SPEED.",
            **{"line": line[:80], "right": f"{kind} {name} {value}"[:80]},
        )
    if name in taken:
        raise SubmissionError("`{name}` is there twice. Give one another name.", name=name[:80])
    if keyword.iskeyword(name) or name in {*_TAKEN, *_OF_C}:
        raise SubmissionError(
            "`{name}` is a word of Python, C++ or ROS itself. Give it another name.", name=name[:80]
        )
    if not pattern.fullmatch(name):
        raise SubmissionError(
            "`{name}` is no name here. A name is written as {example}.",
            **{"name": name[:80], "example": example},
        )
    if meant := _MEANT.get(kind.partition("[")[0]):
        raise SubmissionError("`{kind}` is no type. Write {meant}.", kind=kind[:80], meant=meant)
    try:
        if is_constant:
            constant = adapter.Constant(kind, name, value)
            slot = _slot(adapter.Type(kind))
            return idl.Constant(name, slot, _value(slot, constant.value))
        field = adapter.Field(adapter.Type(kind, package), name, value or None)
        member = idl.Member(_slot(field.type), name)
        if field.default_value is not None:
            default = _value(member.type, field.default_value)
            member.annotations.append(idl.Annotation("default", {"value": default}))
        return member
    except Exception as error:  # the adapter's have nothing in common
        raise SubmissionError(
            "`{line}` is not understood: {error}. Types are int32, string<=10, float64[3], "
            "geometry_msgs/Point[], Num[<=5] and such; a value follows the name.",
            **{"line": line[:80], "error": str(error)[:200]},
        ) from None


def _slot(kind: Any) -> Any:
    """Return a type as SLOT_TYPES has it."""
    most = kind.string_upper_bound
    if not kind.is_primitive_type():
        value: Any = idl.NamespacedType([kind.pkg_name, "msg"], kind.type)
    elif kind.type == "string":
        value = idl.BoundedString(most) if most else idl.UnboundedString()
    elif kind.type == "wstring":
        value = idl.BoundedWString(most) if most else idl.UnboundedWString()
    elif kind.type in ("time", "duration"):
        raise ValueError(f"write builtin_interfaces/{kind.type.capitalize()}")
    else:
        value = idl.BasicType(_BASIC.get(kind.type, kind.type))
    if not kind.is_array:
        return value
    if kind.array_size:
        return (idl.BoundedSequence if kind.is_upper_bound else idl.Array)(value, kind.array_size)
    if kind.type == "wstring" and most:  # so rosidl_parser 4.6 has it
        return idl.BoundedSequence(value, most)
    return idl.UnboundedSequence(value)


# Values, which pass through IDL on their way to Python -----------------------------------------


def _value(slot: Any, value: Any) -> Any:
    """Return a value of the adapter's as classes have it."""
    if isinstance(value, list):
        number = number_of(slot)
        if isinstance(slot.value_type, idl.AbstractGenericString):
            text = repr(tuple(value)).replace("\\", "\\\\").replace('"', '\\"')
            return list(ast.literal_eval(_unescaped(text)))
        if number is None:
            return [_value(slot.value_type, each) for each in value]
        values = np.array([_value(slot.value_type, each) for each in value], number.dtype)
        return values if isinstance(slot, idl.Array) else array.array(number.code, values.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("expected a number")
    if isinstance(value, str) and "\\" in value:
        with warnings.catch_warnings(action="ignore"):  # of unknown escapes, which stay as they are
            value = value.encode().decode("unicode_escape")
        value = value.replace('"', '\\"').encode("latin-1").decode()
        if "\n" in value:
            raise ValueError("a string of IDL ends with its line")
        return _unescaped(value)
    return bytes([value]) if getattr(slot, "typename", "") == "octet" else value


def _unescaped(text: str) -> str:
    text = _ESCAPES.sub(lambda found: codecs.decode(found[0], "unicode-escape"), text)
    return re.sub(r'\\(["\\])', r"\1", text)
