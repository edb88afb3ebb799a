"""A whole URDF: from text to a robot, or to why there is none."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from robot_py.findings import Consequence, Finding, Malformed
from robot_py.model import Collision, Inertial, Joint, Link, Material, Model, Visual
from robot_py.urdf import tinyxml
from robot_py.urdf.joints import joint
from robot_py.urdf.shapes import Tell, collision, inertial, material, visual
from robot_py.urdf.tinyxml import Element

#: A longer text is refused unread [characters]. The largest robots that people publish take 1 %.
LONGEST = 32_000_000
#: What C takes for a whole number at the begin of a text.
VERSION_NUMBER = re.compile(r"[ \t\n\v\f\r]*[+-]?[0-9]+")


@dataclass(frozen=True, slots=True)
class Reading:
    """What came out of a URDF.

    Attributes:
        model: the robot; None where urdfdom refuses the text.
        findings: what urdfdom prints, in its order; what it says twice of one part stands once.
    """

    model: Model | None
    findings: tuple[Finding, ...]

    @property
    def dropped_parts(self) -> bool:
        """Whether the robot goes without something that the file describes, or tried to."""
        return any(found.consequence is Consequence.DROPPED for found in self.findings)


def parse(text: str) -> Reading:
    """Read a URDF; whatever it is, there is an answer.

    Time and memory grow with the length of the text and no more, and nothing that it names is
    opened: it may come from a stranger.
    """
    findings: list[Finding] = []
    try:
        if len(text) > LONGEST:
            raise Malformed(f"{len(text)} characters are too many for a URDF: {LONGEST} at most")
        model = _model(tinyxml.read(text), findings.append)
    except Malformed as error:
        return Reading(None, (*findings, *error.findings(Consequence.REFUSED)))
    return Reading(model, tuple(findings))


def _model(document: Element, tell: Tell) -> Model:
    robot = document.first("robot")
    if robot is None:
        raise Malformed("Could not find the 'robot' element in the xml file")
    name = robot.get("name")
    if name is None:
        raise Malformed("No name given for the robot.", line=robot.line)
    _check_version(robot)
    materials = _materials(robot, tell)
    links = _links(robot, materials, tell)
    joints = _joints(robot)
    return Model(name, _root(links, joints), links, joints, materials)


def _check_version(robot: Element) -> None:
    version = robot.get("version")
    if version is not None and (why := _problem_with_version(version)):
        raise Malformed(why, line=robot.line)


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


def _materials(robot: Element, tell: Tell) -> dict[str, Material]:
    materials: dict[str, Material] = {}
    for element in robot.all("material"):
        name = element.attributes.get("name", "")
        try:
            read = material(element, tell, name_suffices=False)
        except Malformed as error:
            for found in error.findings(Consequence.DROPPED):
                tell(found)
            read = None
        if name in materials:
            raise Malformed(f"material '{name}' is not unique.", line=element.line)
        materials[name] = read or Material(name)
    return materials


def _links(robot: Element, materials: dict[str, Material], tell: Tell) -> dict[str, Link]:
    links: dict[str, Link] = {}
    for element in robot.all("link"):
        link = _link(element, materials, tell)
        if link.name in links:
            raise Malformed(f"link '{link.name}' is not unique.", line=element.line)
        links[link.name] = link
    if not links:
        raise Malformed("No link elements found in urdf file", line=robot.line)
    return links


def _link(element: Element, materials: dict[str, Material], tell: Tell) -> Link:
    """A link; where one of its parts is malformed, without that part and all that follow it."""
    name = element.get("name")
    inert: Inertial | None = None
    visuals: list[tuple[Visual, str]] = []
    collisions: list[Collision] = []
    kind = ""
    try:
        if name is None:
            raise Malformed("No name given for the link.", line=element.line)
        kind = "inertial"
        if (weight := element.first(kind)) is not None:
            inert = inertial(weight)
        kind = "visual"
        visuals.extend(visual(part, tell) for part in element.all(kind))
        kind = "collision"
        collisions.extend(collision(part) for part in element.all(kind))
    except Malformed as error:
        told = error.within(f"Could not parse {kind} element for Link [{name}]") if kind else error
        for found in told.findings(Consequence.DROPPED):
            tell(found)
    link = Link(name or "", (), tuple(collisions), inert)
    dressed = [_dressed(one, named, materials, link.name, tell) for one, named in visuals]
    return replace(link, visuals=tuple(dressed))


def _dressed(
    visual: Visual, named: str, materials: dict[str, Material], link: str, tell: Tell
) -> Visual:
    """The visual in the robot's material of that name, or in its own, which others then may use."""
    if not named:
        return visual
    if named in materials:
        return replace(visual, material=materials[named])
    if visual.material is not None:
        materials[named] = visual.material
    else:
        tell(Finding(Consequence.WARNED, f"link '{link}' material '{named}' undefined."))
    return visual


def _joints(robot: Element) -> dict[str, Joint]:
    joints: dict[str, Joint] = {}
    for element in robot.all("joint"):
        try:
            read = joint(element)
        except Malformed as error:
            raise error.within("joint xml is not initialized correctly") from None
        if read.name in joints:
            raise Malformed(f"joint '{read.name}' is not unique.", line=element.line)
        joints[read.name] = read
    return joints


def _root(links: Mapping[str, Link], joints: Mapping[str, Joint]) -> str:
    """The only link that is no child; urdfdom looks at joints and links by the alphabet."""
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
