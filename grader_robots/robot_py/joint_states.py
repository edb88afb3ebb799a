"""The behaviour of joint_state_publisher 2.4.3, Jazzy's, without a node.

It reads the description by itself, with other rules than urdfdom: `lower` and `upper` have to be
there, and much else is not checked. Of the three formats that the original reads, this reads one,
URDF.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypedDict
from xml.dom import minidom

#: A longer description is refused unread [characters].
LONGEST = 32_000_000
NOT_MOVED = ("fixed", "floating", "planar")
WAITING = "Waiting for robot_description to be published on the robot_description topic..."
ENDLESS = "Found an infinite recursive mimic chain"
#: What `dependent_joints.<joint>.` may be followed by.
DEPENDENCE_KEYS = ("parent", "factor", "offset")


class UnusableDescription(ValueError):
    """Why a description cannot be used; the joints of the one before, if any, are kept."""


class NodeEnded(Exception):
    """The original ends here with exit code 1; the text explains why."""


class Dependence(TypedDict, total=False):
    """How a joint follows another: as a mimic does."""

    parent: str
    factor: float
    offset: float


@dataclass(frozen=True, slots=True)
class JointStateOptions:
    """The node's parameters; docs/robots.md describes them."""

    publish_default_positions: bool = True
    publish_default_velocities: bool = False
    publish_default_efforts: bool = False
    use_mimic_tags: bool = True
    use_smallest_joint_limits: bool = True
    delta: float = 0.0
    zeros: Mapping[str, float] = field(default_factory=dict)
    dependent_joints: Mapping[str, Dependence] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Values:
    """The arrays of a JointState message; each is empty or has one number for each name."""

    names: Sequence[str]
    positions: Sequence[float] = ()
    velocities: Sequence[float] = ()
    efforts: Sequence[float] = ()


@dataclass(slots=True)
class FreeJoint:
    """A joint that follows no other; None where there is no value yet."""

    least: float
    most: float
    is_continuous: bool
    position: float | None = None
    velocity: float | None = None
    effort: float | None = None
    goes_up: bool = True

    def step(self, delta: float) -> None:
        """Go on by `delta`: to and fro between the limits, or round and round."""
        if self.position is None:
            raise NodeEnded("delta needs publish_default_positions, or positions from a source")
        if not self.goes_up:
            self.position -= delta
            if self.position < self.least:
                self.position, self.goes_up = self.least, True
            return
        self.position += delta
        if self.position > self.most:
            self.goes_up = self.is_continuous
            self.position = self.least if self.is_continuous else self.most


class JointStates:
    """The positions of joints: at rest, stepped by `delta`, or those of a source."""

    def __init__(self, options: JointStateOptions | None = None) -> None:
        self._options = options or JointStateOptions()
        self._order: list[str] = []
        self._free: dict[str, FreeJoint] = {}
        # until a description comes, which forgets them: so does the original
        self._dependent: dict[str, Dependence] = dict(self._options.dependent_joints)

    def configure(self, description: str) -> None:
        """Use the joints of a description.

        Raises:
            UnusableDescription: it cannot be used; the joints are as they were.
        """
        order: list[str] = []
        free: dict[str, FreeJoint] = {}
        dependent: dict[str, Dependence] = {}
        try:
            for element in _joint_elements(description):
                name = element.getAttribute("name")
                limits = self._limits(element, name)
                order.append(name)
                if self._options.use_mimic_tags and (mimic := _only(element, "mimic")):
                    dependent[name] = _dependence(mimic)
                elif name not in dependent:
                    is_continuous = element.getAttribute("type") == "continuous"
                    free[name] = self._free_joint(name, limits, is_continuous)
        except RecursionError as error:  # minidom's, of elements within elements
            raise UnusableDescription(str(error)) from None
        self._order, self._free, self._dependent = order, free, dependent

    def hear(self, values: Values) -> None:
        """Copy a source's values of free joints.

        Raises:
            NodeEnded: one of its arrays is shorter than the names, but not empty.
        """
        try:
            for number, name in enumerate(values.names):
                joint = self._free.get(name)
                if joint is None:
                    continue
                joint.position = values.positions[number] if values.positions else joint.position
                joint.velocity = values.velocities[number] if values.velocities else joint.velocity
                joint.effort = values.efforts[number] if values.efforts else joint.effort
        except IndexError:
            raise NodeEnded("a source sent an array that is shorter than its names") from None

    def tick(self) -> Values | None:
        """Return what is published now; None where there are no joints.

        Raises:
            NodeEnded: joints follow each other in a circle, or one that is not there.
        """
        if self._options.delta > 0:
            for joint in self._free.values():
                joint.step(self._options.delta)
        free = self._free.values()
        count = len(self._free) + len(self._dependent)
        has_position = bool(self._dependent) or any(one.position is not None for one in free)
        positions = [0.0] * count if has_position else []
        velocities = [0.0] * count if any(one.velocity is not None for one in free) else []
        efforts = [0.0] * count if any(one.effort is not None for one in free) else []
        for number, name in enumerate(self._order):
            joint, factor, offset = self._source(name)
            if joint.position is not None:
                positions[number] = float(joint.position) * factor + offset
            if joint.velocity is not None:
                velocities[number] = float(joint.velocity) * factor
            if joint.effort is not None:
                efforts[number] = float(joint.effort)
        if not (self._order or positions):
            return None
        return Values(list(self._order), positions, velocities, efforts)

    def _source(self, name: str) -> tuple[FreeJoint, float, float]:
        """Return the free joint that a joint follows in the end, or is, with factor and offset."""
        if name in self._free:
            return self._free[name], 1.0, 0.0
        rule = self._dependent[name]
        factor, offset, parent = rule.get("factor", 1.0), rule.get("offset", 0.0), rule["parent"]
        chain = [name]
        while parent in self._dependent:
            if parent in chain:
                raise NodeEnded(f"{ENDLESS}: {[*chain, parent]}")
            chain.append(parent)
            rule = self._dependent[parent]
            offset += factor * rule.get("offset", 0.0)
            factor *= rule.get("factor", 1.0)
            parent = rule["parent"]
        if parent not in self._free:
            raise NodeEnded(f'joint "{chain[-1]}" follows "{parent}", and no such joint moves')
        return self._free[parent], factor, offset

    def _limits(self, element: minidom.Element, name: str) -> tuple[float, float]:
        kind = element.getAttribute("type")
        if kind == "continuous":
            least, most = -math.pi, math.pi
        else:
            limits = element.getElementsByTagName("limit")
            if not limits:
                why = f'Limits must be specified for joint "{name}" of type "{kind}"'
                raise UnusableDescription(why)
            of = f'for joint "{name}" of type "{kind}"'
            least, most = _limit(limits[0], "lower", of), _limit(limits[0], "upper", of)
        safety = _only(element, "safety_controller")
        if safety and self._options.use_smallest_joint_limits:
            if safety.hasAttribute("soft_lower_limit"):
                least = max(least, _number(safety.getAttribute("soft_lower_limit")))
            if safety.hasAttribute("soft_upper_limit"):
                most = min(most, _number(safety.getAttribute("soft_upper_limit")))
        return least, most

    def _free_joint(self, name: str, limits: tuple[float, float], is_continuous: bool) -> FreeJoint:
        options, (least, most) = self._options, limits
        outside = least > 0 or most < 0
        zero = options.zeros.get(name, (most + least) / 2 if outside else 0.0)
        return FreeJoint(
            least,
            most,
            is_continuous,
            zero if options.publish_default_positions else None,
            0.0 if options.publish_default_velocities else None,
            0.0 if options.publish_default_efforts else None,
        )


