"""What is wrong with a robot's description: what urdfdom says, and what it does not notice."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator

from grader.exercise.verdict import Finding
from grader.exercises.description_package import xacro_said
from grader.exercises.description_package.looked import Looked, not_judged, nothing_started
from grader.language.phrase import say
from grader.scenes.package.said import phrase_of, shown
from grader.scenes.package.trace import Description, Mesh
from robot_py.findings import Consequence
from robot_py.model import Inertial, Joint, JointType, Model, Pose
from robot_py.urdf import parse

#: What is left where a robot is there, and something of it is wrong or dropped.
FAULTY = 0.5
#: Moments of inertia may miss the triangle inequality by so much: they are rounded.
ROUNDED = 0.01
#: Who means an angle in radians turns something once round at most [rad], with some rounding.
ONCE_ROUND = math.tau + 0.02
_XACRO = re.compile(r"</?xacro:\w+|\$\{[^}]*\}|\$\((?:arg|find|env|optenv|eval|dirname)\b[^)]*\)")


def judge(looked: Looked) -> Finding:
    """Whether every description is a robot, with all of its parts."""
    if not looked.descriptions:
        if looked.not_known is not None:
            return not_judged(looked.not_known, say("no description was found"))
        return Finding(
            0,
            say(
                "There is no robot description: no launch file hands one to "
                "robot_state_publisher, and no file in the package is a URDF."
            ),
            say("A URDF is a file with <robot name=...>; it belongs into the folder urdf."),
        )
    links = 0
    for description in looked.descriptions:
        finding = _of(looked, description)
        if finding.share < 1:
            return finding
        links += looked.text(description.text).count("<link ")
    return Finding(
        1, say("urdfdom takes all {links} links, and nothing in them is at odds.", links=links)
    )


def _of(looked: Looked, description: Description) -> Finding:
    where = description.source or description.by or say("the robot of its files")
    text = looked.text(description.text)
    if description.problem is not None:
        if not description.is_launched and looked.not_known is not None:
            return not_judged(looked.not_known, say("{where} alone gives no robot", where=where))
        refused = xacro_said.told(description.problem.text, looked.name)
        told = say("{where}: {why}.", where=where, why=shown(phrase_of(refused)))
        return Finding(0, told, xacro_said.advice(refused))
    if not text.strip():
        return Finding(
            0,
            say("{where}: the description is empty.", where=where),
            say("Which file does it come from?"),
        )
    if "<" not in text:
        return Finding(
            0,
            say(
                "{where}: robot_description is {text!r}, which is no URDF.",
                where=where,
                text=shown(text),
            ),
            say("Hand on what is in the file, not its path."),
        )
    if raw := _XACRO.search(text):
        return Finding(
            0,
            say(
                "{where}: xacro has not been run on it: {found!r} is left in what "
                "robot_state_publisher gets, which understands plain URDF alone.",
                where=where,
                found=shown(raw[0]),
            ),
            say("Hand on what xacro makes of the file: Command(['xacro ', path])."),
        )
    reading = parse(text)
    model = reading.model
    for consequence, share in ((Consequence.REFUSED, 0.0), (Consequence.DROPPED, FAULTY)):
        said = [each for each in reading.findings if each.consequence is consequence]
        if said:
            line = (
                say(" (line {line})", line=said[0].line)
                if said[0].line and "xacro" not in where
                else ""
            )
            what = (
                say("robot_state_publisher ends over it")
                if consequence is Consequence.REFUSED
                else say("the rest of that part is dropped, and the robot shows without it")
            )
            return Finding(
                share,
                say(
                    "{where}: urdfdom says {text!r}{line}: {consequence}.",
                    where=where,
                    text=shown(said[0].text),
                    line=line,
                    consequence=what,
                ),
                _help(said[0].text),
            )
    assert model is not None
    fault = next(faults(model), "")
    if fault:
        return Finding(
            FAULTY,
            say("{where}: {fault}", where=where, fault=fault),
            say(
                "urdfdom accepts this without a word; what RViz and simulators make of "
                "it is not what is meant."
            ),
        )
    return Finding(1, "")


def _help(text: str) -> str:
    if "root link" in text:
        return say(
            "Every link but one is the child of exactly one joint. Which has none, or is misspelt?"
        )
    if "is not unique" in text:
        return say(
            "Each name is given once: two parts are called the same, or a macro is used twice."
        )
    if "limit" in text:
        return say('Such a joint needs <limit lower="" upper="" effort="" velocity=""/>.')
    if "PARSING_DECLARATION" in text:
        return say(
            "A declaration such as <?xml ...?> stands at the very start: take the other away."
        )
    if "XML" in text:
        return say("The file is no XML: look for a tag that is not closed, at the line or above.")
    return say("`check_urdf FILE` prints the same line; the element that it names is at fault.")


def faults(model: Model) -> Iterator[str]:
    """What urdfdom does not notice."""
    children = Counter(joint.child for joint in model.joints.values())
    for child, count in children.items():
        if count > 1:
            yield say(
                "the link {link!r} hangs on {count} joints; it can hang on one only.",
                link=shown(child),
                count=count,
            )
    for joint in model.joints.values():
        yield from _of_joint(joint, model)
    for link in model.links.values():
        origins = [*(v.origin for v in link.visuals), *(c.origin for c in link.collisions)]
        for origin in origins:
            yield from _turned(say("a shape of the link {link!r}", link=shown(link.name)), origin)
        if link.name != link.name.strip() or " " in link.name:
            yield say(
                "the link {link!r} has a blank in its name, which is no frame's.",
                link=shown(link.name),
            )
        if link.inertial is not None:
            yield from (
                say("the link {link!r} {fault}", link=shown(link.name), fault=each)
                for each in _of_mass(link.inertial)
            )


def _of_joint(joint: Joint, model: Model) -> Iterator[str]:
    named = say("the joint {joint!r}", joint=shown(joint.name))
    yield from _turned(named, joint.origin)
    if joint.parent == joint.child:
        yield say("{joint} joins {link!r} to itself.", joint=named, link=shown(joint.child))
    if joint.type.is_movable and not any(joint.axis):
        yield say("{joint} moves about the axis 0 0 0, which is none.", joint=named)
    limit = joint.limit
    if joint.type in (JointType.REVOLUTE, JointType.PRISMATIC) and limit is not None:
        if limit.lower > limit.upper:
            yield say(
                "{joint} has the limits {lower:g} to {upper:g}: lower is above upper.",
                joint=named,
                lower=limit.lower,
                upper=limit.upper,
            )
        elif limit.lower == limit.upper == 0:
            yield say(
                "{joint} cannot move: its <limit> has no lower and no upper, which are then 0.",
                joint=named,
            )
    if joint.mimic is not None and joint.mimic.joint not in model.joints:
        yield say(
            "{joint} mimics {other!r}, and there is no such joint.",
            joint=named,
            other=shown(joint.mimic.joint),
        )


def _turned(what: str, origin: Pose) -> Iterator[str]:
    """An angle that nobody means in radians."""
    most = max(origin.rpy, key=abs)
    if abs(most) > ONCE_ROUND:
        yield say(
            "{what} is turned by {angle:g} rad, as if in degrees: 90 degrees are 1.5708.",
            what=what,
            angle=most,
        )


def _of_mass(inertial: Inertial) -> Iterator[str]:
    if not inertial.mass > 0 or not math.isfinite(inertial.mass):
        yield say("has a mass of {mass:g} kg.", mass=inertial.mass)
        return
    moments = sorted((inertial.ixx, inertial.iyy, inertial.izz))
    if not all(math.isfinite(each) for each in moments) or moments[0] <= 0:
        yield say("has a moment of inertia of {moment:g}; expected more than 0.", moment=moments[0])
    elif moments[0] + moments[1] < moments[2] * (1 - ROUNDED):
        yield say(
            "has the moments of inertia {ixx:g}, {iyy:g}, {izz:g}, which no body has: two are less "
            "than the third.",
            ixx=inertial.ixx,
            iyy=inertial.iyy,
            izz=inertial.izz,
        )


def judge_meshes(looked: Looked) -> Finding:
    """Whether every mesh is named so that it is found wherever the package is installed."""
    readable = [each for each in looked.descriptions if each.is_xml]
    if not readable:
        return Finding(
            0,
            say("Not judged: there is no description whose meshes could be looked for."),
            say("See what is said of the description itself first."),
            judged=False,
        )
    meshes = {mesh.uri: mesh for each in readable for mesh in each.meshes}.values()
    if not meshes and looked.starts_nothing:
        return nothing_started()
    if not meshes:
        return Finding(1, say("The description names no files."))
    wrong = [each for each in meshes if each.state in ("scheme", "missing", "case", "package")]
    if not wrong:
        return Finding(
            1,
            say("All {count} files that the description names are to be found.", count=len(meshes)),
        )
    first = wrong[0]
    why = {
        "scheme": say("no viewer resolves that: expected package://PACKAGE/PATH"),
        "missing": _instead(looked, first),
        "case": say("there is {path}: letters count", path=first.path),
        "package": say("there is no package {package!r}", package=shown(first.path)),
    }[first.state]
    if first.uri.startswith("file://"):
        why = say("a path of one machine, which no other has")
    told = say(
        "{file} names {uri}, and {why}.", file=first_source(readable), uri=shown(first.uri), why=why
    )
    if len(wrong) > 1:
        told += say(" So {count} more.", count=len(wrong) - 1)
    return Finding(
        1 - len(wrong) / len(meshes),
        told,
        say(
            "The way to a mesh begins with package:// and your package's name, and "
            "goes on as below its share folder: package://{name}/meshes/FILE.",
            name=looked.name,
        ),
    )


def _instead(looked: Looked, mesh: Mesh) -> str:
    """Of a mesh that is not there: and where a file of the same name is installed."""
    name = mesh.path.rsplit("/", 1)[-1]
    share = f"share/{looked.name}/"
    for path in looked.setup.installed:
        if path.startswith(share) and path.endswith(f"/{name}"):
            return say(
                "there is no such file: {name} is installed as {uri}",
                name=name,
                uri=f"package://{looked.name}/{path.removeprefix(share)}",
            )
    return say("there is no such file")


def first_source(descriptions: list[Description]) -> str:
    """The file that a description is from."""
    return next((each.source or each.by for each in descriptions), say("The description"))
