"""What is wrong with a robot's description: what urdfdom says, and what it does not notice."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Final

from grader import Checks, Finding, Tolerances
from grader.exercise import unless_unknown
from grader.submission import package_trace, shown
from grader.text import NOTHING, Message, msg
from grader_robots.exercises.description_package.facts import (
    NO_FAULT,
    PackageFacts,
    of_package,
)
from grader_robots.robot_py.model import Inertial, Joint, JointType, Model, Origin
from grader_robots.robot_py.tinyxml import Consequence
from grader_robots.robot_py.unexpanded import unexpanded
from grader_robots.robot_py.urdf import ParsedUrdf, parse

checks = Checks()
#: What is left where a robot is there, and something of it is wrong or dropped.
FAULTY = 0.5
#: Moments of inertia may miss the triangle inequality by so much: they are rounded.
ROUNDED = 0.01
#: Who means an angle in radians turns something once round at most [rad], with some rounding.
ONCE_ROUND = math.tau + 0.02


@checks()
@of_package
def urdf(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """The description is a valid URDF, of which nothing is dropped.

    What robot_state_publisher gets is read by the rules of urdfdom 4.0.2, ROS 2 Jazzy's; where no
    launch file hands on any, what the files of the package give.

    - urdfdom refuses it, or xacro has not been run on it: 0.
    - urdfdom drops a part (it says so, and the robot shows without it), or accepts what cannot be
      meant (limits with lower above upper, an axis 0 0 0, a link with two parents, a mimic of no
      joint, a mass or moment of inertia that no body has, an rpy of more than a turn): half of
      the points.
    """
    if not facts.descriptions:
        rationale = msg(
            "There is no robot description: no launch file hands one to "
            "robot_state_publisher, and no file in the package is a URDF."
        )
        help = msg("A URDF is a file with <robot name=...>; it belongs into the folder urdf.")
        finding = Finding(0, rationale, help)
        return unless_unknown(facts.trace, finding, msg("no description was found"), NO_FAULT)
    links = 0
    for description in facts.descriptions:
        finding = of_description(facts, description)
        if finding.share < 1:
            return finding
        model = parse(facts.text(description.text)).model
        links += len(model.links) if model is not None else 0
    return Finding(
        1, msg("urdfdom takes all {links} links, and nothing in them is at odds.", links=links)
    )


def of_description(facts: PackageFacts, description: package_trace.Description) -> Finding:
    """What a description is worth; no share where robot_state_publisher takes none."""
    where = description.source or description.by or msg("the robot of its files")
    text = facts.text(description.text)
    if description.problem is not None:
        refused = xacro_brief(str(description.problem.text), facts.name)
        rationale = msg("{where}: {why}.", where=where, why=shown(refused))
        finding = Finding(0, rationale, xacro_advice(refused))
        if description.is_launched:
            return finding
        alone = msg("{where} alone gives no robot", where=where)
        return unless_unknown(facts.trace, finding, alone, NO_FAULT)
    return of_text(where, text)


def readable(facts: PackageFacts) -> list[package_trace.Description]:
    """The descriptions that robot_state_publisher takes for a robot."""
    return [each for each in facts.descriptions if of_description(facts, each).share]


def best_of(facts: PackageFacts, judge: Callable[[ParsedUrdf, int], Finding]) -> Finding:
    """What the best of the robots is worth; `judge` gets its description's number, -1 for none."""
    there = ((n, e) for n, e in enumerate(facts.trace.descriptions) if e in facts.descriptions)
    found = [judge(parse(facts.text(each.text)), n) for n, each in there if each.text >= 0]
    return max(found or [judge(parse(""), -1)], key=lambda each: each.share)


