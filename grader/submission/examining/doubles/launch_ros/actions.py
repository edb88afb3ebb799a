"""A double of ROS's `launch_ros.actions`."""

from __future__ import annotations

import json
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
from launch_ros.parameter_descriptions import (
    Parameter,
    ParameterFile,
    ParameterValue,
    evaluated,
    is_substitution,
)

#: What evaluates launch files.
_OURS = str(Path(__file__).resolve().parents[2])
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
        self._parameters = [_known(each) for each in parameters or []]
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
        namespace = _namespace(context, self._namespace)
        own, ros = ([text_of(context, e) for e in words] for words in (self._arguments, self._ros))
        remappings = [
            f"{text_of(context, a)}:={text_of(context, b)}"
            for a, b in (*context.launch_configurations.get(_REMAPPINGS, ()), *self._remappings)
        ]
        absolute = namespace if namespace.startswith("/") or not namespace else f"/{namespace}"
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
            is_file = not isinstance(each, Parameter | Mapping)
            if is_file:
                path = text_of(context, getattr(each, "param_file", each))
                is_template = getattr(each, "allow_substs", False)
                is_there = os.path.isfile(path) and not is_template
                (words if is_there else lacking).extend(("--params-file", os.path.abspath(path)))
            for name, value, wrapped in _values(context, each):  # once: it may run a command
                found[name] = {"name": name, "value": value, "wrapped": wrapped}
                if not is_file:
                    text = json.dumps(value, default=str, ensure_ascii=False)
                    words += ["-p", f"{name}:={text}"]
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
    if not isinstance(given, list | tuple) or len(given) != 2:
        raise TypeError(f"remap_rules must be a list of two-tuples, found {given!r:.80}")
    return given[0], given[1]


def _known(given: Any) -> Any:
    kinds = (Mapping, str, Path, Substitution, ParameterFile, Parameter, list, tuple)
    if not isinstance(given, kinds):
        raise TypeError(
            "Expected 'param' given to normalize_parameters to be a path, a dictionary or a "
            f"Parameter, but got '{given!r:.80}' of type '{type(given)}'"
        )
    return given


def _values(context: LaunchContext, given: Any) -> Iterable[tuple[str, Any, bool]]:
    """Name, value, and whether it surely is a text, of each parameter in an entry."""
    if isinstance(given, Parameter):
        yield text_of(context, given.name), given.evaluate(context), given.is_text
    elif isinstance(given, Mapping):
        yield from _of_mapping(context, given, "")
    else:
        path = given.param_file if isinstance(given, ParameterFile) else given
        yield from _of_file(context.record.path(text_of(context, path)))


def _of_mapping(
    context: LaunchContext, given: Mapping[Any, Any], before: str
) -> Iterable[tuple[str, Any, bool]]:
    for key, value in given.items():
        if not isinstance(key, str | Substitution | list | tuple):
            raise TypeError(f"Expected 'key' of a parameter to be a text, but got {key!r:.80}")
        name = f"{before}{text_of(context, key)}"
        if isinstance(value, Mapping):
            yield from _of_mapping(context, value, f"{name}.")
        elif isinstance(value, ParameterValue):
            yield name, value.evaluate(context), value.is_text
        else:
            yield name, evaluated(context, value), not is_substitution(value)


def _of_file(path: str) -> Iterable[tuple[str, Any, bool]]:
    if not os.path.isfile(path):
        return  # with a warning
    data = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    for node in data.values() if isinstance(data, dict) else ():
        found = node.get("ros__parameters") if isinstance(node, dict) else None
        for name, value in (found or {}).items():
            yield str(name), value, True


def _namespace(context: LaunchContext, given: Any) -> str:
    own = "" if given is None else text_of(context, given)
    outer = context.launch_configurations.get(_NAMESPACE, "")
    return own if own.startswith("/") or not outer else "/".join(filter(None, (outer, own)))


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
        context.launch_configurations[_NAMESPACE] = _namespace(context, self._namespace)


PushRosNamespace = PushROSNamespace


class _SetsParameters(Action):
    def __init__(self, parameters: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._parameters = parameters

    def execute(self, context: LaunchContext) -> None:
        # in place, as the original does: what a group adds to a list from outside stays there
        context.launch_configurations.setdefault(_PARAMETERS, []).append(self._parameters)


class SetParameter(_SetsParameters):
    def __init__(self, name: Any, value: Any, **kwargs: Any) -> None:
        super().__init__(Parameter(name, value), **kwargs)


class SetUseSimTime(SetParameter):
    def __init__(self, value: Any, **kwargs: Any) -> None:
        super().__init__("use_sim_time", value, **kwargs)


class SetParametersFromFile(_SetsParameters):
    def __init__(self, filename: Any, node_name: Any = None, **kwargs: Any) -> None:
        super().__init__(ParameterFile(filename), **kwargs)


class SetRemap(Action):
    def __init__(self, src: Any, dst: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._pair = _pair((src, dst))

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations.setdefault(_REMAPPINGS, []).append(self._pair)


class SetROSLogDir(Action):
    def __init__(self, new_log_dir: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)


class ROSTimer(TimerAction):
    pass


RosTimer = ROSTimer

__all__ = exported(__name__)
__getattr__ = unknown("launch_ros.actions")
