"""Launch files as ROS reads them: in Python, and in XML and YAML, whose entities become actions.

Those two have the same entities. Of XML all attributes are texts, which are converted to what they
are read as; of YAML they have types, and ROS refuses a truth value where it reads a text.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml

from ros_doubles import NotKnown
from ros_doubles.frontend_substitutions import has_later, substitutions

_OF_ROS_1 = ("param", "rosparam", "remap", "env", "machine", "test", "master")
#: What releases after Jazzy have.
_LATER = ("lifecycle_node", "log_debug", "log_info", "log_warning", "log_error")


class Entity:
    """An element of XML, or an entry of YAML; each part of it is read once.

    Args:
        attributes: of XML texts alone; of YAML lists of entities as well.
        nested: of XML all elements in it.
    """

    def __init__(
        self, tag: str, attributes: dict[str, Any], nested: list[Entity], *, is_xml: bool
    ) -> None:
        self.tag, self._nested, self._is_xml = tag, nested, is_xml
        self._attributes = dict(attributes)
        #: what was not read; of XML attributes, and kinds of elements
        self._left = {*attributes, *(f"<{each.tag}>" for each in nested if is_xml)}

    @classmethod
    def of_xml(cls, element: ElementTree.Element) -> Entity:
        nested = [cls.of_xml(each) for each in element]
        return cls(element.tag, dict(element.attrib), nested, is_xml=True)

    @classmethod
    def of_yaml(cls, tag: str, given: Any) -> Entity:
        if not isinstance(given, dict | list):
            raise TypeError(f"expected what '{tag}' has, found {given!r:.80}")
        children = given if isinstance(given, list) else given.get("children", [])
        if children and not isinstance(children, list):
            raise TypeError(f"expected a list of entities in '{tag}', found {children!r:.80}")
        nested = []
        for each in children:
            if not isinstance(each, dict) or len(each) != 1:
                raise RuntimeError(f"expected one entity in each entry, found {each!r:.80}")
            nested += [cls.of_yaml(str(name), value) for name, value in each.items()]
        attributes = given if isinstance(given, dict) else {"children": given}
        return cls(tag, attributes, nested, is_xml=False)

    def get(self, name: str, kind: Any = str) -> Any:
        """An attribute; None where there is none. See `type_utils` for kinds."""
        from launch.utilities.type_utils import coerce_to_type, is_instance_of

        self._left -= {name, f"{name}-sep"} if self._is_xml else {name}
        value: Any = self._attributes.get(name)
        if name not in self._attributes:
            return None
        if not self._is_xml:
            if not is_instance_of(value, kind, can_be_str=True):
                raise TypeError(
                    f"Attribute '{name}' of Entity '{self.tag}' expected to be of type '{kind}', "
                    f"got '{type(value)}'"
                )
            return value
        separator = self._attributes.get(f"{name}-sep")
        try:
            if separator is None:
                return coerce_to_type(value, kind, can_be_str=True)
            of = None if kind is None else kind.__args__[0]
            found = [coerce_to_type(e, of, can_be_str=True) for e in value.split(separator)]
            if not is_instance_of(found, None, can_be_str=True):
                raise ValueError
            return found
        except (AttributeError, ValueError):
            raise TypeError(
                f"Attribute '{name}' of Entity '{self.tag}' expected to be of type '{kind}'. "
                f"'{value:.80}' can not be converted to one of those types"
            ) from None

    def needed(self, name: str) -> str:
        if (value := self.get(name)) is None:
            raise AttributeError(f"Attribute '{name}' of Entity '{self.tag}' not found")
        return str(value)

    def children(self) -> list[Entity]:
        """All entities in it."""
        if not self._is_xml and "children" not in self._attributes:
            raise ValueError(f"Expected entity `{self.tag}` to have children entities")
        self._left -= {f"<{e.tag}>" for e in self._nested} if self._is_xml else {"children"}
        return self._nested

    def several(self, name: str) -> list[Entity]:
        """The entities of one kind in it."""
        self._left.discard(f"<{name}>" if self._is_xml else name)
        if self._is_xml:
            return [each for each in self._nested if each.tag == name]
        given = self._attributes.get(name, [])
        if name in self._attributes and not (isinstance(given, list) and given):
            raise TypeError(
                f"Attribute '{name}' of Entity '{self.tag}' expected to be a list of dictionaries."
            )
        return [self.of_yaml(name, each) for each in given]

    def must_be_through(self) -> None:
        """Raise ValueError: something of it was not read."""
        if self._left:
            raise ValueError(
                f"Unexpected attribute(s) or nested tag(s) found in `{self.tag}`: "
                f"{', '.join(sorted(map(str, self._left)))}"
            )

    def substitutions(self, name: str) -> Any:
        return None if (text := self.get(name)) is None else substitutions(text)

    def pairs(self, name: str, first: str = "name", second: str = "value") -> list[Any]:
        """Two attributes of each of the entities of one kind, as substitutions."""
        found = []
        for each in self.several(name):
            pair = tuple(substitutions(each.needed(of)) for of in (first, second))
            each.must_be_through()
            found.append((tuple(pair[0]), pair[1]))
        return found


def description(path: str, read: str) -> Any:
    """The description in a launch file; the reader that its name does not call for comes second.

    Args:
        read: where the file is that stands for it.

    Raises:
        Exception: it is not what ROS reads, or whatever its own code raises.
    """
    from launch import LaunchDescription

    if path.endswith(".py"):
        return _of_python(path, read)
    text = Path(read).read_text(encoding="utf-8")
    readers: list[Callable[[str], Entity]] = [_of_xml, _of_yaml]
    if read.endswith((".yaml", ".yml")):
        readers.reverse()
    try:
        root = readers[0](text)
    except Exception as error:
        try:
            root = readers[1](text)
        except Exception:
            raise error from None  # the first says more
    if root.tag != "launch":
        raise RuntimeError(f"expected 'launch' as root element, found '{root.tag}'")
    return LaunchDescription([action(each) for each in root.children()])


def _of_python(path: str, read: str) -> Any:
    """The launch description of a launch file in Python."""
    from launch.launch_description_sources import InvalidPythonLaunchFileError

    with open(read, "rb") as file:  # as bytes: a byte order mark is no fault
        code = compile(file.read(), read, "exec")
    names: dict[str, Any] = {"__name__": "python_launch_file", "__file__": path}
    exec(code, names)
    function = names.get("generate_launch_description")
    if function is None:
        raise InvalidPythonLaunchFileError(
            f"launch file at '{os.path.basename(path)}' does not contain the required function "
            "'generate_launch_description()'"
        )
    made = function()
    from launch import LaunchDescription

    if not isinstance(made, LaunchDescription):
        raise TypeError(
            f"generate_launch_description() returned {type(made).__name__}; expected a "
            "LaunchDescription"
        )
    return made


class _Builder(ElementTree.TreeBuilder):
    def doctype(self, *_: object) -> None:
        raise NotKnown("a DOCTYPE")


def _of_xml(text: str) -> Entity:
    parser = ElementTree.XMLParser(target=_Builder())
    return Entity.of_xml(ElementTree.fromstring(text, parser))


def _of_yaml(text: str) -> Entity:
    data = yaml.safe_load(text)
    if not isinstance(data, dict) or len(data) != 1:
        found = ", ".join(map(str, data)) if isinstance(data, dict) else type(data).__name__
        raise RuntimeError(f"expected 'launch' as the one root, found {found:.80}")
    ((tag, content),) = data.items()
    return Entity.of_yaml(str(tag), content)


def action(entity: Entity) -> Any:
    """The action that an entity means."""
    from launch import actions
    from launch.conditions import IfCondition, UnlessCondition
    from launch_ros import actions as ros

    #: those that take nothing but some attributes, all of which are needed
    plain: dict[str, tuple[Any, ...]] = {
        "let": (actions.SetLaunchConfiguration, "name", "value"),
        "set_env": (actions.SetEnvironmentVariable, "name", "value"),
        "unset_env": (actions.UnsetEnvironmentVariable, "name"),
        "reset_env": (actions.ResetEnvironment,),
        "push_ros_namespace": (ros.PushROSNamespace, "namespace"),
        "push-ros-namespace": (ros.PushROSNamespace, "namespace"),
        "set_parameters_from_file": (ros.SetParametersFromFile, "filename"),
        "set_parameter": (ros.SetParameter, "name", "value"),
        "set_remap": (ros.SetRemap, "from", "to"),
        "set_use_sim_time": (ros.SetUseSimTime, "value"),
        "set_ros_log_dir": (ros.SetROSLogDir, "new_log_dir"),
    }
    more: dict[str, Any] = {}
    for name, kind in (("if", IfCondition), ("unless", UnlessCondition)):
        if (text := entity.substitutions(name)) is not None:
            if more:
                raise RuntimeError("if and unless conditions can't be used simultaneously")
            more["condition"] = kind(text)
    if entity.tag in _LATER and not has_later():
        raise RuntimeError(
            f"Unrecognized entity of the type: {entity.tag} (later releases have it)"
        )
    match entity.tag:
        case "arg":
            choices = [each.needed("value") for each in entity.several("choice")]
            made = actions.DeclareLaunchArgument(
                entity.needed("name"),
                default_value=entity.substitutions("default"),
                description=entity.get("description"),
                choices=choices or None,
                **more,
            )
        case tag if tag in plain:
            of, *names = plain[tag]
            made = of(*(substitutions(entity.needed(name)) for name in names), **more)
        case "append_env":
            separator, prepend = entity.substitutions("separator"), entity.get("prepend", bool)
            more |= {} if separator is None else {"separator": separator}
            more |= {} if prepend is None else {"prepend": _if_substitutions(prepend)}
            both = (substitutions(entity.needed(name)) for name in ("name", "value"))
            made = actions.AppendEnvironmentVariable(*both, **more)
        case "reset":
            made = actions.ResetLaunchConfigurations(dict(entity.pairs("keep")), **more)
        case "node" | "lifecycle_node":
            made = _node(entity, more)
        case "include":
            given = entity.pairs("arg") + (entity.pairs("let") if has_later() else [])
            file = substitutions(entity.needed("file"))
            made = actions.IncludeLaunchDescription(file, launch_arguments=given, **more)
        case "group":
            options = {name: entity.get(name, bool) for name in ("scoped", "forwarding")}
            more |= {name: value for name, value in options.items() if value is not None}
            kept = dict(entity.pairs("keep"))
            inner = [action(each) for each in entity.children() if each.tag != "keep"]
            made = actions.GroupAction(inner, launch_configurations=kept, **more)
        case "executable":
            more |= _process(entity)
            made = actions.ExecuteProcess(cmd=_words(entity.needed("cmd")), **more)
        case "timer" | "ros_timer":
            if (period := entity.get("period", float)) is None:
                raise AttributeError(f"Attribute 'period' of Entity '{entity.tag}' not found")
            if (is_cancelled := entity.get("cancel_on_shutdown", bool)) is not None:
                more["cancel_on_shutdown"] = _if_substitutions(is_cancelled)
            of = actions.TimerAction if entity.tag == "timer" else ros.ROSTimer
            inner = [action(each) for each in entity.children()]
            made = of(period=_if_substitutions(period), actions=inner, **more)
        case "log" | "log_debug" | "log_info" | "log_warning" | "log_error":
            if has_later():
                entity.get("level")
            made = actions.LogInfo(msg=substitutions(entity.needed("message")), **more)
        case "shutdown":
            entity.substitutions("reason")
            made = actions.Shutdown(**more)
        case other if other in _OF_ROS_1:
            raise RuntimeError(f"Unrecognized entity of the type: {other} (it is one of ROS 1)")
        case other:
            raise NotKnown(f"<{other}>")
    entity.must_be_through()
    return made


def _node(entity: Entity, more: dict[str, Any]) -> Any:
    from launch_ros.actions import LifecycleNode, Node

    parameters = [_param(each) for each in entity.several("param")]
    remappings = entity.pairs("remap", "from", "to")
    own, ros = (entity.get(name) for name in ("args", "ros_args"))
    if (namespace := entity.substitutions("namespace")) is not None:
        more["namespace"] = namespace
    return (LifecycleNode if entity.tag == "lifecycle_node" else Node)(
        package=entity.substitutions("pkg"),
        executable=substitutions(entity.needed("exec")),
        exec_name=entity.substitutions("exec_name"),
        parameters=parameters,
        remappings=remappings,
        arguments=None if own is None else _words(own),
        ros_arguments=None if ros is None else _words(ros),
        **_process(entity),
        **more,
    )


def _process(entity: Entity) -> dict[str, Any]:
    """Options of whatever is started."""
    from launch.actions import Shutdown

    made = {
        **{name: entity.substitutions(name) for name in ("name", "cwd")},
        "prefix": entity.substitutions("launch-prefix"),
        "additional_env": dict(entity.pairs("env")),
    }
    kinds = {"respawn_delay": float, "respawn_max_retries": int, "shell": bool}
    typed = {name: entity.get(name, kind) for name, kind in kinds.items()}
    typed["respawn"] = entity.substitutions("respawn")
    made |= {name: value for name, value in typed.items() if value is not None}
    if (on_exit := entity.get("on_exit")) is not None:
        if on_exit != "shutdown":
            raise ValueError(f"Attribute on_exit expected to be shutdown but got `{on_exit}`")
        made["on_exit"] = [Shutdown()]
    entity.substitutions("output")
    entity.get("emulate_tty", bool)
    for name in ("respawn_delay", "sigkill_timeout", "sigterm_timeout"):
        if (seconds := entity.get(name, float)) is not None and seconds < 0.0:
            raise ValueError(f"Attribute {name} expected to be non-negative but got `{seconds}`")
    return made


def _param(entity: Entity) -> Any:
    from launch_ros.parameter_descriptions import ParameterFile

    file, name = entity.substitutions("from"), entity.get("name")
    is_template = entity.get("allow_substs", bool)
    if (file is None) == (name is None):
        raise RuntimeError("a param has either a name or from")
    if file is None:
        if is_template is not None:
            raise RuntimeError("'allow_substs' can only be used together with 'from' attribute")
        return _nested([entity])
    entity.must_be_through()
    if isinstance(is_template, str):
        is_template = substitutions(is_template)
    return ParameterFile(file, allow_substs=is_template or False)


def _nested(entities: Iterable[Entity]) -> dict[Any, Any]:
    """Parameters, of which some hold others."""
    from launch_ros.parameter_descriptions import ParameterValue

    scalars = {"str": str, "bool": bool, "int": int, "float": float}
    kinds = {**scalars, "yaml": None}
    kinds |= {f"list_of_{name}": list[kind] for name, kind in scalars.items()}  # type: ignore[valid-type]
    found: dict[Any, Any] = {}
    for each in entities:
        name = tuple(substitutions(each.needed("name")))
        of = each.get("type", None)
        if of is not None and of not in kinds:
            raise ValueError(f"Got invalid type identifier '{of}'")
        kind = None if of is None else kinds[of]
        value, inner = each.get("value", kind), each.several("param")
        each.must_be_through()
        if (value is None) == (not inner) or (inner and of is not None):
            raise RuntimeError("a param has either a value or params in it")
        if inner:
            found[name] = _nested(inner)
        else:
            found[name] = ParameterValue(_if_substitutions(value), value_type=kind)
    return found


def _if_substitutions(value: Any) -> Any:
    """A value, or the substitutions in it; of a list, which is of one type, of each item."""
    from launch._core import TextSubstitution

    if isinstance(value, list):
        found = [_if_substitutions(each) for each in value]
        if len({type(each) for each in found if not isinstance(each, list)}) > 1:
            raise ValueError("The result is a non-uniform list")
        return found
    if not isinstance(value, str):
        return value
    match substitutions(value):
        case [TextSubstitution(text=text)]:
            return text
        case parts:
            return parts


def _words(text: str) -> list[list[Any]]:
    """The words of a command, split after its substitutions are found, as ROS does."""
    from launch._core import TextSubstitution

    words: list[list[Any]] = []
    word: list[Any] = []
    for part in substitutions(text):
        if not isinstance(part, TextSubstitution):
            word.append(part)
            continue
        tokens = [[TextSubstitution(text=each)] for each in shlex.split(part.text)]
        if not tokens or (part.text[0].isspace() and word):
            words.append(word)
            word = []
        if not tokens:
            continue
        word += tokens[0]
        if len(tokens) > 1:
            words.append(word)
            words += tokens[1:-1]
            word = tokens[-1]
        if part.text[-1].isspace():
            words.append(word)
            word = []
    return [*words, word] if word else words