def of_text(where: str | Message, text: str) -> Finding:
    """What a text is as a robot's description: no share where robot_state_publisher refuses it."""
    if not text.strip():
        rationale = msg("{where}: the description is empty.", where=where)
        help = msg("Which file does it come from?")
        return Finding(0, rationale, help)
    if "<" not in text:
        rationale = msg(
            "{where}: robot_description is {text!r}, which is no URDF.",
            where=where,
            text=shown(text),
        )
        return Finding(0, rationale, msg("Hand on what is in the file, not its path."))
    if raw := unexpanded(text):
        rationale = msg(
            "{where}: xacro has not been run on it: {found!r} is left in what "
            "robot_state_publisher gets, which understands plain URDF alone.",
            where=where,
            found=shown(raw),
        )
        help = msg("Hand on what xacro makes of the file: Command(['xacro ', path]).")
        return Finding(0, rationale, help)
    reading = parse(text)
    model = reading.model
    for consequence, share in ((Consequence.REFUSED, 0.0), (Consequence.DROPPED, FAULTY)):
        findings = [each for each in reading.findings if each.consequence is consequence]
        if findings:
            line = (
                msg(" (line {line})", line=findings[0].line)
                if findings[0].line and "xacro" not in str(where)
                else ""
            )
            what = (
                msg("robot_state_publisher stops with this error")
                if consequence is Consequence.REFUSED
                else msg("the rest of that part is dropped, and the robot shows without it")
            )
            rationale = msg(
                "{where}: urdfdom says {text!r}{line}: {consequence}.",
                where=where,
                text=shown(findings[0].text),
                line=line,
                consequence=what,
            )
            said = findings[0].text
            return Finding(share, rationale, next(_HELP[words] for words in _HELP if words in said))
    assert model is not None
    fault = next(faults(model), "")
    if fault:
        help = msg(
            "urdfdom accepts this without a word; what RViz and simulators make of "
            "it is not what is meant."
        )
        return Finding(FAULTY, msg("{where}: {fault}", where=where, fault=fault), help)
    return Finding(1, NOTHING)


#: What urdfdom says -> what to do. The first that fits counts, '' always.
_HELP: Final = {
    "root link": msg(
        "Every link but one is the child of exactly one joint. Which has none, or is misspelt?"
    ),
    "is not unique": msg(
        "Each name is given once: two parts are called the same, or a macro is used twice."
    ),
    "limit": msg('Such a joint needs <limit lower="" upper="" effort="" velocity=""/>.'),
    "PARSING_DECLARATION": msg(
        "A declaration such as <?xml ...?> stands at the very start: take the other away."
    ),
    "XML": msg("The file is no XML: look for a tag that is not closed, at the line or above."),
    "": msg("`check_urdf FILE` prints the same line; the element that it names is at fault."),
}


def faults(model: Model) -> Iterator[Message]:
    children = Counter(joint.child for joint in model.joints.values())
    for child, count in children.items():
        if count > 1:
            yield msg(
                "the link {link!r} hangs on {count} joints; it can hang on one only.",
                link=shown(child),
                count=count,
            )
    for joint in model.joints.values():
        yield from _of_joint(joint, model)
    for link in model.links.values():
        origins = [*(v.origin for v in link.visuals), *(c.origin for c in link.collisions)]
        for origin in origins:
            yield from _turned(msg("a shape of the link {link!r}", link=shown(link.name)), origin)
        if link.name != link.name.strip() or " " in link.name:
            yield msg(
                "the link {link!r} has a blank in its name, which is no frame's.",
                link=shown(link.name),
            )
        if link.inertial is not None:
            yield from (
                msg("the link {link!r} {fault}", link=shown(link.name), fault=each)
                for each in _of_mass(link.inertial)
            )


def _of_joint(joint: Joint, model: Model) -> Iterator[Message]:
    named = msg("the joint {joint!r}", joint=shown(joint.name))
    yield from _turned(named, joint.origin)
    if joint.parent == joint.child:
        yield msg("{joint} joins {link!r} to itself.", joint=named, link=shown(joint.child))
    if joint.type.is_movable and not any(joint.axis):
        yield msg("{joint} moves about the axis 0 0 0, which is none.", joint=named)
    limit = joint.limit
    if joint.type in (JointType.REVOLUTE, JointType.PRISMATIC) and limit is not None:
        if limit.lower > limit.upper:
            yield msg(
                "{joint} has the limits {lower:g} to {upper:g}: lower is above upper.",
                joint=named,
                lower=limit.lower,
                upper=limit.upper,
            )
        elif limit.lower == limit.upper == 0:
            yield msg(
                "{joint} cannot move: its <limit> has no lower and no upper, which are then 0.",
                joint=named,
            )
    if joint.mimic is not None and joint.mimic.joint not in model.joints:
        yield msg(
            "{joint} mimics {other!r}, and there is no such joint.",
            joint=named,
            other=shown(joint.mimic.joint),
        )


