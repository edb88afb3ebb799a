"""A double of ROS's `launch.actions`."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import Any

from launch._core import (
    Action,
    AnyLaunchDescriptionSource,
    Executable,
    LaunchContext,
    LaunchDescriptionSource,
    NeedsArgument,
    Substitution,
    exported,
    normalize_to_list_of_substitutions,
    text_of,
    unknown,
)
from launch.events import Shutdown as ShutdownEvent
from launch.utilities.type_utils import normalize_typed_substitution, perform_typed_substitution

from ros_doubles import NotKnown

#: Nothing starts later [s].
_LONGEST_S = 1e6


class DeclareLaunchArgument(Action):
    def __init__(
        self,
        name: str,
        *,
        default_value: Any = None,
        description: str | None = None,
        choices: list[str] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.name = name
        self.default_value = (
            None if default_value is None else normalize_to_list_of_substitutions(default_value)
        )
        if choices is not None and not choices:
            raise RuntimeError("Provided choices arg is empty. Use None to ignore the choice list.")
        plain = default_value is not None and not isinstance(default_value, Substitution | list)
        if choices is not None and plain and default_value not in choices:
            raise RuntimeError(
                f'Provided default_value "{default_value}" is not in provided choices "{choices}".'
            )
        self.description = description or "no description given"
        self.choices = choices

    def execute(self, context: LaunchContext) -> None:
        context.record.declared(self.name)
        known = context.launch_configurations
        if self.name not in known:
            if self.default_value is not None:
                known[self.name] = text_of(context, self.default_value)
            elif self.choices is not None:
                known[self.name] = str(self.choices[0])
                context.record.chose(self.name, known[self.name])
            else:
                raise NeedsArgument(f'Required launch argument "{self.name}" was not provided.')
        if self.choices is not None and known[self.name] not in self.choices:
            raise RuntimeError(
                f'Argument "{self.name}" provided value "{known[self.name]}" is not valid. '
                f"Valid options are: {self.choices}"
            )


class IncludeLaunchDescription(Action):
    def __init__(
        self, launch_description_source: Any, *, launch_arguments: Any = None, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        if not isinstance(launch_description_source, LaunchDescriptionSource):
            launch_description_source = AnyLaunchDescriptionSource(launch_description_source)
        self.launch_description_source = launch_description_source
        self.launch_arguments = tuple(launch_arguments or ())

    def execute(self, context: LaunchContext) -> list[Any] | None:
        source = self.launch_description_source
        given = [(text_of(context, n), text_of(context, v)) for n, v in self.launch_arguments]
        if source.given is not None:
            return self.included(source.given, given)
        context.record.include(text_of(context, source.location_), self, given)
        return None

    def included(self, description: Any, given: Iterable[tuple[str, str]]) -> list[Any]:
        """What is done of a description that these arguments are given.

        Raises:
            RuntimeError: it needs others, even where they are set outside.
        """
        settings = dict(given)
        for each in description.get_launch_arguments():
            if each.default_value is None and each.name not in settings:
                raise RuntimeError(
                    f"Included launch description missing required argument '{each.name}' "
                    f"(description: '{each.description}'), given: [{', '.join(settings)}]"
                )
        return [*(SetLaunchConfiguration(*each) for each in settings.items()), description]


class GroupAction(Action):
    def __init__(
        self,
        actions: Iterable[Any],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: dict[Any, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.actions = list(actions)
        self._scoped, self._forwarding = scoped, forwarding
        self._more = launch_configurations or {}

    def execute(self, context: LaunchContext) -> list[Any]:
        entries = [SetLaunchConfiguration(*each) for each in self._more.items()]
        if not self._scoped:
            return [*entries, *self.actions]
        if not self._forwarding:
            entries = [ResetEnvironment(), ResetLaunchConfigurations(self._more)]
        return [
            *(PushLaunchConfigurations(), PushEnvironment(), *entries, *self.actions),
            *(PopEnvironment(), PopLaunchConfigurations()),
        ]


class TimerAction(Action):
    def __init__(
        self, *, period: Any, actions: Iterable[Any], cancel_on_shutdown: Any = True, **kwargs: Any
    ) -> None:
        super().__init__(**kwargs)
        if isinstance(period, int):
            raise TypeError(f"'TimerAction' expected 'period' to be a float, but got {period!r}")
        period = float(period) if isinstance(period, str) else period
        self.period = normalize_typed_substitution(period, float)
        normalize_typed_substitution(cancel_on_shutdown, bool)
        self.actions = list(actions)

    def execute(self, context: LaunchContext) -> None:
        seconds = perform_typed_substitution(context, self.period, float)
        if not 0 <= seconds <= _LONGEST_S:
            raise ValueError(f"a period of {seconds} s")
        context.record.time.later(self.actions, seconds)


class OpaqueFunction(Action):
    def __init__(
        self,
        *,
        function: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: dict[str, Any] | None = None,
        **left_over_kwargs: Any,
    ) -> None:
        super().__init__(**left_over_kwargs)
        if not callable(function):
            raise TypeError(
                f"OpaqueFunction expected a callable for 'function', got '{type(function)}'"
            )
        self._call = function, list(args or []), dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Any:
        function, args, kwargs = self._call
        made = function(context, *args, **kwargs)
        if not isinstance(made, Iterable | None):
            name = getattr(function, "__name__", "the function")
            raise TypeError(f"{name}() returned {type(made).__name__}, expected a list of actions")
        return made


class RegisterEventHandler(Action):
    def __init__(self, event_handler: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        context.record.time.handler(self.event_handler)


class UnregisterEventHandler(RegisterEventHandler):
    def execute(self, context: LaunchContext) -> None:
        context.record.time.unregister(self.event_handler)


class ExecuteLocal(Action):
    def __init__(
        self,
        *,
        process_description: Any,
        shell: bool = False,
        sigterm_timeout: Any = "5",
        sigkill_timeout: Any = "5",
        emulate_tty: bool = False,
        output: Any = "log",
        output_format: str = "",
        cached_output: bool = False,
        log_cmd: bool = False,
        on_exit: Any = None,
        respawn: Any = False,
        respawn_delay: float | None = None,
        respawn_max_retries: int = -1,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if not isinstance(output, dict):
            normalize_to_list_of_substitutions(output)
        self.process_description = process_description
        self.on_exit, self.shell = on_exit, shell
        self._respawn = normalize_typed_substitution(respawn, bool)
        self._respawns = respawn_delay or 0.0, respawn_max_retries
        #: options that are not followed
        self.ignored = list[str]()
        self._has_executed = False

    def execute(self, context: LaunchContext) -> None:
        self.must_be_first()
        words = [text_of(context, word) for word in self.process_description.cmd]
        context.record.process(words, self)

    def must_be_first(self) -> None:
        if self._has_executed:
            raise RuntimeError(f"{type(self).__name__} action: executed more than once")
        self._has_executed = True

    def respawns(self, context: LaunchContext) -> tuple[float, int]:
        """How long after its end it is started again [s], and how often; below 0: always."""
        is_again = perform_typed_substitution(context, self._respawn, bool)
        return self._respawns if is_again else (0.0, 0)

    def printed(self, context: LaunchContext, program: str) -> str:
        """What `ros2 launch` calls it, but for a number."""
        name = self.process_description.name
        return os.path.basename(program) if name is None else text_of(context, name)


class ExecuteProcess(ExecuteLocal):
    def __init__(
        self,
        *,
        cmd: Iterable[Any],
        prefix: Any = None,
        name: Any = None,
        cwd: Any = None,
        env: Any = None,
        additional_env: Any = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            process_description=Executable(
                cmd=[normalize_to_list_of_substitutions(word) for word in cmd], name=name
            ),
            **kwargs,
        )
        self._environment = [
            [normalize_to_list_of_substitutions(text) for text in each]
            for each in dict(additional_env or {}).items()
        ]
        given = {"prefix": prefix, "cwd": cwd, "env": env}
        self.ignored += [name for name, value in given.items() if value]

    def environment(self, context: LaunchContext) -> dict[str, str]:
        """The variables of its process alone."""
        return {text_of(context, name): text_of(context, to) for name, to in self._environment}

    @property
    def cmd(self) -> list[Any]:
        return list(self.process_description.cmd)


class _NameAndValue(Action):
    """Gives something of a name a value."""

    def __init__(self, name: Any, value: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._both = (
            normalize_to_list_of_substitutions(name),
            normalize_to_list_of_substitutions(value),
        )

    def texts(self, context: LaunchContext) -> tuple[str, str]:
        name, value = self._both
        return text_of(context, name), text_of(context, value)


class SetEnvironmentVariable(_NameAndValue):
    def execute(self, context: LaunchContext) -> None:
        name, value = self.texts(context)
        context.environment[name] = value


class AppendEnvironmentVariable(_NameAndValue):
    def __init__(
        self,
        name: Any,
        value: Any,
        prepend: Any = False,
        separator: Any = os.pathsep,
        **kwargs: Any,
    ) -> None:
        super().__init__(name, value, **kwargs)
        self._prepend = normalize_typed_substitution(prepend, bool)
        self._separator = normalize_to_list_of_substitutions(separator)

    def execute(self, context: LaunchContext) -> None:
        name, value = self.texts(context)
        parts = [context.environment[name], value] if name in context.environment else [value]
        if perform_typed_substitution(context, self._prepend, bool):
            parts.reverse()
        context.environment[name] = text_of(context, self._separator).join(parts)


class UnsetEnvironmentVariable(Action):
    def __init__(self, name: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name = name

    def execute(self, context: LaunchContext) -> None:
        context.environment.pop(text_of(context, self._name), None)


class SetLaunchConfiguration(_NameAndValue):
    def execute(self, context: LaunchContext) -> None:
        name, value = self.texts(context)
        context.launch_configurations[name] = value


class UnsetLaunchConfiguration(Action):
    def __init__(self, name: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name = name

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations.pop(text_of(context, self._name), None)


class LogInfo(Action):
    def __init__(self, *, msg: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._msg = normalize_to_list_of_substitutions(msg)

    def execute(self, context: LaunchContext) -> None:
        text_of(context, self._msg)


class EmitEvent(Action):
    def __init__(self, *, event: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        if isinstance(self.event, ShutdownEvent):
            context.record.time.shut_down()


class Shutdown(EmitEvent):
    def __init__(self, *, reason: Any = "reason not given", **kwargs: Any) -> None:
        super().__init__(event=ShutdownEvent(reason=reason), **kwargs)


def _popped(stack: list[dict[str, Any]], name: str) -> dict[str, Any]:
    if not stack:
        raise RuntimeError(f"{name} stack unexpectedly empty")
    return stack.pop()


class PushLaunchConfigurations(Action):
    def execute(self, context: LaunchContext) -> None:
        context.configurations.append(dict(context.launch_configurations))


class PopLaunchConfigurations(Action):
    def execute(self, context: LaunchContext) -> None:
        stack = context.configurations
        context.launch_configurations = _popped(stack, "launch_configurations")


class PushEnvironment(Action):
    def execute(self, context: LaunchContext) -> None:
        context.environments.append(dict(context.environment))


class PopEnvironment(Action):
    def execute(self, context: LaunchContext) -> None:
        before = _popped(context.environments, "environment")
        context.environment.clear()
        context.environment.update(before)


class ResetEnvironment(Action):
    def execute(self, context: LaunchContext) -> None:
        context.environment.clear()
        context.environment.update(context.first_environment)


class ResetLaunchConfigurations(Action):
    def __init__(self, launch_configurations: dict[Any, Any] | None = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._kept = launch_configurations or {}

    def execute(self, context: LaunchContext) -> None:
        kept = {text_of(context, n): text_of(context, v) for n, v in self._kept.items()}
        context.launch_configurations.clear()
        context.launch_configurations.update(kept)


class OpaqueCoroutine(Action):
    def __init__(self, *, coroutine: Any, **kwargs: Any) -> None:
        raise NotKnown("OpaqueCoroutine")


__all__ = exported(__name__)
__getattr__ = unknown("launch.actions")
