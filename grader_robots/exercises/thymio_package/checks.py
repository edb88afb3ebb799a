"""The checks: those of any package that describes a robot, and what a Thymio is asked for besides.

Whether the numbers of a xacro are what the robot is made of, and what it weighs.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from grader import Checks, Finding, Tolerances
from grader.submission import shown
from grader.text import NOTHING, Message, msg
from grader_robots.exercises.description_package import checks as of_packages
from grader_robots.exercises.description_package.facts import (
    PackageFacts,
    no_robot,
    of_package,
    unjudged,
)
from grader_robots.exercises.description_package.launching import JOINT_SOURCES, starts_nothing
from grader_robots.exercises.description_package.robots import best_of, readable
from grader_robots.exercises.description_package.spawning import (
    includes_spawner,
    judge_spawning,
    spawners,
)
from grader_robots.exercises.thymio_package import wheels
from grader_robots.robot_py import kinematics
from grader_robots.robot_py.model import Box, Model, Origin
from grader_robots.robot_py.tinyxml import Consequence
from grader_robots.robot_py.urdf import ParsedUrdf, parse

_MOVED_M = 1e-6
#: What hangs on a part so far from its middle, as a share of half of its size, is at its side.
_ASIDE = 0.25
#: The masses of so many links are told one by one.
_FEW = 6

checks = Checks(of_packages.checks, wheels.checks)


class _Shape(NamedTuple):
    origin: Origin
    geometry: Box


@checks()
@of_package
def spawns(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """A launch file puts the robot into Gazebo.

    As `spawn`, and one has to be there.
    """
    return judge_spawning(facts, is_asked=True)


@checks()
@of_package
def parameters(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """The numbers of the xacro are what the robot is made of.

    Each of the properties {numbers} is doubled, and xacro run again: a part has to change its size,
    and what hangs on it away from its middle, along that side, has to move. The share of those that
    do so is the share of the points.
    """
    names = [str(each) for each in tolerances["numbers"]]
    return best_of(facts, lambda robot, number: _moved(robot, names, _varied(facts, number)))


def _moved(parsed: ParsedUrdf, names: list[str], texts: dict[str, str]) -> Finding:
    """Whether what hangs on the robot's parts moves along with the numbers."""
    model = parsed.model
    if model is None:
        return no_robot(msg("Not judged: there is no robot to vary."))
    good, first_fault, help_ = 0, NOTHING, NOTHING
    for name in names:
        fault, advice = _fault(name, model, texts)
        good += not fault
        first_fault, help_ = first_fault or fault, help_ or advice
    is_incomplete = any(each.consequence is Consequence.DROPPED for each in parsed.findings)
    if first_fault and not good and is_incomplete:
        return no_robot(msg("Not judged: there is no robot to vary: parts of it are dropped."))
    if not first_fault:
        return Finding(
            1, msg("What hangs on {names} moves along with them.", names=", ".join(names))
        )
    return Finding(good / max(len(names), 1), msg("In the xacro, {told}.", told=first_fault), help_)


def _fault(name: str, model: Model, texts: dict[str, str]) -> tuple[Message, Message]:
    if name not in texts:
        return (
            msg("there is no property {name} with a number as its value", name=name),
            msg('Name it: <xacro:property name="{name}" value="..."/>.', name=name),
        )
    other = parse(texts[name]).model if texts[name] else None
    if other is None:
        return (
            msg("doubling {name} leaves no robot that urdfdom takes", name=name),
            msg("Run xacro with the number doubled, and check_urdf on what comes out."),
        )
    if _sizes(model) == _sizes(other):
        advice = msg(
            "Use ${{{name}}} where the number stands now, in the geometry and in the inertia.",
            name=name,
        )
        return msg("doubling {name} changes the size of nothing", name=name), advice
    if not (stays := next(_staying(model, other), "")):
        return NOTHING, NOTHING
    fault = msg("doubling {name} changes the size of a part, and {link} does not move along")
    advice = msg("Write the origins of wheels and caster with ${{{name}}}, not as numbers.")
    return fault.given(name=name, link=stays), advice.given(name=name)


def _varied(facts: PackageFacts, number: int) -> dict[str, str]:
    """Name -> a description with that number doubled; of two such numbers the one that counts."""
    found: dict[str, str] = {}
    for each in (each for each in facts.trace.varied if each.of == number):
        as_before = facts.trace.descriptions[each.of].text
        if each.name not in found or each.text != as_before:
            found[each.name] = facts.text(each.text)
    return found


