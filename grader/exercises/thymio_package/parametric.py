"""Whether the numbers of a xacro are what the robot is made of, and what it weighs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from grader.exercise.verdict import Finding
from grader.exercises.description_package.looked import Looked
from grader.language.phrase import say
from grader.scenes.package.said import shown
from robot_py import kinematics
from robot_py.findings import Consequence
from robot_py.model import Box, Model, Pose
from robot_py.urdf import parse

_MOVED_M = 1e-6
#: What hangs on a part so far from its middle, as a share of half of its size, is at its side.
_ASIDE = 0.25
#: The masses of so many links are told one by one.
_FEW = 6
#: Instead of a link, where none moves along.
_NOTHING = "nothing"


class _Shape(NamedTuple):
    origin: Pose
    geometry: Box


def judge(looked: Looked, names: Sequence[str]) -> Finding:
    """Whether doubling a number moves what depends on it."""
    model = _model(looked)
    if model is None:
        return _no_robot(say("Not judged: there is no robot to vary."))
    good, told, help_ = 0, "", ""
    texts = _varied(looked)
    for name in names:
        if name not in texts:
            fault, advice = _unnamed(name)
        else:
            fault, advice = _fault(name, model, texts[name])
        good += not fault
        told, help_ = told or fault, help_ or advice
    if told and not good and _is_incomplete(looked):
        return _no_robot(say("Not judged: there is no robot to vary: parts of it are dropped."))
    if not told:
        return Finding(
            1, say("What hangs on {names} moves along with them.", names=", ".join(names))
        )
    return Finding(good / max(len(names), 1), say("In the xacro, {told}.", told=told), help_)


def _no_robot(why: str) -> Finding:
    return Finding(
        0,
        why,
        say("See what is said of the description first."),
        judged=False,
    )


def _unnamed(name: str) -> tuple[str, str]:
    return (
        say("there is no property {name} with a number as its value", name=name),
        say('Name it: <xacro:property name="{name}" value="..."/>.', name=name),
    )


def _fault(name: str, model: Model, text: str) -> tuple[str, str]:
    other = parse(text).model if text else None
    if other is None:
        return (
            say("doubling {name} leaves no robot that urdfdom takes", name=name),
            say("Run xacro with the number doubled, and check_urdf on what comes out."),
        )
    if _sizes(model) == _sizes(other):
        return (
            say("doubling {name} changes the size of nothing", name=name),
            say(
                "Use ${{{name}}} where the number stands now, in the geometry and in the inertia.",
                name=name,
            ),
        )
    stays = next(_staying(model, other), "")
    if stays:
        return (
            say(
                "doubling {name} changes the size of a part, and nothing does not move along",
                name=name,
            )
            if stays == _NOTHING
            else say(
                "doubling {name} changes the size of a part, and {link} does not move along",
                name=name,
                link=shown(stays),
            ),
            say(
                "Write the origins of wheels and caster with ${{{name}}}, not as numbers.",
                name=name,
            ),
        )
    return "", ""


def _varied(looked: Looked) -> dict[str, str]:
    """Name -> the description with that number doubled; of two such numbers the one that counts."""
    found: dict[str, str] = {}
    for each in looked.trace.varied:
        as_before = looked.trace.descriptions[each.of].text
        if each.name not in found or each.text != as_before:
            found[each.name] = looked.text(each.text)
    return found


def _model(looked: Looked) -> Model | None:
    texts = [looked.text(each.text) for each in looked.descriptions if each.text >= 0]
    return parse(texts[0]).model if texts else None


def _is_incomplete(looked: Looked) -> bool:
    """Whether urdfdom drops a part, and with it what should change."""
    texts = [looked.text(each.text) for each in looked.descriptions if each.text >= 0]
    found = parse(texts[0]).findings if texts else ()
    return any(each.consequence is Consequence.DROPPED for each in found)


def _sizes(model: Model) -> list[object]:
    return [
        [shape.geometry for shape in shapes]
        for link in model.links.values()
        for shapes in (link.visuals, link.collisions)
    ]


def _staying(one: Model, other: Model) -> Iterator[str]:
    """Links that should move along with a part that has changed its size, and do not.

    They hang on it away from its middle, along the side that has changed. Of a part that is no
    upright box nobody knows which side that is: then something has to move.
    """
    boxes = [(name, *both) for name in one.links if (both := _boxes(one, other, name))]
    if not boxes and not _has_moved(one, other):
        yield _NOTHING
    for part, before, after in boxes:
        for joint in one.joints.values():
            if joint.parent != part or joint.name not in other.joints:
                continue
            for axis in range(3):
                half = before.geometry.size[axis] / 2
                offset = joint.origin.xyz[axis] - before.origin.xyz[axis]
                later = other.joints[joint.name].origin.xyz[axis] - after.origin.xyz[axis]
                has_changed = abs(after.geometry.size[axis] / 2 - half) > _MOVED_M
                if has_changed and abs(offset) > _ASIDE * half and abs(later - offset) <= _MOVED_M:
                    yield joint.child


def _boxes(one: Model, other: Model, link: str) -> tuple[_Shape, _Shape] | None:
    """The upright box that a link shows, before and after."""
    both = [model.links[link].visuals for model in (one, other) if link in model.links]
    if len(both) < 2 or not all(both):
        return None
    before, after = both[0][0], both[1][0]
    if not isinstance(before.geometry, Box) or not isinstance(after.geometry, Box):
        return None
    if before.geometry == after.geometry or any(before.origin.rpy):
        return None
    return _Shape(before.origin, before.geometry), _Shape(after.origin, after.geometry)


def _has_moved(one: Model, other: Model) -> bool:
    """Whether a link lies in another place."""
    before, after = (kinematics.forward(each, {}) for each in (one, other))
    common = before.keys() & after.keys()
    return any(np.abs(before[name] - after[name]).max() > _MOVED_M for name in common)


def judge_masses(looked: Looked, mass_kg: float, error: float) -> Finding:
    """Whether the robot weighs what it should."""
    model = _model(looked)
    if model is None:
        return _no_robot(say("Not judged: there is no robot to weigh."))
    bare = [each.name for each in model.links.values() if each.collisions and not each.inertial]
    if bare:
        return Finding(
            0.5,
            say(
                "The link {link!r} has a collision and no inertial: Gazebo leaves it out.",
                link=bare[0],
            ),
            say("Give every link that can be bumped into a mass and moments of inertia."),
        )
    mass = sum(each.inertial.mass for each in model.links.values() if each.inertial)
    if abs(mass - mass_kg) > error * mass_kg:
        return Finding(
            0.5 if mass else 0,
            say(
                "The robot weighs {weight} in all{links}; expected {wanted}, give or take "
                "{error:g} %.",
                weight=_grams(mass),
                links=_each(model),
                wanted=_grams(mass_kg),
                error=100 * error,
            ),
            say("<mass value=...> is in kilograms: 1 g is 0.001.")
            if mass > 100 * mass_kg
            else say("Add up the masses of all links. Is each link there, and has it its mass?"),
        )
    return Finding(1, say("The robot weighs {weight} in all.", weight=_grams(mass)))


def _each(model: Model) -> str:
    """' (base_link 200 g, wheel 30 g)': which link weighs what, where that fits into a line."""
    masses = [(each.name, each.inertial.mass) for each in model.links.values() if each.inertial]
    if not 0 < len(masses) <= _FEW:
        return ""
    return f" ({', '.join(f'{shown(name)} {_grams(mass)}' for name, mass in masses)})"


def _grams(mass_kg: float) -> str:
    return f"{1000 * mass_kg:.0f} g"
