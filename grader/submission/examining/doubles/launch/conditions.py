"""A double of ROS's `launch.conditions`: which texts are true, and which are refused."""

from __future__ import annotations

from typing import Any

from launch._core import Condition, LaunchContext, exported, shown, text_of, unknown


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


__all__ = exported(__name__, "Condition")
__getattr__ = unknown("launch.conditions")
