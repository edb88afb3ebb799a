"""Parses the parts of a URDF's robot: materials, links' shapes, joints, with urdfdom's checks.

Each reader raises `Malformed` where urdfdom gives its part up: something is missing, or no number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import numpy as np

from grader_robots.robot_py.model import (
    BLACK,
    Box,
    Collision,
    Colour,
    Cylinder,
    Geometry,
    Inertial,
    Joint,
    JointType,
    Limit,
    Material,
    Mesh,
    Mimic,
    Sphere,
    Vector,
    Visual,
)
from grader_robots.robot_py.tinyxml import Consequence, Element, Malformed, UrdfFinding

Part = TypeVar("Part")
#: Gets what is left out although its surroundings stay.
Report = Callable[[UrdfFinding], None]

MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
#: The joints that need a limit, and what is wrong without one.
NEEDS_LIMIT = {
    JointType.REVOLUTE: "Joint [{}] is of type REVOLUTE but it does not specify limits",
    JointType.PRISMATIC: "Joint [{}] is of type PRISMATIC without limits",
}

# Links --------------------------------------------------------------------------------------------


def geometry(parent: Element) -> Geometry:
    """Return the shape in an element's <geometry>; without a word where that is missing."""
    element = parent.first("geometry")
    if element is None:
        raise parent.malformed()
    if not element.children:
        raise element.malformed("Geometry tag contains no child element.")
    shape = element.children[0]
    if shape.name not in SHAPES:
        raise shape.malformed(f"Unknown geometry type '{shape.name}'")
    return SHAPES[shape.name](shape)


def _sphere(element: Element) -> Sphere:
    element.needed("radius", "Sphere shape must have a radius attribute")
    return Sphere(_length(element, "radius"))


def _box(element: Element) -> Box:
    return Box(element.vector(element.needed("size", "Box shape has no size attribute")))


def _cylinder(element: Element) -> Cylinder:
    for name in ("length", "radius"):
        element.needed(name, "Cylinder shape must have both length and radius attributes")
    # urdfdom reads the length first
    length_m = _length(element, "length")
    return Cylinder(_length(element, "radius"), length_m)


def _length(element: Element, name: str) -> float:
    text = element.attributes[name]
    return element.number(text, f"{name} [{text}] is not a valid float")


def _mesh(element: Element) -> Mesh:
    filename = element.needed("filename", "Mesh must contain a filename attribute")
    scale = element.get("scale")
    if scale is None:
        return Mesh(filename)
    try:
        return Mesh(filename, element.vector(scale))
    except Malformed as error:
        why = f"Mesh scale was specified, but could not be parsed: {error.texts[0]}"
        raise element.malformed(why) from None


SHAPES: dict[str, Callable[[Element], Geometry]] = {
    "sphere": _sphere,
    "box": _box,
    "cylinder": _cylinder,
    "mesh": _mesh,
}


def material(element: Element, report: Report, name_suffices: bool) -> Material | None:
    """Return a material; None where it has neither colour nor texture, and its name suffices."""
    name = element.needed("name", "Material must contain a name attribute")
    texture, colour = element.first("texture"), element.first("color")
    filename = texture.get("filename") if texture else None
    values = None
    if colour and (rgba := colour.get("rgba")) is not None:
        try:
            values = _colour(colour, rgba)
        except Malformed as error:
            why = f"Material [{name}] has malformed color rgba values: {error.texts[0]}"
            report(UrdfFinding(Consequence.DROPPED, why, colour.line))
    if values is None and filename is None:
        if name_suffices:
            return None
        texts = f"Material [{name}] color has no rgba", f"Material [{name}] not defined in file"
        raise element.malformed(*texts)
    return Material(name, values or BLACK, filename or "")


def _colour(element: Element, text: str) -> Colour:
    values = []
    for piece in filter(None, text.split(" ")):
        wrong = f"Unable to parse component [{piece}] to a double (while parsing a color value)"
        value = element.number(piece, wrong)
        if not 0 <= value <= 1:  # urdfdom has other words for that, but loses them on the way
            raise element.malformed(wrong)
        values.append(float(np.float32(value)))  # as many digits as urdfdom keeps
    if len(values) != 4:
        return BLACK  # urdfdom forgets to check
    red, green, blue, alpha = values
    return red, green, blue, alpha


def visual(element: Element, report: Report) -> tuple[Visual, str]:
    """Return a visual with the material that it defines, and its material's name ('' for none)."""
    origin, shape = element.origin(), geometry(element)
    defined, material_name = None, ""
    named = element.first("material")
    if named is not None:
        material_name = named.needed("name", "Visual material must contain a name attribute")
        defined = material(named, report, name_suffices=True)
    return Visual(origin, shape, defined), material_name


