"""What a package says of its launch files is read, whatever else they hold; nothing is run."""

from __future__ import annotations

import json

import pytest

from grader.packaged import LaunchedNode, Packaged
from grader.submission.opening import open_submission

SETUP = """
import os
from glob import glob
from setuptools import setup
package_name = 'walker'
setup(
    name=package_name, packages=[package_name],
    data_files=[
        ('share/' + package_name, ['package.xml']),
        (os.path.join('share', package_name, 'launch'),
         glob(os.path.join('launch', '*launch.[pxy][yma]*'))),
    ],
    entry_points={'console_scripts': ['state_publisher = walker.state_publisher:main']},
)
"""
PYTHON = """
from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    described = [{'robot_description': open('x').read()}]
    nodes = []
    for name in ('a', 'b'):
        nodes.append(Node(package='walker', executable='state_publisher', name=name))
    return LaunchDescription(nodes + [
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=described)])
"""
XML = """<launch><group>
  <node pkg="walker" exec="state_publisher"><param name="a" value="1"/></node>
  <node pkg="$(var p)" exec="x"/></group><include file="more.launch.xml"/></launch>"""
YAML = "launch:\n- node: {pkg: walker, exec: state_publisher, param: [{name: a, value: 1}]}\n"


@pytest.fixture
def package(tmp_path):
    folder = tmp_path / "ws"
    for name in ("walker", "launch", "urdf"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>walker</name></package>")
    (folder / "setup.py").write_text(SETUP)
    (folder / "walker" / "__init__.py").touch()
    (folder / "walker" / "state_publisher.py").write_text("def main(): pass\n")
    return folder


def told(folder) -> Packaged:
    with open_submission(folder) as submission:
        assert submission.packaged is not None
        return submission.packaged


def test_nodes_are_found_wherever_they_stand(package):
    (package / "launch" / "a.launch.py").write_text(PYTHON)
    found = told(package)
    (launch,) = found.launches
    assert (found.name, found.scripts, found.started) == (
        "walker",
        ("state_publisher",),
        "state_publisher",
    )
    assert set(launch.nodes) == {
        LaunchedNode("walker", "state_publisher", ()),
        LaunchedNode("robot_state_publisher", "robot_state_publisher", ("robot_description",)),
    }
    assert launch.is_installed
    assert not launch.fault


def test_xml_is_read_too_and_of_yaml_nothing_is_known(package):
    (package / "launch" / "a.launch.xml").write_text(XML)
    (package / "launch" / "b.launch.yaml").write_text(YAML)
    a, b = told(package).launches
    assert LaunchedNode("walker", "state_publisher", ("a",)) in a.nodes
    assert LaunchedNode(None, "x", ()) in a.nodes
    assert a.includes
    assert b.nodes == (LaunchedNode(None, None, None),)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("def generate_launch_description(:\n", "it does not parse"),
        ("def launch(): pass\n", "no function generate_launch_description"),
        (PYTHON.replace("executable='state", "node_executable='state"), "no node_executable"),
    ],
)
def test_what_keeps_a_launch_file_from_starting_is_told(package, text, fault):
    (package / "launch" / "a.launch.py").write_text(text)
    assert fault in told(package).launches[0].fault


def test_what_setup_py_does_not_name_is_not_installed(package):
    (package / "urdf" / "walker.urdf").write_text("<robot/>")
    (package / "other").mkdir()
    (package / "other" / "a.launch.py").write_text(PYTHON)
    found = told(package)
    assert found.not_installed == ("urdf/walker.urdf",)
    assert not found.launches[0].is_installed


def test_paths_at_home_are_told(package):
    (package / "launch" / "a.launch.py").write_text(PYTHON.replace("'x'", "'/home/me/x.urdf'"))
    assert told(package).launches[0].absolute == ("/home/me/x.urdf",)


def test_what_is_told_comes_back_from_json_as_it_is(package):
    (package / "launch" / "a.launch.py").write_text(PYTHON)
    found = told(package)
    assert Packaged.from_json(json.loads(json.dumps(found.to_json()))) == found


@pytest.mark.parametrize("data", [None, {}, [], {"name": 1}])
def test_anything_else_is_refused(data):
    with pytest.raises(ValueError, match="expected an object"):
        Packaged.from_json(data)


def test_a_single_file_says_nothing(tmp_path):
    (tmp_path / "node.py").write_text("print()\n")
    with open_submission(tmp_path / "node.py") as submission:
        assert submission.packaged is None
