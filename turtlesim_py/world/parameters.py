"""The parameters of the simulator and the words with which the original refuses a value."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """A declared parameter; `low` and `high` (inclusive) hold for integers only."""

    name: str
    default: bool | int
    description: str
    low: int | None = None
    high: int | None = None


def _channel(name: str, letter: str, default: int) -> Parameter:
    description = f"{name} channel of the background color"
    return Parameter(f"background_{letter}", default, description, 0, 255)


#: Those of the original, in its order of declaration.
PARAMETERS = (
    _channel("Red", "r", 69),
    _channel("Green", "g", 86),
    _channel("Blue", "b", 255),
    Parameter("holonomic", False, "If true, then turtles will be holonomic"),
)
BY_NAME = {parameter.name: parameter for parameter in PARAMETERS}


def kind_of(value: object) -> str:
    """The ROS name of a plain value's type: bool, integer, double or string."""
    if isinstance(value, bool):
        return "bool"
    return {int: "integer", float: "double", str: "string"}.get(type(value), type(value).__name__)


def wrong_type(name: str, expected: str, found: str) -> str:
    """Say, in the original's words, that a parameter cannot change its type."""
    return (
        f"Wrong parameter type, parameter {{{name}}} is of type {{{expected}}}, "
        f"setting it to {{{found}}} is not allowed."
    )


def refusal(parameter: Parameter, value: object) -> str:
    """Why the original would not set this value; '' where it would."""
    expected, found = kind_of(parameter.default), kind_of(value)
    if found != expected:
        return wrong_type(parameter.name, expected, found)
    if parameter.low is not None and parameter.high is not None:
        assert isinstance(value, int)
        if not parameter.low <= value <= parameter.high:
            return f"Parameter {{{parameter.name}}} doesn't comply with integer range."
    return ""
