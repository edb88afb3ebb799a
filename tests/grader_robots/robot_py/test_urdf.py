"""URDF: accepted and refused as urdfdom does it, with its words; then as data."""

import json
import random
from itertools import groupby
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader_robots.robot_py import urdf
from grader_robots.robot_py.model import (
    BLACK,
    Box,
    Cylinder,
    Inertial,
    JointType,
    Limit,
    Material,
    Mesh,
    Mimic,
    Origin,
    Sphere,
)
from grader_robots.robot_py.tinyxml import Consequence
from grader_robots.robot_py.urdf import parse
from tests.grader_robots.robot_py import urdf_cases as cases

URDFDOM = json.loads(Path(__file__).with_name("urdfdom.json").read_text())
ROBOTS = Path(__file__).parent / "robots"


@pytest.mark.parametrize("urdfdom", URDFDOM, ids=range(len(URDFDOM)))
def test_what_urdfdom_says_is_said(urdfdom):
    reading = parse(urdfdom["text"])
    lines = [line for line, _ in groupby(map(str, reading.findings))]
    assert (reading.model is not None, lines) == (urdfdom["accepted"], urdfdom["lines"])


def accepted(text: str):
    reading = parse(text)
    assert reading.model is not None, reading.findings
    return reading


def test_a_robot_as_data():
    model = accepted((ROBOTS / "walker.urdf").read_text()).model
    assert (model.name, model.root) == ("walker", "axis")
    assert list(model.links) == ["axis", "leg1", "leg2", "body", "head", "rod", "box"]
    assert list(model.joints)[2:5] == ["tilt", "swivel", "periscope"]
    tilt = model.joints["tilt"]
    assert (tilt.type, tilt.parent, tilt.child) == (JointType.REVOLUTE, "axis", "body")
    assert (tilt.axis, tilt.limit) == ((0, 1, 0), Limit(-0.6, 0.1, 10, 10))
    assert tilt.origin == Origin((0.01, 0, 0.02))
    assert model.joints["boxconnect"].axis == (0, 0, 0)
    axis = model.links["axis"]
    assert axis.inertial == Inertial(Origin((0, 0, 0.01)), 1.5, 0.4, 0, 0, 0.5, 0, 0.3)
    assert axis.visuals[0].geometry == Cylinder(0.012, 0.46) == axis.collisions[0].geometry
    assert axis.visuals[0].origin == Origin(rpy=(1.5707963, 0, 0))
    assert model.links["leg1"].visuals[0].geometry == Box((0.022, 0.11, 0.55))
    assert model.links["head"].visuals[0].geometry == Sphere(0.38)
    grey = model.links["rod"].visuals[0].material
    assert grey == axis.visuals[0].material
    assert grey.rgba == pytest.approx((0.2, 0.2, 0.2, 1))


def test_a_mimic_and_a_mesh_as_data():
    model = accepted((ROBOTS / "rover.urdf").read_text()).model
    expected = Mimic("left_finger_joint", 0.9, 0.002)
    assert model.joints["right_finger_joint"].mimic == expected
    mesh = '<mesh filename="package://p/meshes/a.stl" scale="1 2 3"/>'
    link = accepted(cases.shape(mesh)).model.links["a"]
    assert link.visuals[0].geometry == Mesh("package://p/meshes/a.stl", (1, 2, 3))


def test_the_rest_of_a_link_goes_with_a_part_that_is_malformed():
    visual = f"<visual>{cases.BOX}</visual>"
    reading = accepted(cases.link(f"{visual}<visual/>{visual}<collision>{cases.BOX}</collision>"))
    assert Consequence.DROPPED in {found.consequence for found in reading.findings}
    link = reading.model.links["a"]
    assert (len(link.visuals), len(link.collisions)) == (1, 0)


def test_a_material_of_the_robot_is_taken_before_one_of_the_visual():
    blue = '<color rgba="0 0 1 1"/>'
    text = cases.robot(
        f'<material name="m">{cases.RED}</material><link name="a"><visual>{cases.BOX}'
        f'<material name="m">{blue}</material></visual></link>'
    )
    assert accepted(text).model.links["a"].visuals[0].material.rgba == (1, 0, 0, 1)


def test_three_numbers_make_a_black_that_nobody_complains_of():
    text = cases.visual(f'{cases.BOX}<material name="m"><color rgba="1 1 1"/></material>')
    reading = accepted(text)
    assert reading.findings == ()
    assert reading.model.links["a"].visuals[0].material == Material("m", BLACK)


def test_an_axis_without_numbers_is_none_and_no_axis_is_x():
    axis = accepted(cases.moving(cases.LIMIT + "<axis/>")).model.joints["j"].axis
    assert axis == (0, 0, 0)
    assert accepted(cases.moving(cases.LIMIT)).model.joints["j"].axis == (1, 0, 0)


def test_findings_say_on_which_line():
    findings = parse(cases.visual("\n<geometry>\n<cone/></geometry>")).findings
    told = [(found.line, found.consequence) for found in findings]
    assert told == [(3, Consequence.DROPPED)] * 2


def test_what_is_only_warned_of_drops_nothing():
    reading = accepted(cases.visual(f'{cases.BOX}<material name="q"/>'))
    assert [found.consequence for found in reading.findings] == [Consequence.WARNED]


def test_what_stands_behind_a_zero_byte_is_not_read():
    assert accepted(cases.RIGHT + "\0<<<")


def test_a_text_that_is_too_long_is_not_read(monkeypatch):
    monkeypatch.setattr(urdf, "LONGEST", 20)
    reading = parse(cases.RIGHT)
    assert reading.model is None
    assert "too many for a URDF: 20 at most" in str(reading.findings[0])


def test_an_entity_is_never_expanded():
    bomb = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>'
    model = accepted(f'{bomb}<robot name="&b;"><link name="a"/></robot>').model
    assert model.name == "&b;"


@pytest.mark.timeout(20)
@pytest.mark.parametrize(
    "text",
    [
        cases.shape(f'<sphere radius="{"1" * 1_000_000}x"/>'),
        cases.shape(f'<box size="{"1 " * 1_000_000}"/>'),
        cases.shape(f'<sphere radius="{" " * 1_000_000}x"/>'),
        cases.link("&#" + "1" * 1_000_000),
        f'<robot name="{"&#1" * 1_000_000}"/>',
        "<a>" * 1_000_000,
        f"<a {' ' * 1_000_000}",
        "<!--" * 1_000_000,
    ],
    ids=["digits", "vector", "blanks", "text", "references", "depth", "tag", "comments"],
)
def test_a_long_text_is_read_in_one_go(text):
    parse(text)


@given(st.text(alphabet="<>/=!?-[]\"' \nab&;#x1", max_size=60))
def test_there_is_an_answer_to_every_text(text):
    assert parse(text).findings


@pytest.mark.parametrize("seed", range(20))
def test_there_is_an_answer_to_every_damaged_robot(seed):
    chance = random.Random(seed)
    text = (ROBOTS / "rover.urdf").read_text()
    for _ in range(30):
        start = chance.randrange(len(text))
        damaged = text[:start] + text[start + chance.randrange(1, 40) :]
        reading = parse(damaged)
        assert reading.model is not None or reading.findings
