"""Whether the numbers of a xacro are what the robot is made of, and what it weighs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from grader.exercise.verdict import Finding
from grader.exercises.description_package.looked import Looked
from robot_py import kinematics
from robot_py.model import Model
from robot_py.urdf import parse

_MOVED_M = 1e-6


def judge(looked: Looked, names: Sequence[str]) -> Finding:
    """Whether doubling a number moves what depends on it."""
    model = _model(looked)
    if model is None:
        return Finding(
            0, "There is no robot to vary.", "See what is said of the description first."
        )
    good, told, help_ = 0, "", ""
    texts = {each.name: looked.text(each.text) for each in looked.trace.varied}
    for name in names:
        if name not in texts:
            fault = f"there is no property {name} with a number as its value"
            advice = f'Name it: <xacro:property name="{name}" value="..."/>.'
        else:
            fault, advice = _fault(name, model, texts[name])
        good += not fault
        told, help_ = told or fault, help_ or advice
    if not told:
        return Finding(1, f"What hangs on {', '.join(names)} moves along with them.")
    return Finding(good / max(len(names), 1), f"In the xacro, {told}.", help_)


def _fault(name: str, model: Model, text: str) -> tuple[str, str]:
    other = parse(text).model if text else None
    if other is None:
        return (
            f"doubling {name} leaves no robot that urdfdom takes",
            "Run xacro with the number doubled, and check_urdf on what comes out.",
        )
    if _sizes(model) == _sizes(other):
        return (
            f"doubling {name} changes the size of nothing",
            f"Use ${{{name}}} where the number stands now, in the geometry and in the inertia.",
        )
    if not _moved(model, other):
        return (
            f"doubling {name} changes the size of a part, and nothing moves along",
            f"Write the origins of wheels and caster with ${{{name}}}, not as numbers.",
        )
    return "", ""


def _model(looked: Looked) -> Model | None:
    texts = [looked.text(each.text) for each in looked.descriptions if each.text >= 0]
    return parse(texts[0]).model if texts else None


def _sizes(model: Model) -> list[object]:
    return [
        [shape.geometry for shape in shapes]
        for link in model.links.values()
        for shapes in (link.visuals, link.collisions)
    ]


def _moved(one: Model, other: Model) -> bool:
    """Whether a link lies in another place, or a shape in its link."""
    before, after = (kinematics.forward(each, {}) for each in (one, other))
    for name in before.keys() & after.keys():
        if np.abs(before[name] - after[name]).max() > _MOVED_M:
            return True
    return False


def judge_masses(looked: Looked, mass_kg: float, error: float) -> Finding:
    """Whether the robot weighs what it should."""
    model = _model(looked)
    if model is None:
        return Finding(
            0, "There is no robot to weigh.", "See what is said of the description first."
        )
    bare = [each.name for each in model.links.values() if each.collisions and not each.inertial]
    if bare:
        return Finding(
            0.5,
            f"The link {bare[0]!r} has a collision and no inertial: Gazebo leaves it out.",
            "Give every link that can be bumped into a mass and moments of inertia.",
        )
    mass = sum(each.inertial.mass for each in model.links.values() if each.inertial)
    if abs(mass - mass_kg) > error * mass_kg:
        return Finding(
            0.5,
            f"The robot weighs {1000 * mass:.0f} g in all; expected {1000 * mass_kg:.0f} g, give "
            f"or take {100 * error:g} %.",
            "Add up the masses of all links.",
        )
    return Finding(1, f"The robot weighs {1000 * mass:.0f} g in all.")
