"""Launch files in XML and YAML, as ROS's frontend reads them: each entity becomes an action.

YAML has the same entities as XML, and is read as such.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any, TextIO
from xml.etree import ElementTree

import yaml

from grader.submission.examining.steps import not_known

_SUBSTITUTIONS_OF_ROS_1 = ("find", "arg", "optenv", "param")
_SUBSTITUTION = re.compile(r"\$\(([\w-]+)")
_PUSHES = ("push_ros_namespace", "push-ros-namespace")
_OF_ROS_1 = ("param", "rosparam", "remap", "env", "machine", "test", "master")


def entities(path: str, *, is_yaml: bool) -> list[Any]:
    """The actions of a launch file.

    Raises:
        Exception: it is not what ROS reads.
    """
    with open(path, encoding="utf-8") as file:
        return [action(each) for each in (_of_yaml(file) if is_yaml else _of_xml(file.read()))]


def _of_xml(text: str) -> ElementTree.Element:
    if "<!DOCTYPE" in text:
        raise not_known("a DOCTYPE")
    root = ElementTree.fromstring(text)
    if root.tag != "launch":
        raise RuntimeError(f"expected 'launch' as root element, found '{root.tag}'")
    return root


def _of_yaml(file: TextIO) -> list[ElementTree.Element]:
    data = yaml.safe_load(file)
    if not isinstance(data, dict) or list(data) != ["launch"]:
        found = ", ".join(map(str, data)) if isinstance(data, dict) else type(data).__name__
        raise RuntimeError(f"expected 'launch' as the one root, found {found:.80}")
    return _children(data["launch"])


def _children(given: Any) -> list[ElementTree.Element]:
    if not isinstance(given, list):
        raise TypeError(f"expected a list of entities, found {type(given).__name__}")
    found = []
    for each in given:
        if not isinstance(each, dict) or len(each) != 1:
            raise RuntimeError(f"expected one entity in each entry, found {each!r:.80}")
        found += [_element(str(name), value) for name, value in each.items()]
    return found


def _element(name: str, given: Any) -> ElementTree.Element:
    made = ElementTree.Element(name)
    if isinstance(given, list):
        made.extend(_children(given))
    elif isinstance(given, dict):
        for key, value in given.items():
            _put(made, str(key), value)
    elif given is not None:
        raise TypeError(f"expected what '{name}' has, found {given!r:.80}")
    return made


def _put(made: ElementTree.Element, name: str, value: Any) -> None:
    """An attribute; or children, where a list of them is given."""
    if name == "children":
        made.extend(_children(value))
    elif isinstance(value, list) and value and all(isinstance(each, dict) for each in value):
        made.extend([_element(name, each) for each in value])
    else:
        made.set(name, value if isinstance(value, str) else json.dumps(value))


def action(element: ElementTree.Element) -> Any:
    """The action that an element means."""
    from launch import actions
    from launch.launch_description_sources import AnyLaunchDescriptionSource
    from launch_ros import actions as ros

    #: those that take nothing but some attributes, all of which are needed
    plain: dict[str, tuple[Any, ...]] = {
        "let": (actions.SetLaunchConfiguration, "name", "value"),
        "set_env": (actions.SetEnvironmentVariable, "name", "value"),
        "append_env": (actions.AppendEnvironmentVariable, "name", "value"),
        "unset_env": (actions.UnsetEnvironmentVariable, "name"),
        **dict.fromkeys(_PUSHES, (ros.PushROSNamespace, "namespace")),
        "set_parameters_from_file": (ros.SetParametersFromFile, "filename"),
        "set_parameter": (ros.SetParameter, "name", "value"),
        "set_remap": (ros.SetRemap, "from", "to"),
        "set_use_sim_time": (ros.SetUseSimTime, "value"),
        "set_ros_log_dir": (ros.SetROSLogDir, "new_log_dir"),
    }
    take = _Attributes(element)
    more = {"condition": take.condition()}
    match element.tag:
        case "arg":
            made = actions.DeclareLaunchArgument(
                take.plain("name"),
                default_value=take("default"),
                description=take.plain("description", ""),
                choices=[each.get("value", "") for each in element.findall("choice")] or None,
                **more,
            )
            take.ignore("choice")
        case tag if tag in plain:
            if tag == "append_env":
                given = {name: take(name) for name in ("prepend", "separator")}
                more |= {name: value for name, value in given.items() if value is not None}
            kind, *names = plain[tag]
            made = kind(*map(take.needed, names), **more)
        case "node" | "lifecycle_node":
            made = _node(element, take, more)
        case "include":
            made = actions.IncludeLaunchDescription(
                AnyLaunchDescriptionSource(take.needed("file")),
                launch_arguments=[
                    (_Attributes(each).needed("name"), _Attributes(each).needed("value"))
                    for each in element
                    if each.tag in ("arg", "let")
                ],
                **more,
            )
        case "group":
            scoped = take.plain("scoped", "true").lower() not in ("false", "0")
            take("forwarding")
            made = actions.GroupAction([action(each) for each in element], scoped=scoped, **more)
        case "executable":
            import shlex

            words = [substitutions(word) for word in shlex.split(take.plain("cmd"))]
            more |= _process(element, take)
            made = actions.ExecuteProcess(cmd=words, name=take("name"), **more)
        case "timer" | "ros_timer":
            made = actions.TimerAction(
                period=take.needed("period"), actions=[action(each) for each in element], **more
            )
        case "log" | "log_info":
            take.ignore("message", "level")
            made = actions.LogInfo(msg="", **more)
        case "shutdown":
            take.ignore("reason")
            made = actions.Shutdown(**more)
        case other if other in _OF_ROS_1:
            raise RuntimeError(f"Unrecognized entity of the type: {other} (it is one of ROS 1)")
        case other:
            raise not_known(f"<{other}>")
    take.must_be_through()
    return made


def _node(element: ElementTree.Element, take: _Attributes, more: dict[str, Any]) -> Any:
    from launch_ros.actions import LifecycleNode, Node

    parameters: list[Any] = []
    remappings = []
    for child in element:
        of = _Attributes(child)
        if child.tag == "param":
            parameters.append(_param(child, of))
        elif child.tag == "remap":
            remappings.append((of.needed("from"), of.needed("to")))
        elif child.tag != "env":
            raise ValueError(f"Unexpected nested entity '{child.tag}' in node")
    own, ros = (
        [substitutions(word) for word in _words(take.plain(name, ""))]
        for name in ("args", "ros_args")
    )
    take.ignore("machine", "log_cmd", "cached_output")
    return (LifecycleNode if element.tag == "lifecycle_node" else Node)(
        package=take.needed("pkg"),
        executable=take.needed("exec"),
        name=take("name"),
        namespace=take("namespace"),
        parameters=parameters,
        remappings=remappings,
        arguments=own,
        ros_arguments=ros,
        exec_name=take("exec_name"),
        **_process(element, take),
        **more,
    )


def _process(element: ElementTree.Element, take: _Attributes) -> dict[str, Any]:
    from launch.actions import Shutdown

    made: dict[str, Any] = {"cwd": take("cwd"), "prefix": take("launch-prefix")}
    made["shell"] = take.plain("shell", "false").lower() in ("true", "1")
    made["respawn"] = take("respawn") or False
    made["respawn_delay"] = float(take.plain("respawn_delay", "0"))
    made["respawn_max_retries"] = int(take.plain("respawn_max_retries", "-1"))
    made["on_exit"] = [Shutdown()] if take.plain("on_exit", "") else None
    env = [_Attributes(each) for each in element.findall("env")]
    made["additional_env"] = {each.plain("name"): each.needed("value") for each in env}
    take.ignore("output", "emulate_tty", "sigkill_timeout", "sigterm_timeout")
    return made


def _param(element: ElementTree.Element, take: _Attributes) -> Any:
    from launch_ros.parameter_descriptions import ParameterFile, ParameterValue

    if (file := take("from")) is not None:
        is_template = take.plain("allow_substs", "false").lower() in ("true", "1")
        take.must_be_through()
        return ParameterFile(file, allow_substs=is_template)
    name, kind = take.plain("name"), take.plain("type", "")
    if len(element):
        inner = [_param(each, _Attributes(each)) for each in element if each.tag == "param"]
        return {name: {k: v for each in inner for k, v in each.items()}}
    text, separator = take.plain("value"), take.plain("value-sep", "")
    take.must_be_through()
    if separator:  # a list, of texts or of what YAML reads
        return {name: [substitutions(part) for part in text.split(separator)]}
    value = substitutions(text)
    kinds = {"str": str, "string": str, "int": int, "float": float, "bool": bool}
    if kind and kind not in kinds:
        return {name: value}
    return {name: ParameterValue(_joined(value), value_type=kinds.get(kind))}


def _joined(value: Any) -> Any:
    """A value that YAML reads, though it may hold no substitution."""
    from launch._core import TextSubstitution

    return [TextSubstitution(text=value)] if isinstance(value, str) else value


def _words(text: str) -> Iterator[str]:
    """Words at blanks that are in no `$(...)` and no quotes."""
    depth, quote, word = 0, "", ""
    for at, sign in enumerate(text):
        if sign in "'\"" and not depth:
            quote = "" if quote == sign else quote or sign
            if quote != sign and quote:
                word += sign
            continue
        depth += text.startswith("$(", at)
        if sign == ")" and depth:
            depth -= 1
        if sign.isspace() and not depth and not quote:
            if word:
                yield word
            word = ""
        else:
            word += sign
    if word:
        yield word


class _Attributes:
    """The attributes of an element, each to be taken once; ROS refuses what nobody takes."""

    def __init__(self, element: ElementTree.Element) -> None:
        self._tag = element.tag
        self._left = dict(element.attrib)

    def __call__(self, name: str) -> Any:
        text = self._left.pop(name, None)
        return None if text is None else substitutions(text)

    def needed(self, name: str) -> Any:
        return substitutions(self.plain(name))

    def plain(self, name: str, default: str | None = None) -> str:
        if name not in self._left and default is None:
            raise AttributeError(f"Attribute '{name}' of Entity '{self._tag}' not found")
        return self._left.pop(name, default or "")

    def condition(self) -> Any:
        from launch.conditions import IfCondition, UnlessCondition

        for name, kind in (("if", IfCondition), ("unless", UnlessCondition)):
            if name in self._left:
                return kind(self(name))
        return None

    def ignore(self, *names: str) -> None:
        for name in names:
            self._left.pop(name, None)

    def must_be_through(self) -> None:
        if self._left:
            raise ValueError(f"Unexpected attribute(s) found in `{self._tag}`: {set(self._left)}")


# Substitutions: `$(name argument ...)`, one in another --------------------------------------------


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
        if (found := _SUBSTITUTION.match(text, at)) is not None:
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
    second = {"env": "default_value", "var": "default", "command": "on_stderr"}.get(name)
    if second and len(arguments) == 2:
        return kinds[name](arguments[0], **{second: arguments[1]})
    if name == "path-join":
        return plain.PathJoinSubstitution(arguments)
    if name in _SUBSTITUTIONS_OF_ROS_1:
        raise RuntimeError(f"Unknown substitution: {name}")
    if name not in kinds:
        raise not_known(f"$({name})")
    return kinds[name](*arguments)
