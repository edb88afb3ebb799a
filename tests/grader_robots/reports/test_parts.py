"""Solids, trees, tables and what is expected of curves, as a page has them; all of it escaped."""

import json
import re

import pytest

from grader.recording.recording import Recording, Recordings, Run
from grader.reports import read as read_report
from grader.reports.page import html
from grader.submission.package_trace import (
    Description,
    LaunchedNode,
    LaunchFile,
    PackageTrace,
    Parameter,
)
from grader_class.gradebook.feedback import Feedback
from grader_class.page.thumb import THUMB, Thumb, thumb
from grader_class.reports import gradescope
from grader_robots.scene.driving import drive
from grader_robots.scene.trace import RobotTrace
from tests.grader.reports import readers, samples
from tests.grader.reports.samples import evidence, verdict
from tests.grader_class.page.classes import entry, result
from tests.grader_robots.scene.robots import walks
from tests.grader_robots.scene.test_view import URDF

EXPECTED = [
    {"curve": "Joint turn", "text": "turns <on>", "within": [-1, 2], "beyond": [0.5, 1.5]},
    {"curve": "Height above odom", "text": "constant"},
    {"curve": "of nothing", "text": "never shown"},
]
EVIL = "</script><img src=x onerror=alert(1)>"


def page_of(folder, trace, scene, *verdicts):
    run = Run(ticks=trace.ticks, simulated_s=trace.duration_ns / 1e9, trace_sha256=trace.sha256())
    recording = Recording(trace, run, scene=scene)
    return html.render(read_report(samples.graded(folder, recording, *verdicts)))


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    judged = verdict("moves", "failed", 2, evidence=[evidence("here", 1.0)], expected=EXPECTED)
    return page_of(tmp_path_factory.mktemp("robot"), drive(walks, 400, URDF), "robot", judged)


def package_trace(name: str = "arm") -> PackageTrace:
    box = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
    urdf = f'<robot name="{name}"><link name="base">{box}</link></robot>'
    node = LaunchedNode(
        "rviz2", EVIL, "", "", (EVIL,), (Parameter("p", EVIL, -1, True),), (), False
    )
    launch = LaunchFile("launch/a.launch.py", None, (node,), (), (), (), (), (), (), "")
    of = Description(0, EVIL, True, "urdf/a.urdf", None, (), True)
    return PackageTrace(launches=(launch,), descriptions=(of,), texts=(urdf,))


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    return page_of(tmp_path_factory.mktemp("package"), package_trace(), "package", verdict("a"))


def test_a_page_with_parts_is_well_formed_loads_nothing_and_runs_its_own_scripts(robot, package):
    assert readers.html(robot) == 2
    assert readers.html(package) == 10
    (policy,) = re.findall(r"script-src ([^\"]*)\"", robot)
    assert len(policy.split()) == 2
    assert "onerror" not in robot


def test_the_solid_s_data_has_a_placing_for_each_time(robot):
    (found,) = re.findall(r'<script type="application/json">(.*?)</script>', robot, re.DOTALL)
    data = json.loads(found)
    assert len(data["t"]) == len(data["frames"][0][1]) > 100
    assert data["t"][-1] == 6.4
    assert [shape[0] for shape in data["shapes"]] == [0, 2]
    assert len(found) < 20_000


def test_what_moves_has_a_player_at_the_solid_and_a_plane_with_its_pins(robot):
    assert robot.count('class="player"') == 1
    solid, plane = robot.index('<figure class="solid">'), robot.index('<svg class="window light"')
    assert solid < robot.index('class="player"') < plane
    assert 'id="pin1"' in robot


def test_a_solid_says_in_words_what_it_shows(robot, package):
    words = "The robot two with 2 links: axis, body; at ("
    assert f'<p class="still">{words}' in robot and f'aria-label="{words}' in robot
    assert "as &lt;/script&gt;&lt;img src=x onerror=alert(1)&gt; describes it" in package


def test_where_a_robot_cannot_be_drawn_it_is_told(tmp_path):
    run = Run(ticks=0, simulated_s=0, trace_sha256=package_trace().sha256())
    recording = Recording(package_trace(), run, scene="package")
    words = "The robot arm with 1 link: base; as &lt;/script&gt;"
    assert words in gradescope.render(read_report(samples.graded(tmp_path, recording)))
    (tmp_path / THUMB).write_bytes(thumb(Recordings(recording)))
    read = Thumb.read(tmp_path)
    assert read is not None and read.picture == ""
    assert read.words.startswith("The robot arm with 1 link: base; as ")
    # feedback, which has no recording, says what a picture would show
    of_class = entry("zoe", result({"a": 10.0}), folder=tmp_path)
    assert "The robot arm with 1 link: base" in Feedback().page(of_class).decode()


def test_frames_are_a_list_with_levels(robot):
    assert re.search(
        r'<li aria-level="2"[^>]*>\s*<b>axis</b><br>\s*<small>31.2 Hz, your node<', robot
    )


def test_what_is_expected_stands_at_its_curve(robot):
    assert "Expected: turns &lt;on&gt;" in robot
    assert "Expected: constant" in robot
    assert "never shown" not in robot
    # the plot goes from 0 to 4: from there to 2 is its lower half
    assert '<rect class="within" y="50.00" width="500" height="50.00"/>' in robot
    assert robot.count('class="beyond"') == 2


def test_a_package_has_a_table_and_neither_plane_nor_player(package):
    assert 'class="window' not in package
    assert 'class="player"' not in package
    assert "What the package describes" in package
    assert '<th scope="col" role="columnheader">Program</th>' in package
    assert EVIL not in package


@pytest.mark.parametrize(
    ("trace", "scene"),
    [(RobotTrace(0), "robot"), (PackageTrace(), "package")],
    ids=lambda v: str(v)[:5],
)
def test_where_nothing_was_found_the_page_says_so_and_works(trace, scene, tmp_path):
    page = page_of(tmp_path, trace, scene, verdict("a", "failed", 0, evidence=[evidence()]))
    readers.html(page)
    assert "<canvas" not in page
    assert "no robot description was" in page or "no transform from odom" in page


def test_a_page_of_turtles_or_without_a_recording_has_nothing_of_it():
    page = html.render(samples.report(verdict("a")))
    for part in (".solid", "turning", "aspect-ratio: 1", "data-heading", "<canvas", '="still"'):
        assert part not in page
