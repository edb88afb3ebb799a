"""A joint of a URDF, with all that urdfdom checks of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from robot_py.findings import Malformed
from robot_py.model import Joint, JointType, Limit, Mimic, Vector
from robot_py.urdf.numbers import attribute, pose, vector
from robot_py.urdf.tinyxml import Element

Part = TypeVar("Part")

#: What a joint needs that goes from here to there.
NEEDS_LIMIT = {
    JointType.REVOLUTE: "Joint [{}] is of type REVOLUTE but it does not specify limits",
    JointType.PRISMATIC: "Joint [{}] is of type PRISMATIC without limits",
}


def joint(element: Element) -> Joint:
    """Read a joint; whether its links are there is not looked at here.

    Raises:
        Malformed: something is missing or no number. urdfdom then refuses the whole robot.
    """
    name = element.get("name")
    if name is None:
        raise Malformed("unnamed joint found", line=element.line)
    with _within(f"Malformed parent origin element for joint [{name}]"):
        origin = pose(element)
    parent, child = (_link(element, role) for role in ("parent", "child"))
    kind = _type(element, name)
    axis = _axis(element, kind, name)
    with _within(f"Could not parse limit element for joint [{name}]"):
        limit = _optional(element, "limit", _limit)
    if limit is None and kind in NEEDS_LIMIT:
        raise Malformed(NEEDS_LIMIT[kind].format(name), line=element.line)
    with _within(f"Could not parse safety element for joint [{name}]"):
        _optional(element, "safety_controller", _check_safety)
    # with two blanks, both
    with _within(f"Could not parse calibration element for joint  [{name}]"):
        _optional(element, "calibration", _check_calibration)
    with _within(f"Could not parse mimic element for joint  [{name}]"):
        mimic = _optional(element, "mimic", _mimic)
    with _within(f"Could not parse joint_dynamics element for joint [{name}]"):
        _optional(element, "dynamics", _check_dynamics)
    return Joint(name, kind, parent, child, origin, axis, limit, mimic)


@contextmanager
def _within(text: str) -> Iterator[None]:
    try:
        yield
    except Malformed as error:
        raise error.within(text) from None


def _optional(parent: Element, name: str, read: Callable[[Element], Part]) -> Part | None:
    element = parent.first(name)
    return None if element is None else read(element)


def _link(element: Element, role: str) -> str:
    named = element.first(role)
    return "" if named is None else named.attributes.get("link", "")


def _type(element: Element, name: str) -> JointType:
    text = element.get("type")
    if text is None:
        why = f"joint [{name}] has no type, check to see if it's a reference."
        raise Malformed(why, line=element.line)
    try:
        return JointType(text)
    except ValueError:
        why = f"Joint [{name}] has no known type [{text}]"
        raise Malformed(why, line=element.line) from None


def _axis(element: Element, kind: JointType, name: str) -> Vector:
    none = (0.0, 0.0, 0.0)
    if kind in (JointType.FLOATING, JointType.FIXED):
        return none
    axis = element.first("axis")
    if axis is None:
        return 1.0, 0.0, 0.0
    text = axis.get("xyz")
    if text is None:
        return none  # urdfdom has a default for the element, and none for what is in it
    try:
        return vector(text, axis.line)
    except Malformed as error:
        why = f"Malformed axis element for joint [{name}]: {error.texts[0]}"
        raise Malformed(why, line=axis.line) from None


def _limit(element: Element) -> Limit:
    return Limit(
        attribute(element, "lower", 0.0),
        attribute(element, "upper", 0.0),
        attribute(element, "effort", None, "joint limit: no effort"),
        attribute(element, "velocity", None, "joint limit: no velocity"),
    )


def _mimic(element: Element) -> Mimic:
    followed = element.get("joint")
    if followed is None:
        raise Malformed("joint mimic: no mimic joint specified", line=element.line)
    return Mimic(followed, attribute(element, "multiplier", 1.0), attribute(element, "offset", 0.0))


def _check_safety(element: Element) -> None:
    for name in ("soft_lower_limit", "soft_upper_limit", "k_position"):
        attribute(element, name, 0.0)
    attribute(element, "k_velocity", None, "joint safety: no k_velocity")


def _check_calibration(element: Element) -> None:
    for name in ("rising", "falling"):
        attribute(element, name, 0.0)


def _check_dynamics(element: Element) -> None:
    for name in ("damping", "friction"):
        attribute(element, name, 0.0)
    if element.get("damping") is None and element.get("friction") is None:
        why = "joint dynamics element specified with no damping and no friction"
        raise Malformed(why, line=element.line)
