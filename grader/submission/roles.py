"""What the source of a program has on the graph, as far as names can be read; nothing is run."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Final

from grader.recording.subject import Role, RoleKind
from grader.submission.folder import read_bounded
from grader.submission.python_source import last, parse

#: What makes an end: which one, and where it gets its name, the place and the keyword.
_MADE_BY: Final[Mapping[str, tuple[RoleKind, int, str]]] = {
    "create_publisher": ("publisher", 1, "topic"),
    "create_subscription": ("subscription", 1, "topic"),
    "create_service": ("service", 1, "srv_name"),
    "create_client": ("client", 1, "srv_name"),
    "ActionServer": ("action", 2, "action_name"),
    "ActionClient": ("action_client", 2, "action_name"),
    "declare_parameter": ("parameter", 0, "name"),
}
#: Classes of tf2_ros, with the end that each makes.
_OF_TF: Final = {
    "TransformBroadcaster": Role("publisher", "/tf"),
    "StaticTransformBroadcaster": Role("publisher", "/tf_static"),
    "TransformListener": Role("subscription", "/tf"),
}
_ANY: Final = "*"


def roles_in(files: Iterable[Path]) -> set[Role]:
    """Return what some files have; `*` in a name stands for what a run alone shows."""
    found = set[Role]()
    for file in files:
        try:
            tree = parse(read_bounded(file) or b"")
        except (OSError, SyntaxError):
            continue
        texts = _texts(tree)
        for node in ast.walk(tree):
            if isinstance(node, ast.Call):
                found |= _made(node, texts)
    return found


def is_among(role: Role, found: Iterable[Role]) -> bool:
    """Whether a role is one of those that were found."""
    return any(
        each.kind == role.kind and each.name.strip("/*") and fnmatchcase(role.name, each.name)
        for each in found
    )


def _made(call: ast.Call, texts: Mapping[str, str]) -> set[Role]:
    called = last(call.func)
    if called in _OF_TF:
        return {_OF_TF[called]}
    if called not in _MADE_BY:
        return set()
    kind, place, keyword = _MADE_BY[called]
    given = [*call.args[place : place + 1], *(k.value for k in call.keywords if k.arg == keyword)]
    if not given:
        return set()
    name = _text(given[0], texts)
    if kind == "parameter" or name.startswith("/"):
        return {Role(kind, name)}
    return {Role(kind, f"/{_ANY if name.startswith('~') else ''}{name.removeprefix('~')}")}


def _texts(tree: ast.Module) -> dict[str, str]:
    """Return the texts that names and attributes are given, by their last parts."""
    found: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant | ast.JoinedStr):
            for target in node.targets:
                name, text = last(target), _text(node.value, {})
                found[name] = _ANY if found.get(name, text) != text else text
    return found


def _text(node: ast.expr, texts: Mapping[str, str]) -> str:
    match node:
        case ast.Constant(value=str(text)):
            return text
        case ast.JoinedStr(values=parts):
            return "".join(_text(each, texts) for each in parts)
        case ast.FormattedValue(value=value):
            return _text(value, texts)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return _text(left, texts) + _text(right, texts)
        case ast.Name() | ast.Attribute():
            return texts.get(last(node), _ANY)
    return _ANY
