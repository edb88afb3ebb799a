"""What virtual time assumes of rclpy's internals, and the checks of these assumptions.

None of this is rclpy's public interface, and any release may change it. So each assumption has a
name here and is checked before anything is replaced: with an rclpy that breaks one, a run goes in
real time, and the result says which. The checks read attributes and the signatures that pybind11
writes into docstrings; they make objects only where these need no DDS. That costs 4 ms of processor
time; a node, without which there is no entity, costs ten times as much, and would show no more.

| group | used by |
|---|---|
| `ENTITIES` | both sides: `endpoints`, `actions`, `waitsets` |
| `PROGRAM` | the submission's side: `clock.rclpy_time`, and `observe.ending` by their names |
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable, Iterable
from functools import partial
from itertools import chain
from typing import Any, NamedTuple

from grader.system import versions as system
from grader.text.message import NOTHING, Message, msg

#: Stands for rclpy's extension module, whatever it is called.
CPP = "_rclpy"


class Assumption(NamedTuple):
    """Something that must hold.

    Attributes:
        name: what it is about, "Executor._tasks".
        check: returns what is wrong, "Executor has no _tasks", or '' where it holds. If it raises
            an exception, that is what is wrong.
    """

    name: str
    check: Callable[[], str]


def broken(*groups: Iterable[Assumption]) -> Message:
    """Return the first of these assumptions that does not hold, in one line; NOTHING if all hold.

    Without groups: those that both sides need.
    """
    for name, check in chain.from_iterable(groups or (ENTITIES,)):
        try:
            fault = check()
        except Exception as error:
            fault = f"{name}: {error!r}"
        if fault:
            return msg(
                "virtual time does not fit rclpy {version}: {fault}",
                version=system.rclpy_version(),
                fault=fault,
            )
    return NOTHING


def _module(name: str) -> Any:
    if name == CPP:
        return importlib.import_module("rclpy.impl.implementation_singleton").rclpy_implementation
    return importlib.import_module(name)


# How assumptions are checked ------------------------------------------------------------------


def _has(module: str, owner: str, *names: str) -> list[Assumption]:
    """Assume that a class, or with '' a module, has attributes."""
    return [Assumption(f"{owner}.{n}", partial(_has_no, module, owner, n)) for n in names]


def _has_no(module: str, owner: str, name: str) -> str:
    thing = _module(module)
    if owner and not hasattr(thing, owner):
        return f"there is no {module}.{owner}"
    found = hasattr(getattr(thing, owner) if owner else thing, name)
    return "" if found else f"{owner or module} has no {name}"


def _arity(owner: str, **counts: int) -> list[Assumption]:
    """Assume the number of arguments of a C++ class's methods; a constructor may take more."""
    return [Assumption(f"{owner}.{n}", partial(_arity_fault, owner, n, counts[n])) for n in counts]


def _arity_fault(owner: str, name: str, count: int) -> str:
    kind = getattr(_module(CPP), owner, None)
    if kind is None:
        return f"there is no {owner}"
    method = getattr(kind, name, None)
    if method is None:
        return f"{owner} has no {name}"
    most, least = _arguments(method.__doc__ or "")
    if least <= count <= most or (name == "__init__" and count <= most):
        return ""
    shown = owner if name == "__init__" else f"{owner}.{name}"
    return f"{shown}() takes {most} arguments instead of {count}"


def _arguments(doc: str) -> tuple[int, int]:
    """Return how many arguments, at most and at least, a pybind11 function takes, without self."""
    signature = re.match(r"\w+\((.*)\)(?: -> .*)?$", doc.strip().partition("\n")[0])
    if signature is None:
        raise ValueError("no signature that we can read")
    depth, parts = 0, [""]
    for sign in signature[1]:
        depth += (sign in "([{") - (sign in ")]}")
        if sign == "," and not depth:
            parts.append("")
        else:
            parts[-1] += sign
    arguments = [text.strip() for text in parts if text.strip() and not text.startswith("self:")]
    return len(arguments), sum(" = " not in text for text in arguments)


def _quality_of_service() -> str:
    """Check that a C profile converts to Python's, where a program's request can be read."""
    from rclpy.qos import QoSProfile, qos_check_compatible

    fields = QoSProfile(depth=3).get_c_qos_profile().to_dict()
    if fields.get("depth") != 3:
        return "a QoS profile has no depth"
    profile = QoSProfile(**{**fields, "depth": 5})
    qos_check_compatible(profile, profile)
    return "" if profile.get_c_qos_profile().to_dict()["depth"] == 5 else "QoS profiles lose depth"


def _request_headers() -> str:
    """Check that headers can be subclassed; rclpy's Python passes those through."""
    cpp = _module(CPP)
    for name in ("rmw_service_info_t", "rmw_request_id_t"):
        kind: Any = type(name, (getattr(cpp, name),), {})
        header = kind.__new__(kind)
        header.number = 5
        if header.number != 5:
            return f"{name} takes nothing of ours"
    return ""


def _overridden_clock() -> str:
    """Check that a ROS clock shows an overridden time; all our clocks are ROS clocks."""
    cpp = _module(CPP)
    ros_time = int(cpp.ClockType.ROS_TIME)
    clock = cpp.Clock(ros_time)
    clock.set_ros_time_override_is_enabled(True)
    clock.set_ros_time_override(cpp.rcl_time_point_t(5, ros_time))
    return "" if clock.get_now().nanoseconds == 5 else "a clock does not show the time it is told"


# What is assumed ------------------------------------------------------------------------------

