"""Which nodes a launch file starts, as far as its text alone fixes that; it is never run.

Read is what most launch files are: a list of nodes with names, remappings and parameters that are
written out. Whatever else one holds (arguments, conditions, other launch files) makes it unread.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from grader.language.phrase import say
from grader.submission.constants import Constants
from grader.submission.folder import read_bounded, shown
from grader.submission.manifest import parse_xml
from grader.submission.python_source import parse

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_ENDINGS: Final = ("launch.py", "launch.xml", "launch.yaml", "launch.yml")
#: Arguments of `Node` that make no difference to what it does.
_IDLE: Final = {"output", "emulate_tty", "output_format", "log_cmd"}
_NAME: Final = re.compile(r"[A-Za-z_~/{}][\w~/{}.]*")
_MAX_NODES: Final = 20


@dataclass(frozen=True)
class Node:
    """One node that a launch file starts, and the arguments that its program gets."""

    package: str
    executable: str
    arguments: tuple[str, ...] = ()

    @property
    def is_as_by_itself(self) -> bool:
        """Whether its program does the same without these arguments, but for its name."""
        return not self.arguments or (
            len(self.arguments) == 3 and self.arguments[2].startswith("__node:=")
        )


@dataclass(frozen=True)
class LaunchFile:
    """A launch file: its nodes; or why they cannot be told without running it."""

    file: Path
    nodes: tuple[Node, ...] = ()
    unread: str = ""


class _Unread(Exception):
    """It holds more than nodes that are written out; the text says what."""


def is_launch_file(file: Path) -> bool:
    """Tell by its name whether `ros2 launch` would take a file: spiral_launch.py, a.launch.xml."""
    return file.name.endswith(_ENDINGS)


def read_launch_file(file: Path) -> LaunchFile:
    """Read one.

    Raises:
        OSError: it cannot be read.
    """
    data = read_bounded(file)
    try:
        if data is None:
            raise _Unread(say("it is too large"))
        if file.suffix == ".py":
            nodes = list(_of_python(data))
        elif file.suffix == ".xml":
            nodes = list(_of_xml(data))
        else:
            raise _Unread(say("it is written in YAML"))
        if len(nodes) > _MAX_NODES:
            raise _Unread(say("it starts too many nodes"))
    except _Unread as unread:
        return LaunchFile(file, unread=unread.args[0])
    return LaunchFile(file, tuple(nodes))


def _of_python(data: bytes) -> Iterator[Node]:
    try:
        tree = parse(data, "launch")
    except SyntaxError as error:
        raise _Unread(say("it does not parse")) from error
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    if [function.name for function in functions] != ["generate_launch_description"]:
        raise _Unread(say("it has no function generate_launch_description, or others as well"))
    constants, bound = Constants(tree), _Actions()
    for statement in functions[0].body:
        bound.take(statement)
    for call in bound.described():
        yield _python_node(call, constants)


class _Actions:
    """The statements of generate_launch_description, as far as they are a list of actions."""

    def __init__(self) -> None:
        self._bound: dict[str, ast.expr] = {}
        self._added: dict[str, list[ast.expr]] = {}
        self._returned: ast.expr | None = None

    def take(self, statement: ast.stmt) -> None:
        """Go by one statement."""
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if name not in self._bound:
                self._bound[name] = value
            case ast.Return(value=ast.expr() as value) if self._returned is None:
                self._returned = value
            case ast.Expr(
                value=ast.Call(
                    func=ast.Attribute(value=ast.Name(id=name), attr="add_action"),
                    args=[action],
                    keywords=[],
                )
            ):
                self._added.setdefault(name, []).append(action)
            case ast.Expr(value=ast.Constant()):
                pass
            case _:
                raise _Unread(
                    say("it does more than list nodes, in line {line}", line=statement.lineno)
                )

    def described(self) -> list[ast.Call]:
        """The actions of the description that is returned."""
        name = self._returned.id if isinstance(self._returned, ast.Name) else ""
        description = self._value(self._returned)
        if _called(description) != "LaunchDescription":
            raise _Unread(say("it returns no LaunchDescription"))
        assert isinstance(description, ast.Call)
        keywords = {keyword.arg: keyword.value for keyword in description.keywords}
        lists = [*description.args, *keywords.values()]
        if len(lists) > 1 or keywords.keys() - {"initial_entities"}:
            raise _Unread(say("its LaunchDescription has other arguments than a list"))
        listed = self._value(lists[0]) if lists else ast.List(elts=[])
        if not isinstance(listed, ast.List):
            raise _Unread(say("its LaunchDescription has other arguments than a list"))
        actions = [self._value(item) for item in (*listed.elts, *self._added.pop(name, []))]
        if self._added:
            raise _Unread(say("it adds actions to something else"))
        for action in actions:
            if _called(action) != "Node":
                called = _called(action)
                what = shown(called) if called else say("something else")
                raise _Unread(say("it holds {what} beside nodes", what=what))
        return [action for action in actions if isinstance(action, ast.Call)]

    def _value(self, node: ast.expr | None) -> ast.expr | None:
        return self._bound.get(node.id) if isinstance(node, ast.Name) else node


def _called(node: ast.expr | None) -> str:
    """What is called: Node of launch_ros.actions.Node(...); '' if it is no call."""
    match node:
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            return name
    return ""


def _python_node(call: ast.Call, constants: Constants) -> Node:
    said: dict[str, ast.expr] = {}
    for keyword in call.keywords:
        said[keyword.arg or "**"] = keyword.value
    others = said.keys() - _IDLE - {"package", "executable", "name", "namespace"}
    others -= {"arguments", "remappings", "parameters"}
    if call.args or others:
        raise _Unread(
            say(
                "a node in line {line} has {what}",
                line=call.lineno,
                what=shown(", ".join(sorted(others))),
            )
        )

    def text(key: str) -> str:
        value = constants.value(said[key]) if key in said else ""
        if not isinstance(value, str):
            raise _Unread(
                say("the {key} of a node in line {line} is computed", key=key, line=call.lineno)
            )
        return value

    def listed(key: str) -> list[object]:
        value = constants.value(said[key]) if key in said else []
        if not isinstance(value, list):
            raise _Unread(
                say("the {key} of a node in line {line} are computed", key=key, line=call.lineno)
            )
        return value

    remappings = [_pair(item) for item in listed("remappings")]
    arguments = [_text(item) for item in listed("arguments")]
    parameters = dict(_parameters(said.get("parameters")))
    words = _ros_arguments(text("name"), text("namespace"), remappings, parameters)
    return _node(text("package"), text("executable"), (*arguments, *words))


def _parameters(node: ast.expr | None) -> Iterator[tuple[str, str]]:
    """Parameters as YAML by their names: of `[{'rate': 2.0}]`, not of files."""
    try:
        dictionaries = ast.literal_eval(node) if node is not None else []
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError) as error:
        raise _Unread(say("the parameters of a node are computed")) from error
    for dictionary in dictionaries if isinstance(dictionaries, list) else [None]:
        if not isinstance(dictionary, dict):
            raise _Unread(say("the parameters of a node are not written out"))
        for name, value in dictionary.items():
            items = value if isinstance(value, list) else [value]
            if not all(isinstance(item, (bool, int, float, str)) for item in items):
                raise _Unread(say("a parameter of a node is neither a number nor a text"))
            yield _text(name), json.dumps(value)


def _pair(item: object) -> tuple[str, str]:
    match item:
        case [str(old), str(new)]:
            return old, new
    raise _Unread(say("a remapping is computed"))


def _text(item: object) -> str:
    if not isinstance(item, str):
        raise _Unread(say("an argument of a node is computed"))
    return item


def _of_xml(data: bytes) -> Iterator[Node]:
    root = parse_xml(data)
    if root is None or isinstance(root, str) or root.tag != "launch":
        raise _Unread(say("it does not parse"))
    if root.attrib:
        raise _Unread(say("<launch> has settings"))
    for element in root:
        if element.tag != "node":
            raise _Unread(say("it holds <{what}> beside nodes", what=shown(element.tag)))
        yield _xml_node(element)


def _xml_node(element: Element) -> Node:
    said = _plain(element, {"pkg", "exec", "name", "namespace", "args"})
    remappings: list[tuple[str, str]] = []
    parameters: dict[str, str] = {}
    for inner in element:
        if inner.tag == "remap":
            pair = _plain(inner, {"from", "to"})
            remappings.append((pair.get("from", ""), pair.get("to", "")))
        elif inner.tag == "param" and len(inner) == 0:
            pair = _plain(inner, {"name", "value"})
            parameters[pair.get("name", "")] = pair.get("value", "")
        else:
            raise _Unread(say("a node has <{what}>", what=shown(inner.tag)))
    words = _ros_arguments(said.get("name", ""), said.get("namespace", ""), remappings, parameters)
    return _node(said.get("pkg", ""), said.get("exec", ""), (*said.get("args", "").split(), *words))


def _plain(element: Element, allowed: set[str]) -> dict[str, str]:
    """The attributes of an element; all of them known, none of them computed."""
    said = {name: value for name, value in element.attrib.items() if name not in _IDLE}
    if said.keys() - allowed:
        raise _Unread(say("<{what}> has other settings", what=shown(element.tag)))
    if any("$" in value for value in said.values()):
        raise _Unread(say("<{what}> computes a value", what=shown(element.tag)))
    return said


def _ros_arguments(
    name: str, namespace: str, remappings: list[tuple[str, str]], parameters: dict[str, str]
) -> list[str]:
    """What `ros2 launch` gives a program for them."""
    namespace = namespace if namespace.startswith("/") or not namespace else f"/{namespace}"
    rules = [("__node", name), ("__ns", namespace)]
    rules = [(old, new) for old, new in rules if new] + remappings
    names = [*(each for rule in rules for each in rule), *parameters]
    if not all(_NAME.fullmatch(each) for each in names):
        raise _Unread(say("a name in it is none of ROS"))
    words = [word for old, new in rules for word in ("-r", f"{old}:={new}")]
    words += [word for key, value in parameters.items() for word in ("-p", f"{key}:={value}")]
    return ["--ros-args", *words] if words else []


def _node(package: str, executable: str, arguments: tuple[str, ...]) -> Node:
    if not package or not executable:
        raise _Unread(say("a node names no package, or no executable"))
    if any("\0" in word for word in arguments):
        raise _Unread(say("an argument of a node cannot be passed on"))
    return Node(package, executable, arguments)
