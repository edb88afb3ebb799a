"""Scenes and report formats of others are checked without a run."""

from dataclasses import replace
from itertools import count

import pytest

from grader.reports import Format
from grader.reports.formats import load
from grader.scenes.subject import load_subject
from grader.scenes.turtlesim.scene import Turtlesim
from grader.system import extensions
from grader.testing import check_report, check_scene
from grader.testing import extensions as checked
from grader.text.message import msg
from tests.grader.reports.samples import CLASSROOM50, FORMATS


@pytest.mark.parametrize("name", extensions.points(extensions.SCENES))
def test_every_scene_is_in_order(name):
    setting = "" if not load_subject(name).wrong_setting("") else ROBOT
    assert list(map(str, check_scene(name, setting))) == []


ROBOT = '<robot name="r"><link name="base"/></robot>'


class Forgets(Turtlesim):
    def from_channels(self, channels, duration_ns):
        return super().from_channels([c for c in channels if "cmd_vel" not in c.topic], duration_ns)


class LacksATurtle(Turtlesim):
    def from_channels(self, channels, duration_ns):
        raise KeyError("turtle1")


class DefinesNothing(Turtlesim):
    def bag_topics(self, trace):
        return [("/lamp", "lamps/msg/Lamp")]


@pytest.mark.parametrize(
    ("scene", "told"),
    [
        (Forgets, "from_channels() gives back another sha256() than to_messages() got"),
        (LacksATurtle, "from_channels() cannot read to_messages(): KeyError"),
        (DefinesNothing, "ValueError: there is no definition of lamps/msg/Lamp"),
    ],
)
def test_a_scene_that_reads_something_else_than_it_wrote_is_told(monkeypatch, scene, told):
    monkeypatch.setattr(checked, "load_subject", lambda name: scene())
    problems = list(map(str, check_scene("turtlesim")))
    assert problems
    assert any(told in problem for problem in problems)


@pytest.mark.parametrize("name", FORMATS)
def test_every_report_format_is_in_order(name, monkeypatch):
    for key, value in CLASSROOM50.items():
        monkeypatch.setenv(key, value)
    assert list(map(str, check_report(name))) == []


def test_a_format_that_fails_or_changes_or_says_nothing_is_told(monkeypatch):
    numbers = count()
    form = Format(msg("number"), lambda report: str(next(numbers)), lambda report: " ")
    monkeypatch.setattr(checked, "load", lambda name: form)
    assert list(map(str, check_report("mine"))) == [
        "a finished result: writes something else the second time",
        "a failed result: writes something else the second time",
        "an aborted grading: writes nothing",
    ]
    broken = replace(load("terminal"), render=lambda report: 1 / 0)
    monkeypatch.setattr(checked, "load", lambda name: broken)
    problems = list(map(str, check_report("mine")))
    assert problems == [
        f"{what}: raises ZeroDivisionError('division by zero')"
        for what in ("a finished result", "a failed result")
    ]
