"""The robot that a package's launch file hands on is drawn; where there is none, that is said."""

import base64
from dataclasses import replace

import numpy as np
import pytest

from grader.submission.package_trace import Description, NamedMesh, PackageTrace, decode, encode
from grader.submission.subject import PACKAGE
from grader_robots.scene import described

URI = "package://a/meshes/b.stl"
URDF = f"""<robot name="arm"><link name="base"><visual><geometry><box size="1 1 1"/></geometry>
  </visual></link><link name="boom"><visual><geometry><mesh filename="{URI}"/></geometry></visual>
  </link><joint name="shoulder" type="revolute"><parent link="base"/><child link="boom"/>
  <origin xyz="0 0 1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint></robot>"""
CORNERS = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 0, 2]]])


def told(corners) -> str:
    return base64.b64encode(corners.astype("<f4").tobytes()).decode()


def trace(text=URDF, surfaces=(), mesh=-1) -> PackageTrace:
    meshes = (NamedMesh(URI, "found", "/prefix/share/a/meshes/b.stl", True, mesh),)
    of = Description(0, "launch/a.launch.py", True, "urdf/a.urdf", None, meshes, True)
    return PackageTrace(descriptions=(of,), texts=(text,), surfaces=surfaces)


def test_a_mesh_that_was_read_is_drawn_and_any_other_named():
    with_mesh = trace(surfaces=(told(CORNERS),), mesh=0)
    solid = described.solid(with_mesh)
    assert [shape.kind for shape in solid.shapes] == ["box", "triangles"]
    assert solid.shapes[1].sizes == tuple(CORNERS.ravel())
    assert solid.left_out == () and "not drawn" not in str(solid.text)
    without = described.solid(trace())
    assert (without.left_out, len(without.shapes)) == ((URI,), 1)


@pytest.mark.parametrize(
    "surface", ["?", "AAAA", told(np.full((1, 3, 3), np.nan)), "AAAA" * 9 + "=" * 7]
)
def test_a_surface_that_is_none_is_as_if_nobody_had_read_it(surface):
    assert described.solid(trace(surfaces=(surface,), mesh=0)).left_out == (URI,)


def test_a_trace_with_a_surface_that_is_not_there_is_none():
    whole = trace(surfaces=(told(CORNERS),), mesh=0)
    assert decode(encode(whole)) == whole
    with pytest.raises(ValueError, match="a surface that is not there"):
        decode(encode(replace(whole, surfaces=())))


def test_the_tree_has_a_link_for_each_joint():
    tree = described.links(trace())
    assert [(n.depth, n.name, str(n.text)) for n in tree.nodes] == [
        (0, "base", "the root"),
        (1, "boom", "shoulder, revolute"),
    ]


@pytest.mark.parametrize(
    "text",
    [
        *("", "no XML", "<robot name='a'/>", "<!DOCTYPE a><robot/>", " " * 600_000),
        "<robot name='a'>" + "<link name='b'/>" * 3,
    ],
)
def test_what_is_no_robot_is_told(text):
    odd = trace(text)
    assert described.solid(odd) is None and described.links(odd) is None
    assert str(described.words(odd)) == "the robot description cannot be drawn"


def test_links_that_go_round_in_a_circle_are_not_followed():
    joint = '<joint name="{}" type="fixed"><parent link="{}"/><child link="{}"/></joint>'
    names = "".join(f'<link name="{name}"/>' for name in "abc")
    joints = "".join(joint.format(n, *n) for n in ("ab", "bc", "cb"))
    assert described.solid(trace(f'<robot name="r">{names}{joints}</robot>')) is None


def test_very_many_links_are_shown_as_far_as_there_is_room():
    links = "".join(
        f'<link name="l{k}"><visual><geometry><sphere radius=".1"/></geometry></visual></link>'
        for k in range(700)
    )
    joints = "".join(
        f'<joint name="j{k}" type="fixed"><parent link="l0"/><child link="l{k}"/></joint>'
        for k in range(1, 700)
    )
    many = trace(f'<robot name="r">{links}{joints}</robot>')
    solid, tree = described.solid(many), described.links(many)
    assert (len(solid.frames), len(solid.shapes)) == (400, 400)
    assert "550 more links are not shown" in str(tree.note)


def test_nothing_that_was_found_is_a_page_of_nothing():
    view = PACKAGE.view(PackageTrace())
    assert view.parts == () and tuple(map(str, view.drawn)) == ("no robot description was found",)
