"""Parses a URDF as urdfdom 4.0.2 does: to a robot, or to the findings that urdfdom prints."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from grader_robots.robot_py import tinyxml
from grader_robots.robot_py.model import Collision, Inertial, Joint, Link, Material, Model, Visual
from grader_robots.robot_py.tinyxml import Consequence, Element, Malformed, UrdfFinding
from grader_robots.robot_py.urdf_parts import Report, collision, inertial, joint, material, visual

#: A longer text is refused unread [characters]. The largest published robots have 1 % of it.
LONGEST = 32_000_000
#: A whole number at the begin of a text, as C parses it.
VERSION_NUMBER = re.compile(r"[ \t\n\v\f\r]*[+-]?[0-9]+")


@dataclass(frozen=True, slots=True)
class ParsedUrdf:
    """The outcome of reading a URDF.

    Attributes:
        model: the robot; None where urdfdom refuses the text.
        findings: what urdfdom prints, in its order; what it prints twice of one part stands once.
    """

    model: Model | None
    findings: tuple[UrdfFinding, ...]


def parse(text: str) -> ParsedUrdf:
    """Parse a URDF; no text raises an exception.

    Time and memory grow with the length of the text and no more, and nothing that it names is
    opened: it may come from a stranger.
    """
    findings: list[UrdfFinding] = []
    try:
        if len(text) > LONGEST:
            raise Malformed(f"{len(text)} characters are too many for a URDF: {LONGEST} at most")
        model = _model(tinyxml.read(text), findings.append)
    except Malformed as error:
        return ParsedUrdf(None, (*findings, *error.findings(Consequence.REFUSED)))
    return ParsedUrdf(model, tuple(findings))


def _model(document: Element, report: Report) -> Model:
    robot = document.first("robot")
    if robot is None:
        raise Malformed("Could not find the 'robot' element in the xml file")
    name = robot.needed("name", "No name given for the robot.")
    if (version := robot.get("version")) is not None and (why := _problem_with_version(version)):
        raise robot.malformed(why)
    materials = _materials(robot, report)
    links = _links(robot, materials, report)
    joints = _joints(robot)
    return Model(name, _root(links, joints), links, joints)


def _problem_with_version(version: str) -> str:
    fields = version.removesuffix(".").split(".")
    if len(fields) != 2:
        return "The version attribute should be in the form 'x.y'"
    numbers = []
    for field in fields:
        start = VERSION_NUMBER.match(field)
        if not field:
            return "One of the fields of the version attribute is blank"
        if start is None:
            return "Version attribute is not an integer"
        if start.end() < len(field):
            return "Extra characters after the version number"
        if start[0].strip().startswith("-"):
            return "Version number must be positive"
        numbers.append(float(start[0]))
    if numbers != [1, 0]:
        return "Invalid 'version' specified; only version 1.0 is currently supported"
    return ""


def _add(parts: dict[str, Any], name: str, part: object, element: Element) -> None:
    if name in parts:
        raise element.malformed(f"{element.name} '{name}' is not unique.")
    parts[name] = part


def _materials(robot: Element, report: Report) -> dict[str, Material]:
    materials: dict[str, Material] = {}
    for element in robot.all("material"):
        name = element.attributes.get("name", "")
        try:
            read = material(element, report, name_suffices=False)
        except Malformed as error:
            for found in error.findings(Consequence.DROPPED):
                report(found)
            read = None
        _add(materials, name, read or Material(name), element)
    return materials


def _links(robot: Element, materials: dict[str, Material], report: Report) -> dict[str, Link]:
    links: dict[str, Link] = {}
    for element in robot.all("link"):
        link = _link(element, materials, report)
        _add(links, link.name, link, element)
    if not links:
        raise robot.malformed("No link elements found in urdf file")
    return links


def _link(element: Element, materials: dict[str, Material], report: Report) -> Link:
    """Parse a link; where a part is malformed, that part and all that follow are left out."""
    name = element.get("name")
    inert: Inertial | None = None
    visuals: list[tuple[Visual, str]] = []
    collisions: list[Collision] = []
    kind = ""
    try:
        if name is None:
            raise element.malformed("No name given for the link.")
        kind = "inertial"
        if (weight := element.first(kind)) is not None:
            inert = inertial(weight)
        kind = "visual"
        visuals.extend(visual(part, report) for part in element.all(kind))
        kind = "collision"
        collisions.extend(collision(part) for part in element.all(kind))
    except Malformed as error:
        if kind:
            error = error.within(f"Could not parse {kind} element for Link [{name}]")
        for found in error.findings(Consequence.DROPPED):
            report(found)
    link = Link(name or "", (), tuple(collisions), inert)
    dressed = [_dressed(one, named, materials, link.name, report) for one, named in visuals]
    return replace(link, visuals=tuple(dressed))


def _dressed(
    visual: Visual, named: str, materials: dict[str, Material], link: str, report: Report
) -> Visual:
    """Return the visual with the material of that name; a new one is added to `materials`."""
    if not named:
        return visual
    if named in materials:
        return replace(visual, material=materials[named])
    if visual.material is not None:
        materials[named] = visual.material
    else:
        report(UrdfFinding(Consequence.WARNED, f"link '{link}' material '{named}' undefined."))
    return visual


def _joints(robot: Element) -> dict[str, Joint]:
    joints: dict[str, Joint] = {}
    for element in robot.all("joint"):
        try:
            read = joint(element)
        except Malformed as error:
            raise error.within("joint xml is not initialized correctly") from None
        _add(joints, read.name, read, element)
    return joints


def _root(links: Mapping[str, Link], joints: Mapping[str, Joint]) -> str:
    """Return the only link that is no child; urdfdom visits joints and links by the alphabet."""
    for name in sorted(joints):
        parent, child = joints[name].parent, joints[name].child
        if why := _problem_with_links(name, parent, child, links):
            raise Malformed(f"Failed to build tree: {why}")
    children = {joint.child for joint in joints.values()}
    roots = sorted(links.keys() - children)
    if not roots:
        why = "No root link found. The robot xml is not a valid tree."
        raise Malformed(f"Failed to find root link: {why}")
    if len(roots) > 1:
        why = f"Two root links found: [{roots[0]}] and [{roots[1]}]"
        raise Malformed(f"Failed to find root link: {why}")
    return roots[0]


def _problem_with_links(name: str, parent: str, child: str, links: Mapping[str, Link]) -> str:
    if not parent or not child:
        return f"Joint [{name}] is missing a parent and/or child link specification."
    if child not in links:
        return f"child link [{child}] of joint [{name}] not found"
    if parent not in links:
        return (
            f"parent link [{parent}] of joint [{name}] not found.  This is not valid according to "
            "the URDF spec. Every link you refer to from a joint needs to be explicitly defined in "
            "the robot description. To fix this problem you can either remove this joint "
            f'[{name}] from your urdf file, or add "<link name="{parent}" />" to your urdf file.'
        )
    return ""
