"""What a link is made of: geometry, material, visual, collision, inertia."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from robot_py.findings import Consequence, Finding, Malformed
from robot_py.model import (
    BLACK,
    Box,
    Collision,
    Colour,
    Cylinder,
    Geometry,
    Inertial,
    Material,
    Mesh,
    Sphere,
    Visual,
)
from robot_py.urdf.numbers import number, pose, vector
from robot_py.urdf.tinyxml import Element

#: Told of what is left out although its surroundings stay.
Tell = Callable[[Finding], None]

MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def geometry(parent: Element) -> Geometry:
    """The shape in an element's <geometry>.

    Raises:
        Malformed: there is none that urdfdom knows; without words where the element is missing.
    """
    element = parent.first("geometry")
    if element is None:
        raise Malformed(line=parent.line)
    if not element.children:
        raise Malformed("Geometry tag contains no child element.", line=element.line)
    shape = element.children[0]
    read = SHAPES.get(shape.name)
    if read is None:
        raise Malformed(f"Unknown geometry type '{shape.name}'", line=shape.line)
    return read(shape)


def _sphere(element: Element) -> Sphere:
    text = element.get("radius")
    if text is None:
        raise Malformed("Sphere shape must have a radius attribute", line=element.line)
    return Sphere(_length(element, "radius", text))


def _box(element: Element) -> Box:
    text = element.get("size")
    if text is None:
        raise Malformed("Box shape has no size attribute", line=element.line)
    return Box(vector(text, element.line))


def _cylinder(element: Element) -> Cylinder:
    length, radius = element.get("length"), element.get("radius")
    if length is None or radius is None:
        why = "Cylinder shape must have both length and radius attributes"
        raise Malformed(why, line=element.line)
    # the length is the first to be looked at
    length_m = _length(element, "length", length)
    return Cylinder(_length(element, "radius", radius), length_m)


def _length(element: Element, name: str, text: str) -> float:
    try:
        return number(text)
    except ValueError:
        raise Malformed(f"{name} [{text}] is not a valid float", line=element.line) from None


def _mesh(element: Element) -> Mesh:
    filename, scale = element.get("filename"), element.get("scale")
    if filename is None:
        raise Malformed("Mesh must contain a filename attribute", line=element.line)
    if scale is None:
        return Mesh(filename)
    try:
        return Mesh(filename, vector(scale, element.line))
    except Malformed as error:
        why = f"Mesh scale was specified, but could not be parsed: {error.texts[0]}"
        raise Malformed(why, line=element.line) from None


SHAPES: dict[str, Callable[[Element], Geometry]] = {
    "sphere": _sphere,
    "box": _box,
    "cylinder": _cylinder,
    "mesh": _mesh,
}


def material(element: Element, tell: Tell, name_suffices: bool) -> Material | None:
    """A material; None where it has neither colour nor texture, but a name, and that suffices.

    Raises:
        Malformed: it has no name, or nothing else where a name does not suffice.
    """
    name = element.get("name")
    if name is None:
        raise Malformed("Material must contain a name attribute", line=element.line)
    texture, colour = element.first("texture"), element.first("color")
    filename = texture.get("filename") if texture else None
    rgba = colour.get("rgba") if colour else None
    values = None
    if rgba is not None and colour is not None:
        try:
            values = _colour(rgba, colour.line)
        except Malformed as error:
            why = f"Material [{name}] has malformed color rgba values: {error.texts[0]}"
            tell(Finding(Consequence.DROPPED, why, colour.line))
    if values is None and filename is None:
        if name_suffices:
            return None
        texts = f"Material [{name}] color has no rgba", f"Material [{name}] not defined in file"
        raise Malformed(*texts, line=element.line)
    return Material(name, values or BLACK, filename or "")


def _colour(text: str, line: int) -> Colour:
    values = []
    for piece in filter(None, text.split(" ")):
        try:
            value = number(piece)
        except ValueError:
            value = math.nan
        if not 0 <= value <= 1:
            # urdfdom has other words for a number outside, but loses them on the way
            why = f"Unable to parse component [{piece}] to a double (while parsing a color value)"
            raise Malformed(why, line=line)
        values.append(float(np.float32(value)))  # as many digits as urdfdom keeps
    if len(values) != 4:
        return BLACK  # urdfdom forgets to look
    red, green, blue, alpha = values
    return red, green, blue, alpha


def visual(element: Element, tell: Tell) -> tuple[Visual, str]:
    """A visual with its own material, and its material's name ('' for none).

    Raises:
        Malformed: urdfdom gives it up.
    """
    origin, shape = pose(element), geometry(element)
    own, material_name = None, ""
    named = element.first("material")
    if named is not None:
        if named.get("name") is None:
            raise Malformed("Visual material must contain a name attribute", line=named.line)
        material_name = named.attributes["name"]
        own = material(named, tell, name_suffices=True)
    return Visual(element.attributes.get("name", ""), origin, shape, own), material_name


def collision(element: Element) -> Collision:
    """A collision.

    Raises:
        Malformed: urdfdom gives it up.
    """
    origin, shape = pose(element), geometry(element)
    return Collision(element.attributes.get("name", ""), origin, shape)


def inertial(element: Element) -> Inertial:
    """What a link weighs.

    Raises:
        Malformed: urdfdom gives it up.
    """
    origin = pose(element)
    mass, inertia = element.first("mass"), element.first("inertia")
    if mass is None:
        raise Malformed("Inertial element must have a mass element", line=element.line)
    text = mass.get("value")
    if text is None:
        raise Malformed("Inertial: mass element must have value attribute", line=mass.line)
    try:
        mass_kg = number(text)
    except ValueError:
        why = f"Inertial: mass [{text}] is not a float"
        raise Malformed(why, line=mass.line) from None
    if inertia is None:
        raise Malformed("Inertial element must have inertia element", line=element.line)
    return Inertial(origin, mass_kg, *_moments(inertia))


def _moments(inertia: Element) -> list[float]:
    # urdfdom 4 looks at them one after the other, and says the same of each
    moments = []
    for name in MOMENTS:
        text = inertia.get(name)
        if text is None:
            why = f"Inertial: inertia element missing {name} attribute"
            raise Malformed(why, line=inertia.line)
        try:
            moments.append(number(text))
        except ValueError:
            why = f"Inertial: inertia element {name} is not a valid double"
            raise Malformed(why, line=inertia.line) from None
    return moments