def collision(element: Element) -> Collision:
    """Return a collision."""
    return Collision(element.origin(), geometry(element))


def inertial(element: Element) -> Inertial:
    """Return the mass and inertia of a link."""
    origin = element.origin()
    mass, inertia = element.first("mass"), element.first("inertia")
    if mass is None:
        raise element.malformed("Inertial element must have a mass element")
    text = mass.needed("value", "Inertial: mass element must have value attribute")
    mass_kg = mass.number(text, f"Inertial: mass [{text}] is not a float")
    if inertia is None:
        raise element.malformed("Inertial element must have inertia element")
    moments = []
    for name in MOMENTS:
        of = f"Inertial: inertia element {name}"
        text = inertia.needed(name, f"Inertial: inertia element missing {name} attribute")
        moments.append(inertia.number(text, f"{of} is not a valid double"))
    return Inertial(origin, mass_kg, *moments)


# Joints -------------------------------------------------------------------------------------------


def joint(element: Element) -> Joint:
    """Return a joint; where it is malformed, urdfdom refuses the whole robot.

    Whether its links are there is not checked here.
    """
    name = element.needed("name", "unnamed joint found")
    with _within(f"Malformed parent origin element for joint [{name}]"):
        origin = element.origin()
    parent, child = (_link(element, role) for role in ("parent", "child"))
    kind = _type(element, name)
    axis = _axis(element, kind, name)
    limit = _optional(element, "limit", _limit, "limit element for joint")
    if limit is None and kind in NEEDS_LIMIT:
        raise element.malformed(NEEDS_LIMIT[kind].format(name))
    _optional(element, "safety_controller", _check_safety, "safety element for joint")
    # with two blanks, both
    _optional(element, "calibration", _check_calibration, "calibration element for joint ")
    mimic = _optional(element, "mimic", _mimic, "mimic element for joint ")
    _optional(element, "dynamics", _check_dynamics, "joint_dynamics element for joint")
    return Joint(name, kind, parent, child, origin, axis, limit, mimic)


@contextmanager
def _within(text: str) -> Iterator[None]:
    try:
        yield
    except Malformed as error:
        raise error.within(text) from None


def _optional(parent: Element, name: str, read: Callable[[Element], Part], of: str) -> Part | None:
    element = parent.first(name)
    with _within(f"Could not parse {of} [{parent.attributes['name']}]"):
        return None if element is None else read(element)


def _link(element: Element, role: str) -> str:
    named = element.first(role)
    return "" if named is None else named.attributes.get("link", "")


def _type(element: Element, name: str) -> JointType:
    text = element.needed("type", f"joint [{name}] has no type, check to see if it's a reference.")
    try:
        return JointType(text)
    except ValueError:
        raise element.malformed(f"Joint [{name}] has no known type [{text}]") from None


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
        return axis.vector(text)
    except Malformed as error:
        why = f"Malformed axis element for joint [{name}]: {error.texts[0]}"
        raise axis.malformed(why) from None


def _attribute(element: Element, name: str, missing: str = "", default: str = "0") -> float:
    """Return a number; if it is absent, raise `Malformed` with the text `missing`, if any."""
    text = element.needed(name, missing) if missing else element.attributes.get(name, default)
    return element.number(text, f"{name} value ({text}) is not a valid float")


def _limit(element: Element) -> Limit:
    return Limit(
        _attribute(element, "lower"),
        _attribute(element, "upper"),
        _attribute(element, "effort", "joint limit: no effort"),
        _attribute(element, "velocity", "joint limit: no velocity"),
    )


def _mimic(element: Element) -> Mimic:
    followed = element.needed("joint", "joint mimic: no mimic joint specified")
    multiplier = _attribute(element, "multiplier", default="1")
    return Mimic(followed, multiplier, _attribute(element, "offset"))


def _numbers(element: Element, *names: str) -> None:
    for name in names:
        _attribute(element, name)


def _check_safety(element: Element) -> None:
    _numbers(element, "soft_lower_limit", "soft_upper_limit", "k_position")
    _attribute(element, "k_velocity", "joint safety: no k_velocity")


def _check_calibration(element: Element) -> None:
    _numbers(element, "rising", "falling")


def _check_dynamics(element: Element) -> None:
    _numbers(element, "damping", "friction")
    if element.get("damping") is None and element.get("friction") is None:
        raise element.malformed("joint dynamics element specified with no damping and no friction")