#: Of entities, wait sets and clocks in C++, and of the Python that passes them through.
ENTITIES: tuple[Assumption, ...] = (
    # node, type, name, quality of service
    *_arity("Publisher", __init__=4, publish=1, publish_raw=1, get_subscription_count=0),
    *_arity("Publisher", get_topic_name=0, destroy_when_not_in_use=0),
    *_arity("Subscription", __init__=4, take_message=2, get_publisher_count=0, get_topic_name=0),
    *_arity("Subscription", destroy_when_not_in_use=0),
    *_arity("Client", __init__=4, send_request=1, take_response=1, service_server_is_available=0),
    *_arity("Client", destroy_when_not_in_use=0),
    *_arity("Service", __init__=4, service_take_request=1, service_send_response=2),
    *_arity("Service", destroy_when_not_in_use=0),
    *_has(CPP, "Client", "service_name", "pointer"),
    *_has(CPP, "Service", "name", "pointer"),
    *_has(CPP, "Subscription", "pointer"),
    # name, namespace, context, and whatever follows
    *_arity("Node", __init__=3),
    *_arity("Context", ok=0),
    *_arity("LifecycleStateMachine", __init__=2),
    *_has(CPP, "", "rclpy_serialize", "rclpy_deserialize"),
    Assumption("request headers", _request_headers),
    *_arity("Node", get_count_clients=1, get_count_services=1),
    *_arity("Node", get_count_publishers=1, get_count_subscribers=1),
    Assumption("quality of service", _quality_of_service),
    # node, type, name, quality of service of goal, result, cancel, feedback, status
    *_arity("ActionClient", __init__=8, is_action_server_available=0, send_goal_request=1),
    *_arity("ActionClient", send_cancel_request=1, send_result_request=1, take_goal_response=1),
    *_arity("ActionClient", take_cancel_response=1, take_result_response=1, take_feedback=1),
    *_arity("ActionClient", take_status=1, add_to_waitset=1, is_ready=1),
    # node, clock, type, name, quality of service of the same five, time-out
    *_arity("ActionServer", __init__=10, take_goal_request=1, take_cancel_request=1),
    *_arity("ActionServer", take_result_request=1, send_goal_response=2, send_cancel_response=2),
    *_arity("ActionServer", send_result_response=2, publish_feedback=1, publish_status=0),
    *_arity("ActionServer", notify_goal_done=0, expire_goals=1, add_to_waitset=1, is_ready=1),
    *_arity("ActionGoalHandle", __init__=2, get_status=0),
    *_arity("WaitSet", __init__=7, clear_entities=0, wait=1, get_ready_entities=1, is_ready=2),
    *_arity("WaitSet", add_subscription=1, add_client=1, add_service=1, add_guard_condition=1),
    *_arity("WaitSet", add_timer=1, add_event=1),
    *_arity("GuardCondition", __init__=1, trigger_guard_condition=0),
    *_has(CPP, "GuardCondition", "pointer"),
    # clock, context, period, autostart
    *_arity("Timer", __init__=4, reset_timer=0, cancel_timer=0, change_timer_period=1),
    *_arity("Timer", is_timer_ready=0, time_until_next_call=0, destroy_when_not_in_use=0),
    *_has(CPP, "Timer", "pointer"),
    *_has(CPP, "EventHandle", "take_event"),
    *_arity("Clock", __init__=1, get_now=0, get_ros_time_override_is_enabled=0),
    *_arity("Clock", set_ros_time_override_is_enabled=1, set_ros_time_override=1),
    *_arity("Clock", add_clock_callback=4, remove_clock_callback=1),
    *_has(CPP, "ClockType", "ROS_TIME", "STEADY_TIME", "SYSTEM_TIME"),
    Assumption("a clock's override", _overridden_clock),
    *_has(CPP, "", "RCLError", "NodeNameNonExistentError", "rclpy_resolve_name"),
    *_has(CPP, "", "rmw_matched_status_t", "rmw_requested_qos_incompatible_event_status_t"),
    *_has(CPP, "", "rclpy_get_topic_names_and_types", "rclpy_get_service_names_and_types"),
    *_has(CPP, "", *(f"rclpy_get_{n}_info_by_topic" for n in ("publishers", "subscriptions"))),
    *(
        _has(CPP, "", f"rclpy_get_{which}_names_and_types_by_node")[0]
        for which in ("publisher", "subscriber", "service", "client")
    ),
    *_arity("Node", get_node_names_and_namespaces=0, get_action_names_and_types=0),
    *_arity("Node", get_node_names_and_namespaces_with_enclaves=0),
    *_arity("Node", get_action_client_names_and_types_by_node=2),
    *_arity("Node", get_action_server_names_and_types_by_node=2),
)

#: Of rclpy's Python, as a program uses it.
PROGRAM: tuple[Assumption, ...] = (
    *_has("rclpy.executors", "Executor", "_wait_for_ready_callbacks"),
    *_has("rclpy.executors", "", "SingleThreadedExecutor"),
    *_has("rclpy.task", "Future", "done"),
    *_has("rclpy.task", "Task", "__call__"),
    *_has("rclpy.context", "Context", "ok"),
    *_has("rclpy.client", "Client", "call"),
    *_has("rclpy.timer", "Rate", "sleep"),
    *_has("rclpy.action", "ActionClient", "send_goal", "_get_result", "_cancel_goal"),
    *_has("rclpy.node", "Node", "__init__"),
    # what `clock.rclpy_time` puts in its place
    *_arity("ClockEvent", __init__=0, wait_until_steady=2, wait_until_system=2, wait_until_ros=2),
    *_arity("ClockEvent", set=0, clear=0, is_set=0),
)
