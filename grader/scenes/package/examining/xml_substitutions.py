"""Substitutions as launch files in XML write them: `$(name argument ...)`, one in another."""

from __future__ import annotations

import re
from typing import Any

from grader.scenes.package.examining.steps import NotKnown

_NOT_KNOWN = "it uses {}, which the grader does not know"
_OF_ROS_1 = ("find", "arg", "optenv", "param")
_NAME = re.compile(r"\$\(([\w-]+)")


def substitutions(text: str) -> Any:
    """A text with `$(...)` as the substitutions that it means."""
    parts, _ = _parse(text, 0, top=True)
    return parts if parts else ""


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
        if (found := _NAME.match(text, at)) is not None:
            flush()
            arguments, at = _arguments(text, found.end())
            parts.append(_substitution(found[1], arguments))
            continue
        sign = text[at]
        if sign == "\\" and at + 1 < len(text):
            plain += text[at + 1]
            at += 2
            continue
        if not top and not quote and (sign.isspace() or sign == ")"):
            break
        if quote and sign == quote:
            break
        if not top and not quote and sign in "'\"":
            flush()
            inner, at = _parse(text, at + 1, top=False, quote=sign)
            parts += inner
            at += 1
            continue
        plain += sign
        at += 1
    flush()
    return parts, at


def _arguments(text: str, at: int) -> tuple[list[list[Any]], int]:
    """The arguments of a `$(name ...)`, and where it ends."""
    found: list[list[Any]] = []
    while at < len(text):
        if text[at].isspace():
            at += 1
        elif text[at] == ")":
            return found, at + 1
        else:
            parts, at = _parse(text, at, top=False)
            found.append(parts)
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
        "find-pkg-share": ros.FindPackageShare,
        "find-pkg-prefix": ros.FindPackagePrefix,
    }
    if name in ("dirname", "filename"):
        return plain.ThisLaunchFileDir() if name == "dirname" else plain.ThisLaunchFile()
    if name == "find-exec":
        return plain.FindExecutable(name=arguments[0])
    if name == "exec-in-pkg":
        return ros.ExecutableInPackage(executable=arguments[0], package=arguments[1])
    if name == "env" and len(arguments) == 2:
        return plain.EnvironmentVariable(arguments[0], default_value=arguments[1])
    if name == "var" and len(arguments) == 2:
        return plain.LaunchConfiguration(arguments[0], default=arguments[1])
    if name == "command" and len(arguments) == 2:
        return plain.Command(arguments[0], on_stderr=arguments[1])
    if name == "path-join":
        return plain.PathJoinSubstitution(arguments)
    if name in _OF_ROS_1:
        raise RuntimeError(f"Unknown substitution: {name}")
    if name not in kinds:
        raise NotKnown(_NOT_KNOWN.format(f"$({name})"))
    return kinds[name](*arguments)
