"""What all of these doubles stand on: entities, substitutions, the context, and what is not known.

They are ROS's `launch` as far as a description package uses it (ros2/launch, branch jazzy): the
same names, arguments and refusals. Nothing is started: what would be is taken down in
`LaunchContext.record`. A name that ROS may have and these have not ends in `NotKnown`.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from types import ModuleType
from typing import Any

from ros_doubles import NotKnown

_MOST_ENTITIES = 10_000


#: Modules of the original whose names are not those of what is in them.
_OTHERWISE_NAMED = (
    *("boolean_substitution", "find_package", "shutdown_action", "timer_event"),
    *("matchers", "process_matchers", "process_targeted_event"),
)


def unknown(module: str) -> Any:
    """The `__getattr__` of a module: names that are not here may be in the original.

    The original has a module for each of its classes, which a double finds by that name.
    """
    vars(sys.modules[module]).setdefault("__path__", [])

    def missing(name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        found = submodule(f"{module}.{name}")
        if found is None:
            raise NotKnown(f"{module}.{name}")
        return found

    return missing


def submodule(name: str) -> ModuleType | None:
    """The module `launch.actions.group_action` of a double: with what `launch.actions` has."""
    parent, _, last = name.rpartition(".")
    if parent not in sys.modules:
        return None
    names = {each: value for each, value in vars(sys.modules[parent]).items() if each[0] != "_"}
    if last not in (*map(_snake_case, names), *_OTHERWISE_NAMED):
        return None
    return module(name, **names)


def _snake_case(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def exported(name: str, *more: str) -> list[str]:
    """What `import *` takes of a module: its own classes and functions, and more."""
    made = vars(sys.modules[name]).items()
    own = [each for each, value in made if getattr(value, "__module__", "") == name]
    return [*(each for each in own if not each.startswith("_")), *more]


def module(name: str, /, *given: Any, **more: Any) -> ModuleType:
    """A module that is a file of its own in the original: classes and functions, more by name."""
    names = {each.__name__: each for each in given} | more
    made = ModuleType(name, f"A double of ROS's `{name}`.")
    sys.modules[name] = made
    made.__dict__.update(names, __all__=list(names), __getattr__=unknown(name))
    return made


class Record:
    """What a launch file would have started, and asked for: nothing of it is kept."""

    def include(self, path: str, arguments: dict[str, str]) -> bool:
        return False

    def path(self, path: str) -> str:
        return path

    def command(self, words: list[str], on_stderr: str) -> str:
        raise NotKnown("a command")

    @property
    def time(self) -> Any:
        return self

    def __getattr__(self, name: str) -> Any:
        return lambda *_: None


class LaunchContext:
    def __init__(self, *, argv: Iterable[str] | None = None, noninteractive: bool = False) -> None:
        self.argv = list(argv or [])
        self.launch_configurations: dict[str, Any] = {}
        self.environment = os.environ
        self.locals_: dict[str, Any] = {}
        self.record = Record()
        self.environments, self.first_environment = list[dict[str, str]](), dict(os.environ)
        self.configurations: list[dict[str, Any]] = []

    @property
    def locals(self) -> Any:
        return type("Locals", (), dict(self.locals_))()

    def extend_locals(self, extensions: dict[str, Any]) -> None:
        self.locals_.update(extensions)

    def extend_globals(self, extensions: dict[str, Any]) -> None:
        self.locals_.update(extensions)

    def get_locals_as_dict(self) -> dict[str, Any]:
        return dict(self.locals_)

    def perform_substitution(self, substitution: Any) -> str:
        return str(substitution.perform(self))

    def __getattr__(self, name: str) -> Any:
        raise NotKnown(f"LaunchContext.{name}")


class Substitution:
    def perform(self, context: LaunchContext) -> str:
        return ""

    def describe(self) -> str:
        return repr(self)


class TextSubstitution(Substitution):
    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution expected str object got '{type(text)}' instead.")
        self.text = text

    def perform(self, context: LaunchContext) -> str:
        return self.text


def normalize_to_list_of_substitutions(subs: Any) -> list[Substitution]:
    def one(each: Any) -> Substitution:
        if isinstance(each, Substitution):
            return each
        if isinstance(each, str):
            return TextSubstitution(text=each)
        if isinstance(each, Path):
            return TextSubstitution(text=str(each))
        raise TypeError(
            f"Failed to normalize given item of type '{type(each)}', when only "
            "'str' or 'launch.Substitution' were expected."
        )

    if isinstance(subs, str | Path | Substitution):
        return [one(subs)]
    if isinstance(subs, Iterable):
        return [one(each) for each in subs]
    return [one(subs)]


def perform_substitutions(context: LaunchContext, subs: Iterable[Substitution]) -> str:
    return "".join(str(each.perform(context)) for each in subs)


def text_of(context: LaunchContext, subs: Any) -> str:
    """Whatever may be a substitution, as a text."""
    return perform_substitutions(context, normalize_to_list_of_substitutions(subs))


def shown(subs: Any) -> str:
    """Whatever may be a substitution, as a launch file in XML has it."""
    parts = []
    for each in normalize_to_list_of_substitutions(subs):
        name = getattr(each, "variable_name", None)
        if isinstance(each, TextSubstitution):
            parts.append(each.text)
        elif isinstance(name, list):
            parts.append(f"$(var {shown(name)})")
        else:
            parts.append(f"$({type(each).__name__})")
    return "".join(parts)


class LaunchDescriptionEntity:
    def visit(self, context: LaunchContext) -> list[Any] | None:
        return None


class Condition:
    #: in words
    told = "a condition"

    def __init__(self, *, predicate: Any = None) -> None:
        self.predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        return bool(self.predicate(context)) if self.predicate else True


class InvalidConditionExpressionError(Exception):
    pass


def evaluate_condition_expression(context: LaunchContext, expression: Any) -> bool:
    expanded = text_of(context, expression).strip().lower()
    if expanded in ("true", "1"):
        return True
    if expanded in ("false", "0"):
        return False
    raise InvalidConditionExpressionError(
        f"invalid condition expression '{expanded}', expected one of ['true', '1', 'false', '0']"
    )


class IfCondition(Condition):
    def __init__(self, predicate_expression: Any) -> None:
        super().__init__(predicate=lambda c: evaluate_condition_expression(c, predicate_expression))
        self.told = f"if {shown(predicate_expression)}"


class UnlessCondition(Condition):
    def __init__(self, predicate_expression: Any) -> None:
        super().__init__(
            predicate=lambda c: not evaluate_condition_expression(c, predicate_expression)
        )
        self.told = f"unless {shown(predicate_expression)}"


class LaunchConfigurationEquals(Condition):
    def __init__(self, launch_configuration_name: str, expected_value: Any) -> None:
        super().__init__(predicate=lambda c: _equals(c, launch_configuration_name, expected_value))


class LaunchConfigurationNotEquals(Condition):
    def __init__(self, launch_configuration_name: str, expected_value: Any) -> None:
        super().__init__(
            predicate=lambda c: not _equals(c, launch_configuration_name, expected_value)
        )


def _equals(context: LaunchContext, name: str, expected: Any) -> bool:
    value = context.launch_configurations.get(name)
    return value == (None if expected is None else text_of(context, expected))


conditions = module(
    "launch.conditions",
    *(Condition, IfCondition, UnlessCondition),
    *(LaunchConfigurationEquals, LaunchConfigurationNotEquals),
    *(InvalidConditionExpressionError, evaluate_condition_expression),
)


class Action(LaunchDescriptionEntity):
    def __init__(self, *, condition: Condition | None = None) -> None:
        self.condition = condition

    def visit(self, context: LaunchContext) -> list[Any] | None:
        if self.condition is None or self.condition.evaluate(context):
            try:
                return self.execute(context)
            finally:
                context.record.time.executed(self)
        self.skip(context)
        return None

    def skip(self, context: LaunchContext) -> None:
        """Its condition is not met."""

    def execute(self, context: LaunchContext) -> list[Any] | None:
        return None


class Executable:
    def __init__(
        self,
        *,
        cmd: Any,
        prefix: Any = None,
        name: Any = None,
        cwd: Any = None,
        env: Any = None,
        additional_env: Any = None,
        arguments: Any = None,
    ) -> None:
        self.cmd = [*cmd, *(arguments or [])]
        self.name = name


class NeedsArgument(RuntimeError):
    """A launch argument without a value: whoever launches it has to give one."""

    kind_of_problem = "argument"


class LaunchDescription(LaunchDescriptionEntity):
    def __init__(
        self, initial_entities: Iterable[Any] | None = None, *, deprecated_reason: str | None = None
    ) -> None:
        self.entities = list(islice(initial_entities or (), _MOST_ENTITIES + 1))
        if len(self.entities) > _MOST_ENTITIES:
            raise RecursionError("a launch description of actions without end")
        self.deprecated_reason = deprecated_reason

    def add_entity(self, entity: Any) -> None:
        self.entities.append(entity)

    def add_action(self, action: Any) -> None:
        self.add_entity(action)

    def visit(self, context: LaunchContext) -> list[Any] | None:
        return self.entities

    def get_launch_arguments(self, conditional_inclusion: bool = False) -> list[Any]:
        from launch.actions import DeclareLaunchArgument, GroupAction

        found: list[Any] = []
        for each in self.entities:
            if isinstance(each, DeclareLaunchArgument):
                found.append(each)
            elif isinstance(each, GroupAction):
                found += LaunchDescription(each.actions).get_launch_arguments()
        return [each for each in found if each.condition is None]


class LaunchDescriptionSource:
    def __init__(
        self, launch_description: Any = None, location: Any = "", method: str = "unspecified"
    ) -> None:
        self.given = launch_description
        self.location_ = normalize_to_list_of_substitutions(location)
        self.method = method

    @property
    def location(self) -> str:
        return "".join(getattr(each, "text", "") for each in self.location_)


class InvalidPythonLaunchFileError(Exception):
    pass


class _FileSource(LaunchDescriptionSource):
    kind = "interpreted launch file"

    def __init__(self, launch_file_path: Any) -> None:
        super().__init__(None, launch_file_path, self.kind)


class AnyLaunchDescriptionSource(_FileSource):
    pass


class PythonLaunchDescriptionSource(_FileSource):
    kind = "interpreted python launch file"


class FrontendLaunchDescriptionSource(_FileSource):
    kind = "interpreted frontend launch file"


class XMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    pass


class YAMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    pass


class LaunchService:
    """Launches without `ros2 launch`, behind `if __name__ == "__main__"`: that is not done here."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise NotKnown(type(self).__name__)


class LaunchIntrospector(LaunchService):
    pass


def walk(entities: Any, context: LaunchContext, depth: int = 0) -> None:
    """Visit what a launch service would.

    Raises:
        TypeError: it is no list of actions.
    """
    if entities is None:
        return
    for entity in entities:
        if not isinstance(entity, LaunchDescriptionEntity):
            raise TypeError(
                f"expected an action in the launch description, found {type(entity).__name__}"
            )
        if depth > 60:
            raise RecursionError("launch files or actions that lead to each other without end")
        context.record.visited(type(entity).__name__)
        walk(entity.visit(context), context, depth + 1)