def _turned(what: Message, origin: Origin) -> Iterator[Message]:
    """An angle that nobody means in radians."""
    most = max(origin.rpy, key=abs)
    if abs(most) > ONCE_ROUND:
        yield msg(
            "{what} is turned by {angle:g} rad, as if in degrees: 90 degrees are 1.5708.",
            what=what,
            angle=most,
        )


def _of_mass(inertial: Inertial) -> Iterator[Message]:
    if not inertial.mass > 0 or not math.isfinite(inertial.mass):
        yield msg("has a mass of {mass:g} kg.", mass=inertial.mass)
        return
    moments = sorted((inertial.ixx, inertial.iyy, inertial.izz))
    if not all(math.isfinite(each) for each in moments) or moments[0] <= 0:
        yield msg("has a moment of inertia of {moment:g}; expected more than 0.", moment=moments[0])
    elif moments[0] + moments[1] < moments[2] * (1 - ROUNDED):
        yield msg(
            "has the moments of inertia {ixx:g}, {iyy:g}, {izz:g}, which no body has: two are less "
            "than the third.",
            ixx=inertial.ixx,
            iyy=inertial.iyy,
            izz=inertial.izz,
        )


# What xacro says ---------------------------------------------------------------------------------

#: What xacro puts behind every fault of XML; of most it is not true.
_CHECK_THAT: Final = " Check that:"
#: Where what lies in the package's share folder lies in the package, if nobody renames it.
_SHARE: Final = "/prefix/share/{}/"
_BY_HAND: Final = msg("Run xacro by hand on the file: it says the same.")
_ABOVE: Final = msg(
    "a tag that is not closed, or closed by another name, stands at that line or above."
)
#: What xacro says -> what to do. The first that fits counts.
_ADVICE: Final = {
    "unbound prefix": msg(
        "The first tag has to say what xacro: is: "
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name=...>.'
    ),
    "mismatched tag": msg("The line is where it was noticed: {above}", above=_ABOVE),
    "no element found": msg("The file ends too soon: {above}", above=_ABOVE),
    "XML or text declaration not at start": msg(
        "<?xml ...?> stands at the very start of a file: take away what is above it."
    ),
    "not well-formed": msg(
        "Look at that place: a quotation mark that is missing, a < or & that is"
        " meant as it stands, or -- within a comment."
    ),
    "unknown macro name": msg(
        "A macro is defined by <xacro:macro name=...>, or in a file that is "
        "included, above where it is used. Compare the names."
    ),
    "Undefined parameters": msg(
        "The macro's params asks for them: each use of it has to give them, "
        "unless params has a default (NAME:=VALUE)."
    ),
    "Invalid parameter": msg(
        "The macro has no such parameter: add it to its params, or leave it out where it is used."
    ),
    "No such file or directory": msg(
        "A name in <xacro:include filename=...> is looked for beside the file that includes "
        "it, where it is installed: is it there, and in data_files?"
    ),
    "a file of another package": msg(
        "$(find NAME) takes the name of a package: of your own, as package.xml has it, for "
        "your own files. Another one has to be installed where this is graded."
    ),
    "codec can't decode": msg(
        "Save the file as UTF-8: editors have that under 'Save with encoding' or 'Save as'."
    ),
    "sequence by non-int": msg(
        "A number is a text here: decimals take a point, 0.11, not a comma, and no unit."
    ),
    "Undefined substitution argument": msg(
        "<xacro:arg name=... default=...> has to come before $(arg ...) is used."
    ),
}
_UNDEFINED: Final = re.compile(r"name '(\w+)' is not defined")


def xacro_brief(errors: str, package: str) -> str:
    """The same without what is of no use, and with the package's own paths in it."""
    text = " ".join(errors.split()).partition(_CHECK_THAT)[0]
    text = text.replace("xacro: error: ", "xacro: ").replace(_SHARE.format(package), "")
    return re.sub(r" when processing file: \S+$", "", text)


def xacro_advice(errors: str) -> Message:
    """What to do about what xacro says."""
    undefined = _UNDEFINED.search(errors)
    if undefined is not None:
        return msg(
            'Nothing above defines it: <xacro:property name="{name}" '
            "value=.../>, with xacro: before it, or a parameter of the macro. "
            "Compare letter by letter.",
            name=undefined[1],
        )
    return next((help for words, help in _ADVICE.items() if words in errors), _BY_HAND)
