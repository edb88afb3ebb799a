"""A double of ROS's `launch_ros.actions`."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import FrameType
from typing import Any

import yaml
from launch._core import (
    Action,
    LaunchContext,
    Substitution,
    exported,
    normalize_to_list_of_substitutions,
    text_of,
    unknown,
)
from launch.actions import ExecuteProcess, TimerAction
from launch.utilities.type_utils import normalize_typed_substitution
from launch_ros.parameter_descriptions import (
    Parameter,
    ParameterFile,
    ParameterValue,
    as_word,
    evaluated,
    normalize_parameter_dict,
)

#: The doubles.
_OURS = str(Path(__file__).resolve().parents[1])
_NAMESPACE, _PARAMETERS, _REMAPPINGS = "ros_namespace", "global_params", "ros_remaps"


class Node(ExecuteProcess):
    def __init__(
        self,
        *,
        executable: Any,
        package: Any = None,
        name: Any = None,
        namespace: Any = None,
        exec_name: Any = None,
        parameters: Any = None,
        remappings: Any = None,
        ros_arguments: Any = None,
        arguments: Any = None,
        **kwargs: Any,
    ) -> None:
        if parameters is not None and not isinstance(parameters, list):
            raise TypeError(
                "Expected 'parameters' given to Node to be one of ['list'], but got "
                f"'{parameters!r:.80}' of type '{type(parameters)}'"
            )
        super().__init__(cmd=[], name=exec_name, **kwargs)
        self._made = _made_at()
        self._package, self._executable = package, executable
        for given in (package, executable, name, namespace):
            if given is not None:
                normalize_to_list_of_substitutions(given)
        self._name, self._namespace = name, namespace
        self._parameters = [_normalized(each) for each in parameters or []]
        self._remappings = [_pair(each) for each in remappings or []]
        self._arguments = [normalize_to_list_of_substitutions(each) for each in _words(arguments)]
        self._ros = [normalize_to_list_of_substitutions(each) for each in _words(ros_arguments)]

    def execute(self, context: LaunchContext) -> None:
        self.must_be_first()
        record = context.record
        package = "" if self._package is None else text_of(context, self._package)
        executable = text_of(context, self._executable)
        if package:
            record.executable(package, executable)
        name = "" if self._name is None else text_of(context, self._name)
        if self._name is not None and not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
            raise ValueError(f"Invalid node name: {name!r}")
        namespace, absolute = _namespace(context, self._namespace)
        own, ros = ([text_of(context, e) for e in words] for words in (self._arguments, self._ros))
        remappings = [
            *context.launch_configurations.get(_REMAPPINGS, ()),
            *(f"{text_of(context, a)}:={text_of(context, b)}" for a, b in self._remappings),
        ]
        names = [f"{old}:={new}" for old, new in (("__node", name), ("__ns", absolute)) if new]
        parameters, words, lacking = self._evaluated(context)
        ros += [word for rule in names for word in ("-r", rule)] + words
        ros += [word for rule in remappings for word in ("-r", rule)]
        record.node(
            {
                "package": package,
                "executable": executable,
                "name": name,
                "namespace": namespace,
                "arguments": [*own, *ros[: len(self._ros)]],
                "parameters": parameters,
                "remappings": remappings,
                **self._told(),
            },
            [*own, *(["--ros-args", *ros] if ros else [])],
            lacking,
            self,
        )

    def skip(self, context: LaunchContext) -> None:
        names = []
        for given in (self._package, self._executable):
            try:
                names.append("" if given is None else text_of(context, given))
            except Exception:  # what does not start need not have a name
                names.append("?")
        context.record.skipped({"package": names[0], "executable": names[1], **self._told()})

    def _told(self) -> dict[str, Any]:
        condition = getattr(self.condition, "told", "")
        return {"made": self._made, "condition": condition if isinstance(condition, str) else ""}

    def _evaluated(
        self, context: LaunchContext
    ) -> tuple[list[dict[str, Any]], list[str], list[str]]:
        """The parameters, arguments that give them, and those that cannot be given."""
        found: dict[str, dict[str, Any]] = {}
        words, lacking = list[str](), list[str]()
        for each in (*context.launch_configurations.get(_PARAMETERS, ()), *self._parameters):
            if isinstance(each, ParameterFile):
                given, more, cannot = _of_file(context, each)
                words += more
                lacking += cannot
            else:  # once: it may run a command
                given = [each] if isinstance(each, tuple) else list(_values(context, each))
                words += [word for n, value, _ in given for word in ("-p", as_word(n, value))]
            for name, value, wrapped in given:
                found[name] = {"name": name, "value": value, "wrapped": wrapped}
        return list(found.values()), words, lacking


def _made_at() -> tuple[str, int]:
    """The line of a launch file that makes the action; '' and 0 of one that is not Python."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_code.co_filename.startswith(_OURS):
        frame = frame.f_back
    return (frame.f_code.co_filename, frame.f_lineno) if frame else ("", 0)


def _words(given: Any) -> list[Any]:
    if given is None:
        return []
    if isinstance(given, str | Substitution):
        raise TypeError(f"expected a list of arguments, found {given!r:.80}")
    return list(given)


def _pair(given: Any) -> tuple[Any, Any]:
    if not isinstance(given, tuple) or len(given) != 2:
        raise TypeError(f"remap_rules must be a list of two-tuples, found {given!r:.80}")
    return given[0], given[1]