def dependences(parameters: Mapping[str, object]) -> dict[str, Dependence]:
    """Return the parameters below `dependent_joints`, by joint.

    Raises:
        ValueError: in the original's words.
    """
    found: dict[str, dict[str, object]] = {}
    for name, value in parameters.items():
        parts = name.split(".")
        if len(parts) != 2:
            raise ValueError(f"Invalid dependent_joint name '{name}'")
        if parts[1] not in DEPENDENCE_KEYS:
            allowed = ", ".join(f"'{key}'" for key in DEPENDENCE_KEYS)
            why = f"Invalid dependent_joint name '{parts[1]}' (allowed values are {allowed})"
            raise ValueError(why)
        found.setdefault(parts[0], {})[parts[1]] = value
    if any(rule.get("parent") is None for rule in found.values()):
        raise ValueError("All dependent_joints must at least have a parent")
    return found  # type: ignore[return-value]


def _joint_elements(description: str) -> list[minidom.Element]:
    if len(description) > LONGEST:
        raise UnusableDescription(f"robot_description is longer than {LONGEST} characters")
    if "<!ENTITY" in description:
        # expat, from 2.4.1 on, bounds what entities may become, but a robot needs none
        raise UnusableDescription("robot_description declares entities, which are not read here")
    try:
        document = minidom.parseString(description)
    except Exception as error:  # expat's, minidom's
        raise UnusableDescription(str(error)) from None
    root = document.documentElement
    assert root is not None  # expat has found one
    if root.tagName in ("sdf", "COLLADA"):
        raise UnusableDescription(f"robot_description is {root.tagName}: only URDF is read here")
    robots = document.getElementsByTagName("robot")
    if not robots:
        raise UnusableDescription('URDF must have a "robot" tag')
    return [
        child
        for child in robots[0].childNodes
        if child.localName == "joint" and child.getAttribute("type") not in NOT_MOVED
    ]


def _only(parent: minidom.Element, name: str) -> minidom.Element | None:
    found = parent.getElementsByTagName(name)
    return found[0] if len(found) == 1 else None


def _dependence(mimic: minidom.Element) -> Dependence:
    rule = Dependence(parent=mimic.getAttribute("joint"))
    if mimic.hasAttribute("multiplier"):
        rule["factor"] = _number(mimic.getAttribute("multiplier"))
    if mimic.hasAttribute("offset"):
        rule["offset"] = _number(mimic.getAttribute("offset"))
    return rule


def _limit(element: minidom.Element, name: str, of: str) -> float:
    if not element.hasAttribute(name):
        raise UnusableDescription(f'"{name}" limit must be specified {of}')
    try:
        return float(element.getAttribute(name))
    except ValueError:
        raise UnusableDescription(f'"{name}" limit must be a float {of}') from None


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise UnusableDescription(str(error)) from None