def _sizes(model: Model) -> list[object]:
    return [
        [shape.geometry for shape in shapes]
        for link in model.links.values()
        for shapes in (link.visuals, link.collisions)
    ]


def _staying(one: Model, other: Model) -> Iterator[str | Message]:
    """Links that should move along with a part that has changed its size, and do not.

    They hang on it away from its middle, along the side that has changed. Of a part that is no
    upright box nobody knows which side that is: then something has to move.
    """
    boxes = [(name, *both) for name in one.links if (both := _boxes(one, other, name))]
    if not boxes and not _has_moved(one, other):
        yield msg("what hangs on it")
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
                    yield shown(joint.child)


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


@checks()
@of_package
def masses(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """The robot weighs what it should.

    All links together weigh {mass_kg} kg, give or take {mass_error%}, and each link with a
    collision has an inertial. Otherwise half of the points; none without any mass.
    """
    mass_kg, error = tolerances["mass_kg"], tolerances["mass_error"]
    return best_of(facts, lambda robot, _: _weighed(robot.model, mass_kg, error))


def _weighed(model: Model | None, mass_kg: float, error: float) -> Finding:
    """Whether a robot weighs what it should."""
    if model is None:
        return no_robot(msg("Not judged: there is no robot to weigh."))
    bare = [each.name for each in model.links.values() if each.collisions and not each.inertial]
    if bare:
        rationale = msg(
            "The link {link!r} has a collision and no inertial: Gazebo leaves it out.", link=bare[0]
        )
        help = msg("Give every link that can be bumped into a mass and moments of inertia.")
        return Finding(0.5, rationale, help)
    mass = sum(each.inertial.mass for each in model.links.values() if each.inertial)
    if abs(mass - mass_kg) > error * mass_kg:
        rationale = msg(
            "The robot weighs {weight} in all{links}; expected {wanted}, give or take {error:g} %.",
            weight=_grams(mass),
            links=_each(model),
            wanted=_grams(mass_kg),
            error=100 * error,
        )
        help = msg("Add up the masses of all links. Is each link there, and has it its mass?")
        if mass > 100 * mass_kg:
            help = msg("<mass value=...> is in kilograms: 1 g is 0.001.")
        return Finding(0.5 if mass else 0, rationale, help)
    return Finding(1, msg("The robot weighs {weight} in all.", weight=_grams(mass)))


def _each(model: Model) -> str:
    """' (base_link 200 g, wheel 30 g)': which link weighs what, where that fits into a line."""
    masses = [(each.name, each.inertial.mass) for each in model.links.values() if each.inertial]
    if not 0 < len(masses) <= _FEW:
        return ""
    return f" ({', '.join(f'{shown(name)} {_grams(mass)}' for name, mass in masses)})"


def _grams(mass_kg: float) -> str:
    return f"{1000 * mass_kg:.0f} g"


@checks()
@of_package
def one_source(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """Beside Gazebo nothing else publishes joint states.

    No launch file that puts the robot into Gazebo starts a joint_state_publisher. All or nothing.
    """
    into = [
        each
        for each in facts.launches
        if (spawners(each) or includes_spawner(each)) and starts_nothing(facts, each) is None
    ]
    if readable(facts) == []:
        return no_robot(msg("Not judged: there is no robot that could be put into Gazebo."))
    if not into:
        return unjudged(
            msg("Not judged: no launch file puts the robot into Gazebo."),
            msg("Write that launch file first."),
        )
    for launch in into:
        second = [node for node in launch.nodes if node.package in JOINT_SOURCES]
        if second:
            rationale = msg(
                "{file} starts {executable} beside Gazebo, which publishes the joints "
                "as well: the wheels jump between what turns and what the sliders say.",
                file=launch.file,
                executable=second[0].executable,
            )
            help = msg(
                "Beside a simulator no joint_state_publisher may run; it belongs into "
                "the launch file for RViz alone."
            )
            return Finding(0, rationale, help)
    return Finding(1, msg("Beside Gazebo nothing else publishes joint states."))


@checks.tolerance
def numbers(value: object) -> None:
    """Look at the names of properties."""
    if not isinstance(value, list) or not all(isinstance(each, str) for each in value):
        raise ValueError(f"expected a list of names, found {value!r}")