def _normalized(given: Any) -> Any:
    """An entry of a node's parameters."""
    if isinstance(given, Mapping):
        return normalize_parameter_dict(given)
    if isinstance(given, Parameter | ParameterFile):
        return given
    if not isinstance(given, str | Path | Substitution | list | tuple):
        raise TypeError(
            "Expected 'param' given to normalize_parameters to be a path, a dictionary or a "
            f"Parameter, but got '{given!r:.80}' of type '{type(given)}'"
        )
    return ParameterFile(given)


def _values(context: LaunchContext, given: Any) -> Iterable[tuple[str, Any, bool]]:
    """Name, value, and whether it surely is a text, of each parameter in an entry."""
    entries = {(*given.name,): given} if isinstance(given, Parameter) else given
    for name, value in entries.items():
        is_text = value.is_text if isinstance(value, ParameterValue) else type(value) is not list
        yield text_of(context, name), evaluated(context, value), is_text


def _of_file(
    context: LaunchContext, given: ParameterFile
) -> tuple[list[tuple[str, Any, bool]], list[str], list[str]]:
    """What a file gives; as arguments, where ROS fills it in and gives it under another name."""
    path = text_of(context, given.param_file)
    option = ["--params-file", os.path.abspath(path)]
    is_there, read = os.path.isfile(path), context.record.path(path)
    if not os.path.isfile(read):
        return [], [], option  # with a warning
    text = Path(read).read_text(encoding="utf-8")
    is_template = given.has_substitutions(context)
    if is_template:
        text = context.record.filled(text)
    data = yaml.safe_load(text)
    found, words, lacking = list[tuple[str, Any, bool]](), list[str](), list[str]()
    for node, content in data.items() if isinstance(data, dict) else ():
        values = content.get("ros__parameters") if isinstance(content, dict) else None
        found += [(str(name), value, True) for name, value in (values or {}).items()]
        of = "" if node in ("/**", "**") else f"{str(node).removeprefix('/')}:"
        if "/" in of or "*" in of:
            lacking += option
        words += [w for n, v in _flat(values or {}, of) for w in ("-p", as_word(n, v))]
    if not is_template:
        return found, option if is_there else [], [] if is_there else option
    return found, [] if lacking else words, lacking


def _flat(given: Mapping[Any, Any], before: str) -> Iterable[tuple[str, Any]]:
    """Parameters by their whole names."""
    for name, value in given.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def _namespace(context: LaunchContext, given: Any) -> tuple[str, str]:
    """The namespace within the one that is pushed; and as ROS is told, '' where it is not.

    Raises:
        ValueError: it is none.
    """
    own = None if given is None else text_of(context, given)
    outer = context.launch_configurations.get(_NAMESPACE)
    if own is None and outer is None:
        return "", ""
    inner = outer or "" if own is None else own
    if own is not None and outer and not own.startswith("/"):
        inner = f"{outer.rstrip('/')}/{own}"
    inner = inner.rstrip("/") or ("/" if inner else "")
    absolute = inner if inner.startswith("/") else f"/{inner}"
    if not re.fullmatch(r"/|(/[A-Za-z_]\w*)+", absolute, re.ASCII):
        raise ValueError(f"Invalid namespace: {absolute!r}")
    return inner, absolute


class LifecycleNode(Node):
    def __init__(self, *, name: Any, namespace: Any, autostart: Any = False, **kwargs: Any) -> None:
        super().__init__(name=name, namespace=namespace, **kwargs)


class ComposableNodeContainer(Node):
    def __init__(
        self,
        *,
        name: Any,
        namespace: Any,
        composable_node_descriptions: Any = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **kwargs)


class LoadComposableNodes(Action):
    def __init__(
        self, *, composable_node_descriptions: Any, target_container: Any, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)


class PushROSNamespace(Action):
    def __init__(self, namespace: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._namespace = namespace

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations[_NAMESPACE], _ = _namespace(context, self._namespace)


PushRosNamespace = PushROSNamespace


def _extend(context: LaunchContext, name: str, entries: Iterable[Any]) -> None:
    """In place, as the original does: what a group adds to a list from outside stays there."""
    context.launch_configurations.setdefault(name, []).extend(entries)


class SetParameter(Action):
    def __init__(self, name: Any, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._entry = normalize_parameter_dict(
            {(*normalize_to_list_of_substitutions(name),): value}
        )

    def execute(self, context: LaunchContext) -> None:
        # what a node reads of it as the original prints it: of a list, a text with brackets
        for name, value, _ in _values(context, self._entry):
            printed = str(tuple(value) if isinstance(value, list) else value)
            _extend(context, _PARAMETERS, [(name, yaml.safe_load(printed), False)])


class SetUseSimTime(Action):
    """Of the launch's own node, and no other."""

    def __init__(self, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)


class SetParametersFromFile(Action):
    def __init__(self, filename: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._filename = normalize_to_list_of_substitutions(filename)

    def execute(self, context: LaunchContext) -> None:
        _extend(context, _PARAMETERS, [ParameterFile(text_of(context, self._filename))])


class SetRemap(Action):
    def __init__(self, src: Any, dst: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._pair = src, dst

    def execute(self, context: LaunchContext) -> None:
        source, target = (text_of(context, each) for each in self._pair)
        _extend(context, _REMAPPINGS, [f"{source}:={target}"])


class SetROSLogDir(Action):
    def __init__(self, new_log_dir: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)


class ROSTimer(TimerAction):
    def __init__(self, *, period: Any, **kwargs: Any) -> None:
        super().__init__(period=normalize_typed_substitution(period, float), **kwargs)


RosTimer = ROSTimer

__all__ = exported(__name__)
__getattr__ = unknown("launch_ros.actions")
