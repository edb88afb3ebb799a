"""A node with rclcpp's texts for refusals and warnings, where rclpy's differ."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import qos_policy_name_from_kind

from turtlesim_py.ros import interfaces
from turtlesim_py.ros.interfaces import Interfaces
from turtlesim_py.world.arena import wrong_type

Value = TypeVar("Value", bound=bool | int | float | str)

OFFERED = "New publisher discovered on topic '{}', offering incompatible QoS. "
REQUESTED = "New subscription discovered on topic '{}', requesting incompatible QoS. "
NO_MESSAGES = "No messages will be sent to it. Last incompatible policy: {}_QOS_POLICY"

#: The types that a parameter can have, as numbers of rcl_interfaces/msg/ParameterType; rclcpp's
#: words for others, before it aborts.
TYPES = frozenset(kind.value for kind in Parameter.Type)
UNKNOWN_TYPE = "Unknown type: {}"

#: A type -> how its values are written on the command line.
IN_WORDS: dict[type, str] = {
    bool: "true or false",
    int: "a whole number",
    float: "a number with a decimal point",
    str: "a string",
}


class UnusableStart(Exception):
    """A program cannot start with its arguments or parameters; the text explains why."""


class UnusableParameter(UnusableStart):
    """A parameter cannot have the value with which the node was started."""

    def __init__(self, name: str, value: object, expected: str) -> None:
        super().__init__(f"parameter {name} is {value!r}, expected {expected}")


class RclcppNode(Node):
    """A node whose refusals and warnings read like those of a C++ node."""

    def __init__(self, name: str, **more: Any) -> None:
        super().__init__(name, **more)
        # those of rclpy raise an exception for a value of a type that ROS does not have
        setters = {SetParameters: self._on_set, SetParametersAtomically: self._on_set_atomically}
        for service in self.services:
            service.callback = setters.get(service.srv_type, service.callback)

    def log(self, severity: str, text: str) -> None:
        """Log a line with a severity of rcutils ("INFO", "WARN", ...).

        rclpy's logger looks through the files of all modules for the caller of the first line,
        which takes most of a tick, and refuses a caller that changes its severity.
        """
        caller = sys._getframe(1)
        code, name = caller.f_code, self.get_logger().name
        where = code.co_name, code.co_filename, caller.f_lineno
        _rclpy.rclpy_logging_rcutils_log(LoggingSeverity[severity], name, text, *where)

    # Parameters -------------------------------------------------------------------------------

    def declare(
        self,
        name: str,
        default: Value,
        description: str,
        limits: tuple[float, float] | None = None,
        read_only: bool = False,
    ) -> Value:
        """Declare a parameter and return its value; `limits` are the least and the largest.

        Raises:
            UnusableParameter: the value that it was started with is of another type or outside.
        """
        descriptor = ParameterDescriptor(description=description, read_only=read_only)
        expected = IN_WORDS[type(default)]
        if limits:
            expected += " from {} to {}".format(*limits)
            low, high = limits
            if isinstance(default, int):
                descriptor.integer_range = [IntegerRange(from_value=low, to_value=high, step=1)]
            else:
                descriptor.floating_point_range = [
                    FloatingPointRange(from_value=low, to_value=high)
                ]
        try:
            value: Value = self.declare_parameter(name, default, descriptor).value
        except (InvalidParameterTypeException, InvalidParameterValueException):
            found = self._parameter_overrides[name].value
            raise UnusableParameter(name, found, expected) from None
        return value

    def declare_interfaces(self) -> Interfaces:
        """Declare the parameter `interfaces`; return the classes of the package that it names.

        Raises:
            UnusableParameter: there is no such package here.
        """
        one_of = f"one of {', '.join(interfaces.NAMES)}"
        name = self.declare(
            "interfaces",
            interfaces.usual(),
            f"Package of turtlesim's messages, services and action, {one_of}",
            read_only=True,
        )
        if name not in interfaces.NAMES:
            raise UnusableParameter("interfaces", name, one_of)
        if name not in (there := interfaces.installed()):
            found = f"here is {' and '.join(there) or 'neither of them'}"
            raise UnusableParameter("interfaces", name, f"an installed package, and {found}")
        return Interfaces.of(name)

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all or none; an undeclared one is a refusal here, an exception in rclpy."""
        for parameter in parameter_list:
            if not self.has_parameter(parameter.name):
                reason = f"parameter '{parameter.name}' cannot be set because it was not declared"
                return SetParametersResult(successful=False, reason=reason)
        return super().set_parameters_atomically(parameter_list)

    def _on_set(self, request: Any, response: Any) -> Any:
        response.results = [self._set([message]) for message in request.parameters]
        return response

    def _on_set_atomically(self, request: Any, response: Any) -> Any:
        response.result = self._set(request.parameters)
        return response

    def _set(self, messages: Sequence[ParameterMessage]) -> SetParametersResult:
        for message in messages:
            if message.value.type not in TYPES:
                reason = UNKNOWN_TYPE.format(message.value.type)
                return SetParametersResult(successful=False, reason=reason)
        return self.set_parameters_atomically(list(map(Parameter.from_parameter_msg, messages)))

    def _apply_descriptor(
        self,
        parameter: Parameter,
        descriptor: ParameterDescriptor | None = None,
        check_read_only: bool = True,
    ) -> SetParametersResult:
        """Called by rclpy for each value that is to be declared or set."""
        result = super()._apply_descriptor(parameter, descriptor, check_read_only)
        if not result.successful:
            descriptor = descriptor or self.describe_parameter(parameter.name)
            result.reason = _refusal(parameter, descriptor, check_read_only)
        return result

    # Quality of service -----------------------------------------------------------------------

    def warn_subscribers(self, topic: str) -> PublisherEventCallbacks:
        """Return callbacks by which a publisher warns of subscribers that it cannot serve."""
        return PublisherEventCallbacks(incompatible_qos=self._warner(REQUESTED, topic))

    def warn_publishers(self, topic: str) -> SubscriptionEventCallbacks:
        """Return callbacks by which a subscription warns of publishers that cannot serve it."""
        return SubscriptionEventCallbacks(incompatible_qos=self._warner(OFFERED, topic))

    def _warner(self, text: str, topic: str) -> Callable[[Any], None]:
        begin = text.format(self.resolve_topic_name(topic))

        def warn(event: Any) -> None:
            policy = qos_policy_name_from_kind(event.last_policy_kind)
            self.log("WARN", begin + NO_MESSAGES.format(policy))

        return warn


def _refusal(parameter: Parameter, descriptor: ParameterDescriptor, check_read_only: bool) -> str:
    """Return why a parameter is not set; rclcpp checks in this order."""
    if check_read_only and descriptor.read_only:
        return f"parameter '{parameter.name}' cannot be set because it is read-only"
    if parameter.type_ == Parameter.Type.NOT_SET:
        return "cannot undeclare a statically typed parameter"
    expected = Parameter.Type(descriptor.type)
    if parameter.type_ != expected:
        return wrong_type(parameter.name, expected.name.lower(), parameter.type_.name.lower())
    kind = "integer" if descriptor.integer_range else "floating point"
    return f"Parameter {{{parameter.name}}} doesn't comply with {kind} range."
