"""What is drawn is where arithmetic says, the nearer before the farther, in its link's colour."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace

import numpy as np
import pytest

from robot_py.drawing import NOBODY, body, picture
from robot_py.drawing.body import triangles
from robot_py.drawing.picture import Camera, nearest
from robot_py.kinematics import forward
from robot_py.model import Box, Cylinder, Sphere
from robot_py.urdf import parse

RED, GREEN, BLUE = "1 0 0 1", "0 1 0 1", "0 0 1 1"


def link(name: str, shape: str, rgba: str) -> str:
    return (
        f'<link name="{name}"><visual><geometry>{shape}</geometry>'
        f'<material name="of_{name}"><color rgba="{rgba}"/></material></visual></link>'
    )


def joint(name: str, child: str, xyz: str, parent: str = "base") -> str:
    return (
        f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/></joint>'
    )


def model(*parts: str):
    made = parse(f'<robot name="a">{"".join(parts)}</robot>').model
    assert made is not None
    return made


#: Of the pictures here.
SIZE_PX = 200
BALL = '<sphere radius="0.2"/>'
#: The red ball in front of the blue one, as the camera looks at it; the green one beside.
FRONT = 3 * np.array((math.cos(0.69813), math.sin(0.69813), math.tan(0.41888)))
THREE = model(
    link("base", BALL, BLUE),
    link("near", BALL, RED),
    link("side", BALL, GREEN),
    joint("a", "near", " ".join(map(str, FRONT))),
    joint("b", "side", "-0.9 0.9 0"),
)


def seen(robot, point, size_px=SIZE_PX):
    """Where a place is in its picture: row, column."""
    pixels, ahead = Camera.at(robot.corners.reshape(-1, 3), size_px).seen(np.array(point))
    assert ahead > 0
    return int(pixels[1]), int(pixels[0])


def strongest(pixel) -> str:
    return ["red", "green", "blue"][int(np.argmax(pixel))]


def drawn(of, positions=None, **more):
    robot = body(of, forward(of, positions or {}))
    return robot, picture(robot, SIZE_PX, robot.lowest_m, **more)


def test_each_link_is_where_it_should_be_in_its_own_colour():
    robot, pixels = drawn(THREE)
    assert strongest(pixels[seen(robot, (-0.9, 0.9, 0.0))]) == "green"
    assert strongest(pixels[seen(robot, tuple(FRONT))]) == "red"


def test_what_is_nearer_hides_what_is_farther():
    hidden = (0.0, 0.0, 0.0)
    apart = model(link("base", BALL, BLUE))
    alone, shown = drawn(apart)
    assert strongest(shown[seen(alone, hidden)]) == "blue"
    robot, pixels = drawn(THREE)
    there = pixels.astype(int)
    is_blue = (there[..., 2] > 150) & (there[..., 0] < 60) & (there[..., 1] < 60)
    is_red = (there[..., 0] > 150) & (there[..., 1] < 60)
    assert strongest(pixels[seen(robot, hidden)]) == "red"
    assert is_red.sum() > 1.5 * is_blue.sum()


def test_of_two_triangles_the_nearer_counts_pixel_by_pixel():
    """Two that cross each other: left of the middle one is nearer, right of it the other."""
    square = np.array([[[0.0, 0], [10, 0], [0, 10]], [[0, 0], [10, 0], [0, 10]]])
    ahead = np.array([[1.0, 2.0, 1.0], [2.0, 1.0, 2.0]])
    found, nearness = nearest(square, ahead, 10)
    assert found[0].tolist() == [0] * 5 + [1] * 5
    assert found[9, 5] == -1 and nearness[9, 5] == 0
    # over a plane the inverse of the distance is linear: at x = 0.5 and 9.5 of 10
    assert nearness[0, 0] == pytest.approx(1 - 0.05 * 0.5)


def test_a_ball_is_round_and_as_large_as_perspective_makes_it():
    one = model(link("base", '<sphere radius="0.5"/>', RED))
    robot, pixels = drawn(one)
    there = pixels.astype(int)
    is_ball = (there[..., 0] - there[..., 2] > 40) & (there[..., 1] < 80)
    rows, columns = np.flatnonzero(is_ball.any(axis=1)), np.flatnonzero(is_ball.any(axis=0))
    camera = Camera.at(robot.corners.reshape(-1, 3), SIZE_PX)
    away = float(np.sqrt((camera.eye**2).sum()))
    expected = 2 * camera.focal_px * 0.5 / math.sqrt(away**2 - 0.25)
    assert len(columns) == pytest.approx(expected, rel=0.03)
    assert len(rows) == pytest.approx(expected, rel=0.03)


def test_the_same_robot_gives_the_same_bytes():
    first, second = (drawn(THREE, labels=("words",))[1].tobytes() for _ in range(2))
    assert hashlib.sha256(first).digest() == hashlib.sha256(second).digest()


@pytest.mark.parametrize("far", [np.nan, np.inf, 1e9])
def test_a_link_without_a_place_is_white_and_at_the_origin(far):
    frames = forward(THREE, {})
    frames["near"] = frames["near"].copy()
    frames["near"][0, 3] = far
    del frames["side"]
    robot = body(THREE, frames)
    assert robot.lost == ("near", "side")
    pixels = picture(robot, SIZE_PX, robot.lowest_m)
    assert pixels[seen(robot, (0.0, 0.0, 0.19))].min() > 150
    whites = robot.corners[(robot.colours == 1).all(axis=1)]
    assert np.abs(whites).max() < 0.21


def test_no_robot_is_an_empty_ground_with_its_words():
    empty, said = picture(NOBODY), picture(NOBODY, labels=("nothing was recorded",))
    assert empty.shape == (500, 500, 3)
    assert (empty != said).any()


def test_a_way_on_the_ground_is_in_the_picture():
    robot = body(THREE, forward(THREE, {}))
    angles = np.linspace(0, 6, 50)
    way = 4 * np.column_stack((np.cos(angles), np.sin(angles)))
    with_way = picture(robot, SIZE_PX, ways=(way,)).astype(int)
    is_ink = (with_way[..., 2] > 180) & (with_way[..., 0] < 120)
    assert is_ink.sum() > 200
    assert not is_ink[[0, -1]].any() and not is_ink[:, [0, -1]].any()


def test_glass_lets_through_what_is_behind_and_hides_nothing_before_it():
    behind = model(
        link("base", '<box size="0.4 0.4 0.4"/>', RED),
        link("glass", '<box size="1 1 1"/>', "0 0 1 0.4"),
        joint("a", "glass", "0 0 0"),
    )
    robot, pixels = drawn(behind)
    red, green, blue = pixels[seen(robot, (0.2, 0.2, 0.0))].astype(int)
    assert red > green and blue > green


def test_a_shape_of_no_size_or_without_end_is_left_out_and_told():
    made = model(
        link("base", BALL, RED),
        link("huge", '<sphere radius="1e300"/>', RED),
        joint("a", "huge", "0 0 0"),
    )
    robot, _ = drawn(made)
    assert robot.left_out == ("a shape of huge",)


def test_a_mesh_is_drawn_where_somebody_has_read_it_and_named_where_not():
    mesh = '<mesh filename="package://a/b.stl" scale="2 2 2"/>'
    made = model(link("base", mesh, RED))
    assert drawn(made)[0].left_out == ("package://a/b.stl",)
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 0, 1]]])
    robot = body(made, forward(made, {}), {"package://a/b.stl": corners})
    assert robot.left_out == ()
    assert robot.corners.tolist() == (2 * corners).tolist()


def test_very_many_shapes_are_drawn_coarsely_and_end_at_a_limit():
    base = THREE.links["base"]
    many = replace(base, visuals=base.visuals * 1000)
    crowd = replace(THREE, links={"base": many}, joints={})
    robot = body(crowd, {"base": np.eye(4)})
    assert len(robot.corners) <= 100_000
    gone = replace(crowd, links={"base": replace(base, visuals=base.visuals * 2000)})
    assert body(gone, {"base": np.eye(4)}).left_out == ("a shape of base",)


def test_triangles_that_cover_the_picture_too_often_are_left_out_and_told():
    mesh = '<mesh filename="package://a/b.stl"/>'
    made = model(link("base", BALL, RED), link("b", mesh, RED), joint("a", "b", "0 0 0"))
    one = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 0, 1]]])
    few, many = (
        body(made, forward(made, {}), {"package://a/b.stl": np.repeat(one, count, axis=0)})
        for count in (500, 2000)
    )
    assert few.left_out == ()
    assert many.left_out == ("package://a/b.stl",)
    assert len(many.corners) + 500 == len(few.corners)


@pytest.mark.parametrize(
    ("shape", "area"),
    [
        (Box((1.0, 2.0, 3.0)), 22.0),
        (Cylinder(1.0, 2.0), 6 * math.pi),
        (Sphere(2.0), 16 * math.pi),
    ],
)
def test_surfaces_are_closed_and_look_outwards(shape, area):
    made = triangles(shape, 64)
    a, b, c = (made.corners[:, k] for k in range(3))
    across = np.cross(b - a, c - a) / 2
    assert np.abs(across.sum(axis=0)).max() < 1e-9
    assert np.sqrt((across**2).sum(axis=1)).sum() == pytest.approx(area, rel=0.01)
    assert ((across * made.normals[:, 0]).sum(axis=1) >= -1e-9).all()
    assert ((made.corners * made.normals).sum(axis=2) > 0).all()
