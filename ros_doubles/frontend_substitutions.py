"""Substitutions in launch files of XML and YAML: `$(name argument ...)`, one in another.

As the grammar of ROS has them: launch/share/launch/frontend/grammar.lark.
"""

from __future__ import annotations

import os
import re
from typing import Any

from ros_doubles import NotKnown

_SUBSTITUTION = re.compile(r"\$\(([A-Za-z][\w-]*)")
_OF_ROS_1 = ("find", "arg", "optenv")
#: What releases after Jazzy have.
_LATER = ("path-join", "string-join", "index")


def has_later() -> bool:
    """Whether the release of ROS has what came after Jazzy."""
    return os.environ.get("ROS_DISTRO", "jazzy") not in ("humble", "iron", "jazzy")


def substitutions(text: str) -> list[Any]:
    """A text with `$(...)` as the substitutions that it means."""
    from launch._core import TextSubstitution

    parts, _ = _parse(text, 0, top=True)
    return parts or [TextSubstitution(text="")]


def _parse(text: str, at: int, top: bool, quote: str = "") -> tuple[list[Any], int]:
    """Parts up to the end of a text, an argument or a quoted one, and where that is."""
    from launch._core import TextSubstitution

    parts: list[Any] = []
    plain = ""

    def flush() -> None:
        nonlocal plain
        if plain:
            parts.append(TextSubstitution(text=plain))
            plain = ""

    while at < len(text):
        if text.startswith("$(", at) and text[at - 1 : at] != "\\":
            flush()
            if (found := _SUBSTITUTION.match(text, at)) is None:
                raise RuntimeError(f"a substitution has no name: {text[at : at + 80]!r}")
            arguments, at = _arguments(text, found.end())
            parts.append(_substitution(found[1], arguments))
            continue
        sign = text[at]
        if sign == "\\" and at + 1 < len(text):
            plain += text[at + 1]
            at += 2
            continue
        if not top and not quote and sign in " )":
            break
        if quote and sign == quote:
            break
        if not top and not quote and sign in "'\"":
            flush()
            inner, at = _parse(text, at + 1, top=False, quote=sign)
            parts += inner or [TextSubstitution(text="")]
            at += 1
            continue
        plain += sign
        at += 1
    flush()
    return parts, at


def _arguments(text: str, at: int) -> tuple[list[list[Any]], int]:
    """The arguments of a `$(name ...)`, and where it ends."""
    found: list[list[Any]] = []
    while at < len(text) and text[at] == " ":  # one blank, and no more
        parts, at = _parse(text, at + 1, top=False)
        if not parts:
            raise RuntimeError(f"an empty argument of a substitution: {text[:80]!r}")
        found.append(parts)
    if text[at : at + 1] == ")":
        return found, at + 1
    raise RuntimeError(f"a substitution has no end: {text[:80]!r}")


def _substitution(name: str, arguments: list[list[Any]]) -> Any:
    from launch import substitutions as plain
    from launch_ros import substitutions as ros

    kinds: dict[str, Any] = {
        "var": plain.LaunchConfiguration,
        "env": plain.EnvironmentVariable,
        "command": plain.Command,
        "eval": plain.PythonExpression,
        "anon": plain.AnonName,
        "not": plain.NotSubstitution,
        "and": plain.AndSubstitution,
        "or": plain.OrSubstitution,
        "equals": plain.EqualsSubstitution,
        "not-equals": plain.NotEqualsSubstitution,
        "if": plain.IfElseSubstitution,
        "file-content": plain.FileContent,
        "param": ros.Parameter,
        "find-pkg-share": ros.FindPackageShare,
        "find-pkg-prefix": ros.FindPackagePrefix,
    }
    if name in ("dirname", "filename"):
        return plain.ThisLaunchFileDir() if name == "dirname" else plain.ThisLaunchFile()
    if name == "find-exec":
        return plain.FindExecutable(name=arguments[0])
    if name == "exec-in-pkg":
        return ros.ExecutableInPackage(executable=arguments[0], package=arguments[1])
    seconds = {"env": "default_value", "command": "on_stderr"}
    second = seconds.get(name, "default" if name in ("var", "param") else None)
    if second and len(arguments) == 2:
        return kinds[name](arguments[0], **{second: arguments[1]})
    if name in _LATER and not has_later():
        raise RuntimeError(f"Unknown substitution: {name} (later releases have it)")
    if name == "path-join":
        return plain.PathJoinSubstitution(arguments)
    if name in _OF_ROS_1:
        raise RuntimeError(f"Unknown substitution: {name}")
    if name not in kinds:
        raise NotKnown(f"$({name})")
    return kinds[name](*arguments)
